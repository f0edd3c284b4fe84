//! Does the accelerometer's mean look like gravity? If not, in which unit would it?

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

/// Units that recordings hold although m/s² is expected, and one of them in m/s².
const OTHERS: [(&str, &str, f64); 3] = [
    ("g", "g", STANDARD_GRAVITY),
    ("mg", "mg", STANDARD_GRAVITY * 1e-3),
    ("cm/s² (Gal)", "", 0.01),
];

/// Judges the mean of an accelerometer in what is taken for m/s².
pub fn check(mean: [f64; 3]) -> Verdict {
    let norm = mean.iter().map(|x| x * x).sum::<f64>().sqrt();
    let is_gravity = |force: f64| (force / STANDARD_GRAVITY - 1.0).abs() < 0.1;
    if is_gravity(norm) {
        return Verdict::Plausible;
    }
    let read = format!("the accelerometer reads {norm:.4} m/s² on average, which is not gravity");
    for (unit, flag, in_m_s2) in OTHERS {
        if is_gravity(norm * in_m_s2) {
            let mend = match flag {
                "" => "convert it to m/s²".to_owned(),
                flag => format!("say --accel-unit {flag}"),
            };
            return Verdict::OtherUnit(format!(
                "{read}: its unit is probably {unit}; {mend}, or --accel-unit m/s^2 if it is not"
            ));
        }
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
        for (mean, unit) in [(1.002, "--accel-unit g,"), (998.0, "--accel-unit mg,")] {
            let Verdict::OtherUnit(sentence) = check([0.0, mean, 0.0]) else { panic!("{mean}") };
            assert!(sentence.contains(unit), "{sentence}");
        }
        assert!(matches!(check([0.0, 0.0, 980.0]), Verdict::OtherUnit(_)));
    }

    #[test]
    fn no_gravity_at_all_is_odd() {
        assert!(matches!(check([0.0; 3]), Verdict::Odd(_)));
        assert!(matches!(check([f64::NAN; 3]), Verdict::Odd(_)));
    }
}
