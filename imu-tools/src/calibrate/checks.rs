//! What the values themselves say of a sensor and its driver: stuck, saturated, held, coarse.
//!
//! - **Stuck**: an axis that never changes.
//! - **Saturated**: an axis that stays at its own largest or smallest value for [`FLAT`] samples in
//!   a row, several times as often as it returns to its middle: noise does not do that, a full scale
//!   does.
//! - **Held**: all three axes at once are what they were, far more often than their steps explain: a
//!   driver that publishes faster than the sensor measures, and repeats the last reading. Runs of
//!   [`LONG`] and more are not a driver's: there the sensor, or what reads it, hangs.
//! - **Coarse**: values lie on a grid. Its step is the smallest difference of the first
//!   [`FIRST`] values, if all others are multiples of it.

use serde::{Deserialize, Serialize};

use super::Stretch;

/// Values that show the step of the grid.
const FIRST: usize = 4096;
/// Equal values in a row at an end of the range that noise does not make.
const FLAT: u32 = 4;
/// Equal samples in a row that are no repeated reading any more.
const LONG: u64 = 64;
/// Held samples are told of when they are more than this part.
const HELD: f64 = 0.02;

/// What is seen of the values of one sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checks {
    /// Smallest and largest value of each axis, in the sensor's unit.
    pub range: [(f64, f64); 3],
    /// The step of the grid that values lie on; `None` where there is none, or too few values.
    pub step: [Option<f64>; 3],
    /// Samples at an end of the range in runs of four and more.
    pub saturated: [u64; 3],
    /// An axis that never changes.
    pub stuck: [bool; 3],
    /// Stretches in which an axis stood still that otherwise never does, and which ones did. They are among
    /// [`SensorNoise::disturbed`](super::SensorNoise::disturbed).
    pub frozen: Vec<([bool; 3], Stretch)>,
    /// Samples that repeat the one before on all axes, beyond what the steps explain, and not in runs of
    /// 64 and more.
    pub held: u64,
    /// The part of the first samples that are 0 on all axes.
    pub zeros: f64,
    /// Samples that are not finite, such as empty fields.
    pub not_finite: u64,
    /// The longest run of equal samples.
    pub longest_hold: u64,
}

impl Checks {
    /// Whether a driver repeats readings: more than a fiftieth of `samples` are repeated.
    #[must_use]
    pub fn is_held(&self, samples: u64) -> bool {
        self.held as f64 > HELD * samples as f64
    }
}

/// Runs at one end of an axis's range.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct End {
    value: f64,
    /// Samples in the present run at that value, and in all long ones.
    run: u32,
    flat: u64,
}

impl End {
    /// A sample, which is further out than the end if `beyond`.
    #[inline]
    fn take(&mut self, x: f64, beyond: bool) {
        if beyond {
            *self = Self { value: x, run: 1, flat: 0 };
        } else if x == self.value {
            self.run = self.run.saturating_add(1);
            if self.run == FLAT {
                self.flat += u64::from(FLAT);
            } else if self.run > FLAT {
                self.flat += 1;
            }
        } else {
            self.run = 0;
        }
    }
}

/// Looks at values as they come.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Checker {
    low: [End; 3],
    high: [End; 3],
    last: [f64; 3],
    samples: u64,
    /// Samples equal to the one before: each axis, and all at once.
    same: [u64; 3],
    all_same: u64,
    run: u64,
    longest: u64,
    /// Samples that repeat the one before in long runs.
    hung: u64,
    not_finite: u64,
    first: Vec<[f64; 3]>,
}

impl Checker {
    pub(super) fn new() -> Self {
        let end = |value| End { value, run: 0, flat: 0 };
        Self {
            low: [end(f64::INFINITY); 3],
            high: [end(f64::NEG_INFINITY); 3],
            last: [f64::NAN; 3],
            samples: 0,
            same: [0; 3],
            all_same: 0,
            run: 1,
            longest: 1,
            hung: 0,
            not_finite: 0,
            first: Vec::new(),
        }
    }

