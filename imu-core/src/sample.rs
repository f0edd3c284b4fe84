//! What an IMU says: a [`Sample`] of rate and force at an instant, or an [`Increment`] gathered over an interval.
//!
//! Which of the two a sensor gives matters more than the rule that integrates it: the mean over an interval belongs to
//! the middle of it, a sample to its end, half an interval apart. So they are two types, and a rule takes one of them.
//! A gyroscope's register, filtered and sampled, is a [`Sample`]; Δθ and Δv of a tactical sensor, or the mean of many
//! fast samples, are an [`Increment`].
//!
//! Nothing that is not a number gets in: constructors refuse it, and whoever holds a value may integrate it.
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::sample::{Bias, Sample};
//! let bias = Bias::new(Vector3::new(0.01, 0.0, 0.0), Vector3::zeros())?; // rad/s, m/s²
//! let sample = Sample::new(Vector3::new(0.51, 0.0, 0.0), Vector3::new(0.0, 0.0, 9.81))?;
//! assert_eq!(sample.minus(&bias).angular_rate().x, 0.5);
//! assert!(Sample::new(Vector3::new(f32::NAN, 0.0, 0.0), Vector3::zeros()).is_err());
//! # Ok::<(), imu_core::Error>(())
//! ```

use crate::time::Step;
use crate::vector::within;
use crate::{Error, Real};
use nalgebra::Vector3;

/// The largest component, rad/s, m/s², rad or m/s: beyond any sensor, and small enough that a step of 4 s in `f32`
/// does not overflow.
const LIMIT: f64 = 1e6;

/// Angular rate and specific force at one instant, in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T: Real> {
    pub(crate) angular_rate: Vector3<T>,
    pub(crate) specific_force: Vector3<T>,
}

impl<T: Real> Sample<T> {
    /// A sample of a gyroscope in rad/s and an accelerometer in m/s².
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument, where a component is not a number, or beyond ±10⁶.
    #[inline]
    pub fn new(angular_rate: Vector3<T>, specific_force: Vector3<T>) -> Result<Self, Error> {
        check(&angular_rate, "angular_rate")?;
        check(&specific_force, "specific_force")?;
        Ok(Self { angular_rate, specific_force })
    }

    /// ω, rad/s.
    #[must_use]
    #[inline]
    pub fn angular_rate(&self) -> Vector3<T> {
        self.angular_rate
    }

    /// f, m/s².
    #[must_use]
    #[inline]
    pub fn specific_force(&self) -> Vector3<T> {
        self.specific_force
    }

    /// The sample less what the sensor reads too much.
    #[must_use]
    #[inline]
    pub fn minus(&self, bias: &Bias<T>) -> Self {
        Self {
            angular_rate: self.angular_rate - bias.angular_rate,
            specific_force: self.specific_force - bias.specific_force,
        }
    }
}

/// Integrals of angular rate and specific force over one interval, both in body axes as they turn: Δθ and Δv.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment<T: Real> {
    pub(crate) angle: Vector3<T>,
    pub(crate) velocity: Vector3<T>,
}

impl<T: Real> Increment<T> {
    /// ∫ω dt in rad and ∫f dt in m/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument, where a component is not a number, or beyond ±10⁶.
    #[inline]
    pub fn new(angle: Vector3<T>, velocity: Vector3<T>) -> Result<Self, Error> {
        check(&angle, "angle")?;
        check(&velocity, "velocity")?;
        Ok(Self { angle, velocity })
    }

    /// From means over the interval that ends now, in rad/s and m/s².
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument, where a component is not a number, or beyond ±10⁶.
    #[inline]
    pub fn from_means(
        angular_rate: Vector3<T>,
        specific_force: Vector3<T>,
        dt: &Step<T>,
    ) -> Result<Self, Error> {
        let mean = Sample::new(angular_rate, specific_force)?;
        let dt = dt.seconds();
        Ok(Self { angle: mean.angular_rate * dt, velocity: mean.specific_force * dt })
    }

    /// ∫ω dt, rad.
    #[must_use]
    #[inline]
    pub fn angle(&self) -> Vector3<T> {
        self.angle
    }

