//! What the world adds to what an IMU felt: gravity, and the turning of the Earth where it matters.
//!
//! An accelerometer does not feel gravity. A rule makes a gravity-free [`Delta`](crate::delta::Delta) of the samples; a
//! [`World`] makes it a motion in a world frame. [`Flat`] is gravity alone, and what hand-held and flying things need
//! for seconds. [`RotatingEarth`] is for sensors that see the Earth turn (15 °/h), and for minutes without another
//! reference: on a flat world a still sensor falls by 25 m within the first one.
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::world::{Flat, RotatingEarth};
//! let flat = Flat::new(Vector3::new(0.0, 0.0, -9.81))?; // z up
//! let zurich = RotatingEarth::new(47.38_f64.to_radians(), 408.0)?;
//! assert_eq!(flat.gravity().z, -9.81_f32);
//! let gravity: Vector3<f64> = zurich.gravity();
//! assert!((gravity.z + 9.8071).abs() < 1e-4);
//! # Ok::<(), imu_core::Error>(())
//! ```

use crate::vector::{cross, within};
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3};

/// Velocity and position gained in one step, in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain<T: Real> {
    /// m/s.
    pub velocity: Vector3<T>,
    /// m.
    pub position: Vector3<T>,
}

/// Where a body moves: what its velocity and position gain besides what its sensors felt.
///
/// Gains are differences, small beside the state they are added to, and are formed without cancellation: that is what
/// a [`Compensated`](crate::Compensated) state in single precision lives on.
pub trait World<T: Real> {
    /// All that is gained in `dt` seconds, by a body of this velocity (m/s) and position (m), whose sensors account
    /// for `felt`.
    fn gain(
        &self,
        velocity_w: &Vector3<T>,
        position_w: &Vector3<T>,
        felt: &Gain<T>,
        dt: T,
    ) -> Gain<T>;

    /// By how much the world frame turns under the body in `dt` seconds, if it does: the rotation from the frame
    /// before to the frame after.
    #[inline(always)]
    fn turn(&self, dt: T) -> Option<Quaternion<T>> {
        let _ = dt;
        None
    }
}

/// A frame that does not turn, under constant gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat<T: Real> {
    gravity: Vector3<T>,
}

impl<T: Real> Flat<T> {
    /// Under this gravity, in axes of the world frame, m/s²: (0, 0, −9.81) where z points up.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `gravity`, where a component is not a number, or beyond ±10⁶.
    pub fn new(gravity: Vector3<T>) -> Result<Self, Error> {
        let fine = within(&gravity, T::from_f64(1e6));
        if fine { Ok(Self { gravity }) } else { Err(Error::OutOfRange("gravity")) }
    }

    /// g, m/s².
    #[must_use]
    pub fn gravity(&self) -> Vector3<T> {
        self.gravity
    }
}

impl<T: Real> Default for Flat<T> {
    /// Standard gravity (9.80665 m/s²; CGPM, 1901), z up.
    fn default() -> Self {
        Self { gravity: Vector3::new(T::ZERO, T::ZERO, T::from_f64(-9.806_65)) }
    }
}

impl<T: Real> World<T> for Flat<T> {
    #[inline(always)]
    fn gain(&self, velocity_w: &Vector3<T>, _: &Vector3<T>, felt: &Gain<T>, dt: T) -> Gain<T> {
        let fall = self.gravity * dt;
        Gain {
            velocity: felt.velocity + fall,
            position: felt.position + (velocity_w + fall * T::from_f64(0.5)) * dt,
        }
    }
}

/// East, north and up at a place on the turning Earth, under the normal gravity of that place.
///
/// The gyroscope then reads ω + RᵀΩ, and the accelerometer Rᵀ(p̈ + 2Ω×ṗ + Ω×(Ω×p) − g): what a real one does. Earth
/// rate and the normal gravity on the ellipsoid are those of WGS 84 (NIMA TR8350.2 (2000), tables 3.1 to 3.4 and
/// equation 4-1), gravity at a height by its second-order series (the same, equation 4-3).
///
/// Axes and gravity are those of the origin. Gravity turns by 1.6e-7 rad with every metre away from it: this frame
/// serves a few kilometres, 1.6 mm/s² and more are wrong from 1 km on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotatingEarth<T: Real> {
    rate: Vector3<T>,
    gravity: Vector3<T>,
    /// Ω×g
    gravity_turn: Vector3<T>,
}

impl<T: Real> RotatingEarth<T> {
    /// Ω of WGS 84, rad/s.
    pub const RATE: f64 = 7.292_115e-5;