    /// Takes consecutive samples; what is not finite is passed over.
    pub(super) fn take(&mut self, values: &[[f64; 3]]) {
        if self.take_unremarkable(values) {
            return;
        }
        for value in values {
            if (value[0] + value[1] + value[2]).is_finite() {
                self.take_one(value);
            } else {
                self.not_finite += 1;
            }
        }
    }

    /// Takes samples of which none reaches an end of the range, none repeats the one before on all
    /// axes, and all are finite: most samples are such. Does nothing and returns `false` if one is not.
    fn take_unremarkable(&mut self, values: &[[f64; 3]]) -> bool {
        if self.first.len() < FIRST {
            return false;
        }
        let (low, high) = (self.low.map(|end| end.value), self.high.map(|end| end.value));
        let (mut last, mut same) = (self.last, [0; 3]);
        let mut unremarkable = true;
        for value in values {
            let mut all = true;
            for axis in 0..3 {
                let x = value[axis];
                unremarkable &= (low[axis] < x) & (x < high[axis]); // not for a NaN
                let repeats = x == last[axis];
                same[axis] += u64::from(repeats);
                all &= repeats;
            }
            unremarkable &= !all;
            last = *value;
        }
        if !unremarkable {
            return false;
        }
        if !values.is_empty() {
            self.low.iter_mut().chain(&mut self.high).for_each(|end| end.run = 0);
            self.run = 1;
        }
        self.samples += values.len() as u64;
        self.same.iter_mut().zip(same).for_each(|(sum, more)| *sum += more);
        self.last = last;
        true
    }

    fn take_one(&mut self, value: &[f64; 3]) {
        self.samples += 1;
        let mut all = true;
        for (axis, &x) in value.iter().enumerate() {
            self.low[axis].take(x, x < self.low[axis].value);
            self.high[axis].take(x, x > self.high[axis].value);
            let same = x == self.last[axis];
            self.same[axis] += u64::from(same);
            all &= same;
        }
        if all {
            self.all_same += 1;
            self.run += 1;
            self.hung += match self.run {
                LONG => LONG - 1,
                run if run > LONG => 1,
                _ => 0,
            };
            self.longest = self.longest.max(self.run);
        } else {
            self.run = 1;
        }
        self.last = *value;
        if self.first.len() < FIRST {
            self.first.push(*value);
        }
    }

    pub(super) fn finish(&self) -> Checks {
        let (longest_hold, not_finite) = (self.longest, self.not_finite);
        let mut checks = Checks { longest_hold, not_finite, ..Checks::default() };
        if self.samples == 0 {
            return checks;
        }
        let pairs = (self.samples - 1 - self.hung).max(1) as f64;
        let mut live = Vec::new();
        for axis in 0..3 {
            let (low, high) = (self.low[axis], self.high[axis]);
            checks.range[axis] = (low.value, high.value);
            checks.stuck[axis] = self.samples > 1 && low.value == high.value;
            if !checks.stuck[axis] {
                // Where values between the ends repeat often, runs at the ends say nothing.
                let flat = low.flat + high.flat;
                let between = (self.samples - flat).max(1) as f64;
                let often = self.same[axis].saturating_sub(flat) as f64 / between > 0.25;
                checks.saturated[axis] = if often { 0 } else { flat };
                live.push((self.same[axis] - self.hung) as f64 / pairs);
            }
            checks.step[axis] = step(self.first.iter().map(|value| value[axis]));
        }
        let all_same = (self.all_same - self.hung) as f64;
        checks.held = (held(&live, all_same / pairs) * pairs).round() as u64;
        checks.zeros = self.first.iter().filter(|value| **value == [0.0; 3]).count() as f64
            / self.first.len().max(1) as f64;
        checks
    }
}

