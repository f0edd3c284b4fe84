//! What to give a filter that knows white noise N and a random walk K of the bias, one of each for all axes: the
//! values, and by how much to multiply them.
//!
//! One rule for both: where all axes together show a value to [`Known::ENOUGH`], it is that value. Otherwise it is a
//! bound that covers all axes: the largest upper end of the 90 % intervals of x, y, z and of all together. What an axis
//! shows by itself is in there, also where the others show nothing.

use imu_core::allan::Parameter;

use super::verdict::Known;
use super::{AxisNoise, SensorNoise};

/// Where a value for a filter comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// All axes together show it well enough.
    Estimate,
    /// A reading without an interval.
    Reading,
    /// A random walk that covers flicker too.
    CoversFlicker,
    /// It is not known well enough: a bound that covers all axes.
    UpperBound,
}

/// A value for a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterValue {
    /// In the unit of N or K.
    pub value: f64,
    /// Where it comes from.
    pub basis: Basis,
}

impl FilterValue {
    /// N; `None` where nothing is known of it.
    #[must_use]
    pub fn noise_density(sensor: &SensorNoise) -> Option<Self> {
        let axes = sensor.axes.each_ref().map(|axis| axis.noise_density);
        Self::of(axes, sensor.pooled.noise_density, true)
    }

    /// K, which covers flicker where there is any; `None` where nothing is known of it.
    #[must_use]
    pub fn random_walk(sensor: &SensorNoise) -> Option<Self> {
        if let Some(value) = walk_for_filter(&sensor.pooled) {
            return Some(Self { value, basis: Basis::CoversFlicker });
        }
        let axes = sensor.axes.each_ref().map(|axis| axis.random_walk);
        Self::of(axes, sensor.pooled.random_walk, !sensor.misfit.contains(&true))
    }

    /// By the rule; `believed` says that intervals hold what they promise.
    fn of(axes: [Parameter; 3], pooled: Parameter, believed: bool) -> Option<Self> {
        let known = Known::of(pooled);
        match pooled {
            Parameter::Observable { value, .. } if believed && known.is_enough() => {
                Some(Self { value, basis: Basis::Estimate })
            }
            Parameter::Observable { value, .. } if known == Known::Reading => {
                Some(Self { value, basis: Basis::Reading })
            }
            _ if known == Known::NotAtAll => None,
            _ => {
                // An axis of which nothing is known is stuck, and no part of all together.
                let ends =
                    axes.into_iter().chain([pooled]).map(upper_end).filter(|end| end.is_finite());
                Some(Self { value: ends.fold(0.0, f64::max), basis: Basis::UpperBound })
            }
        }
    }
}

/// The upper end of a 90 % interval, or the bound of what does not show.
fn upper_end(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Observable { high90, .. } => high90,
        Parameter::NotObservable { upper90, .. } => upper90,
    }
}

/// An estimate; 0 of what does not show.
fn estimate(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { .. } => 0.0,
    }
}

/// The random walk to give a filter that has no term for flicker, unit/s/√Hz: the K that makes the bias go as far in
/// [`Factors::OVER_S`] as B and K together do, K'²τ/3 = (2 ln 2/π)B² + K²τ/3. `None` where there is no B to cover:
/// then it is K.
#[must_use]
pub fn walk_for_filter(noise: &AxisNoise) -> Option<f64> {
    match noise.bias_instability? {
        Parameter::Observable { value, .. } => Some(cover(value, estimate(noise.random_walk))),
        Parameter::NotObservable { .. } => None,
    }
}

/// The random walk that goes as far as B and K.
fn cover(flicker: f64, walk: f64) -> f64 {
    let flat = 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI * flicker * flicker;
    (walk * walk + 3.0 * flat / Factors::OVER_S).sqrt()
}

/// By how much a [`FilterValue`] should be larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    /// The upper end of its 90 % interval over the value; `None` where it has none, or is a bound already.
    pub interval: Option<f64>,
    /// The largest value of an axis over it, 1 where none is above it; `None` of a bound, which covers all.
    pub axes: Option<f64>,
    /// What was seen beside the sensor's own noise, and a filter has to live with, over it; 1 for nothing. Of N: what
    /// short averaging times show; of K: what a drift moves the bias by in [`Self::OVER_S`].
    pub beside: f64,
}

impl Factors {
    /// Drift and walk are compared over this time, s: as long as a filter goes without a fix.
    pub const OVER_S: f64 = 100.0;

    /// What use adds to what any recording at rest can show, where motion is gentle.
    pub const USE: f64 = 2.0;

    /// Those of N; `None` where nothing is known of it.
    #[must_use]
    pub fn noise_density(sensor: &SensorNoise) -> Option<Self> {
        let filter = FilterValue::noise_density(sensor)?;
        let value = filter.value;
        let mut beside = 1.0;
        for d in &sensor.deviation {
            let beyond = sensor.tau_used_s.is_some_and(|(first, _)| d.tau_s < 0.99 * first);
            for octave in d.octaves.iter().filter(|o| beyond && o.differences > 0) {
                let white = octave.deviation() * d.tau_s.sqrt();
                if value > 0.0 && white > 1.1 * beside * value {
                    beside = white / value;
                }
            }
        }
        let axes = sensor.axes.each_ref().map(|axis| estimate(axis.noise_density));
        Some(Self::of(filter, upper_end(sensor.pooled.noise_density), axes, beside))
    }

