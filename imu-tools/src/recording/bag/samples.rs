//! From messages to samples, in SI units.

use super::imu_message::ImuMessage;
use super::pose_message;
use super::temperature_message::TemperatureMessage;
use crate::recording::pose_body::PoseMessage;
use crate::recording::topics::Role;
use crate::recording::{Block, ForceUnit, RateUnit, ReadOptions, Sample, Temperature};

/// Takes messages, and counts what is strange about them.
#[derive(Clone, Debug)]
pub struct Samples {
    bag_time: bool,
    /// Factors to SI units: 1 unless the user says that the bag does not keep to them.
    rate: f64,
    force: f64,
    messages: u64,
    /// Messages whose stamp is 0.
    unstamped: u64,
    /// Messages that cannot be read.
    malformed: u64,
}

/// A time of a bag on one scale.
pub fn nanoseconds((sec, nsec): (u32, u32)) -> i64 {
    i64::from(sec) * 1_000_000_000 + i64::from(nsec)
}

impl Samples {
    /// Stamps and units as the user wants them.
    pub fn new(options: &ReadOptions) -> Self {
        Self {
            bag_time: options.bag_time,
            rate: options.gyro_unit.map_or(1.0, RateUnit::to_rad_s),
            force: options.accel_unit.map_or(1.0, ForceUnit::to_m_s2),
            messages: 0,
            unstamped: 0,
            malformed: 0,
        }
    }

    /// Takes one message, recorded at `time`; `false` where it is none.
    #[inline]
    pub fn message(
        &mut self,
        payload: &[u8],
        time: (u32, u32),
        role: Role,
        to: &mut Block,
    ) -> bool {
        if role.temperature {
            return self.temperature(payload, time, to);
        }
        if let Some(message) = role.pose {
            return self.pose(message, payload, time, to);
        }
        let Some(message) = ImuMessage::parse(payload) else { return false };
        self.imu(&message, time, role, to);
        true
    }

    /// Takes an IMU's message, recorded at `time`.
    #[inline]
    pub fn imu(&mut self, message: &ImuMessage, time: (u32, u32), role: Role, to: &mut Block) {
        self.messages += 1;
        self.unstamped += u64::from(message.stamp == (0, 0));
        let stamp_ns = nanoseconds(if self.bag_time { time } else { message.stamp });
        if let Some(value) = message.rate
            && role.gyroscope
        {
            to.gyroscope.push(Sample { stamp_ns, value });
        }
        if let Some(value) = message.force
            && role.accelerometer
        {
            to.accelerometer.push(Sample { stamp_ns, value });
        }
    }

    fn temperature(&mut self, payload: &[u8], time: (u32, u32), to: &mut Block) -> bool {
        let Some(message) = TemperatureMessage::parse(payload) else { return false };
        let stamp_ns = nanoseconds(if self.bag_time { time } else { message.stamp });
        to.temperature.push(Temperature { stamp_ns, celsius: message.celsius });
        true
    }

    fn pose(
        &mut self,
        message: PoseMessage,
        payload: &[u8],
        time: (u32, u32),
        to: &mut Block,
    ) -> bool {
        let Some(mut pose) = pose_message::parse(message, payload) else { return false };
        self.messages += 1;
        self.unstamped += u64::from(pose.stamp_ns == 0);
        if self.bag_time {
            pose.stamp_ns = nanoseconds(time);
        }
        to.poses.push(pose);
        true
    }

    /// Counts a message that is none.
    pub fn count_malformed(&mut self) {
        self.malformed += 1;
    }

    /// Brings the values of a block to SI units.
    pub fn scale(&self, block: &mut Block) {
        for (samples, factor) in
            [(&mut block.gyroscope, self.rate), (&mut block.accelerometer, self.force)]
        {
            if factor != 1.0 {
                for value in samples.iter_mut().flat_map(|sample| &mut sample.value) {
                    *value *= factor;
                }
            }
        }
    }

    /// What was strange, in words that follow the name of the bag.
    pub fn strange(&self) -> Vec<String> {
        let mut strange = Vec::new();
        if self.malformed > 0 {
            strange.push(format!(
                "has {} messages that are not of the type that their topic says: they are left out",
                self.malformed
            ));
        }
        if self.messages > 1 && self.unstamped == self.messages && !self.bag_time {
            strange.push("has no stamps in its messages: read it with --bag-time".into());
        }
        strange
    }
}
