//! The functions of images that hold one thing each, for the flash that it takes with all it needs.

use core::hint::black_box;
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
