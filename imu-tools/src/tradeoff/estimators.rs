//! Ways from samples to N and K that are compared.

use imu_core::allan::{AllanLadder, Difference, Octave, Parameter, Sampling, fit_noise};

use crate::calibrate::batch::Batch;
use crate::calibrate::block_means::BlockMeans;
use crate::calibrate::{maximum_likelihood, slope};

/// Octaves of the ladders: as many as `imu calibrate` has for hours at hundreds of hertz.
pub(super) const LEVELS: usize = 24;

/// How variances are gathered from samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gather {
    /// A ladder of octaves over disjoint blocks: the smallest.
    Disjoint,
    /// A ladder with four windows an averaging time: what `imu calibrate` uses.
    FourWindows,
    /// Every overlapping window at every octave, of a record that is kept in memory.
    Overlapping,
    /// Means of blocks of half a second or more, at most 2¹⁶ of them.
    BlockMeans,
}

/// The numbers that samples and sums are kept in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

/// How N and K are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The likelihood of all octaves with their degrees of freedom ([`imu_core::allan::fit_noise`]).
    Fit,
    /// Exact maximum likelihood ([`maximum_likelihood`]).
    MaximumLikelihood,
    /// Lines of slope ∓½, read at 1 s and 3 s, as kalibr_allan does ([`slope`]).
    Slope,
}

/// One way from samples to N and K.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Estimator {
    /// How variances are gathered.
    pub gather: Gather,
    /// In which numbers.
    pub scalar: Scalar,
    /// How they are read.
    pub method: Method,
}

/// All that are compared.
pub(super) const ESTIMATORS: [Estimator; 11] = {
    use Gather::{BlockMeans, Disjoint, FourWindows, Overlapping};
    use Method::{Fit, MaximumLikelihood, Slope};
    use Scalar::{F32, F64};
    const fn of(gather: Gather, scalar: Scalar, method: Method) -> Estimator {
        Estimator { gather, scalar, method }
    }
    [
        of(Disjoint, F32, Fit),
        of(Disjoint, F32, Slope),
        of(Disjoint, F64, Fit),
        of(Disjoint, F64, Slope),
        of(FourWindows, F32, Fit),
        of(FourWindows, F32, Slope),
        of(FourWindows, F64, Fit),
        of(FourWindows, F64, Slope),
        of(Overlapping, F64, Fit),
        of(Overlapping, F64, Slope),
        of(BlockMeans, F64, MaximumLikelihood),
    ]
};

/// What each estimator says of an axis.
pub(super) type Estimates = [(Parameter, Parameter); ESTIMATORS.len()];

/// What all estimators say of the three axes of a record, sampled every `tau0_s` seconds.
pub(super) fn estimate(tau0_s: f64, values: &[[f64; 3]]) -> [Estimates; 3] {
    let single: Vec<[f32; 3]> = values.iter().map(|row| row.map(|x| x as f32)).collect();
    let mut disjoint32 = AllanLadder::<f32, 3, LEVELS, 1>::new();
    let mut disjoint64 = AllanLadder::<f64, 3, LEVELS, 1>::new();
    let mut windows32 = AllanLadder::<f32, 3, LEVELS, 4>::new();
    let mut windows64 = AllanLadder::<f64, 3, LEVELS, 4>::new();
    let mut means = BlockMeans::new();
    disjoint32.extend(&single);
    disjoint64.extend(values);
    windows32.extend(&single);
    windows64.extend(values);
    means.extend(values);
    let likelihood = maximum_likelihood::fit(&means, tau0_s, 0.0);
    [0, 1, 2].map(|axis| {
        let column: Vec<f64> = values.iter().map(|row| row[axis]).collect();
        let overlapping = overlapping(&column);
        ESTIMATORS.map(|Estimator { gather, scalar, method }| {
            let octaves = match (gather, scalar) {
                (Gather::BlockMeans, _) => {
                    let axis = likelihood.axes[axis];
                    return (axis.noise_density, axis.random_walk);
                }
                (Gather::Disjoint, Scalar::F32) => disjoint32.octaves(axis),
                (Gather::Disjoint, Scalar::F64) => disjoint64.octaves(axis),
                (Gather::FourWindows, Scalar::F32) => windows32.octaves(axis),
                (Gather::FourWindows, Scalar::F64) => windows64.octaves(axis),
                (Gather::Overlapping, _) => overlapping,
            };
            read(&octaves, method, sampling(gather, tau0_s))
        })
    })
}

/// How the windows of a ladder lie. Those that overlap in every sample are read as if there were four
/// an averaging time, of which they are averages.
pub(super) fn sampling(gather: Gather, tau0_s: f64) -> Sampling {
    let windows = if gather == Gather::Disjoint { 1 } else { 4 };
    Sampling { tau0_s, difference: Difference::Allan, windows, records: 1 }
}

/// N and K from octaves.
pub(super) fn read(
    octaves: &[Octave; LEVELS],
    method: Method,
    sampling: Sampling,
) -> (Parameter, Parameter) {
    match method {
        Method::Slope => {
            let reading = slope::kalibr_allan(&[octaves], sampling.tau0_s);
            let parameter = |value: Option<f64>| match value {
                Some(value) => {
                    let (low90, high90) = (f64::NAN, f64::NAN);
                    Parameter::Observable { value, sd: f64::NAN, low90, high90 }
                }
                None => Parameter::NotObservable { upper90: f64::NAN, record_at_least_s: f64::NAN },
            };
            (parameter(reading.noise_density), parameter(reading.random_walk))
        }
        Method::Fit | Method::MaximumLikelihood => {
            let fit = fit_noise(octaves, sampling);
            (fit.noise_density, fit.random_walk)
        }
    }
}

/// The octaves of a record over every window.
pub(super) fn overlapping(values: &[f64]) -> [Octave; LEVELS] {
    let batch = Batch::new(values).ok();
    let mut level = 0;
    [(); LEVELS].map(|()| {
        let samples = 1 << level;
        level += 1;
        let mut octave = Octave { samples, differences: 0, variance: 0.0, white_gain: 1.0 };
        let reading =
            batch.as_ref().and_then(|batch| batch.reading(Difference::Allan, samples as usize, 1));
        if let Some(reading) = reading {
            octave.variance = reading.variance;
            octave.differences = (reading.differences as u64 - 1) / (samples / 4).max(1) + 1;
        }
        octave
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlapping_octaves_agree_with_the_ladder_of_four_windows() {
        // Sums of three sines: anything but a constant.
        let value = |k: f64| (0.1 * k).sin() + (0.7 * k).cos() + (1e-3 * k).sin();
        let values: Vec<[f64; 3]> = (0..4096).map(|k| [value(f64::from(k)); 3]).collect();
        let mut ladder = AllanLadder::<f64, 3, LEVELS, 4>::new();
        ladder.extend(&values);
        let column: Vec<f64> = values.iter().map(|row| row[0]).collect();
        for (level, (one, four)) in overlapping(&column).iter().zip(ladder.octaves(0)).enumerate() {
            assert_eq!(one.samples, four.samples);
            if level < 3 {
                // At τ of 1, 2 and 4 samples four windows are all there are.
                assert!((one.variance / four.variance - 1.0).abs() < 1e-12, "{one:?} {four:?}");
                assert_eq!(one.differences, four.differences);
            } else if four.differences > 0 {
                assert!(one.differences.abs_diff(four.differences) <= 1, "{one:?} {four:?}");
            }
        }
    }
}
