//! Scale factors and misalignment: what each axis of the sensor is really sensitive to.
//!
//! The reading is M times the true vector, M = (1 + S)·A: the rows of A are the sensor's true axes
//! in body axes (1 on the diagonal, small angles in radians beside it: non-orthogonality and
//! mounting), S holds the relative errors of scale (ppm·10⁻⁶, or %·10⁻²) (Groves (2013), section
//! 4.4.2; IEEE Std 528).
//!
//! ```
//! use imu_core::sensor::{AxisMap, ScaleMisalignment};
//! // x reads 1 % too much; y leans 2 mrad towards z.
//! let angles = [[0.0, 0.0], [0.0, 0.001_953_125], [0.0, 0.0]];
//! let map = ScaleMisalignment::new([0.01, 0.0, 0.0], angles);
//! assert_eq!(map.read([1.0, 0.0, 8.0]), [1.01, 0.015_625, 8.0]);
//! ```

use super::{finite_matrix, product};
use crate::{Error, Real};

/// How a sensor's axes read a vector: [`ScaleMisalignment`], or `()` for perfect axes.
pub trait AxisMap<T>: Copy {
    /// Refuses what is not finite.
    ///
    /// # Errors
    /// [`Error::NonFinite`], naming `scale_misalignment`.
    fn check(&self) -> Result<(), Error>;

    /// What the axes read of `truth`.
    fn read(&self, truth: [T; 3]) -> [T; 3];
}

/// Scale factors and misalignment as one matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleMisalignment<T> {
    /// M, row by row: a row is what one axis of the sensor reads of body x, y, z.
    pub matrix: [[T; 3]; 3],
}

impl<T: Real> ScaleMisalignment<T> {
    /// From relative errors of scale of x, y, z, and small angles in radians: of x towards (y, z),
    /// of y towards (x, z), of z towards (x, y).
    #[must_use]
    pub fn new(scale: [T; 3], [[xy, xz], [yx, yz], [zx, zy]]: [[T; 2]; 3]) -> Self {
        let [sx, sy, sz] = scale.map(|error| T::ONE + error);
        Self { matrix: [[sx, sx * xy, sx * xz], [sy * yx, sy, sy * yz], [sz * zx, sz * zy, sz]] }
    }

    /// Relative errors of scale alone.
    #[must_use]
    pub fn scale(errors: [T; 3]) -> Self {
        Self::new(errors, [[T::ZERO; 2]; 3])
    }
}

impl<T: Real> AxisMap<T> for ScaleMisalignment<T> {
    fn check(&self) -> Result<(), Error> {
        finite_matrix("scale_misalignment", &self.matrix)
    }

    #[inline(always)]
    fn read(&self, truth: [T; 3]) -> [T; 3] {
        product(&self.matrix, truth)
    }
}

impl<T: Real> AxisMap<T> for () {
    fn check(&self) -> Result<(), Error> {
        Ok(())
    }

    #[inline(always)]
    fn read(&self, truth: [T; 3]) -> [T; 3] {
        truth
    }
}
