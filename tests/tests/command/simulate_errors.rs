//! Every error of a scene together: that the terms add up to the samples, what means and increments
//! are, what the clock does to stamps, and that none of them changes another's numbers.

use imu_tools::recording::{Block, SampleKind};
use imu_tools::scene::{
    ClockErrors, Contributions, ErrorTerm, Path, Poles, Rate, Scene, SensorErrors, Simulator, Truth,
};

/// Everything that a scene can switch on.
const ALL: &str = include_str!("../../../examples/scenes/everything.toml");

fn all() -> Scene {
    Scene {
        duration_ns: 30_000_000_000,
        ..Scene::from_toml(ALL, "everything.toml").expect("valid")
    }
}

/// All samples, and their truth block by block.
fn play(scene: &Scene, terms: bool) -> (Block, Vec<Truth>) {
    let mut simulator = Simulator::new(scene).expect("a valid scene");
    if terms {
        simulator.keep_terms();
    }
    let (mut all, mut block, mut truths) = (Block::default(), Block::default(), Vec::new());
    while let Some(truth) = simulator.advance_with_truth(&mut block) {
        truths.push(truth.clone());
        all.gyroscope.extend(&block.gyroscope);
        all.accelerometer.extend(&block.accelerometer);
        all.temperature.extend(&block.temperature);
    }
    (all, truths)
}

/// The samples without asking for the truth.
fn samples(scene: &Scene) -> Block {
    let mut simulator = Simulator::new(scene).expect("a valid scene");
    let (mut all, mut block) = (Block::default(), Block::default());
    while simulator.advance(&mut block) {
        all.gyroscope.extend(&block.gyroscope);
        all.accelerometer.extend(&block.accelerometer);
        all.temperature.extend(&block.temperature);
    }
    all
}

/// The sum of an axis's terms up to one of them (not with it) at sample `i`.
fn sum(axis: &Contributions, until: Option<ErrorTerm>, i: usize) -> f64 {
    let before = axis.terms.iter().take_while(|(term, _)| Some(*term) != until);
    before.map(|(_, added)| added[i]).sum()
}

/// Twenty additions of numbers below 200 round by less than 20·200·2⁻⁵³ = 5e-13.
#[test]
fn the_terms_add_up_to_the_samples_of_every_kind() {
    for kind in SampleKind::ALL {
        let scene = Scene { samples: kind, ..all() };
        let scale = match kind {
            SampleKind::Increments => scene.rate.interval_s(),
            _ => 1.0,
        };
        let (block, truths) = play(&scene, true);
        assert_eq!(block, samples(&scene), "what is watched does not change");
        let (mut rates, mut forces) = (block.gyroscope.iter(), block.accelerometer.iter());
        for truth in &truths {
            for (i, stamp) in truth.stamps_ns.iter().enumerate() {
                let Some(stamp) = *stamp else { continue };
                let (rate, force) = (rates.next().expect("one"), forces.next().expect("one"));
                assert_eq!((rate.stamp_ns, force.stamp_ns), (stamp, stamp));
                for axis in 0..3 {
                    let off = sum(&truth.gyroscope_terms[axis], None, i) * scale - rate.value[axis];
                    assert!(off.abs() < 5e-13, "{kind:?}: {off}");
                    let terms = &truth.accelerometer_terms[axis];
                    let off = sum(terms, None, i) * scale - force.value[axis];
                    assert!(off.abs() < 5e-13, "{kind:?}: {off}");
                    // What comes before saturation may exceed the full scale, what comes behind not.
                    let behind = sum(terms, Some(ErrorTerm::Quantisation), i);
                    assert!(behind.abs() <= scene.accelerometer.saturation.expect("one") + 5e-13);
                }
            }
        }
        assert!(rates.next().is_none() && forces.next().is_none());
    }
}

/// Every error that the example has is there by its name, once.
#[test]
fn every_term_has_its_column() {
    let (_, truths) = play(&all(), true);
    let names = |axis: &Contributions| axis.terms.iter().map(|(t, _)| t.name()).collect::<Vec<_>>();
    let gyroscope = names(&truths[0].gyroscope_terms[0]);
    assert_eq!(
        gyroscope,
        [
            "truth",
            "scale_misalignment",
            "g_sensitivity",
            "white_noise",
            "random_walk",
            "constant_bias",
            "turn_on_bias",
            "gauss_markov",
            "flicker",
            "rate_ramp",
            "temperature",
            "warm_up",
            "vibration",
            "band_vibration",
            "bandwidth",
            "saturation",
            "increment_quantisation",
            "quantisation",
        ]
    );
    assert_eq!(
        names(&truths[0].accelerometer_terms[2])[..3],
        ["truth", "lever_arm", "scale_misalignment"]
    );
}

