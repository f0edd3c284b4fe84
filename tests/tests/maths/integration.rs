//! Integration rules on motions in closed form: their orders, how much better each is than the one before, and what
//! single precision does to them.

use imu_tools::tradeoff::rules::follow::{Carrier, Errors, Record, Rule, follow};
use imu_tools::tradeoff::rules::motion::Motion;

fn errors(motion: Motion, rate: u32, rule: Rule) -> Errors {
    let record = Record::at_rate(motion, rate, rule.takes_increments());
    follow(&record, rule, Carrier::F64).unwrap()
}

/// Ten seconds of a motion; every stamp up to `jitter`/2 of a step early or late.
fn jittered(motion: Motion, rate: u32, jitter: f64, increments: bool) -> Record {
    let step = 1e9 / f64::from(rate);
    let mut state = 1_u64;
    let stamps = (0..=10 * rate).map(|k| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        ((f64::from(k) + jitter * unit) * step).round() as i64
    });
    Record::new(motion, stamps.collect(), increments)
}

/// The slope of log error over log step, by least squares over these rates: attitude, velocity, position.
fn orders(rule: Rule, motion: Motion, rates: &[u32], jitter: f64) -> [f64; 3] {
    let points = rates.iter().map(|&rate| {
        let record = jittered(motion, rate, jitter, rule.takes_increments());
        let Errors { attitude_deg, velocity, position } =
            follow(&record, rule, Carrier::F64).unwrap();
        (-f64::from(rate).ln(), [attitude_deg, velocity, position].map(f64::ln))
    });
    let points: Vec<_> = points.collect();
    let n = points.len() as f64;
    let mean_x = points.iter().map(|(x, _)| x).sum::<f64>() / n;
    let spread = points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>();
    [0, 1, 2].map(|k| points.iter().map(|(x, y)| (x - mean_x) * y[k]).sum::<f64>() / spread)
}

/// Smooth motion, where one step changes little: MATHS of each rule, to ±0.15.
#[test]
fn orders_are_those_of_the_formulas() {
    for (rule, order, rates) in [
        (Rule::Euler, 1.0, [125, 250, 500, 1000]),
        (Rule::Midpoint, 2.0, [125, 250, 500, 1000]),
        (Rule::ConingSculling, 2.0, [125, 250, 500, 1000]),
        (Rule::ThreeSample, 3.0, [125, 250, 500, 1000]),
        (Rule::PreviousIncrement, 3.0, [125, 250, 500, 1000]),
        // Fourth order reaches the rounding of double precision soon.
        (Rule::TwoSample, 4.0, [32, 64, 128, 256]),
    ] {
        for measured in orders(rule, Motion::Ellipse, &rates, 0.0) {
            assert!((measured - order).abs() < 0.15, "{rule:?}: {measured}");
        }
    }
}

/// Stamps up to 15 % of a step early or late: errors are sums of random parts, so slopes scatter by 0.1.
#[test]
fn uneven_steps_keep_the_third_order() {
    let rates = [62, 125, 250, 500, 1000, 2000];
    for rule in [Rule::ThreeSample, Rule::PreviousIncrement] {
        for measured in orders(rule, Motion::Ellipse, &rates, 0.3) {
            assert!((measured - 3.0).abs() < 0.15, "{rule:?}: {measured}");
        }
    }
    // Of the pairs only the uneven part is of third order.
    for measured in orders(Rule::TwoSample, Motion::Ellipse, &rates, 0.3) {
        assert!(measured > 2.85, "{measured}");
    }
}

/// At 1 kHz in double precision, the largest error of a run.
#[test]
fn better_rules_are_better_by_orders_of_magnitude() {
    for (motion, three, midpoint) in
        [(Motion::Ellipse, 2e-9, 1.6e-5), (Motion::Gait, 6e-6, 6.6e-3), (Motion::Spin, 4e-2, 0.73)]
    {
        let attitude = |rule| errors(motion, 1000, rule).attitude_deg;
        assert!(attitude(Rule::ThreeSample) <= three);
        let plain = attitude(Rule::Midpoint);
        assert!((plain / midpoint - 1.0).abs() < 0.03, "{plain}");
    }
    let coning = |rule| errors(Motion::Coning, 1000, rule).attitude_deg;
    let ratio = coning(Rule::ConingSculling) / coning(Rule::Midpoint);
    assert!((ratio - 0.5).abs() < 0.02, "{ratio}");
}

/// What the documentation says of it: no better than midpoint in position on a smooth motion, better on a rough one.
#[test]
fn coning_and_sculling_does_not_pay_for_the_position_of_smooth_motion() {
    let position = |motion, rule| errors(motion, 1000, rule).position;
    let ratio = |motion| position(motion, Rule::ConingSculling) / position(motion, Rule::Midpoint);
    assert!(ratio(Motion::Ellipse) > 1.0);
    assert!(ratio(Motion::Gait) < 0.8 && ratio(Motion::Spin) < 0.8);
}

/// 60 s of 8 kHz in single precision: what a plain state loses, and what blocks and compensation save.
#[test]
fn single_precision_is_right_at_8_khz() {
    let record = Record::at_rate(Motion::Ellipse, 8000, false);
    for rule in [Rule::Midpoint, Rule::ConingSculling, Rule::ThreeSample] {
        let of = |carrier| follow(&record, rule, carrier).unwrap();
        let plain = of(Carrier::F32);
        assert!(plain.attitude_deg > 5e-3 && plain.position > 0.1, "{plain:?}");
        let compensated = of(Carrier::F32Compensated);
        assert!(
            compensated.attitude_deg <= 1e-4 && compensated.position <= 1e-3,
            "{compensated:?}"
        );
        let blocks = of(Carrier::F32Blocks);
        assert!(blocks.attitude_deg <= 5e-4 && blocks.position <= 1e-3, "{blocks:?}");
    }
}
