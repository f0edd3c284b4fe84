//! The error terms of a sensor, as a scene has them.

use std::fmt;

use serde::Deserialize;
use serde::de::{self, Deserializer, SeqAccess, Visitor};

use crate::error::Error;

/// The error terms of one sensor on its axes x, y, z; a zero, or `None`, is a term left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// N, in the sensor's unit per √Hz.
    pub noise_density: [f64; 3],
    /// K, in the sensor's unit per second per √Hz.
    pub random_walk: [f64; 3],
    /// A constant offset, in the sensor's unit.
    pub constant_bias: [f64; 3],
    /// Standard deviation of an offset that is drawn once, in the sensor's unit.
    pub turn_on_bias: [f64; 3],
    /// R: growth of the bias, in the sensor's unit per second.
    pub rate_ramp: [f64; 3],
    /// A bias that wanders and forgets.
    pub gauss_markov: Option<GaussMarkovTerm>,
    /// Bias instability.
    pub flicker: Option<FlickerTerm>,
    /// Vibration of one frequency.
    pub vibration: Option<VibrationTerm>,
    /// Vibration of a band.
    pub band_vibration: Option<BandVibrationTerm>,
    /// Cut-off of a one-pole low-pass before the sampling, Hz.
    pub lowpass_hz: Option<f64>,
    /// Full scale, in the sensor's unit.
    pub saturation: Option<f64>,
    /// One count, in the sensor's unit.
    pub quantisation: Option<f64>,
}

/// A first-order Gauss-Markov bias ([`imu_core::noise::GaussMarkov`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct GaussMarkovTerm {
    /// σ, in the sensor's unit.
    pub standard_deviation: Axes,
    /// T, s.
    pub correlation_time_s: f64,
}

/// Bias instability ([`imu_core::noise::Flicker`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FlickerTerm {
    /// B, in the sensor's unit.
    pub bias_instability: Axes,
    /// The shortest averaging time of the flat, s.
    pub shortest_tau_s: f64,
    /// The longest, s: up to six decades more.
    pub longest_tau_s: f64,
}

/// A sinusoid ([`imu_core::noise::Sinusoid`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct VibrationTerm {
    /// The peak, in the sensor's unit.
    pub amplitude: Axes,
    /// Hz.
    pub frequency_hz: f64,
}

/// Vibration in a band ([`imu_core::noise::BandVibration`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct BandVibrationTerm {
    /// Root mean square, in the sensor's unit.
    pub standard_deviation: Axes,
    /// The middle of the band, Hz.
    pub frequency_hz: f64,
    /// The width of the band at half power, Hz.
    pub bandwidth_hz: f64,
}

/// The same as the table of a scene file.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct SensorTable {
    noise_density: Axes,
    random_walk: Axes,
    constant_bias: Axes,
    turn_on_bias: Axes,
    rate_ramp: Axes,
    gauss_markov: Option<GaussMarkovTerm>,
    flicker: Option<FlickerTerm>,
    vibration: Option<VibrationTerm>,
    band_vibration: Option<BandVibrationTerm>,
    lowpass_hz: Option<f64>,
    saturation: Option<f64>,
    quantisation: Option<f64>,
}

/// A number for each of x, y and z; in a scene file one for all, or three.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axes(pub [f64; 3]);

impl<'de> Deserialize<'de> for Axes {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Numbers;

        impl<'de> Visitor<'de> for Numbers {
            type Value = Axes;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number for all axes, or three, [x, y, z]")
            }

            fn visit_f64<E: de::Error>(self, x: f64) -> Result<Axes, E> {
                Ok(Axes([x; 3]))
            }

