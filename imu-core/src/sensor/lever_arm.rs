//! Lever arm: the sensor sits beside the point whose motion is known, and feels the rotation.
//!
//! At r from that point, in body axes, on a rigid body the specific force is
//!
//! f + α × r + ω × (ω × r)
//!
//! (Groves (2013), Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems,
//! section 4.1.3; Euler's and the centripetal acceleration). Angular rate and acceleration are the
//! same all over the body.
//!
//! ```
//! use imu_core::sensor::{Kinematics, LeverArm, Placement};
//! let spin = Kinematics { angular_rate: [0.0, 0.0, 4.0], ..Kinematics::default() };
//! let felt = LeverArm { arm: [0.125, 0.0, 0.0] }.felt(&spin); // out along x: ω²r inwards
//! assert_eq!(felt.specific_force, [-2.0_f32, 0.0, 0.0]);
//! ```

use super::{Kinematics, cross, sum};
use crate::{Error, Real};

/// Where a sensor is: a [`LeverArm`], or `()` for the point that the motion describes.
pub trait Placement<T>: Copy {
    /// Refuses what is not finite.
    ///
    /// # Errors
    /// [`Error::NonFinite`], naming `arm`.
    fn check(&self) -> Result<(), Error>;

    /// What is felt there.
    fn felt(&self, motion: &Kinematics<T>) -> Kinematics<T>;
}

/// The place of a sensor on a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeverArm<T> {
    /// r, from the point that the motion describes to the sensor, in body axes, m.
    pub arm: [T; 3],
}

impl<T: Real> Placement<T> for LeverArm<T> {
    fn check(&self) -> Result<(), Error> {
        let finite = self.arm.iter().all(|x| x.is_finite());
        if finite { Ok(()) } else { Err(Error::NonFinite("arm")) }
    }

    #[inline(always)]
    fn felt(&self, motion: &Kinematics<T>) -> Kinematics<T> {
        let euler = cross(motion.angular_acceleration, self.arm);
        let centripetal = cross(motion.angular_rate, cross(motion.angular_rate, self.arm));
        let specific_force = sum(motion.specific_force, sum(euler, centripetal));
        Kinematics { specific_force, ..*motion }
    }
}

impl<T: Real> Placement<T> for () {
    fn check(&self) -> Result<(), Error> {
        Ok(())
    }

    #[inline(always)]
    fn felt(&self, motion: &Kinematics<T>) -> Kinematics<T> {
        *motion
    }
}
