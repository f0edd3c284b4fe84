//! From values to pixels, and where the ticks stand.

/// An axis of a chart: the values at its ends, and how they are laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Linear,
    Decades,
}

/// A tick: where, and what is written at it (nothing at a minor one).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

impl Scale {
    /// Around positive values, logarithmic, with a little room at both ends; a decade at least.
    pub(super) fn decades(values: impl Iterator<Item = f64>) -> Self {
        let positive = values.filter(|v| *v > 0.0 && v.is_finite());
        let (low, high) = extent(positive).unwrap_or((0.1, 10.0));
        let room = 1.25;
        let (mut low, mut high) = (low / room, high * room);
        let lacking = (10.0 * low / high).max(1.0).sqrt();
        (low, high) = (low / lacking, high * lacking);
        Self { low, high, kind: Kind::Decades }
    }

    /// From one value to another, linear.
    pub(super) fn between(low: f64, high: f64) -> Self {
        let least = 1e-12 * low.abs().max(high.abs()).max(1e-300);
        Self { low, high: high.max(low + least), kind: Kind::Linear }
    }

    /// Around values, linear, with room for a twentieth more at both ends.
    pub(super) fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extent(values.filter(|v| v.is_finite())).unwrap_or((-1.0, 1.0));
        let room = (0.05 * (high - low)).max(1e-9 * low.abs().max(high.abs())).max(1e-300);
        Self { low: low - room, high: high + room, kind: Kind::Linear }
    }

    /// The ends.
    pub(super) fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Where a value lies: 0 at the low end, 1 at the high one.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self.kind {
            Kind::Linear => (value - self.low) / (self.high - self.low),
            Kind::Decades => {
                (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln()
            }
        }
    }

    /// Ticks from the low end up: at most some ten with a label.
    pub(super) fn ticks(&self) -> Vec<Tick> {
        match self.kind {
            Kind::Linear => self.linear_ticks(),
            Kind::Decades => self.decade_ticks(),
        }
    }

    fn decade_ticks(&self) -> Vec<Tick> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().floor() as i32);
        let many = last - first > 3;
        let mut ticks = Vec::new();
        for exponent in first..=last {
            for digit in 1..10 {
                let value = f64::from(digit) * 10_f64.powi(exponent);
                if value < self.low || value > self.high {
                    continue;
                }
                let labelled = digit == 1 || (!many && (digit == 2 || digit == 5));
                let label = match (labelled, digit, exponent) {
                    (false, ..) => String::new(),
                    (true, 1, _) => power_of_ten(exponent),
                    (true, _, -1) => format!("0.{digit}"),
                    (true, _, 0..3) => format!("{value}"),
                    (true, ..) => format!("{digit}·{}", power_of_ten(exponent)),
                };
                ticks.push(Tick { value, label });
            }
        }
        ticks
    }

    fn linear_ticks(&self) -> Vec<Tick> {
        let span = self.high - self.low;
        let rough = span / 6.0;
        let magnitude = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .map(|factor| factor * magnitude)
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        if !(step > 0.0 && step.is_finite()) {
            return Vec::new();
        }
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last.min(first + 20))
            .map(|k| {
                let value = k as f64 * step;
                Tick { value, label: number(value, step, decimals) }
            })
            .collect()
    }
}

/// The unit of an axis of time that goes up to `end_s`, and how many of it a second is.
pub(super) fn time(end_s: f64) -> (&'static str, f64) {
    match end_s {
        end if end > 3.0 * 3600.0 => ("h", 1.0 / 3600.0),
        end if end > 300.0 => ("min", 1.0 / 60.0),
        _ => ("s", 1.0),
    }
}

/// The least and the largest; `None` of none.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |extent, v| {
        let (low, high) = extent.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    })
}

/// A tick's number, with as many digits as the step needs.
fn number(value: f64, step: f64, decimals: usize) -> String {
    let text = if value == 0.0 {
        "0".to_owned()
    } else if step < 1e-4 || value.abs() >= 1e6 {
        let digits = (value.abs() / step).log10().max(0.0).ceil() as usize;
        let text = format!("{value:.*e}", digits.min(9));
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{mantissa}·{}", power_of_ten(exponent.parse().unwrap_or(0)))
    } else {
        format!("{value:.decimals$}")
    };
    text.replace('-', "−")
}

/// 10ᵉ, written small where it would be long.
fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        2 => "100".into(),
        -1 => "0.1".into(),
        _ => {
            let sign = if exponent < 0 { "⁻" } else { "" };
            let digits = exponent.unsigned_abs().to_string();
            let digits = digits.bytes().map(|d| DIGITS[usize::from(d - b'0') % 10]);
            std::iter::once("10").chain([sign]).collect::<String>() + &digits.collect::<String>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<String> {
        scale.ticks().into_iter().map(|tick| tick.label).filter(|l| !l.is_empty()).collect()
    }

    #[test]
    fn decades() {
        let scale = Scale::decades([0.005, 2000.0].into_iter());
        assert_eq!(labels(&scale), ["10⁻²", "0.1", "1", "10", "100", "10³"]);
        assert!(scale.place(0.005) > 0.0 && scale.place(2000.0) < 1.0);
        assert!((scale.place((0.005_f64 * 2000.0).sqrt()) - 0.5).abs() < 1e-12);
        assert_eq!(labels(&Scale::decades([1.0].into_iter())), ["0.5", "1", "2"]);
        assert_eq!(Scale::decades(std::iter::empty()).ends().0, 0.1 / 1.25);
    }

    #[test]
    fn linear() {
        assert_eq!(labels(&Scale::between(0.0, 4.0)), ["0", "1", "2", "3", "4"]);
        assert_eq!(labels(&Scale::between(-0.02, 0.02)), ["−0.02", "−0.01", "0", "0.01", "0.02"]);
        assert_eq!(labels(&Scale::between(0.0, 2e-6))[1], "5·10⁻⁷");
        // Nothing to see, or too much: no panic, no endless list.
        for (low, high) in [(9.8, 9.8), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-1e308, 1e308)] {
            assert!(Scale::between(low, high).ticks().len() < 25);
        }
    }
}
