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

    /// What a fit makes of it: noise of this size is fitted in the place of `poses`, of which those of `held` that are
    /// no bridge are. None where it decides no curve.
    pub(super) fn on(
        self,
        solver: &LeastSquares,
        poses: &[TimedPose],
        held: &[TimedPose],
        knots: &Knots<f64>,
    ) -> Option<JitterOfCurve> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut given = poses.iter().peekable();
        let noise: Vec<_> = held
            .iter()
            .map(|pose| match given.next_if(|given| given.stamp_ns == pose.stamp_ns) {
                Some(_) => Vector3::from([(); 3].map(|()| f64::standard_normal(&mut rng))),
                None => Vector3::zeros(),
            })
            .collect();
        let control = solver.vectors(&noise)?;
        let (mut acceleration, mut velocity, mut count) = (0.0, 0.0, 0.0);
        let ends = if control.len() > 10 * AT_ENDS { AT_ENDS } else { 0 };
        for four in control[ends..control.len() - ends].windows(4) {
            let [a, b, c, d] = [four[0], four[1], four[2], four[3]];
            for axis in 0..3 {
                let [a, b, c, d] = [a[axis], b[axis], c[axis], d[axis]];
                // Of an interval: acceleration is a straight line, velocity a parabola.
                let (begin, end) = (a - 2.0 * b + c, b - 2.0 * c + d);
                acceleration += (begin * begin + begin * end + end * end) / 3.0;
                let (begin, middle, end) =
                    ((c - a) / 2.0, (d - a + 5.0 * (c - b)) / 8.0, (d - b) / 2.0);
                velocity += mean_square_of_parabola(begin, middle, end);
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

/// The mean of p² over an interval, of a parabola p with these values at its beginning, middle and end.
fn mean_square_of_parabola(b: f64, m: f64, e: f64) -> f64 {
    (2.0 * (b * b + e * e + b * m + m * e) + 8.0 * m * m - b * e) / 15.0
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

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫p² of p = 1, u, u² and 1 − 4u + 4u²: 1, 1/3, 1/5 and 1/5; sums of a few roundings.
    #[test]
    fn the_square_of_a_parabola_is_a_quartic() {
        for ([b, m, e], wanted) in [
            ([1.0, 1.0, 1.0], 1.0),
            ([0.0, 0.5, 1.0], 1.0 / 3.0),
            ([0.0, 0.25, 1.0], 0.2),
            ([1.0, 0.0, 1.0], 0.2),
        ] {
            assert!((mean_square_of_parabola(b, m, e) - wanted).abs() < 1e-15);
        }
    }
}
