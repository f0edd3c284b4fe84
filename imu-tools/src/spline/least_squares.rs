//! Least squares: the curve that comes nearest to poses at any instants, and, if asked, no less smooth than wanted.
//!
//! With plain cubic weights N, poses (t, p) and control points c the cost of positions is
//! Σ|Σⱼ Nⱼ(t)cⱼ − p|² + (τ⁶/Δt) ∫|p⃛|² dt: a smoothing spline of third order (Reinsch (1967), "Smoothing by spline
//! functions"), which passes half of what moves with 1/(2πτ) Hz, and of what moves twice as fast a 65th. Δt is the mean
//! time between poses. The integral is Σ|Δ³c|²/h⁵ exactly, so the matrix has seven diagonals. Attitudes are of the same
//! matrix, in sweeps: what the curve lacks at every pose, log(RSᵀ), is solved for, and the control points turn by it. All
//! turns are in the world's axes: in each body's own, sweeps diverge where neighbours are a radian apart.
//!
//! The smoothing is never quite nothing: where no pose decides a control point (in a hole), the smoothest way across
//! is taken, if it is a short one (`bridge`).

use imu_core::nalgebra::Vector3;
use imu_core::se3::Pose;
use imu_core::spline::{Form, Knots, So3Curve};
use imu_core::{Error, so3};

use super::TimedPose;
use super::banded::{Banded, Factor};

/// Of the largest entry of the matrix, what smoothing there is at least.
const LEAST_SMOOTHING: f64 = 1e-10;
/// Sweeps, at most.
const MOST_SWEEPS: usize = 50;
/// They end when they turn by less than this, rad; …
const SETTLED: f64 = 1e-13;
/// … and have not settled where the last one turns by more than this.
const UNSETTLED: f64 = 1e-6;
/// Positions are decided if the last correction is at most this part of them.
const DECIDED: f64 = 1e-9;

/// One matrix for positions, attitudes, and what noise becomes.
pub(super) struct LeastSquares {
    rows: Vec<Row>,
    factor: Factor,
    smoothing: f64,
    count: usize,
}

/// What the control points weigh at one pose.
struct Row {
    first: usize,
    weights: [f64; 4],
}

impl LeastSquares {
    /// For poses at these instants, all within the span of the knots; τ in seconds. `None` where the matrix cannot be
    /// factored.
    pub(super) fn new(poses: &[TimedPose], knots: &Knots<f64>, smoothing_s: f64) -> Option<Self> {
        let rows: Vec<Row> = poses.iter().map(|pose| Row::at(pose.stamp_ns, knots)).collect();
        let count = knots.count();
        let (first, last) = (poses.first()?.stamp_ns, poses.last()?.stamp_ns);
        let between_s = (last - first) as f64 / 1e9 / (poses.len() as f64 - 1.0);
        let smoothing = (smoothing_s.powi(6) / between_s * knots.rate().powi(5))
            .max(LEAST_SMOOTHING / (between_s * knots.rate()).min(1.0));
        let mut matrix = Banded::zero(count);
        for row in &rows {
            matrix.add(row.first, &row.weights, 1.0);
        }
        for first in 0..count.saturating_sub(3) {
            matrix.add(first, &[-1.0, 3.0, -3.0, 1.0], smoothing);
        }
        Some(Self { rows, factor: matrix.factor()?, smoothing, count })
    }

    /// Control points of values at the poses; `None` where so much is smoothed that digits do not suffice.
    ///
    /// What they lack is solved for once more until it does not shrink: the residuals are those of the values
    /// themselves, so the square of the condition number does not tell (Björck (1987), "Stability analysis of the method
    /// of seminormal equations").
    pub(super) fn vectors(&self, values: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let mut control = vec![Vector3::zeros(); self.count];
        let mut before = f64::INFINITY;
        for _ in 0..MOST_SWEEPS {
            let lack = self.rows.iter().zip(values).map(|(row, value)| {
                let acting = control[row.first..].iter().zip(row.weights);
                acting.fold(*value, |lack, (point, weight)| lack - point * weight)
            });
            let mut more = self.gathered(lack);
            let steps: Vec<_> = control.windows(2).map(|two| two[1] - two[0]).collect();
            self.smooth(&steps, &mut more);
            self.factor.solve(&mut more);
            let largest = more.iter().fold(0.0_f64, |largest, v| largest.max(v.abs().max()));
            // Down to rounding, which does not fall any more.
            if largest >= 0.5 * before {
                break;
            }
            before = largest;
            for (point, more) in control.iter_mut().zip(&more) {
                *point += more;
            }
        }
        let scale = control.iter().fold(0.0_f64, |largest, v| largest.max(v.abs().max()));
        (before <= DECIDED * scale).then_some(control)
    }