    /// Those of K; `None` where nothing is known of it.
    #[must_use]
    pub fn random_walk(sensor: &SensorNoise) -> Option<Self> {
        let filter = FilterValue::random_walk(sensor)?;
        let pooled = &sensor.pooled;
        let high = match (filter.basis, pooled.bias_instability) {
            (Basis::CoversFlicker, Some(flicker)) => {
                cover(upper_end(flicker), upper_end(pooled.random_walk))
            }
            _ => upper_end(pooled.random_walk),
        };
        let of_axis =
            |axis: &AxisNoise| walk_for_filter(axis).unwrap_or_else(|| estimate(axis.random_walk));
        let drift = sensor.ramp.map_or(0.0, |ramp| {
            ramp.iter().fold(0.0_f64, |most, r| most.max(r.abs())) * Self::OVER_S
        });
        let walk = filter.value * Self::OVER_S.sqrt();
        let beside = if walk > 0.0 { (drift / walk).max(1.0) } else { 1.0 };
        Some(Self::of(filter, high, sensor.axes.each_ref().map(of_axis), beside))
    }

    fn of(filter: FilterValue, high: f64, axes: [f64; 3], beside: f64) -> Self {
        let FilterValue { value, basis } = filter;
        let open = basis != Basis::UpperBound && value > 0.0;
        Self {
            interval: (open && high.is_finite()).then(|| high / value),
            axes: open.then(|| axes.into_iter().fold(value, f64::max) / value),
            beside,
        }
    }

    /// What the recording itself asks for: the largest of them.
    #[must_use]
    pub fn of_recording(&self) -> f64 {
        [self.interval, self.axes].into_iter().flatten().fold(self.beside.max(1.0), f64::max)
    }

    /// What to multiply by in the end, where motion is gentle: estimate and use err independently.
    #[must_use]
    pub fn advised(&self) -> f64 {
        Self::USE * self.of_recording()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn known(value: f64, low90: f64, high90: f64) -> Parameter {
        Parameter::Observable { value, sd: 0.1, low90, high90 }
    }

    const fn hidden(upper90: f64) -> Parameter {
        Parameter::NotObservable { upper90, record_at_least_s: 1.0 }
    }

    #[test]
    fn a_value_that_is_known_well_is_taken_as_it_is() {
        let axes = [known(0.9, 0.5, 1.6), known(1.2, 0.8, 1.7), hidden(9.0)];
        let value = FilterValue::of(axes, known(1.0, 0.8, 1.3), true).unwrap();
        assert_eq!(value, FilterValue { value: 1.0, basis: Basis::Estimate });
        let factors = Factors::of(value, 1.3, [0.9, 1.2, 0.0], 1.0);
        assert_eq!((factors.interval, factors.axes), (Some(1.3), Some(1.2)));
        assert_eq!(factors.advised(), 2.6);
    }

    /// One axis shows it, and lies above what all together say: its own upper end counts.
    #[test]
    fn a_bound_covers_what_one_axis_shows() {
        let axes = [hidden(1.5), known(1.7, 0.9, 3.0), hidden(0.8)];
        for pooled in [known(1.0, 0.3, 1.6), hidden(1.55)] {
            let value = FilterValue::of(axes, pooled, true).unwrap();
            assert_eq!(value, FilterValue { value: 3.0, basis: Basis::UpperBound });
            let factors = Factors::of(value, 1.6, [0.0, 1.7, 0.0], 1.0);
            assert_eq!((factors.interval, factors.axes, factors.of_recording()), (None, None, 1.0));
        }
        // A stuck axis has no bound; where intervals are not believed, their ends are the best there is.
        let axes = [hidden(f64::INFINITY), hidden(1.0), hidden(2.0)];
        assert_eq!(FilterValue::of(axes, hidden(1.5), true).unwrap().value, 2.0);
        let value =
            FilterValue::of([known(1.0, 0.9, 1.1); 3], known(1.0, 0.95, 1.05), false).unwrap();
        assert_eq!(value, FilterValue { value: 1.1, basis: Basis::UpperBound });
    }

    #[test]
    fn nothing_and_readings() {
        assert_eq!(FilterValue::of([hidden(1.0); 3], hidden(f64::INFINITY), true), None);
        let reading = known(1.0, 0.0, f64::INFINITY);
        let value = FilterValue::of([reading; 3], reading, true).unwrap();
        assert_eq!(value.basis, Basis::Reading);
        assert_eq!(Factors::of(value, f64::INFINITY, [1.0; 3], 1.0).interval, None);
    }

    /// B = 1, K = 0.1: 0.01 + 3·0.4413/100 = 0.02324.
    #[test]
    fn a_walk_that_covers_flicker() {
        let known = |value| known(value, value, value);
        let two = AxisNoise::of_two(known(1.0), known(0.1));
        assert_eq!(walk_for_filter(&two), None);
        let noise = AxisNoise { bias_instability: Some(known(1.0)), ..two };
        let walk = walk_for_filter(&noise).unwrap();
        assert!((walk * walk - 0.023_238_136).abs() < 1e-9, "{walk}");
    }
}