/// The part of the samples that repeat the one before because a driver holds it, where each live axis
/// repeats in the part `same` of the samples, and all at once in `all`: of what is not held, axes
/// repeat independently. A single axis shows nothing.
fn held(same: &[f64], all: f64) -> f64 {
    if same.len() < 2 {
        return 0.0;
    }
    let mut low = 0.0;
    let mut high = same.iter().copied().fold(1.0, f64::min);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let chance: f64 = same.iter().map(|s| (s - middle) / (1.0 - middle)).product();
        if middle + (1.0 - middle) * chance < all {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The grid that values lie on.
fn step(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let (low, high) = (*values.first()?, *values.last()?);
    // What rounding leaves of a multiple of the step: eight units in the last place of single
    // precision, in which many drivers compute.
    let rounding = 8.0 * f64::from(f32::EPSILON) * low.abs().max(high.abs());
    let gaps = || values.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > rounding);
    let step = gaps().min_by(f64::total_cmp)?;
    // A few values far apart lie on many grids.
    if values.len() < 3 || step <= 4.0 * rounding {
        return None;
    }
    let on_grid =
        gaps().all(|gap| (gap / step - (gap / step).round()).abs() * step <= 2.0 * rounding);
    // Noise without a grid has no two gaps alike.
    let alike = gaps().filter(|gap| (gap - step).abs() <= 2.0 * rounding).count();
    (on_grid && alike * 8 >= values.len().min(64)).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize, seed: u64) -> Vec<[f64; 3]> {
        let mut state = seed;
        let mut next = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..n).map(|_| [next(), next(), next()]).collect()
    }

    fn check(values: &[[f64; 3]]) -> Checks {
        let mut checker = Checker::new();
        for piece in values.chunks(97) {
            checker.take(piece);
        }
        checker.finish()
    }

    #[test]
    fn noise_is_fine() {
        let checks = check(&noise(20_000, 1));
        assert_eq!((checks.saturated, checks.stuck, checks.held), ([0; 3], [false; 3], 0));
        assert_eq!(checks.step, [None; 3]);
    }

    #[test]
    fn what_is_not_finite_is_counted_also_where_nothing_else_is() {
        for finite in [0, 5] {
            let values = [vec![[f64::NAN, 0.0, 0.0]; 7], vec![[1.0; 3]; finite]].concat();
            assert_eq!(check(&values).not_finite, 7);
        }
    }

    #[test]
    fn a_grid_is_found_whatever_its_offset() {
        for lsb in [9.80665 / 16384.0, 0.001, 0.0174532925] {
            let values: Vec<_> = noise(20_000, 2)
                .iter()
                .map(|v| v.map(|x| (x * 30.0).round() * lsb + 9.8))
                .collect();
            let checks = check(&values);
            for step in checks.step {
                assert!((step.unwrap() / lsb - 1.0).abs() < 1e-6, "{step:?} {lsb}");
            }
            assert!(!checks.is_held(20_000));
            let single: Vec<_> = values.iter().map(|v| v.map(|x| f64::from(x as f32))).collect();
            let step = check(&single).step[0].unwrap();
            assert!((step / lsb - 1.0).abs() < 1e-2, "{step} {lsb}");
        }
    }

    #[test]
    fn a_full_scale_is_seen() {
        let clipped: Vec<_> = (0..20_000)
            .map(|k| {
                let x = (f64::from(k) * 0.01).sin() * 3.0;
                [x.clamp(-2.0, 2.0), x, -x]
            })
            .collect();
        let checks = check(&clipped);
        assert!(checks.saturated[0] > 5000, "{checks:?}");
        assert_eq!((checks.saturated[1], checks.saturated[2]), (0, 0));
    }

    #[test]
    fn a_driver_that_repeats_is_seen() {
        let values: Vec<_> = noise(5_000, 4).iter().flat_map(|v| [*v, *v]).collect();
        let checks = check(&values);
        assert!(checks.is_held(10_000) && checks.held > 4_900, "{checks:?}");
        assert_eq!(checks.longest_hold, 2);
        let stuck: Vec<_> = noise(5_000, 5).iter().map(|v| [v[0], v[1], 0.0]).collect();
        assert_eq!((check(&stuck).stuck, check(&stuck).held), ([false, false, true], 0));
    }

    /// Half of the record is one reading: no driver publishes that fast.
    #[test]
    fn a_sensor_that_hangs_is_not_held() {
        let mut values = noise(20_000, 6);
        let last = values[9_999];
        values[10_000..].fill(last);
        let checks = check(&values);
        assert_eq!((checks.held, checks.longest_hold), (0, 10_001));
        let both: Vec<_> = values.iter().flat_map(|v| [*v, *v]).collect();
        let held = check(&both).held;
        assert!((9_990..=10_010).contains(&held), "{held}");
    }
}
