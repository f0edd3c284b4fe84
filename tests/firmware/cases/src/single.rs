//! The functions of images that hold one thing each, for the flash that it takes with all it needs.

use core::hint::black_box;
use imu_core::allan::{Difference, Octave, Sampling, fit_noise};
use imu_core::noise::{Axis, Channel, Sensor, Stage, Term, White};

/// White noise, not composed.
pub fn white_alone() {
    hundred_steps(black_box(White { noise_density: 0.019_f32 }));
}

/// White noise, composed with two terms left out.
pub fn white_composed() {
    hundred_steps(((), black_box(White { noise_density: 0.019_f32 }), ()));
}

fn hundred_steps(terms: impl Term<f32>) {
    let channel = Channel::new(black_box(7), Sensor::GYROSCOPE, Axis::X);
    if let Ok(mut stage) = terms.prepare(black_box(0.005), channel) {
        for _ in 0..100 {
            black_box(stage.step(black_box(1.0)));
        }
    }
}

/// The fit of N and K to 22 octaves.
pub fn fit_only() {
    let octave = Octave { samples: 1, differences: 1000, variance: 1.0, white_gain: 1.0 };
    let sampling =
        Sampling { tau0_s: 0.005, difference: Difference::Allan, windows: 4, records: 1 };
    black_box(fit_noise(black_box(&[octave; 22]), black_box(sampling)));
}
