//! Fits of curves to 3000 poses: interpolation, and least squares with a knot for every five poses; beside positions
//! alone by elimination with pivoting in a band matrix, as any numerical library has it.
//!
//! `cargo bench -p imu-benches --bench fit`: criterion's times are of all poses, and its throughput of one. Fits count all
//! that `imu spline fit` works out: sweeps of attitudes, the distance of every pose, what their jitter does.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_core::nalgebra::Vector3;
use imu_core::se3::Pose;
use imu_core::spline::{Form, OneSided, TimeSymmetric, interpolate};
use imu_core::trajectory::{Ellipse, Motion, Trajectory};
use imu_tools::spline::{FormName, Options, Spacing, TimedPose, fit};
use std::hint::black_box;

type V3 = Vector3<f64>;

const COUNT: usize = 3000;
/// A pose every 10 ms; knots of least squares every five.
const STEP_NS: u32 = 10_000_000;
const TO_A_KNOT: usize = 5;

fn poses() -> Vec<TimedPose> {
    (0..COUNT as i64)
        .map(|k| {
            let stamp_ns = k * i64::from(STEP_NS);
            let Motion { attitude_wb, position_w, .. } = Ellipse::default().at(stamp_ns);
            TimedPose { stamp_ns, pose: Pose::new(attitude_wb, position_w).expect("a pose") }
        })
        .collect()
}

/// A square matrix of which only entries within `reach` columns of the diagonal are not nothing.
struct Band {
    reach: usize,
    /// Entry (row, column) is at `[row][reach + column − row]`; pivoting fills as many more to the right.
    rows: Vec<Vec<f64>>,
}

impl Band {
    fn zero(size: usize, reach: usize) -> Self {
        Self { reach, rows: vec![vec![0.0; 3 * reach + 1]; size] }
    }

    fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.rows[row][self.reach + column - row]
    }

    /// Gauss's elimination with partial pivoting.
    fn solve(mut self, values: &mut [V3]) {
        let size = self.rows.len();
        let right = |row: usize| (row + 2 * self.reach + 1).min(size);
        let below = |row: usize| (row + self.reach + 1).min(size);
        let ends: Vec<_> = (0..size).map(|row| (below(row), right(row))).collect();
        for (k, &(below, right)) in ends.iter().enumerate() {
            let pivot = (k..below)
                .max_by(|&a, &b| self.entry(a, k).abs().total_cmp(&self.entry(b, k).abs()))
                .expect("a row");
            for column in k..right {
                let (a, b) = (*self.entry(k, column), *self.entry(pivot, column));
                (*self.entry(k, column), *self.entry(pivot, column)) = (b, a);
            }
            values.swap(k, pivot);
            for row in k + 1..below {
                let factor = *self.entry(row, k) / *self.entry(k, k);
                for column in k..right {
                    *self.entry(row, column) -= factor * *self.entry(k, column);
                }
                let above = values[k];
                values[row] -= above * factor;
            }
        }
        for (k, &(_, right)) in ends.iter().enumerate().rev() {
            let known: V3 = (k + 1..right).map(|c| values[c] * *self.entry(k, c)).sum();
            values[k] = (values[k] - known) / *self.entry(k, k);
        }
    }
}

/// (c₋ + 4c + c₊)/6 = p, and no fifth difference at either end.
fn interpolated_in_a_band(poses: &[TimedPose]) -> Vec<V3> {
    let size = poses.len() + 2;
    let mut band = Band::zero(size, 5);
    let mut values = vec![V3::zeros(); size];
    for (k, weight) in [-1.0, 5.0, -10.0, 10.0, -5.0, 1.0].into_iter().enumerate() {
        *band.entry(0, k) = weight;
        *band.entry(size - 1, size - 6 + k) = weight;
    }
    for (row, pose) in (1..).zip(poses) {
        for (column, weight) in (row - 1..).zip([1.0, 4.0, 1.0]) {
            *band.entry(row, column) = weight / 6.0;
        }
        values[row] = pose.pose.translation();
    }
    band.solve(&mut values);
    values
}

