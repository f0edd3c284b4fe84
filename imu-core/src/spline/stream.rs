//! A spline that grows as poses come in: one window of it, no solve, no memory of what is past.
//!
//! Control points by the local quasi-interpolant c = p − (p₊ − 2p + p₋)/6, in position, and in the tangent space of
//! the middle attitude: order 4 in position, and in attitude with the time-symmetric form (3 with the one-sided one).
//! Source: Sablonnière (2005), "Recent progress on univariate and multivariate polynomial and spline
//! quasi-interpolants", section 2, for the cubic.
//!
//! With the pose of the instant t the curve is known from t − 3h to t − 2h.

use super::cached::Knot;
use super::control::are_neighbours;
use super::knots::Knots;
use super::split::{SplitSpline, SymmetricSplitSpline};
use crate::se3::{self, Pose};
use crate::{Error, Real, so3};

/// The control pose for the middle one of three poses at even distances in time.
///
/// A curve of such control poses goes through poses of a smooth motion but for h⁴/36 of its fourth derivative, and as
/// closely through attitudes. It hardly smooths: of independent jitter of the poses, 85 % comes out at the knots.
///
/// For curves of positions beside attitudes. An [`Se3Spline`](super::Se3Spline) of these is of order 2:
/// [`quasi_interpolant_on_screws`] is for that one.
///
/// # Errors
/// [`Error::OutOfRange`], naming `turn between neighbours`, where those are further apart than π − 10⁻³ rad.
pub fn quasi_interpolant<T: Real>(
    before: &Pose<T>,
    at: &Pose<T>,
    after: &Pose<T>,
) -> Result<Pose<T>, Error> {
    let (attitude, position) = (at.rotation(), at.translation());
    are_neighbours(&before.rotation(), &attitude)?;
    are_neighbours(&attitude, &after.rotation())?;
    let sixth = T::from_f64(-1.0 / 6.0);
    let to = |other: &Pose<T>| {
        so3::log_of_unit(&so3::product(&so3::inverse(&attitude), &other.rotation()))
    };
    let turn = so3::exp((to(after) + to(before)) * sixth);
    let bend = (after.translation() - position) - (position - before.translation());
    let rotation = so3::renormalised(&so3::product(&attitude, &turn));
    Ok(Pose::of_unit(rotation, position + bend * sixth))
}

/// The same for an [`Se3Spline`](super::Se3Spline), whose positions and attitudes bend together: in the tangent space of
/// the middle pose, by the logarithm of SE(3).
///
/// # Errors
/// As of [`quasi_interpolant`].
pub fn quasi_interpolant_on_screws<T: Real>(
    before: &Pose<T>,
    at: &Pose<T>,
    after: &Pose<T>,
) -> Result<Pose<T>, Error> {
    are_neighbours(&before.rotation(), &at.rotation())?;
    are_neighbours(&at.rotation(), &after.rotation())?;
    let back = at.inverse();
    let bend = se3::log(&back.then(after)) + se3::log(&back.then(before));
    let control = at.then(&se3::exp(&(bend * T::from_f64(-1.0 / 6.0))));
    Ok(Pose::of_unit(so3::renormalised(&control.rotation()), control.translation()))
}

/// Takes poses one by one, every `step_ns`, and holds the curve of the newest whole interval.
///
/// `S` is the scalar of the poses and `T` that of the curve: differences are formed in `S`.
///
/// ```
/// use imu_core::nalgebra::Vector3;
/// use imu_core::se3::{Pose, Twist, exp};
/// use imu_core::spline::Stream;
/// let mut stream = Stream::<f64, f32>::new(0, 10_000_000)?; // a pose every 10 ms
/// for k in 0..6 {
///     let turned = Twist { linear: Vector3::zeros(), angular: Vector3::new(0.0, 0.0, 0.02 * f64::from(k)) };
///     stream.push(&exp(&turned))?;
/// }
/// let curve = stream.time_symmetric().expect("six poses make an interval");
/// assert_eq!(curve.knots().span(), (20_000_000, 30_000_000));
/// assert!((curve.full(25_000_000)?.angular_rate.z - 2.0).abs() < 1e-5);
/// # Ok::<(), imu_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stream<S: Real, T: Real = S> {
    /// Of the window.
    knots: Knots<T>,
    window: [Knot<T>; 4],
    /// The newest control pose.
    control: Pose<S>,
    /// The newest two poses, the last one last.
    poses: [Pose<S>; 2],
    /// The instant of the next pose; none is representable after the end of time.
    next_ns: Option<i64>,
    /// How many poses have come, up to six.
    count: u8,
}

/// Poses that it takes to make four control points.
const WHOLE: u8 = 6;

impl<S: Real, T: Real> Stream<S, T> {
    /// The first pose will be of `start_ns`, and each later one of `step_ns` after.
    ///
    /// # Errors
    /// As of [`Knots::new`].
    pub fn new(start_ns: i64, step_ns: u32) -> Result<Self, Error> {
        Ok(Self {
            knots: Knots::new(start_ns, step_ns, 4)?,
            window: [Knot::default(); 4],
            control: Pose::identity(),
            poses: [Pose::identity(); 2],
            next_ns: Some(start_ns),
            count: 0,
        })
    }

