//! An IMU that streams: two hundred numbered, stamped frames a second over the board's serial line, for `imu live`.
//!
//! In the place of a sensor's driver stands noise of known density, so that what `imu live` finds can be checked. The
//! rest is what firmware of your own needs: a frame, a buffer for its bytes, and the line.
#![no_std]
#![no_main]

use firmware_image::{Every, Uart};
use imu_core::frame::{Frame, LONGEST};
use imu_core::noise::{Sensor, Stage, ThreeAxis, White};

firmware_image::main!(run);

/// The board's clock, Hz, and that of the samples.
const BOARD_HZ: u32 = 25_000_000;
const RATE_HZ: u32 = 200;
/// rad/s/√Hz
const GYROSCOPE: White<f32> = White { noise_density: 1e-3 };
/// m/s²/√Hz
const ACCELEROMETER: White<f32> = White { noise_density: 2e-3 };

fn run() {
    let interval_s = 1.0 / RATE_HZ as f32;
    let (Ok(mut gyroscope), Ok(mut accelerometer)) = (
        ThreeAxis::prepare([(GYROSCOPE,); 3], interval_s, 1, Sensor::GYROSCOPE),
        ThreeAxis::prepare([(ACCELEROMETER,); 3], interval_s, 1, Sensor::ACCELEROMETER),
    ) else {
        return;
    };
    let mut line = Uart::new();
    let mut clock = Every::ticks(BOARD_HZ / RATE_HZ);
    let mut bytes = [0; LONGEST];
    for sample in 0_u64.. {
        clock.wait();
        let frame = Frame {
            number: sample as u16,
            // When the sensor sampled, whenever this was sent.
            time_ns: sample.wrapping_mul(u64::from(1_000_000_000 / RATE_HZ)),
            gyroscope: Some(gyroscope.step([0.0; 3])),
            accelerometer: Some(accelerometer.step([0.0, 0.0, 9.81])),
            ..Frame::default()
        };
        line.send(frame.encode(&mut bytes));
    }
}