/// The normal equations of plain cubic weights.
fn least_squares_in_a_band(poses: &[TimedPose]) -> Vec<V3> {
    let size = (poses.len() - 1).div_ceil(TO_A_KNOT) + 3;
    let mut band = Band::zero(size, 3);
    let mut values = vec![V3::zeros(); size];
    for (k, pose) in poses.iter().enumerate() {
        let first = (k / TO_A_KNOT).min(size - 4);
        let u = (k - first * TO_A_KNOT) as f64 / TO_A_KNOT as f64;
        let v = 1.0 - u;
        let weights = [
            v * v * v / 6.0,
            2.0 / 3.0 - u * u * (1.0 - 0.5 * u),
            2.0 / 3.0 - v * v * (1.0 - 0.5 * v),
            u * u * u / 6.0,
        ];
        for (i, a) in weights.into_iter().enumerate() {
            for (j, b) in weights.into_iter().enumerate() {
                *band.entry(first + i, first + j) += a * b;
            }
            values[first + i] += pose.pose.translation() * a;
        }
    }
    band.solve(&mut values);
    values
}

/// Both baselines find the control points that the product does.
fn check(poses: &[TimedPose]) {
    let mut control = vec![Pose::identity(); poses.len() + 2];
    through::<OneSided>(poses, &mut control);
    let knots = Spacing::Every(STEP_NS * TO_A_KNOT as u32);
    let fitted =
        fit(poses, &Options { form: Some(FormName::Plain), spacing: knots, smoothing_s: 0.0 });
    let near = |control: &[Pose<f64>], band: &[V3], limit: f64| {
        assert_eq!(control.len(), band.len());
        for (point, values) in control.iter().zip(band) {
            assert!((point.translation() - values).abs().max() < limit);
        }
    };
    near(&control, &interpolated_in_a_band(poses), 1e-9);
    // The product smooths by 1e-10.
    near(&fitted.expect("a fit").control, &least_squares_in_a_band(poses), 1e-6);
}

fn through<F: Form<f64>>(poses: &[TimedPose], control: &mut [Pose<f64>]) {
    let poses: Vec<_> = poses.iter().map(|pose| pose.pose).collect();
    let mut scratch = vec![Vector3::zeros(); poses.len()];
    black_box(interpolate::<_, F>(&poses, control, &mut scratch).expect("a curve"));
}

fn fits(c: &mut Criterion) {
    let poses = poses();
    check(&poses);
    let level = |pose: &TimedPose| {
        let place = pose.pose.translation();
        TimedPose { pose: Pose::new(Pose::identity().rotation(), place).expect("a pose"), ..*pose }
    };
    let level: Vec<_> = poses.iter().map(level).collect();
    let mut control = vec![Pose::identity(); poses.len() + 2];
    let least_squares = |form| Options {
        form,
        spacing: Spacing::Every(STEP_NS * TO_A_KNOT as u32),
        smoothing_s: 0.0,
    };
    let mut group = c.benchmark_group("fit");
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("interpolation, positions in a band matrix", |b| {
        b.iter(|| interpolated_in_a_band(black_box(&poses)));
    });
    group.bench_function("interpolation, positions", |b| {
        b.iter(|| through::<OneSided>(black_box(&level), &mut control));
    });
    group.bench_function("interpolation, plain", |b| {
        b.iter(|| through::<OneSided>(black_box(&poses), &mut control));
    });
    group.bench_function("interpolation, symmetric", |b| {
        b.iter(|| through::<TimeSymmetric>(black_box(&poses), &mut control));
    });
    group.bench_function("least squares, positions in a band matrix", |b| {
        b.iter(|| least_squares_in_a_band(black_box(&poses)));
    });
    for (name, form) in [("plain", FormName::Plain), ("symmetric", FormName::Symmetric)] {
        group.bench_function(format!("least squares, {name}"), |b| {
            b.iter(|| fit(black_box(&poses), &least_squares(Some(form))).expect("a fit"));
        });
    }
    group.finish();
}

criterion_group!(benches, fits);
criterion_main!(benches);
