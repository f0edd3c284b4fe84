//! A flight that nobody flew, as a file of poses would have it.

use std::fmt::Write as _;

use imu_core::nalgebra::Vector3;
use imu_core::so3;

/// When it began, s after the epoch: EuRoC's first.
const BEGIN_S: f64 = 1_403_715_273.262_14;

/// Poses of TUM, 20 a second, of a smooth flight about a room: a dozen sines up to 0.9 Hz for each of six
/// coordinates. Stamps are those of a camera whose driver has them to 10 µs: 50 ms apart, but for that.
#[must_use]
pub fn tum(seconds: u32, seed: u64) -> String {
    let mut state = seed;
    // Steele, Lea & Flood (2014): SplitMix64.
    let mut random = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    };
    let waves: Vec<[(f64, f64, f64); 12]> = (0..6)
        .map(|_| {
            std::array::from_fn(|k| {
                let hertz = 0.05 + 0.07 * k as f64 + 0.03 * random();
                // Slower is larger: a metre of place, half a radian of attitude in all.
                (0.05 / hertz.max(0.1), std::f64::consts::TAU * hertz, 6.3 * random())
            })
        })
        .collect();
    let at = |coordinate: usize, t: f64| -> f64 {
        waves[coordinate].iter().map(|(size, rate, phase)| size * (rate * t + phase).sin()).sum()
    };
    let mut text = "# timestamp tx ty tz qx qy qz qw\n".to_owned();
    for k in 0..=20 * seconds {
        let t = 0.05 * f64::from(k) + 1e-5 * (random() - 0.5);
        let turn = Vector3::new(0.3 * at(3, t), 0.3 * at(4, t), at(5, t));
        let q = so3::exp(turn);
        writeln!(
            text,
            "{:.5} {:.6} {:.6} {:.6} {:.6} {:.6} {:.6} {:.6}",
            BEGIN_S + t,
            at(0, t),
            at(1, t),
            at(2, t),
            q.i,
            q.j,
            q.k,
            q.w
        )
        .expect("memory");
    }
    text
}