            fn visit_i64<E: de::Error>(self, x: i64) -> Result<Axes, E> {
                Ok(Axes([x as f64; 3]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Axes, A::Error> {
                let mut axes = [0.0; 3];
                for (i, axis) in axes.iter_mut().enumerate() {
                    *axis = seq
                        .next_element::<f64>()?
                        .ok_or_else(|| de::Error::invalid_length(i, &self))?;
                }
                if seq.next_element::<f64>()?.is_some() {
                    return Err(de::Error::invalid_length(4, &self));
                }
                Ok(Axes(axes))
            }
        }

        from.deserialize_any(Numbers)
    }
}

impl SensorTable {
    pub(super) fn errors(&self) -> SensorErrors {
        SensorErrors {
            noise_density: self.noise_density.0,
            random_walk: self.random_walk.0,
            constant_bias: self.constant_bias.0,
            turn_on_bias: self.turn_on_bias.0,
            rate_ramp: self.rate_ramp.0,
            gauss_markov: self.gauss_markov,
            flicker: self.flicker,
            vibration: self.vibration,
            band_vibration: self.band_vibration,
            lowpass_hz: self.lowpass_hz,
            saturation: self.saturation,
            quantisation: self.quantisation,
        }
    }
}

impl SensorErrors {
    pub(super) fn check(&self, sensor: &str) -> Result<(), Error> {
        for (key, values) in [
            ("noise_density", self.noise_density),
            ("random_walk", self.random_walk),
            ("turn_on_bias", self.turn_on_bias),
        ] {
            if let Some(bad) = values.iter().find(|x| !(0.0..=1e6).contains(*x)) {
                return Err(Error::usage(format!(
                    "{key} = {bad} of the {sensor} cannot be: give a number from 0 (term left \
                     out) to 1e6"
                )));
            }
        }
        if let Some(bad) = self.constant_bias.iter().find(|x| !(-1e6..=1e6).contains(*x)) {
            return Err(Error::usage(format!(
                "constant_bias = {bad} of the {sensor} cannot be: give a number within ±1e6"
            )));
        }
        if let Some(bad) = self.rate_ramp.iter().find(|x| !(-1e6..=1e6).contains(*x)) {
            return Err(Error::usage(format!(
                "rate_ramp = {bad} of the {sensor} cannot be: give a number within ±1e6"
            )));
        }
        self.check_tables(sensor)?;
        match self.lowpass_hz {
            Some(hz) if !(hz > 0.0 && hz <= 1e6) => Err(Error::usage(format!(
                "a low-pass at {hz} Hz of the {sensor} cannot be: give a cut-off above 0, up to 1e6"
            ))),
            _ => Ok(()),
        }
    }

    /// The numbers of the terms that have a table or a limit of their own: all positive, or zero where
    /// that leaves the term out on an axis.
    fn check_tables(&self, sensor: &str) -> Result<(), Error> {
        let mut amounts: Vec<(&str, f64)> = Vec::new();
        let mut limits: Vec<(&str, f64)> = Vec::new();
        if let Some(GaussMarkovTerm { standard_deviation, correlation_time_s }) = self.gauss_markov
        {
            amounts.extend(standard_deviation.0.map(|x| ("gauss_markov.standard_deviation", x)));
            limits.push(("gauss_markov.correlation_time_s", correlation_time_s));
        }
        if let Some(FlickerTerm { bias_instability, shortest_tau_s, longest_tau_s }) = self.flicker
        {
            amounts.extend(bias_instability.0.map(|x| ("flicker.bias_instability", x)));
            limits.push(("flicker.shortest_tau_s", shortest_tau_s));
            limits.push(("flicker.longest_tau_s", longest_tau_s));
        }
        if let Some(VibrationTerm { amplitude, frequency_hz }) = self.vibration {
            amounts.extend(amplitude.0.map(|x| ("vibration.amplitude", x)));
            limits.push(("vibration.frequency_hz", frequency_hz));
        }
        if let Some(term) = self.band_vibration {
            let BandVibrationTerm { standard_deviation, frequency_hz, bandwidth_hz } = term;
            amounts.extend(standard_deviation.0.map(|x| ("band_vibration.standard_deviation", x)));
            limits.push(("band_vibration.frequency_hz", frequency_hz));
            limits.push(("band_vibration.bandwidth_hz", bandwidth_hz));
        }
        limits.extend(self.saturation.map(|x| ("saturation", x)));
        limits.extend(self.quantisation.map(|x| ("quantisation", x)));
        if let Some((key, bad)) = amounts.iter().find(|(_, x)| !(0.0..=1e6).contains(x)) {
            return Err(Error::usage(format!(
                "{key} = {bad} of the {sensor} cannot be: give a number from 0 to 1e6"
            )));
        }
        if let Some((key, bad)) = limits.iter().find(|(_, x)| !(*x > 0.0 && *x <= 1e9)) {
            return Err(Error::usage(format!(
                "{key} = {bad} of the {sensor} cannot be: give a number above 0, up to 1e9"
            )));
        }
        Ok(())
    }
}