/// A bias that the truth tells is the sum of its terms, to the bit of the order they are added in.
#[test]
fn the_bias_is_the_sum_of_its_terms() {
    let (_, truths) = play(&all(), true);
    for truth in &truths {
        for (i, bias) in truth.gyroscope_bias.iter().enumerate() {
            for (terms, bias) in truth.gyroscope_terms.iter().zip(bias) {
                let from = sum(terms, Some(ErrorTerm::RandomWalk), i);
                let until = sum(terms, Some(ErrorTerm::Vibration), i);
                assert!((until - from - bias).abs() < 5e-13);
            }
        }
    }
}

fn ideal(samples: SampleKind, motion: Path) -> Scene {
    Scene { samples, motion, duration_ns: 20_000_000_000, ..Scene::default() }
}

#[test]
fn at_rest_a_mean_is_the_value_and_an_increment_the_value_times_dt() {
    let means = samples(&ideal(SampleKind::Mean, Path::Rest));
    assert!(means.accelerometer.iter().all(|sample| sample.value == [0.0, 0.0, 9.81]));
    let increments = samples(&ideal(SampleKind::Increments, Path::Rest));
    assert_eq!(increments.gyroscope.len(), 4000);
    assert!(increments.accelerometer.iter().all(|s| s.value == [0.0, 0.0, 9.81 * 0.005]));
}

type Quaternion = [f64; 4];

