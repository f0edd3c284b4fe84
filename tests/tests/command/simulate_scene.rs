//! The simulator against the compiled composition of the same stages, and its low-pass against the
//! law of a one-pole-filtered noise.

use imu_core::noise::{ConstantBias, RandomWalk, Sensor, Stage, ThreeAxis, White};
use imu_core::trajectory::{Ellipse, Motion, Trajectory};
use imu_tools::recording::{BLOCK_SAMPLES, Block, Sample};
use imu_tools::scene::{Path, Preset, Rate, Scene, SensorErrors, Simulator};

/// A scene with every term, different on every axis, on the ellipse.
fn full() -> Scene {
    Scene {
        motion: Path::Ellipse,
        duration_ns: 50_000_000_000,
        seed: 7,
        gyroscope: SensorErrors {
            noise_density: [0.01, 0.02, 0.03],
            random_walk: [1e-3, 2e-3, 3e-3],
            constant_bias: [0.1, -0.2, 0.3],
            lowpass_hz: None,
            ..SensorErrors::default()
        },
        accelerometer: SensorErrors {
            noise_density: [0.04, 0.05, 0.06],
            random_walk: [4e-3, 5e-3, 6e-3],
            constant_bias: [-0.4, 0.5, -0.6],
            lowpass_hz: None,
            ..SensorErrors::default()
        },
        ..Preset::Mid.scene()
    }
}

fn play(scene: &Scene) -> Block {
    let mut simulator = Simulator::new(scene).expect("valid scene");
    let (mut all, mut block) = (Block::default(), Block::default());
    while simulator.advance(&mut block) {
        assert!(block.gyroscope.len() <= BLOCK_SAMPLES);
        all.gyroscope.extend(&block.gyroscope);
        all.accelerometer.extend(&block.accelerometer);
    }
    assert_eq!(block, Block::default(), "the end is an empty block");
    all
}

type Terms = (White<f64>, RandomWalk<f64>, ConstantBias<f64>);

fn compiled(
    scene: &Scene,
    errors: &SensorErrors,
    sensor: Sensor,
) -> ThreeAxis<<Terms as imu_core::noise::Term<f64>>::Stage> {
    let terms = [0, 1, 2].map(|axis| {
        (
            White { noise_density: errors.noise_density[axis] },
            RandomWalk { random_walk: errors.random_walk[axis] },
            ConstantBias { constant_bias: errors.constant_bias[axis] },
        )
    });
    ThreeAxis::prepare(terms, scene.rate.interval_s(), scene.seed, sensor).expect("valid")
}

#[test]
fn a_scene_gives_the_bits_of_the_compiled_composition_and_of_its_own_truth() {
    let scene = full();
    let mut gyroscope = compiled(&scene, &scene.gyroscope, Sensor::GYROSCOPE);
    let mut accelerometer = compiled(&scene, &scene.accelerometer, Sensor::ACCELEROMETER);
    let all = play(&scene);
    assert_eq!(all.gyroscope.len(), 10_000);

    let mut simulator = Simulator::new(&scene).expect("valid scene");
    let mut block = Block::default();
    let mut samples = all.gyroscope.iter().zip(&all.accelerometer);
    while let Some(truth) = simulator.advance_with_truth(&mut block) {
        for i in 0..block.gyroscope.len() {
            let (rate, force) = samples.next().expect("as many with truth as without");
            assert_eq!((&block.gyroscope[i], &block.accelerometer[i]), (rate, force));
            assert_eq!(truth.stamps_ns[i], Some(rate.stamp_ns));
            assert_eq!(truth.times_ns[i], rate.stamp_ns);
            let motion: Motion<f64> = Ellipse::default().at(rate.stamp_ns - scene.start_ns);
            assert_eq!(motion, truth.motions[i]);
            // The scene's sum of a bias starts at zero, in the order of the composition.
            assert_eq!(gyroscope.bias(), truth.gyroscope_bias[i]);
            assert_eq!(accelerometer.bias(), truth.accelerometer_bias[i]);
            assert_eq!(gyroscope.step(motion.angular_rate.into()), rate.value);
            assert_eq!(accelerometer.step(motion.specific_force.into()), force.value);
        }
    }
    assert!(samples.next().is_none());
}

#[test]
fn a_term_left_out_changes_no_other_and_an_empty_scene_is_the_truth() {
    let with = full();
    let mut without = full();
    without.gyroscope.noise_density[1] = 0.0;
    without.accelerometer.random_walk = [0.0; 3];
    let (with, without) = (play(&with), play(&without));
    for (a, b) in with.gyroscope.iter().zip(&without.gyroscope) {
        assert_eq!((a.value[0], a.value[2]), (b.value[0], b.value[2]));
        assert_ne!(a.value[1], b.value[1]);
    }
    let ideal = play(&Scene { duration_ns: 1_000_000_000, ..Scene::default() });
    assert!(ideal.gyroscope.iter().all(|sample| sample.value == [0.0; 3]));
    assert!(ideal.accelerometer.iter().all(|sample| sample.value == [0.0, 0.0, 9.81]));
}

