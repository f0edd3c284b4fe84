//! g-sensitivity: a gyroscope that also reads acceleration.
//!
//! The proof mass of a vibrating gyroscope sags under specific force, and the reading gains G·f, with
//! G in rad/s per m/s² (data sheets: °/s/g; 0.1 °/s/g = 1.78·10⁻⁴ rad/s per m/s²), the diagonal and
//! what crosses over (Groves (2013), section 4.4.2; IEEE Std 1431).
//!
//! ```
//! use imu_core::sensor::{ForceCoupling, GSensitivity};
//! let coupling = GSensitivity { matrix: [[1e-4, 0.0, 0.0], [0.0, 1e-4, 0.0], [0.0, 0.0, 2e-4]] };
//! assert_eq!(coupling.couple([0.5, 0.0, 0.0], [0.0, 0.0, 10.0]), [0.5, 0.0, 2e-3]);
//! ```

use super::{finite_matrix, product, sum};
use crate::{Error, Real};

/// What specific force adds to a rate: [`GSensitivity`], or `()` for nothing.
pub trait ForceCoupling<T>: Copy {
    /// Refuses what is not finite.
    ///
    /// # Errors
    /// [`Error::NonFinite`], naming `g_sensitivity`.
    fn check(&self) -> Result<(), Error>;

    /// The reading `rate` under `specific_force`.
    fn couple(&self, rate: [T; 3], specific_force: [T; 3]) -> [T; 3];
}

/// Linear g-sensitivity of a gyroscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GSensitivity<T> {
    /// G, row by row: what one axis reads of the specific force along body x, y, z, rad/s per m/s².
    pub matrix: [[T; 3]; 3],
}

impl<T: Real> ForceCoupling<T> for GSensitivity<T> {
    fn check(&self) -> Result<(), Error> {
        finite_matrix("g_sensitivity", &self.matrix)
    }

    #[inline(always)]
    fn couple(&self, rate: [T; 3], specific_force: [T; 3]) -> [T; 3] {
        sum(rate, product(&self.matrix, specific_force))
    }
}

impl<T: Real> ForceCoupling<T> for () {
    fn check(&self) -> Result<(), Error> {
        Ok(())
    }

    #[inline(always)]
    fn couple(&self, rate: [T; 3], _: [T; 3]) -> [T; 3] {
        rate
    }
}
