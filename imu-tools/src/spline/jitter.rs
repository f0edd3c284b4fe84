//! How much poses jitter, and what a curve makes of that: a second derivative multiplies noise by 1/h².
//!
//! Jitter is what is left of neighbouring poses after any motion of fifth degree: the sixth divided difference of seven
//! of them, in units of its own standard deviation for white noise. The median of its size over the record makes it
//! blind to single jumps. What moves fast is counted as jitter, too: of a sinusoid of f Hz (2πfΔt)⁶/30 of its amplitude
//! at a step of Δt, 2 parts in a thousand of a tremor of 2 Hz at 20 poses a second.

use imu_core::nalgebra::Vector3;
use imu_core::noise::{Normal as _, Xoshiro256PlusPlus};
use imu_core::so3;
use imu_core::spline::Knots;
use rand_core::SeedableRng as _;

use super::TimedPose;
use super::least_squares::LeastSquares;

/// Poses of a difference.
const WINDOW: usize = 7;
/// At both ends a curve jitters more; so many intervals there are not counted where there are ten times as many.
const AT_ENDS: usize = 8;
/// The median size of a standard normal number.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_082;

/// White noise of poses, standard deviations of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jitter {
    /// m.
    pub position_m: f64,
    /// rad.
    pub rotation_rad: f64,
}

/// What jitter makes of a curve away from its ends, root mean squares of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JitterOfCurve {
    /// Of the poses.
    pub poses: Jitter,
    /// m/s².
    pub acceleration: f64,
    /// rad/s.
    pub angular_rate: f64,
}

impl Jitter {
    /// Of poses in the order of their stamps; `None` of fewer than seven.
    pub(super) fn of(poses: &[TimedPose]) -> Option<Self> {
        let (mut positions, mut rotations) = (Vec::new(), Vec::new());
        for window in poses.windows(WINDOW) {
            let weights = weights(window);
            let middle = so3::inverse(&window[WINDOW / 2].pose.rotation());
            let (mut position, mut rotation) = (Vector3::zeros(), Vector3::zeros());
            for (TimedPose { pose, .. }, weight) in window.iter().zip(weights) {
                // From the first one, so that a place far from home takes no digits.
                position += (pose.translation() - window[0].pose.translation()) * weight;
                rotation += so3::log(&so3::product(&middle, &pose.rotation())) * weight;
            }
            positions.extend(position.abs().iter());
            rotations.extend(rotation.abs().iter());
        }
        Some(Self { position_m: deviation(positions)?, rotation_rad: deviation(rotations)? })
    }

    /// What a fit makes of it: noise of this size is fitted in place of the poses. None where it decides no curve.
    pub(super) fn on(
        self,
        solver: &LeastSquares,
        poses: &[TimedPose],
        knots: &Knots<f64>,
    ) -> Option<JitterOfCurve> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let noise: Vec<_> = poses
            .iter()
            .map(|_| Vector3::from([(); 3].map(|()| f64::standard_normal(&mut rng))))
            .collect();
        let control = solver.vectors(&noise)?;
        let (mut acceleration, mut velocity, mut count) = (0.0, 0.0, 0.0);
        let ends = if control.len() > 10 * AT_ENDS { AT_ENDS } else { 0 };
        for four in control[ends..control.len() - ends].windows(4) {
            let [a, b, c, d] = [four[0], four[1], four[2], four[3]];
            for axis in 0..3 {
                let [a, b, c, d] = [a[axis], b[axis], c[axis], d[axis]];
                // Of an interval: acceleration is a straight line, velocity a parabola (Simpson's rule of its square).
                let (begin, end) = (a - 2.0 * b + c, b - 2.0 * c + d);
                acceleration += (begin * begin + begin * end + end * end) / 3.0;
                let (begin, middle, end) =
                    ((c - a) / 2.0, (d - a + 5.0 * (c - b)) / 8.0, (d - b) / 2.0);
                velocity += (begin * begin + 4.0 * middle * middle + end * end) / 6.0;
                count += 1.0;
            }
        }
        let rate = knots.rate();
        Some(JitterOfCurve {
            poses: self,
            acceleration: self.position_m * (acceleration / count).sqrt() * rate * rate,
            angular_rate: self.rotation_rad * (velocity / count).sqrt() * rate,
        })
    }
}

/// Of the sixth divided difference at these instants, for noise of deviation 1 in deviation 1.
fn weights(window: &[TimedPose]) -> [f64; WINDOW] {
    let begin = window.first().map_or(0, |pose| pose.stamp_ns);
    let span = window.last().map_or(1, |pose| pose.stamp_ns.abs_diff(begin)) as f64;
    let mut times = [0.0; WINDOW];
    for (time, pose) in times.iter_mut().zip(window) {
        *time = pose.stamp_ns.abs_diff(begin) as f64 / span;
    }
    let mut weights = [1.0; WINDOW];
    for (j, weight) in weights.iter_mut().enumerate() {
        for (i, time) in times.iter().enumerate() {
            if i != j {
                *weight /= times[j] - time;
            }
        }
    }
    let length = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
    weights.map(|weight| weight / length)
}

fn deviation(mut sizes: Vec<f64>) -> Option<f64> {
    let middle = sizes.len().checked_sub(1)? / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median / MEDIAN_OF_NORMAL)
}