    /// ∫f dt, m/s.
    #[must_use]
    #[inline]
    pub fn velocity(&self) -> Vector3<T> {
        self.velocity
    }

    /// The increment less what the sensor gathered too much over `dt`.
    #[must_use]
    #[inline]
    pub fn minus(&self, bias: &Bias<T>, dt: &Step<T>) -> Self {
        Self {
            angle: self.angle - bias.angular_rate * dt.seconds(),
            velocity: self.velocity - bias.specific_force * dt.seconds(),
        }
    }
}

/// What a sensor reads at rest beyond the truth, in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias<T: Real> {
    pub(crate) angular_rate: Vector3<T>,
    pub(crate) specific_force: Vector3<T>,
}

impl<T: Real> Bias<T> {
    /// Biases of the gyroscope, b_g in rad/s, and of the accelerometer, b_a in m/s².
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument, where a component is not a number, or beyond ±10⁶.
    pub fn new(angular_rate: Vector3<T>, specific_force: Vector3<T>) -> Result<Self, Error> {
        Sample::new(angular_rate, specific_force)
            .map(|Sample { angular_rate, specific_force }| Self { angular_rate, specific_force })
    }

    /// b_g, rad/s.
    #[must_use]
    pub fn angular_rate(&self) -> Vector3<T> {
        self.angular_rate
    }

    /// b_a, m/s².
    #[must_use]
    pub fn specific_force(&self) -> Vector3<T> {
        self.specific_force
    }

    /// By how much this bias is larger than another.
    #[inline]
    pub(crate) fn less(&self, other: &Self) -> Self {
        Self {
            angular_rate: self.angular_rate - other.angular_rate,
            specific_force: self.specific_force - other.specific_force,
        }
    }
}

impl<T: Real> Default for Bias<T> {
    /// None.
    fn default() -> Self {
        let zero = Vector3::from([T::ZERO; 3]);
        Self { angular_rate: zero, specific_force: zero }
    }
}

#[inline(always)]
fn check<T: Real>(v: &Vector3<T>, what: &'static str) -> Result<(), Error> {
    if within(v, T::from_f64(LIMIT)) { Ok(()) } else { Err(Error::OutOfRange(what)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_refused_by_name() {
        let fine = Vector3::new(1e6_f32, -1e6, 1e-45);
        assert!(Sample::new(fine, fine).is_ok() && Increment::new(fine, fine).is_ok());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e6] {
            for axis in 0..3 {
                let mut v = fine;
                v[axis] = bad;
                let step = Step::from_nanoseconds(1).unwrap();
                assert_eq!(Sample::new(v, fine), Err(Error::OutOfRange("angular_rate")));
                assert_eq!(Sample::new(fine, v), Err(Error::OutOfRange("specific_force")));
                assert_eq!(Increment::new(v, fine), Err(Error::OutOfRange("angle")));
                assert_eq!(Increment::new(fine, v), Err(Error::OutOfRange("velocity")));
                assert_eq!(
                    Increment::from_means(v, fine, &step),
                    Err(Error::OutOfRange("angular_rate"))
                );
                assert_eq!(Bias::new(fine, v), Err(Error::OutOfRange("specific_force")));
            }
        }
    }

    #[test]
    fn a_bias_gathers_over_the_step() {
        let (rate, force) = (Vector3::new(0.5, 0.25, 1.0), Vector3::new(0.0, 2.0, 8.0));
        let (bias, dt) =
            (Bias::new(rate, force).unwrap(), Step::from_nanoseconds(500_000_000).unwrap());
        let gathered =
            Increment::from_means(rate * 3.0, force * 3.0, &dt).unwrap().minus(&bias, &dt);
        assert_eq!((gathered.angle(), gathered.velocity()), (rate, force));
        let left = Sample::new(rate, force).unwrap().minus(&bias);
        assert_eq!(
            (left.angular_rate(), left.specific_force()),
            (Vector3::zeros(), Vector3::zeros())
        );
        assert_eq!(left.minus(&Bias::default()), left);
    }
}
