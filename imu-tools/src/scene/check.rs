//! Whether the numbers of a scene can be, each under its key.

use super::errors::{BandVibrationTerm, FlickerTerm, GaussMarkovTerm, Poles, VibrationTerm};
use super::{ClockErrors, Scene, SensorErrors, Temperature, trajectory};
use crate::error::Error;

/// Between the averaging times of a flicker; its eight processes reach 13⁷/16, 6.59 decades.
const MOST_DECADES: f64 = 6.5;

/// A number that cannot be: its key, with its tables before it, and one sentence.
pub(super) struct Bad {
    pub(super) key: String,
    sentence: String,
}

impl From<Bad> for Error {
    fn from(bad: Bad) -> Self {
        Self::usage(bad.sentence)
    }
}

impl Bad {
    pub(super) fn new(key: impl Into<String>, sentence: impl Into<String>) -> Self {
        Self { key: key.into(), sentence: sentence.into() }
    }
}

/// The table that a number is in: its key, and how a sentence names it.
struct Table {
    name: &'static str,
    of: &'static str,
}

impl Table {
    const SCENE: Self = Self { name: "", of: "" };
    const CLOCK: Self = Self { name: "clock", of: " of the clock" };
    const TEMPERATURE: Self = Self { name: "temperature", of: " of the temperature" };
    const GYROSCOPE: Self = Self { name: "gyroscope", of: " of the gyroscope" };
    const ACCELEROMETER: Self = Self { name: "accelerometer", of: " of the accelerometer" };

    fn bad(&self, key: &str, sentence: impl Into<String>) -> Bad {
        let dot = if self.name.is_empty() { "" } else { "." };
        Bad::new(format!("{}{dot}{key}", self.name), sentence)
    }

    /// That each of `values` is one of those that `allowed` accepts, which `words` tell.
    fn check(
        &self,
        key: &str,
        values: &[f64],
        allowed: impl Fn(f64) -> bool,
        words: &str,
    ) -> Result<(), Bad> {
        match values.iter().find(|x| !allowed(**x)) {
            Some(bad) => {
                // Debug writes 1e300 so, and not with its zeros.
                let value = if bad.abs() < 1e15 { bad.to_string() } else { format!("{bad:?}") };
                Err(self.bad(key, format!("{key} = {value}{} cannot be: give {words}", self.of)))
            }
            None => Ok(()),
        }
    }

    /// From 0, which leaves the term out, to 1e6.
    fn amount(&self, key: &str, values: &[f64]) -> Result<(), Bad> {
        let words = "a number from 0 (term left out) to 1e6";
        self.check(key, values, |x| (0.0..=1e6).contains(&x), words)
    }

    /// Of either sign, up to `most`.
    fn within(&self, key: &str, values: &[f64], most: f64) -> Result<(), Bad> {
        let words = format!("a number within ±{most}");
        self.check(key, values, |x| x.abs() <= most, &words)
    }

    /// Above zero.
    fn positive(&self, key: &str, value: Option<f64>) -> Result<(), Bad> {
        let words = "a number above 0, up to 1e9";
        self.check(key, value.as_slice(), |x| x > 0.0 && x <= 1e9, words)
    }
}

/// The first number of a scene that cannot be.
pub(super) fn check(scene: &Scene) -> Result<(), Bad> {
    let (table, gravity) = (Table::SCENE, scene.gravity);
    table.check("gravity", &[gravity], |x| x.abs() <= 1e3, "m/s², such as 9.81")?;
    if scene.start_ns < 0 {
        return Err(Bad::new(
            "start_ns",
            format!(
                "start_ns = {} is before 1970: stamps count nanoseconds from there",
                scene.start_ns
            ),
        ));
    }
    check_clock(&scene.clock)?;
    if let Some(temperature) = &scene.temperature {
        check_temperature(temperature)?;
    }
    check_stamps(scene)?;
    trajectory::check(scene)?;
    sensor(&Table::GYROSCOPE, &scene.gyroscope, scene.temperature.is_some())?;
    sensor(&Table::ACCELEROMETER, &scene.accelerometer, scene.temperature.is_some())?;
    if scene.accelerometer.g_sensitivity != [[0.0; 3]; 3] {
        return Err(Bad::new(
            "accelerometer.g_sensitivity",
            "g_sensitivity is what a gyroscope reads of specific force: an accelerometer's is its \
             scale_misalignment",
        ));
    }
    Ok(())
}

