//! NumPy's arrays: `.npy`, one array, and `.npz`, a zip file of several.
//!
//! An array of shape (n, 7) is t, gyroscope x y z, accelerometer x y z; `--columns` says otherwise.
//! Fields of a structured array, and arrays in an `.npz`, are found by their names as a table's
//! columns are: `t`, `gyro` and `accel` with three columns each, for instance. What is stored column
//! by column (Fortran order) is read at several places at once, so it needs a file, not a pipe.
//! Format: NumPy enhancement proposal 1 (Kern 2007), versions 1 to 3.

mod archive;
mod arrays;
mod header;
mod literal;
mod reader;
mod scalar;

pub use reader::NumpyReader;

/// Whether a file begins as an array or an archive of arrays does.
pub(super) fn is_numpy(start: &[u8]) -> bool {
    start.starts_with(header::MAGIC) || is_archive(start)
}

/// Whether a file begins as a zip file does.
fn is_archive(start: &[u8]) -> bool {
    archive::MAGICS.iter().any(|magic| start.starts_with(magic))
}
