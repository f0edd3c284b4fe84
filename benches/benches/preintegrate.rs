//! A step of preintegration, beside the dense form: error-state matrices F (15 × 15) and V (15 × 18) of a midpoint step
//! filled, J ← F J and P ← F P Fᵀ + V N Vᵀ by nalgebra, as VINS-Mono (Qin, Li & Shen, 2018) does it.
//!
//! `cargo bench -p imu-benches --bench preintegrate`: times are of one step. Intervals are of 20 samples, a camera frame
//! at 10 Hz; each is begun anew, in either form.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_core::Real;
use imu_core::delta::Delta;
use imu_core::integrate::{Midpoint, Rule};
use imu_core::nalgebra::{Field, Matrix3, SMatrix, Vector3};
use imu_core::preintegrate::{Mean, NoiseDensities, WithCovariance, WithJacobian};
use imu_core::sample::{Bias, Sample};
use imu_core::time::Step;
use std::hint::black_box;

const STEPS: u32 = 20;

fn samples<T: Real>() -> Vec<Sample<T>> {
    let vector = |v: [f64; 3]| Vector3::from(v.map(T::from_f64));
    (0..=STEPS)
        .map(|k| {
            let t = f64::from(k) / 200.0;
            let rate = [1.2 + (9.0 * t).cos(), -0.8 * (3.0 * t).sin(), 1.5];
            let force = [4.0 * (3.0 * t).sin(), 2.0, 9.81 + (9.0 * t).cos()];
            Sample::new(vector(rate), vector(force)).expect("finite")
        })
        .collect()
}

fn densities<T: Real>() -> NoiseDensities<T> {
    let [gyro_noise_density, accel_noise_density, gyro_random_walk, accel_random_walk] =
        [2e-3, 2e-2, 1e-5, 1e-4].map(T::from_f64);
    NoiseDensities { gyro_noise_density, accel_noise_density, gyro_random_walk, accel_random_walk }
}

/// The dense form. The order of the errors is θ, p, v, b_a, b_g; of the noise the gyroscope's and accelerometer's at the
/// beginning and at the end of the step, then both walks.
struct Dense<T: Real + Field> {
    rule: Midpoint<T>,
    before: Sample<T>,
    delta: Delta<T>,
    jacobian: SMatrix<T, 15, 15>,
    covariance: SMatrix<T, 15, 15>,
    noise: SMatrix<T, 18, 18>,
}

impl<T: Real + Field> Dense<T> {
    fn new(first: &Sample<T>, dt: T) -> Self {
        let d = densities::<T>();
        let mut noise = SMatrix::zeros();
        for (block, density, scale) in [
            (0, d.gyro_noise_density, T::ONE / dt),
            (1, d.accel_noise_density, T::ONE / dt),
            (2, d.gyro_noise_density, T::ONE / dt),
            (3, d.accel_noise_density, T::ONE / dt),
            (4, d.gyro_random_walk, dt),
            (5, d.accel_random_walk, dt),
        ] {
            for axis in 0..3 {
                noise[(3 * block + axis, 3 * block + axis)] = density * density * scale;
            }
        }
        Self {
            rule: Midpoint::new(first),
            before: *first,
            delta: Delta::identity(),
            jacobian: SMatrix::identity(),
            covariance: SMatrix::zeros(),
            noise,
        }
    }

