//! What an IMU's message is behind its header, in ROS 1 and in ROS 2: 37 doubles.
//!
//! Orientation x y z w, its covariance 3×3, angular velocity x y z, covariance, linear acceleration
//! x y z, covariance. A first covariance element of −1 says that the quantity is not given.

/// Bytes of it.
pub const LEN: usize = 37 * 8;

/// Offsets in it.
const ORIENTATION_W: usize = 24;
const ORIENTATION_COVARIANCE: usize = 32;
const RATE: usize = 104;
const RATE_COVARIANCE: usize = 128;
const FORCE: usize = 200;
const FORCE_COVARIANCE: usize = 224;

/// Angular rate and specific force, where given; `double` reads the one at an offset.
#[inline]
pub fn read(double: impl Fn(usize) -> f64) -> (Option<[f64; 3]>, Option<[f64; 3]>) {
    let given = |value: usize, covariance: usize| {
        let given = double(covariance) != -1.0;
        given.then(|| [double(value), double(value + 8), double(value + 16)])
    };
    (given(RATE, RATE_COVARIANCE), given(FORCE, FORCE_COVARIANCE))
}

/// Appends one without orientation, little-endian.
pub fn push(to: &mut Vec<u8>) {
    let mut body = [0; LEN];
    put(&mut body, ORIENTATION_W, 1.0);
    put(&mut body, ORIENTATION_COVARIANCE, -1.0);
    to.extend_from_slice(&body);
}

/// Puts angular rate and specific force into one, little-endian.
pub fn write(body: &mut [u8; LEN], rate: Option<[f64; 3]>, force: Option<[f64; 3]>) {
    put_sensor(body, rate, RATE, RATE_COVARIANCE);
    put_sensor(body, force, FORCE, FORCE_COVARIANCE);
}

fn put_sensor(body: &mut [u8; LEN], value: Option<[f64; 3]>, at: usize, covariance: usize) {
    let given = value.is_some();
    for (axis, v) in value.unwrap_or_default().into_iter().enumerate() {
        put(body, at + 8 * axis, v);
    }
    put(body, covariance, if given { 0.0 } else { -1.0 });
}

fn put(body: &mut [u8; LEN], offset: usize, value: f64) {
    if let Some(bytes) = body.get_mut(offset..offset + 8) {
        bytes.copy_from_slice(&value.to_le_bytes());
    }
}