#[test]
fn stamps_are_rounded_quotients_at_an_uneven_rate() {
    let scene = Scene {
        rate: Rate::from_hz(333.3).expect("valid"),
        duration_ns: 100_000_000_000,
        ..Preset::Low.scene()
    };
    let samples = play(&scene).accelerometer;
    assert_eq!(samples.len(), 33_330);
    for (i, sample) in samples.iter().enumerate() {
        let exact = (i as i64 * 20_000_000_000 + 3_333) / 6_666;
        assert_eq!(sample.stamp_ns, scene.start_ns + exact);
    }
}

/// FNV-1a of a whole scene: the same bytes on every machine and in every version.
#[test]
fn the_samples_of_a_scene_never_change() {
    let mut scene = full();
    scene.gyroscope.lowpass_hz = Some(42.0);
    let all = play(&scene);
    let hash = all.gyroscope.iter().chain(&all.accelerometer).fold(
        0xcbf2_9ce4_8422_2325,
        |hash: u64, sample| {
            sample
                .value
                .iter()
                .map(|x| x.to_bits())
                .chain([sample.stamp_ns as u64])
                .fold(hash, |hash, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3))
        },
    );
    assert_eq!(hash, 903_187_302_869_295_714);
}

fn filtered(hz: f64, seed: u64, duration_ns: u64) -> Vec<Sample> {
    let errors =
        SensorErrors { noise_density: [1.0; 3], lowpass_hz: Some(hz), ..SensorErrors::default() };
    let scene =
        Scene { gyroscope: errors, accelerometer: errors, seed, duration_ns, ..Scene::default() };
    play(&scene).gyroscope
}

/// White noise behind one pole is AR(1): variance σ²(1 − φ)/(1 + φ), neighbours correlated by φ.
/// Over n samples the sample variance has the relative sd √(2(1 + φ²)/(1 − φ²)/n), and the
/// correlation √((1 − φ²)/n) (Bartlett); 5.5 of each.
#[test]
fn a_low_pass_makes_the_ar1_process_of_its_cut_off() {
    for hz in [92.0, 42.0, 20.0] {
        let phi = (-2.0 * std::f64::consts::PI * hz / 200.0).exp();
        let samples = filtered(hz, 3, 2_000_000_000_000);
        let n = samples.len() as f64;
        for axis in 0..3 {
            let x: Vec<f64> = samples.iter().map(|sample| sample.value[axis]).collect();
            let variance = x.iter().map(|x| x * x).sum::<f64>() / n;
            let expected = 200.0 * (1.0 - phi) / (1.0 + phi);
            let sd = (2.0 * (1.0 + phi * phi) / (1.0 - phi * phi) / n).sqrt();
            assert!((variance / expected - 1.0).abs() < 5.5 * sd, "{hz} Hz: {variance}");
            let neighbours = x.iter().zip(&x[1..]).map(|(a, b)| a * b).sum::<f64>() / n;
            let sd = ((1.0 - phi * phi) / n).sqrt();
            assert!((neighbours / variance - phi).abs() < 5.5 * sd, "{hz} Hz: {neighbours}");
        }
    }
}

/// Long averages show the density N that the scene gives: blocks of 1 s (200 samples), whose ends
/// lose φ-sized parts: var = (N²/τ)(1 − 2φ/(m(1 − φ²))) to first order. 5.5 sd of the variance.
#[test]
fn a_low_pass_keeps_the_density_at_low_frequency() {
    let samples = filtered(20.0, 4, 4_000_000_000_000);
    let phi = (-2.0 * std::f64::consts::PI * 20.0 / 200.0).exp();
    let expected = 1.0 - 2.0 * phi / (200.0 * (1.0 - phi * phi));
    for axis in 0..3 {
        let blocks: Vec<f64> = samples
            .chunks(200)
            .map(|block| block.iter().map(|sample| sample.value[axis]).sum::<f64>() / 200.0)
            .collect();
        let n = blocks.len() as f64;
        let variance = blocks.iter().map(|x| x * x).sum::<f64>() / n;
        assert!((variance - expected).abs() < 5.5 * (2.0 / n).sqrt(), "{variance} {expected}");
    }
}

/// The very first sample has the law of any other: over 3000 seeds and axes, and with a bias and
/// gravity that it does not have to creep up to.
#[test]
fn a_low_pass_starts_settled() {
    let phi: f64 = (-2.0 * std::f64::consts::PI * 20.0 / 200.0).exp();
    let expected = 200.0 * (1.0 - phi) / (1.0 + phi);
    let firsts: Vec<f64> =
        (0..1000).flat_map(|seed| filtered(20.0, seed, 5_000_000)[0].value).collect();
    let n = firsts.len() as f64;
    let variance = firsts.iter().map(|x| x * x).sum::<f64>() / n;
    assert!((variance / expected - 1.0).abs() < 5.5 * (2.0 / n).sqrt(), "{variance} {expected}");

    let still =
        SensorErrors { constant_bias: [0.5; 3], lowpass_hz: Some(20.0), ..SensorErrors::default() };
    let scene = Scene { accelerometer: still, duration_ns: 1_000_000_000, ..Scene::default() };
    assert!(play(&scene).accelerometer.iter().all(|sample| sample.value == [0.5, 0.5, 10.31]));
}