/// That every stamp is in the 64-bit nanoseconds from 1970 on.
fn check_stamps(scene: &Scene) -> Result<(), Bad> {
    let clock = &scene.clock;
    let first = scene.start_ns as f64 + 1e9 * clock.offset_s;
    if first < 0.0 {
        return Err(Bad::new(
            "clock.offset_s",
            format!(
                "offset_s = {} of the clock puts stamps before 1970: start later (start_ns)",
                clock.offset_s
            ),
        ));
    }
    let room = u64::try_from(i64::MAX - scene.start_ns).unwrap_or(0);
    let length = scene.duration_ns as f64 * (1.0 + 1e-6 * clock.drift_ppm);
    let jitter = 1e9 * (10.0 * clock.jitter_s + clock.jitter_uniform_s);
    // A second is the rounding of these doubles, and more.
    let last = length + 1e9 * clock.offset_s + jitter + 1e9;
    let ideal = *clock == ClockErrors::default();
    if scene.duration_ns >= room || (!ideal && last >= room as f64) {
        return Err(Bad::new(
            "duration",
            "the last stamp is beyond the year 2262, where 64-bit nanoseconds end: start earlier \
             or make the duration shorter",
        ));
    }
    Ok(())
}

fn check_clock(clock: &ClockErrors) -> Result<(), Bad> {
    let table = Table::CLOCK;
    table.within("offset_s", &[clock.offset_s], 1e9)?;
    table.within("drift_ppm", &[clock.drift_ppm], 1e5)?;
    let seconds = "seconds from 0 to 1000";
    for (key, value) in [("jitter_s", clock.jitter_s), ("jitter_uniform_s", clock.jitter_uniform_s)]
    {
        table.check(key, &[value], |x| (0.0..=1e3).contains(&x), seconds)?;
    }
    let lost = clock.lost_fraction;
    let words = "a fraction from 0 to below 1";
    table.check("lost_fraction", &[lost], |x| (0.0..1.0).contains(&x), words)?;
    let Some(burst) = clock.lost_burst else { return Ok(()) };
    if lost == 0.0 {
        return Err(table.bad("lost_burst", "lost_burst is nothing without a lost_fraction"));
    }
    // Between two bursts there is at least one sample.
    let least = (lost / (1.0 - lost)).max(1.0);
    let words = format!(
        "the mean number of samples lost in a row, from {} (for a lost_fraction of {lost}) to 1e9",
        (1e6 * least).round() / 1e6
    );
    let rounded = least * (1.0 - 1e-6);
    table.check("lost_burst", &[burst], |x| x >= rounded && x <= 1e9, &words)
}

fn check_temperature(temperature: &Temperature) -> Result<(), Bad> {
    let table = Table::TEMPERATURE;
    let celsius = "degrees Celsius from -273.15 to 1000";
    let allowed = |x: f64| (-273.15..=1000.0).contains(&x);
    table.check("calibrated_c", &[temperature.calibrated_c], allowed, celsius)?;
    table.check("start_c", temperature.start_c.as_slice(), allowed, celsius)?;
    table.within("rate_k_s", &[temperature.rate_k_s], 1e3)?;
    table.within("rise_k", &[temperature.rise_k], 1e3)?;
    table.positive("time_constant_s", temperature.time_constant_s)?;
    match (temperature.rise_k == 0.0, temperature.time_constant_s) {
        (false, None) => {
            Err(table.bad("rise_k", "rise_k of the temperature needs a time_constant_s"))
        }
        (true, Some(_)) => {
            Err(table.bad("time_constant_s", "time_constant_s of the temperature needs a rise_k"))
        }
        _ => Ok(()),
    }
}