    /// Forgets everything, and begins anew: after a hole in the poses, or a jump.
    pub fn restart(&mut self, start_ns: i64) {
        (self.next_ns, self.count) = (Some(start_ns), 0);
    }

    /// The instant of the pose that comes next, ns; `None` after the last representable one.
    #[must_use]
    pub fn next_ns(&self) -> Option<i64> {
        self.next_ns
    }

    /// Takes the next pose.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `turn between neighbours`, where it is turned further from the pose before, or its
    /// control pose from the one before, than π − 10⁻³ rad; naming `t_ns` after the end of time. The pose is not taken
    /// then.
    pub fn push(&mut self, pose: &Pose<S>) -> Result<(), Error> {
        let now = self.next_ns.ok_or(Error::OutOfRange("t_ns"))?;
        let [before, at] = self.poses;
        if self.count > 0 {
            are_neighbours(&at.rotation(), &pose.rotation())?;
        }
        if self.count > 1 {
            let control = quasi_interpolant(&before, &at, pose)?;
            if self.count > 2 {
                are_neighbours(&self.control.rotation(), &control.rotation())?;
            }
            let [_, first, second, _] = self.window;
            let newest = Knot::between(&control, &control);
            self.window = [first, second, Knot::between(&self.control, &control), newest];
            self.control = control;
        }
        let step = i64::from(self.knots.step_ns());
        // The newest control pose is one step back, the first of the window four.
        self.knots = self.knots.moved_to(now.saturating_sub(step.saturating_mul(4)));
        self.poses = [at, *pose];
        self.next_ns = now.checked_add(step);
        self.count = self.count.saturating_add(1).min(WHOLE);
        Ok(())
    }

    /// The curve of the newest whole interval, its attitude by the product from one end; from the sixth pose on.
    #[must_use]
    #[inline]
    pub fn one_sided(&self) -> Option<SplitSpline<'_, T, Knot<T>>> {
        (self.count == WHOLE).then(|| SplitSpline::of_checked(self.knots, &self.window))
    }

    /// The curve of the newest whole interval, its attitude of the time-symmetric form; from the sixth pose on.
    #[must_use]
    #[inline]
    pub fn time_symmetric(&self) -> Option<SymmetricSplitSpline<'_, T, Knot<T>>> {
        (self.count == WHOLE).then(|| SymmetricSplitSpline::of_checked(self.knots, &self.window))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nalgebra::{Quaternion, Vector3};

    fn pose(k: i32) -> Pose<f64> {
        let s = f64::from(k) * 0.05;
        let turn = so3::exp(Vector3::new(s.sin(), 0.3 * s, (2.0 * s).cos()));
        Pose::new(turn, Vector3::new(10.0 * s, s * s, 3.0)).unwrap()
    }

    /// Whatever comes in, the curve is that of all control points at once.
    #[test]
    fn it_is_the_whole_curve_a_window_at_a_time() {
        let controls: std::vec::Vec<_> = (1..30)
            .map(|k| quasi_interpolant(&pose(k - 1), &pose(k), &pose(k + 1)).unwrap())
            .collect();
        let whole = SplitSpline::from_control_points(1000 + 500, 500, &controls).unwrap();
        let mut stream = Stream::<f64>::new(1000, 500).unwrap();
        for k in 0..30 {
            assert_eq!(stream.next_ns(), Some(1000 + 500 * i64::from(k)));
            stream.push(&pose(k)).unwrap();
            let Some(curve) = stream.one_sided() else {
                assert!(k < 5);
                continue;
            };
            let (first, last) = curve.knots().span();
            assert_eq!(last, 1000 + 500 * (i64::from(k) - 2));
            for t in [first, first + 17, last] {
                assert_eq!(curve.full(t).is_ok(), whole.full(t).is_ok());
                let (here, there) = (curve.pose(t).unwrap(), whole.pose(t).unwrap());
                // A knot belongs to two intervals: the same but for rounding.
                assert!((here.translation() - there.translation()).abs().max() < 1e-14);
                assert!((here.rotation().coords - there.rotation().coords).abs().max() < 1e-15);
            }
        }
    }

    #[test]
    fn a_jump_is_refused_and_a_restart_mends_it() {
        let mut stream = Stream::<f64>::new(0, 1000).unwrap();
        for k in 0..10 {
            stream.push(&pose(k)).unwrap();
        }
        let before = stream;
        let half_turn = so3::product(&pose(9).rotation(), &Quaternion::new(0.0, 1.0, 0.0, 0.0));
        let jump = Pose::new(half_turn, Vector3::new(0.0, 0.0, 0.0)).unwrap();
        assert_eq!(stream.push(&jump), Err(Error::OutOfRange("turn between neighbours")));
        assert_eq!(stream, before);
        stream.restart(50_000);
        assert!(stream.one_sided().is_none());
        for k in 0..6 {
            stream.push(&pose(k)).unwrap();
        }
        assert_eq!(stream.time_symmetric().unwrap().knots().span(), (52_000, 53_000));
    }

    #[test]
    fn time_ends() {
        let mut stream = Stream::<f64>::new(i64::MAX - 3000, 1000).unwrap();
        for k in 0..4 {
            stream.push(&pose(k)).unwrap();
        }
        assert_eq!(stream.push(&pose(4)), Err(Error::OutOfRange("t_ns")));
        assert!(Stream::<f32>::new(0, 0).is_err());
    }
}