    fn step(&mut self, sample: &Sample<T>, step: &Step<T>) {
        let real = |x: f64| <T as Real>::from_f64(x);
        let (half, quarter) = (real(0.5), real(0.25));
        let dt = step.seconds();
        let skew = |v: Vector3<T>| {
            let zero = T::ZERO;
            Matrix3::new(zero, -v.z, v.y, v.z, zero, -v.x, -v.y, v.x, zero)
        };
        let axes = |delta: &Delta<T>| {
            let q = delta.rotation();
            let (w, x, y, z) = (q.coords.w, q.coords.x, q.coords.y, q.coords.z);
            let two = real(2.0);
            Matrix3::new(
                T::ONE - two * (y * y + z * z),
                two * (x * y - w * z),
                two * (x * z + w * y),
                two * (x * y + w * z),
                T::ONE - two * (x * x + z * z),
                two * (y * z - w * x),
                two * (x * z - w * y),
                two * (y * z + w * x),
                T::ONE - two * (x * x + y * y),
            )
        };
        let r0 = axes(&self.delta);
        self.delta = self.delta.then(&self.rule.step(sample, step));
        let r1 = axes(&self.delta);
        let one = Matrix3::<T>::identity();
        let rate = (self.before.angular_rate() + sample.angular_rate()) * half;
        let (w, f0, f1) =
            (skew(rate), skew(self.before.specific_force()), skew(sample.specific_force()));
        self.before = *sample;
        let turned = one - w * dt;
        let v_theta = (r0 * f0 + r1 * f1 * turned) * (-half * dt);
        let v_accel = (r0 + r1) * (-half * dt);
        let v_gyro = r1 * f1 * (half * dt * dt);
        let mut f = SMatrix::<T, 15, 15>::identity();
        let mut set = |row: usize, column: usize, block: Matrix3<T>| {
            f.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&block);
        };
        set(0, 0, turned);
        set(0, 4, one * -dt);
        set(1, 0, v_theta * (half * dt));
        set(1, 2, one * dt);
        set(1, 3, v_accel * (half * dt));
        set(1, 4, v_gyro * (half * dt));
        set(2, 0, v_theta);
        set(2, 3, v_accel);
        set(2, 4, v_gyro);
        let mut v = SMatrix::<T, 15, 18>::zeros();
        let mut set = |row: usize, column: usize, block: Matrix3<T>| {
            v.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&block);
        };
        let by_turn = r1 * f1 * (-quarter * dt * dt);
        for (gyro, accel, axes) in [(0, 1, r0), (2, 3, r1)] {
            set(0, gyro, one * (half * dt));
            set(1, gyro, by_turn * (half * dt));
            set(2, gyro, by_turn);
            set(1, accel, axes * (quarter * dt * dt));
            set(2, accel, axes * (half * dt));
        }
        set(3, 5, one);
        set(4, 4, one);
        self.jacobian = f * self.jacobian;
        self.covariance = f * self.covariance * f.transpose() + v * self.noise * v.transpose();
    }
}

fn steps<T: Real + Field>(c: &mut Criterion, scalar: &str) {
    let samples = samples::<T>();
    let dt = Step::from_nanoseconds(5_000_000).expect("a step");
    let none = Bias::default();
    let rule = Midpoint::new(&samples[0]);
    let whole = WithCovariance::new(rule, none, &densities()).expect("valid");
    let mut group = c.benchmark_group(format!("preintegrate_{scalar}"));
    group.throughput(Throughput::Elements(STEPS.into()));
    macro_rules! time {
        ($name:literal, $new:expr, $($read:ident),+) => {
            group.bench_function($name, |b| {
                b.iter(|| {
                    let mut it = $new;
                    for sample in black_box(&samples[1..]) {
                        it.step(sample, &dt);
                    }
                    black_box(($(it.$read(),)+))
                });
            });
        };
    }
    time!("mean", Mean::new(rule, none), delta);
    time!("with_jacobian", WithJacobian::new(rule, none), delta, jacobian);
    time!("with_covariance", whole, delta, jacobian, covariance);
    group.bench_function("baseline_dense", |b| {
        b.iter(|| {
            let mut it = Dense::new(&samples[0], dt.seconds());
            for sample in black_box(&samples[1..]) {
                it.step(sample, &dt);
            }
            black_box((it.delta, it.jacobian, it.covariance))
        });
    });
    group.finish();
}

fn f32_and_f64(c: &mut Criterion) {
    steps::<f32>(c, "f32");
    steps::<f64>(c, "f64");
}

criterion_group!(benches, f32_and_f64);
criterion_main!(benches);