    /// At a geodetic latitude in rad, north positive, and a height above the ellipsoid in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `latitude` beyond ±π/2, `height` beyond ±100 km.
    pub fn new(latitude: f64, height: f64) -> Result<Self, Error> {
        let within = |x: f64, limit| Real::abs(x) <= limit;
        if !within(latitude, core::f64::consts::FRAC_PI_2) {
            return Err(Error::OutOfRange("latitude"));
        }
        if !within(height, 1e5) {
            return Err(Error::OutOfRange("height"));
        }
        let (sin, cos) = Real::sin_cos(latitude);
        let rate = [0.0, Self::RATE * cos, Self::RATE * sin];
        let g = normal_gravity(sin * sin, height);
        let single = |v: [f64; 3]| Vector3::from(v.map(T::from_f64));
        Ok(Self {
            rate: single(rate),
            gravity: single([0.0, 0.0, -g]),
            gravity_turn: single([-rate[1] * g, 0.0, 0.0]),
        })
    }

    /// g, east, north and up, m/s².
    #[must_use]
    pub fn gravity(&self) -> Vector3<T> {
        self.gravity
    }

    /// Ω, east, north and up, rad/s.
    #[must_use]
    pub fn rate(&self) -> Vector3<T> {
        self.rate
    }
}

/// Normal gravity of WGS 84 at a height in m above the ellipsoid, m/s².
fn normal_gravity(sin_squared: f64, height: f64) -> f64 {
    const EQUATORIAL_RADIUS: f64 = 6_378_137.0;
    const FLATTENING: f64 = 1.0 / 298.257_223_563;
    /// Ω²a²b/GM
    const CENTRIFUGAL: f64 = 0.003_449_786_506_84;
    let on_the_ellipsoid = 9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * sin_squared)
        / Real::sqrt(1.0 - 0.006_694_379_990_14 * sin_squared);
    let h = height / EQUATORIAL_RADIUS;
    let slope = 1.0 + FLATTENING + CENTRIFUGAL - 2.0 * FLATTENING * sin_squared;
    on_the_ellipsoid * (1.0 - 2.0 * slope * h + 3.0 * h * h)
}

impl<T: Real> World<T> for RotatingEarth<T> {
    /// In the frame that stands still while the step lasts, and back into the one that turned.
    #[inline]
    fn gain(
        &self,
        velocity_w: &Vector3<T>,
        position_w: &Vector3<T>,
        felt: &Gain<T>,
        dt: T,
    ) -> Gain<T> {
        let (half, sixth) = (T::from_f64(0.5) * dt, T::from_f64(1.0 / 6.0) * dt);
        let turn = self.turned(dt);
        let carried = cross(&self.rate, position_w);
        let still_velocity = velocity_w + carried;
        let still_fall = (self.gravity + self.gravity_turn * half) * dt;
        let still_gain = felt.position
            + (still_velocity + (self.gravity * T::from_f64(0.5) + self.gravity_turn * sixth) * dt)
                * dt;
        let position = still_gain + so3::displacement(&turn, &(position_w + still_gain));
        let velocity = felt.velocity + still_fall;
        let end = still_velocity + velocity;
        Gain {
            velocity: velocity + so3::displacement(&turn, &end) - cross(&self.rate, &position),
            position,
        }
    }

    #[inline]
    fn turn(&self, dt: T) -> Option<Quaternion<T>> {
        Some(self.turned(dt))
    }
}

impl<T: Real> RotatingEarth<T> {
    #[inline]
    fn turned(&self, dt: T) -> Quaternion<T> {
        so3::exp(self.rate * -dt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_that_of_wgs_84() {
        // NIMA TR8350.2, table 3.4: at the equator and at the pole; and -3.0877e-6 (1 - 0.0014 sin²) s⁻² h up from it.
        for (latitude, g, slope) in [
            (0.0, 9.780_325_335_9, -3.0877e-6),
            (core::f64::consts::FRAC_PI_2, 9.832_184_937_8, -3.0833e-6),
        ] {
            let up = |h| -RotatingEarth::<f64>::new(latitude, h).unwrap().gravity().z;
            assert!((up(0.0) - g).abs() < 1e-9);
            assert!(((up(1000.0) - up(0.0)) / 1000.0 - slope).abs() < 3e-9);
        }
    }

    #[test]
    fn places_that_do_not_exist_are_refused() {
        for latitude in [1.6, -1.6, f64::NAN, f64::INFINITY] {
            assert_eq!(
                RotatingEarth::<f32>::new(latitude, 0.0),
                Err(Error::OutOfRange("latitude"))
            );
        }
        for height in [1.1e5, -1.1e5, f64::NAN] {
            assert_eq!(RotatingEarth::<f32>::new(0.0, height), Err(Error::OutOfRange("height")));
        }
        assert!(Flat::new(Vector3::new(0.0, f32::NAN, 0.0)).is_err());
    }
}
