//! How to read the plots.

pub(in super::super) const ALLAN: &str = "How much the means of neighbouring blocks of τ seconds differ. On the left the curve falls, as white \
     noise averages out (slope −½); on the right it rises, as the bias walks away (slope +½). Dots are measured, \
     bands are their intervals. The thick line is the fit of all three axes together (the row “all” of the tables). \
     Dashed lines are its terms: white noise N/√τ, which is N at τ = 1 s; the walk K√(τ/3), which is K at \
     3 s; flicker, where there is any, a flat line at 0.664 B. Circles mark N at 1 s, K at 3 s, the lowest point of the \
     fit, and B on its flat line. Violet averaging times were not used for the fit: at the left end because they contradict the longer \
     ones, at the right end because too few blocks are left to decide anything.";

pub(in super::super) const RESIDUAL: &str = "Measured over fitted, a number without a unit. Each axis is divided by its own fit (the rows x, y \
     and z of the tables). Where the bars (intervals) touch 1, the fit explains the sensor; of ten bars one may \
     miss it by chance. Below 1 on the left: a low-pass filter. Above 1 on the right: drift, temperature or motion. \
     Above 1 in the middle and below it on the right: flicker that was not fitted.";

pub(in super::super) const SIGNAL: &str = "The signal about its mean: the band is its range, the line its mean. Bands that lie on each other look \
     grey. Violet, if there is any: moved, touched, or a sensor that hung and repeated \
     itself. Yellow: the sensor warmed up. The warnings say what was left out.";