fn sensor(table: &Table, errors: &SensorErrors, has_temperature: bool) -> Result<(), Bad> {
    geometry(table, errors)?;
    table.amount("noise_density", &errors.noise_density)?;
    table.amount("random_walk", &errors.random_walk)?;
    table.amount("turn_on_bias", &errors.turn_on_bias)?;
    table.within("constant_bias", &errors.constant_bias, 1e6)?;
    table.within("rate_ramp", &errors.rate_ramp, 1e6)?;
    table.within("temperature_coefficient", &errors.temperature_coefficient, 1e6)?;
    if errors.temperature_coefficient != [0.0; 3] && !has_temperature {
        let words = format!(
            "temperature_coefficient{} needs to know the temperature: give a table [temperature]",
            table.of
        );
        return Err(table.bad("temperature_coefficient", words));
    }
    terms(table, errors)?;
    table.positive("saturation", errors.saturation)?;
    table.positive("increment_quantisation", errors.increment_quantisation)?;
    table.positive("quantisation", errors.quantisation)?;
    match errors.lowpass_hz {
        Some(hz) if !(hz > 0.0 && hz <= 1e6) => Err(table.bad(
            "lowpass_hz",
            format!(
                "a low-pass at {hz} Hz{} cannot be: give a cut-off above 0, up to 1e6",
                table.of
            ),
        )),
        None if errors.lowpass_poles != Poles::One => {
            Err(table.bad("lowpass_poles", format!("lowpass_poles{} needs a lowpass_hz", table.of)))
        }
        _ => Ok(()),
    }
}

/// Where the sensor is, and what its axes are.
fn geometry(table: &Table, errors: &SensorErrors) -> Result<(), Bad> {
    table.within("lever_arm_m", &errors.lever_arm_m, 1e3)?;
    table.within("scale_error", &errors.scale_error, 10.0)?;
    let angles = errors.misalignment_rad.as_flattened();
    table.check("misalignment_rad", angles, |x| x.abs() <= 1.0, "radians within ±1")?;
    table.within("g_sensitivity", errors.g_sensitivity.as_flattened(), 1e3)?;
    let Some(matrix) = &errors.scale_misalignment else { return Ok(()) };
    table.within("scale_misalignment", matrix.as_flattened(), 1e3)?;
    if errors.scale_error != [0.0; 3] || errors.misalignment_rad != [[0.0; 2]; 3] {
        let words = format!(
            "scale_misalignment{} is the whole matrix: give it, or scale_error and \
             misalignment_rad, not both",
            table.of
        );
        return Err(table.bad("scale_misalignment", words));
    }
    Ok(())
}

/// The terms that have a table of their own.
fn terms(table: &Table, errors: &SensorErrors) -> Result<(), Bad> {
    if let Some(GaussMarkovTerm { standard_deviation, correlation_time_s }) = errors.gauss_markov {
        table.amount("gauss_markov.standard_deviation", &standard_deviation.0)?;
        table.positive("gauss_markov.correlation_time_s", Some(correlation_time_s))?;
    }
    if let Some(FlickerTerm { bias_instability, shortest_tau_s, longest_tau_s }) = errors.flicker {
        table.amount("flicker.bias_instability", &bias_instability.0)?;
        table.positive("flicker.shortest_tau_s", Some(shortest_tau_s))?;
        table.positive("flicker.longest_tau_s", Some(longest_tau_s))?;
        let decades = (longest_tau_s / shortest_tau_s).log10();
        if !(0.0..=MOST_DECADES).contains(&decades) {
            let words = "a time from shortest_tau_s to six decades above it";
            table.check("flicker.longest_tau_s", &[longest_tau_s], |_| false, words)?;
        }
    }
    if let Some(VibrationTerm { amplitude, frequency_hz }) = errors.vibration {
        table.amount("vibration.amplitude", &amplitude.0)?;
        table.positive("vibration.frequency_hz", Some(frequency_hz))?;
    }
    if let Some(term) = errors.band_vibration {
        let BandVibrationTerm { standard_deviation, frequency_hz, bandwidth_hz } = term;
        table.amount("band_vibration.standard_deviation", &standard_deviation.0)?;
        table.positive("band_vibration.frequency_hz", Some(frequency_hz))?;
        let words = "a width above 0 and below twice its frequency_hz";
        let allowed = |x: f64| x > 0.0 && x < 2.0 * frequency_hz;
        table.check("band_vibration.bandwidth_hz", &[bandwidth_hz], allowed, words)?;
    }
    Ok(())
}
