//! Does the accelerometer's mean look like gravity? If not, in which unit would it?
//!
//! Whoever says or writes g over values in m/s² makes them 9.8 times too large: the mean tells what the
//! unit was taken for, too.

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// What the mean specific force at rest says about its unit.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Gravity, within 10 %.
    Plausible,
    /// Gravity if the unit were another one.
    OtherUnit(String),
    /// Nothing that standing still explains.
    Odd(String),
}

/// A unit of specific force.
struct Unit {
    name: &'static str,
    /// What `--accel-unit` calls it, if it knows it.
    flag: Option<&'static str>,
    in_m_s2: f64,
}

const METRES: Unit = Unit { name: "m/s²", flag: Some("m/s^2"), in_m_s2: 1.0 };
const G: Unit = Unit { name: "g", flag: Some("g"), in_m_s2: STANDARD_GRAVITY };
const MILLI_G: Unit = Unit { name: "mg", flag: Some("mg"), in_m_s2: STANDARD_GRAVITY * 1e-3 };
const GAL: Unit = Unit { name: "cm/s² (Gal)", flag: None, in_m_s2: 0.01 };

/// What values are taken for, and what they may be in truth.
const MISTAKES: [(Unit, Unit); 7] = [
    (METRES, G),
    (METRES, MILLI_G),
    (METRES, GAL),
    (G, METRES),
    (G, MILLI_G),
    (MILLI_G, METRES),
    (MILLI_G, G),
];

/// The length of a vector, also where its square is too large to be a number.
#[must_use]
pub fn norm([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

/// Judges the mean of an accelerometer, m/s² if the unit was taken for what it is.
pub fn check(mean: [f64; 3]) -> Verdict {
    let norm = norm(mean);
    let is_gravity = |force: f64| (force / STANDARD_GRAVITY - 1.0).abs() < 0.1;
    if is_gravity(norm) {
        return Verdict::Plausible;
    }
    let shown = if norm < 1e6 { format!("{norm:.4}") } else { format!("{norm:.3e}") };
    let read = format!("the accelerometer reads {shown} m/s² on average, which is not gravity");
    let off = |(taken_for, unit): &(Unit, Unit)| {
        (norm / taken_for.in_m_s2 * unit.in_m_s2 / STANDARD_GRAVITY - 1.0).abs()
    };
    // Where two units fit, as mg and Gal do, the one that fits best.
    let best = MISTAKES.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    if let Some((taken_for, unit)) = best.filter(|mistake| off(mistake) < 0.1) {
        let mend = match unit.flag {
            None => "convert it to m/s²".to_owned(),
            Some(flag) => format!("say --accel-unit {flag}"),
        };
        let other = taken_for.flag.unwrap_or_default();
        return Verdict::OtherUnit(format!(
            "{read}: its unit is probably {} and not {}; {mend}, or --accel-unit {other} if it is not",
            unit.name, taken_for.name
        ));
    }
    Verdict::Odd(format!(
        "{read}: the sensor moved, gravity was removed from the data, or the unit is not m/s²"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_in_any_direction_is_plausible() {
        assert_eq!(check([0.0, 0.0, 9.81]), Verdict::Plausible);
        assert_eq!(check([5.66, -5.66, 5.66]), Verdict::Plausible);
    }

    #[test]
    fn other_units_are_named_with_the_way_out() {
        for (mean, unit) in [
            (1.002, "is probably g and not m/s²; say --accel-unit g, or --accel-unit m/s^2"),
            (998.0, "is probably mg and not m/s²; say --accel-unit mg,"),
            (1000.0, "is probably mg and not m/s²"),
            (980.665, "is probably cm/s² (Gal) and not m/s²; convert it to m/s²,"),
            (9.8 * 9.8, "is probably m/s² and not g; say --accel-unit m/s^2, or --accel-unit g if"),
            (9806.0, "is probably mg and not g"),
            (0.0961, "is probably m/s² and not mg"),
            (0.0098, "is probably g and not mg"),
        ] {
            let Verdict::OtherUnit(sentence) = check([0.0, mean, 0.0]) else { panic!("{mean}") };
            assert!(sentence.contains(unit), "{sentence}");
        }
    }

    #[test]
    fn no_gravity_at_all_is_odd() {
        assert!(matches!(check([0.0; 3]), Verdict::Odd(_)));
        assert!(matches!(check([f64::NAN; 3]), Verdict::Odd(_)));
        let Verdict::Odd(sentence) = check([1e308, 0.0, 0.0]) else { panic!() };
        assert!(!sentence.contains("inf"), "{sentence}");
    }
}