fn product([a, b, c, d]: Quaternion, [e, f, g, h]: Quaternion) -> Quaternion {
    [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn rotate(q: Quaternion, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [w, i, j, k] = q;
    let [_, x, y, z] = product(product(q, [0.0, x, y, z]), [w, -i, -j, -k]);
    [x, y, z]
}

/// Increments of the ellipse, integrated by the two-sample rule (fourth order), arrive at
/// the true attitude and velocity. Its own error at 200 Hz over a minute is 1.3e-11 rad, and of velocity
/// by the same expansion below 20 m/s times that; had each increment a relative error of 1e-8, as of the
/// midpoint's, these would be off by 1e-7.
#[test]
fn increments_lead_to_the_true_attitude_and_velocity() {
    let (block, truths) = play(&ideal(SampleKind::Increments, Path::Ellipse), false);
    let motions: Vec<_> = truths.iter().flat_map(|truth| &truth.motions).collect();
    let start = motions[0].attitude_wb;
    let mut q = [start.w, start.i, start.j, start.k];
    let mut v: [f64; 3] = motions[0].velocity_w.into();
    let h = 2.0 * 0.005;
    let add = |a: [f64; 3], b: [f64; 3], s: f64| [0, 1, 2].map(|i| a[i] + s * b[i]);
    for pair in (1..3999).step_by(2) {
        let [(a1, u1), (a2, u2)] =
            [pair, pair + 1].map(|i| (block.gyroscope[i].value, block.accelerometer[i].value));
        let theta = add(add(a1, a2, 1.0), cross(a1, a2), 2.0 / 3.0);
        let coupled = add(cross(a1, u2), cross(u1, a2), 1.0);
        let u = add(add(u1, u2, 1.0), coupled, 2.0 / 3.0);
        let square: f64 = theta.iter().map(|x| x * x).sum();
        let turned = cross(theta, u);
        let dv = add(add(u, turned, 0.5 - square / 24.0), cross(theta, turned), 1.0 / 6.0);
        v = add(add(v, rotate(q, dv), 1.0), [0.0, 0.0, -9.81], h);
        let angle = square.sqrt();
        let s = (0.5 * angle).sin() / angle;
        q = product(q, [(0.5 * angle).cos(), s * theta[0], s * theta[1], s * theta[2]]);
        let true_q = motions[pair + 1].attitude_wb;
        let back = [true_q.w, -true_q.i, -true_q.j, -true_q.k];
        let [_, x, y, z] = product(back, q);
        assert!(2.0 * (x * x + y * y + z * z).sqrt() < 1e-10, "{pair}");
        let off = add(v, motions[pair + 1].velocity_w.into(), -1.0);
        assert!(off.iter().all(|x| x.abs() < 2e-9), "{pair}: {off:?}");
    }
}

/// Means of a random walk have the Allan variance K²τ/3 at one sample, instants half as much again.
/// Neighbouring differences of means are correlated by ¼, of instants not at all: over n of them the
/// estimate scatters by √((2 + 4/16)/n), √(2/n) of itself; 5.5 of each.
#[test]
fn the_noise_of_means_is_that_of_means() {
    for (kind, factor, edf) in
        [(SampleKind::Mean, 1.0, 2.25), (SampleKind::Instantaneous, 1.5, 2.0)]
    {
        let gyroscope = SensorErrors { random_walk: [0.1; 3], ..SensorErrors::default() };
        let scene = Scene { gyroscope, duration_ns: 500_000_000_000, ..ideal(kind, Path::Rest) };
        let values = samples(&scene).gyroscope;
        for axis in 0..3 {
            let n = (values.len() - 1) as f64;
            let squares: f64 =
                values.windows(2).map(|w| (w[1].value[axis] - w[0].value[axis]).powi(2)).sum();
            let expected = factor * 0.01 * 0.005 / 3.0;
            let off = squares / (2.0 * n) / expected - 1.0;
            assert!(off.abs() < 5.5 * (edf / n).sqrt(), "{kind:?}: {off}");
        }
    }
}

/// A clock changes stamps and leaves out samples; what is left keeps its bits.
#[test]
fn a_clock_changes_no_sample() {
    let right = Scene { clock: ClockErrors::default(), ..all() };
    let (whole, _) = play(&right, false);
    let (left, truths) = play(&all(), false);
    let stamps = truths.iter().flat_map(|truth| truth.times_ns.iter().zip(&truth.stamps_ns));
    let (mut rates, mut lost) = (left.gyroscope.iter().zip(&left.temperature), 0);
    for ((time, stamp), rate) in stamps.zip(&whole.gyroscope) {
        assert_eq!(*time, rate.stamp_ns);
        match stamp {
            None => lost += 1,
            Some(stamp) => {
                let (came, temperature) = rates.next().expect("a sample for each stamp");
                assert_eq!((came.value, came.stamp_ns), (rate.value, *stamp));
                assert_eq!(temperature.stamp_ns, *stamp);
            }
        }
    }
    assert!(rates.next().is_none());
    assert!(lost > 0 && left.gyroscope.len() + lost == whole.gyroscope.len());
}

/// Each error switched off by itself leaves the numbers of all others.
#[test]
fn switching_one_error_off_changes_no_other() {
    let scene = all();
    let mut without = scene.clone();
    without.gyroscope.noise_density = [0.0; 3];
    without.gyroscope.flicker = None;
    (without.gyroscope.lowpass_hz, without.gyroscope.lowpass_poles) = (None, Poles::One);
    without.clock.jitter_s = 0.0;
    without.accelerometer.turn_on_bias = [0.0; 3];
    let ((_, with), (_, without)) = (play(&scene, true), play(&without, true));
    for (with, without) in with.iter().zip(&without) {
        for axis in 0..3 {
            let shaped = [ErrorTerm::Bandwidth, ErrorTerm::Saturation, ErrorTerm::Quantisation];
            for (term, added) in &without.gyroscope_terms[axis].terms {
                if !shaped.contains(term) {
                    let same = with.gyroscope_terms[axis].terms.iter().find(|(t, _)| t == term);
                    assert_eq!(&same.expect("there").1, added, "{term:?}");
                }
            }
        }
    }
}

/// Two poles, from the first sample on what they have long seen: a constant bias, scale and gravity.
#[test]
fn two_poles_start_settled() {
    let accelerometer = SensorErrors {
        constant_bias: [0.5; 3],
        scale_error: [0.0, 0.0, 0.5],
        lowpass_hz: Some(20.0),
        lowpass_poles: Poles::Two,
        ..SensorErrors::default()
    };
    let scene = Scene {
        accelerometer,
        rate: Rate::from_hz(100.0).expect("valid"),
        ..ideal(SampleKind::Instantaneous, Path::Rest)
    };
    let settled = [0.5, 0.5, 1.5 * 9.81 + 0.5];
    assert!(samples(&scene).accelerometer.iter().all(|sample| sample.value == settled));
}