    fn gathered(&self, values: impl Iterator<Item = Vector3<f64>>) -> Vec<Vector3<f64>> {
        let mut sums = vec![Vector3::zeros(); self.count];
        for (row, value) in self.rows.iter().zip(values) {
            for (sum, weight) in sums[row.first..].iter_mut().zip(row.weights) {
                *sum += value * weight;
            }
        }
        sums
    }

    /// Turns control points of given attitudes towards those of the poses, by sweeps; whether they have settled.
    ///
    /// # Errors
    /// As of [`So3Curve::from_control_points`]: where control points would be half a turn apart.
    pub(super) fn attitudes<F: Form<f64>>(
        &self,
        poses: &[TimedPose],
        knots: &Knots<f64>,
        control: &mut [Pose<f64>],
    ) -> Result<bool, Error> {
        let mut largest = f64::INFINITY;
        for _ in 0..MOST_SWEEPS {
            let curve = So3Curve::<_, _, F>::from_control_points(
                knots.start_ns(),
                knots.step_ns(),
                &*control,
            )?;
            let lack = poses
                .iter()
                .map(|TimedPose { stamp_ns, pose }| {
                    let there = curve.attitude(*stamp_ns)?;
                    Ok(so3::log(&so3::product(&pose.rotation(), &so3::inverse(&there))))
                })
                .collect::<Result<Vec<_>, Error>>()?;
            let mut turns = self.gathered(lack.into_iter());
            self.roughness(control, &mut turns);
            self.factor.solve(&mut turns);
            largest = 0.0;
            for (point, turn) in control.iter_mut().zip(&turns) {
                largest = largest.max(turn.abs().max());
                let turned = so3::product(&so3::exp(*turn), &point.rotation());
                *point = Pose::new(turned, point.translation())?;
            }
            if largest < SETTLED {
                break;
            }
        }
        // The last turn may have taken neighbours apart.
        So3Curve::<f64, _, F>::from_control_points(knots.start_ns(), knots.step_ns(), &*control)
            .map(|_| largest < UNSETTLED)
    }

    /// Takes the slope of the smoothing's cost off the right-hand side: Δ³ of attitudes.
    fn roughness(&self, control: &[Pose<f64>], sums: &mut [Vector3<f64>]) {
        let steps: Vec<_> = control
            .windows(2)
            .map(|two| {
                so3::log(&so3::product(&two[1].rotation(), &so3::inverse(&two[0].rotation())))
            })
            .collect();
        self.smooth(&steps, sums);
    }

    /// The same of anything whose steps from one control point to the next are these.
    fn smooth(&self, steps: &[Vector3<f64>], sums: &mut [Vector3<f64>]) {
        for (first, three) in steps.windows(3).enumerate() {
            let third = (three[0] - three[1] * 2.0 + three[2]) * self.smoothing;
            for (sum, weight) in sums[first..].iter_mut().zip([-1.0, 3.0, -3.0, 1.0]) {
                *sum -= third * weight;
            }
        }
    }
}

impl Row {
    /// The plain weights of a cubic B-spline: differences of the cumulative ones.
    fn at(stamp_ns: i64, knots: &Knots<f64>) -> Self {
        let step = i128::from(knots.step_ns());
        let elapsed = i128::from(stamp_ns) - i128::from(knots.start_ns());
        // The last instant belongs to the interval before it.
        let interval = (elapsed / step).clamp(1, knots.count() as i128 - 3);
        let u = (elapsed - interval * step) as f64 / step as f64;
        let v = 1.0 - u;
        let weights = [
            v * v * v / 6.0,
            2.0 / 3.0 - u * u * (1.0 - 0.5 * u),
            2.0 / 3.0 - v * v * (1.0 - 0.5 * v),
            u * u * u / 6.0,
        ];
        Self { first: interval as usize - 1, weights }
    }
}
