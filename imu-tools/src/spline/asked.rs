//! What people ask of a fit, as they write it: a form by its name, a distance as `5mm,0.1deg`, a frequency.

use std::f64::consts::PI;
use std::str::FromStr;

use super::{FormName, Options, Spacing};
use crate::error::Error;
use crate::scene::parse_duration;

impl FromStr for FormName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = [Self::Plain, Self::Symmetric].into_iter().find(|form| form.name() == name);
        found.ok_or_else(|| "the form of a curve is plain or symmetric".into())
    }
}

impl Default for Options {
    /// The plain curve, a control point for every pose, as smooth as that makes it.
    fn default() -> Self {
        Self { form: None, spacing: Spacing::AsPoses, smoothing_s: 0.0 }
    }
}

/// A length in m or an angle in rad.
enum Part {
    Metres(f64),
    Radians(f64),
}

/// What so many of a unit are.
type Of = fn(f64) -> Part;

/// Units and what they are in SI, longer names before what they end in.
const UNITS: [(&str, Of); 7] = [
    ("mrad", |x| Part::Radians(1e-3 * x)),
    ("rad", Part::Radians),
    ("deg", |x| Part::Radians(x * (PI / 180.0))),
    ("°", |x| Part::Radians(x * (PI / 180.0))),
    ("mm", |x| Part::Metres(1e-3 * x)),
    ("cm", |x| Part::Metres(1e-2 * x)),
    ("m", Part::Metres),
];

/// The spacing of `5mm,0.1deg`; what is left out may be any.
///
/// # Errors
/// A sentence for what is not above zero, or no length and no angle.
pub fn within(text: &str) -> Result<Spacing, Error> {
    let wrong = || {
        Error::usage(format!(
            "'{text}' is no distance: give a length, an angle, or both, such as 5mm,0.1deg (m, cm, mm; rad, mrad, deg)"
        ))
    };
    let (mut position_m, mut rotation_rad) = (None, None);
    for part in text.split(',') {
        let part = part.trim();
        let of_unit = |(unit, of): &(&str, Of)| {
            let number: f64 = part.strip_suffix(unit)?.trim_end().parse().ok()?;
            (number > 0.0 && number.is_finite()).then(|| of(number))
        };
        let (slot, value) = match UNITS.iter().find_map(of_unit).ok_or_else(wrong)? {
            Part::Metres(metres) => (&mut position_m, metres),
            Part::Radians(radians) => (&mut rotation_rad, radians),
        };
        if slot.replace(value).is_some() {
            return Err(wrong());
        }
    }
    let any = f64::INFINITY;
    Ok(Spacing::Within {
        position_m: position_m.unwrap_or(any),
        rotation_rad: rotation_rad.unwrap_or(any),
    })
}

/// Knots as far apart as `0.1`, `0.1s` or `50ms`.
///
/// # Errors
/// A sentence for what is no time between knots.
pub fn spacing(text: &str) -> Result<Spacing, Error> {
    match text.trim().parse() {
        Ok(seconds) => every(seconds),
        Err(_) => every(parse_duration(text)? as f64 / 1e9),
    }
}

/// Knots so many seconds apart.
///
/// # Errors
/// A sentence for what is no time between knots.
pub fn every(seconds: f64) -> Result<Spacing, Error> {
    let step = (1e9 * seconds).round();
    if step >= 1.0 && step <= f64::from(u32::MAX) {
        Ok(Spacing::Every(step as u32))
    } else {
        Err(Error::usage(format!(
            "knots {seconds:?} s apart cannot be: give a time up to 4.29 s, such as 0.1s"
        )))
    }
}

/// τ of a smoothing that passes half of what moves with so many Hz.
///
/// # Errors
/// A sentence for what is no frequency.
pub fn smoothing_s(hertz: f64) -> Result<f64, Error> {
    if hertz > 0.0 && (1e-6..=1e6).contains(&hertz) {
        Ok(1.0 / (2.0 * PI * hertz))
    } else {
        Err(Error::usage(format!(
            "smoothing at {hertz:?} Hz cannot be: give the frequency of which half is to be left, such as 5"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_read_as_written() {
        for (text, position_m, rotation_rad) in [
            ("5mm,0.1deg", 5e-3, 0.1 * PI / 180.0),
            ("0.1 deg, 2 cm", 0.02, 0.1 * PI / 180.0),
            ("1m", 1.0, f64::INFINITY),
            ("2mrad", f64::INFINITY, 2e-3),
            ("0.5°,1e-3m", 1e-3, 0.5 * PI / 180.0),
        ] {
            assert_eq!(
                within(text).unwrap(),
                Spacing::Within { position_m, rotation_rad },
                "{text}"
            );
        }
        for text in ["", "5", "5mm,6mm", "-1mm", "0deg", "nanm", "5 miles", "5mm,", "infm"] {
            assert!(within(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_and_frequencies_that_cannot_be() {
        assert_eq!(every(0.05).unwrap(), Spacing::Every(50_000_000));
        for text in ["0.05", "5e-2", "0.05s", "50 ms"] {
            assert_eq!(spacing(text).unwrap(), Spacing::Every(50_000_000), "{text}");
        }
        assert!([0.0, -1.0, f64::NAN, 5.0, 1e-12].iter().all(|s| every(*s).is_err()));
        assert!(["", "-50ms", "5s", "1e300", "0.1 Hz"].iter().all(|text| spacing(text).is_err()));
        assert!(every(1e300).unwrap_err().to_string().contains("1e300 s"));
        assert!([0.0, -1.0, f64::NAN, f64::INFINITY].iter().all(|hz| smoothing_s(*hz).is_err()));
    }
}
