//! Files that cannot be one recording: named twice, copies, of two rates, in two units.

use std::path::PathBuf;

use super::part::{Part, name};
use crate::error::Error;
use crate::recording::sensor::Sensor;

/// Rates of two files that differ by a larger part are those of two settings.
const SAME_RATE: f64 = 0.01;

/// The same file twice would count twice.
pub fn twice(paths: &[PathBuf]) -> Result<(), Error> {
    let mut seen = Vec::new();
    for path in paths {
        let target = path.canonicalize().unwrap_or_else(|_| path.clone());
        if seen.contains(&target) {
            return Err(Error::usage(format!(
                "{} is named twice: its samples would count twice",
                name(path)
            )));
        }
        seen.push(target);
    }
    Ok(())
}

/// So would a copy: the same first samples, to the bit. `parts` are in order of their first stamps.
pub fn copies(parts: &[Part]) -> Result<(), Error> {
    let bits = |part: &Part| {
        part.first.map(|first| first.map(|s| (s.stamp_ns, s.value.map(f64::to_bits))))
    };
    for pair in parts.windows(2) {
        if let [one, other] = pair
            && bits(one) == bits(other)
        {
            return Err(Error::data(format!(
                "{} and {} begin with the same samples: one is a copy of the other, or a part, and \
                 would count twice",
                one.name(),
                other.name()
            )));
        }
    }
    Ok(())
}

/// One ladder has one τ.
pub fn two_rates(parts: &[Part]) -> Result<(), Error> {
    for (at, sensor) in Sensor::BOTH.into_iter().enumerate() {
        let rates =
            || parts.iter().filter_map(|part| Some((part, part.rates.get(at).copied().flatten()?)));
        let Some((one, rate)) = rates().next() else { continue };
        if let Some((other, own)) = rates().find(|(_, own)| (own / rate - 1.0).abs() > SAME_RATE) {
            return Err(Error::data(format!(
                "the {} has {rate:.1} samples a second in {} and {own:.1} in {}: take them one by one",
                sensor.name(),
                one.name(),
                other.name()
            )));
        }
    }
    Ok(())
}

/// Gravity that differs by a large factor is gravity in two units.
pub fn two_units(parts: &[Part]) -> Result<(), Error> {
    /// Neither motion nor a bias makes so much of the mean; g and m/s² are 9.8 apart.
    const FACTOR: f64 = 5.0;
    /// Less than this, in whatever unit, is no gravity.
    const LEAST: f64 = 0.5;
    let mut forces =
        parts.iter().filter_map(|part| Some((part, part.force.filter(|f| *f > LEAST)?)));
    let Some((one, force)) = forces.next() else { return Ok(()) };
    match forces.find(|(_, own)| own / force > FACTOR || force / own > FACTOR) {
        None => Ok(()),
        Some((other, own)) => Err(Error::data(format!(
            "the accelerometer reads {force:.3} m/s² on average in {} and {own:.3} in {}: one of \
             them is in another unit; convert it first with --accel-unit",
            one.name(),
            other.name()
        ))),
    }
}
