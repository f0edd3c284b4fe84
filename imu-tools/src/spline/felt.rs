//! What an IMU along a curve would feel, in a few numbers that show poses that cannot be right.

/// More than sensors of the largest usual ranges can read: 16 g and 2000 °/s.
const MOST_FORCE: f64 = 157.0;
const MOST_RATE: f64 = 35.0;

/// Of a whole route, at the point whose poses it goes through.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeltAlong {
    /// What an accelerometer reads on average, body axes, m/s².
    pub mean_specific_force: [f64; 3],
    /// The largest specific force, m/s², and its instant, ns.
    pub largest_force: (f64, i64),
    /// The largest angular rate, rad/s, and its instant, ns.
    pub largest_rate: (f64, i64),
}

impl FeltAlong {
    /// What to tell of a route, begun at `begin_ns`, along which no IMU can be.
    pub(super) fn suspicion(&self, begin_ns: i64) -> Option<String> {
        let after = |t_ns: i64| t_ns.abs_diff(begin_ns) as f64 / 1e9;
        let ((force, force_ns), (rate, rate_ns)) = (self.largest_force, self.largest_rate);
        if force > MOST_FORCE {
            let g = force / imu_core::trajectory::GRAVITY;
            Some(format!(
                "an accelerometer along the curve would read up to {g:.0} g, {:.3} s after the start: do poses jump \
                 there, or jitter?",
                after(force_ns)
            ))
        } else if rate > MOST_RATE {
            Some(format!(
                "a gyroscope along the curve would read up to {:.0} °/s, {:.3} s after the start: do poses jump there, \
                 or jitter?",
                rate.to_degrees(),
                after(rate_ns)
            ))
        } else {
            None
        }
    }
}
