use super::*;
use proptest::prelude::*;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

fn delta() -> impl Strategy<Value = Delta<f64>> {
    (vector(3.0), vector(10.0), vector(10.0), -10_000_000_000..10_000_000_000_i64).prop_map(
        |(turn, velocity, position, time)| Delta::new(so3::exp(turn), velocity, position, time),
    )
}

/// The largest difference; of the rotations the smaller one of both signs.
fn apart(a: &Delta<f64>, b: &Delta<f64>) -> f64 {
    assert_eq!(a.nanoseconds(), b.nanoseconds());
    let turned = so3::log(&so3::product(&so3::inverse(&a.rotation()), &b.rotation())).abs().max();
    let moved = (a.position() - b.position()).abs().max();
    turned.max((a.velocity() - b.velocity()).abs().max()).max(moved)
}

// Positions of a few hundred metres come of a dozen rounded operations: 1e-12 is 30 of their units.
proptest! {
    #[test]
    fn composing_is_associative(a in delta(), b in delta(), c in delta()) {
        prop_assert!(apart(&a.then(&b).then(&c), &a.then(&b.then(&c))) < 1e-12);
    }

    #[test]
    fn one_changes_nothing(a in delta()) {
        prop_assert!(apart(&a.then(&Delta::identity()), &a) < 1e-14);
        prop_assert!(apart(&Delta::identity().then(&a), &a) < 1e-14);
    }

    #[test]
    fn there_and_back_is_nowhere(a in delta()) {
        prop_assert!(apart(&a.then(&a.inverse()), &Delta::identity()) < 1e-12);
        prop_assert!(apart(&a.inverse().then(&a), &Delta::identity()) < 1e-12);
    }
}

#[test]
fn time_stops_at_the_end_of_its_range() {
    let zero = Vector3::zeros();
    let one = Quaternion::new(1.0_f32, 0.0, 0.0, 0.0);
    let long = Delta::new(one, zero, zero, i64::MAX);
    assert_eq!(long.then(&long).nanoseconds(), i64::MAX);
    assert_eq!(Delta::new(one, zero, zero, i64::MIN).inverse().nanoseconds(), i64::MAX);
}
