//! What a topic of an IMU holds of each sensor, and how its readings are made of its fields.
//!
//! The fields are those of PX4's `msg/SensorGyro.msg`, `SensorAccel.msg`, `SensorGyroFifo.msg`,
//! `SensorAccelFifo.msg`, `VehicleImu.msg`, `SensorCombined.msg` and what they were called before.

use super::format::{Field, Formats, Scalar};
use crate::recording::Sample;
use crate::recording::sensor::Sensor;

/// A source of readings; the rawest comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Every sample of a chip's FIFO.
    Fifo,
    /// What the driver publishes.
    Sensor,
    /// Increments of both sensors.
    Increments,
    /// Means of the selected IMU.
    Combined,
}

impl Kind {
    /// What a topic of this name holds.
    pub fn of(topic: &str) -> Option<Self> {
        Some(match topic {
            "sensor_gyro_fifo" | "sensor_accel_fifo" => Self::Fifo,
            "sensor_gyro" | "sensor_accel" => Self::Sensor,
            "vehicle_imu" => Self::Increments,
            "sensor_combined" => Self::Combined,
            _ => return None,
        })
    }

    /// What a reading of it is.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Fifo => "every sample of the chip's FIFO, not calibrated by PX4",
            Self::Sensor => "as its driver published them, not calibrated by PX4",
            Self::Increments => {
                "increments over their time: each reading is the mean over the interval that ends \
                 at its stamp, calibrated by PX4"
            }
            Self::Combined => {
                "of the IMU that PX4 had selected: each reading is the mean over the interval that \
                 ends at its stamp, calibrated by PX4"
            }
        }
    }
}

/// How a topic's messages are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    stamp: Field,
    /// Angular rates, where it has them.
    pub gyroscope: Option<Channel>,
    /// Specific forces, where it has them.
    pub accelerometer: Option<Channel>,
    /// Degrees Celsius, where it has them.
    pub temperature: Option<Field>,
}

/// The readings of one sensor in the messages of a topic.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    readings: Readings,
    /// Microseconds from the message's stamp to the reading's.
    later: Option<Field>,
    /// Not 0 where a reading was clipped.
    clipped: Vec<Field>,
    /// Number of the chip.
    device: Option<Field>,
}

#[derive(Clone, Debug, PartialEq)]
enum Readings {
    /// As they are.
    Plain([Field; 3]),
    /// To be divided by so many microseconds.
    Increment { axes: [Field; 3], dt: Field },
    /// So many counts an axis.
    Fifo { axes: [Field; 3], dt: Field, scale: Field, samples: Field },
}

/// What a message gave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Taken {
    /// It makes no sense: no sample of it was taken.
    pub malformed: bool,
    /// The motion exceeded the sensor's range.
    pub clipped: bool,
}

/// `accelerometer_timestamp_relative` of a reading that there is not.
const INVALID: f64 = 0x7fff_ffff_u32 as f64;

/// A chip gives a sample at least that often: dt in a FIFO, in microseconds.
const SLOWEST_US: f64 = 1e6;

impl Layout {
    /// Of the topic of this name by its format; why it cannot be read: a sentence without its
    /// beginning and end.
    pub fn of(kind: Kind, topic: &str, formats: &Formats) -> Result<Self, String> {
        let field = |name: &str| formats.field(topic, name);
        let wanted = |name: &str| field(name).ok_or_else(|| format!("has no field {name}"));
        let elements = |name: &str| {
            let field = wanted(name)?;
            let axis = |i| field.element(i).ok_or_else(|| format!("has no three axes in {name}"));
            Ok::<_, String>([axis(0)?, axis(1)?, axis(2)?])
        };
        let xyz = || Ok::<_, String>([wanted("x")?, wanted("y")?, wanted("z")?]);
        let each = |name: &str| {
            let field = field(name);
            field.iter().flat_map(|f| (0..f.count.min(3)).filter_map(|i| f.element(i))).collect()
        };
        let stamp = field("timestamp_sample").map_or_else(|| wanted("timestamp"), Ok)?;
        if stamp.scalar != Scalar::U64 {
            return Err("has a stamp of unknown type".into());
        }
        let mut layout = Self { stamp, gyroscope: None, accelerometer: None, temperature: None };
        match kind {
            Kind::Fifo | Kind::Sensor => {
                let readings = if kind == Kind::Fifo {
                    let (dt, scale) = (wanted("dt")?, wanted("scale")?);
                    Readings::Fifo { axes: xyz()?, dt, scale, samples: wanted("samples")? }
                } else {
                    Readings::Plain(xyz()?)
                };
                let clipped = each("clip_counter");
                let channel =
                    Channel { readings, later: None, clipped, device: field("device_id") };
                if topic.starts_with("sensor_gyro") {
                    layout.gyroscope = Some(channel);
                } else {
                    layout.accelerometer = Some(channel);
                }
                layout.temperature = field("temperature");
            }
            Kind::Increments => {
                let channel = |increment: &str, device| {
                    let (axes, dt) = (elements(increment)?, wanted(&format!("{increment}_dt"))?);
                    Ok::<_, String>(Channel {
                        readings: Readings::Increment { axes, dt },
                        later: None,
                        clipped: each(&format!("{increment}_clipping")),
                        device: field(device),
                    })
                };
                layout.gyroscope = Some(channel("delta_angle", "gyro_device_id")?);
                layout.accelerometer = Some(channel("delta_velocity", "accel_device_id")?);
            }
            Kind::Combined => {
                let channel = |mean: &str, later, clipped| {
                    Ok::<_, String>(Channel {
                        readings: Readings::Plain(elements(mean)?),
                        later,
                        clipped: each(clipped),
                        device: None,
                    })
                };
                layout.gyroscope = Some(channel("gyro_rad", None, "gyro_clipping")?);
                let later = field("accelerometer_timestamp_relative");
                let clipped = "accelerometer_clipping";
                layout.accelerometer = Some(channel("accelerometer_m_s2", later, clipped)?);
            }
        }
        Ok(layout)
    }

    /// The channel of a sensor, where it has one.
    pub fn channel(&self, sensor: Sensor) -> Option<&Channel> {
        match sensor {
            Sensor::Gyroscope => self.gyroscope.as_ref(),
            Sensor::Accelerometer => self.accelerometer.as_ref(),
        }
    }

    /// When the message's readings were taken, in nanoseconds; `None` where that fits no clock.
    #[inline]
    pub fn stamp_ns(&self, message: &[u8]) -> Option<i64> {
        i64::try_from(self.stamp.read_u64(message)?).ok()?.checked_mul(1000)
    }
}

impl Channel {
    /// The number of the chip that this message is of.
    pub fn device(&self, message: &[u8]) -> Option<f64> {
        self.device?.read(message)
    }

    /// Readings of a message, as far as its bytes tell.
    pub fn count(&self, message: &[u8]) -> u64 {
        match self.readings {
            Readings::Fifo { samples, .. } => {
                let samples = samples.read(message).unwrap_or(0.0) as u64;
                if samples > LONGEST_BATCH as u64 { 0 } else { samples }
            }
            _ => 1,
        }
    }

    /// Takes the readings of a message stamped `stamp_ns`.
    #[inline]
    pub fn take(&self, message: &[u8], stamp_ns: i64, to: &mut Vec<Sample>) -> Taken {
        let whole = to.len();
        match self.readings(message, stamp_ns, to) {
            Some(clipped) => {
                let counted = self.clipped.iter().filter_map(|field| field.read(message));
                let clipped = counted.fold(clipped, |any, count| any || count != 0.0);
                Taken { malformed: false, clipped }
            }
            None => {
                to.truncate(whole);
                Taken { malformed: true, clipped: false }
            }
        }
    }

    /// Whether counts were at the end of their range; `None` where the message makes no sense.
    #[inline]
    fn readings(&self, message: &[u8], mut stamp_ns: i64, to: &mut Vec<Sample>) -> Option<bool> {
        if let Some(later) = self.later {
            let later = later.read(message)?;
            if later == INVALID {
                return Some(false);
            }
            stamp_ns = stamp_ns.checked_add((later as i64).checked_mul(1000)?)?;
        }
        match &self.readings {
            Readings::Plain(axes) => {
                to.push(Sample { stamp_ns, value: vector(axes, message)? });
            }
            Readings::Increment { axes, dt } => {
                let dt = dt.read(message)?;
                if dt <= 0.0 || dt.is_nan() {
                    return None;
                }
                let value = vector(axes, message)?.map(|increment| increment / (dt * 1e-6));
                to.push(Sample { stamp_ns, value });
            }
            Readings::Fifo { axes, dt, scale, samples } => {
                let (dt, scale) = (dt.read(message)?, scale.read(message)?);
                let samples = samples.read(message)? as usize;
                if samples > LONGEST_BATCH {
                    return None;
                }
                if !(dt > 0.0 && dt <= SLOWEST_US && scale.is_finite() && scale != 0.0) {
                    return None;
                }
                let mut clipped = false;
                for k in 0..samples {
                    let mut value = [0.0; 3];
                    for (value, axis) in value.iter_mut().zip(axes) {
                        let count = axis.element(k)?.read(message)?;
                        clipped |= is_clipped(count);
                        *value = count * scale;
                    }
                    let before = ((samples - 1 - k) as f64 * dt * 1e3).round();
                    to.push(Sample { stamp_ns: stamp_ns - before as i64, value });
                }
                return Some(clipped);
            }
        }
        Some(false)
    }
}

/// Samples of a FIFO in one message, at most: they are counted in a byte.
pub const LONGEST_BATCH: usize = 255;

/// Within 1 of the end of 16 bits, as `PX4Gyroscope.cpp` has it: some chips use the lowest bit for
/// something else, and a turned axis changes its sign.
fn is_clipped(count: f64) -> bool {
    count <= f64::from(i16::MIN) + 1.0 || count >= f64::from(i16::MAX) - 1.0
}

#[inline]
fn vector(axes: &[Field; 3], message: &[u8]) -> Option<[f64; 3]> {
    let [x, y, z] = axes;
    Some([x.read(message)?, y.read(message)?, z.read(message)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> Result<Layout, String> {
        let mut formats = Formats::default();
        formats.define(text.as_bytes());
        let topic = text.split(':').next().unwrap();
        Layout::of(Kind::of(topic).unwrap(), topic, &formats)
    }

    #[test]
    fn a_batch_ends_at_its_stamp() {
        let layout = layout(
            "sensor_gyro_fifo:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;\
             float dt;float scale;uint8_t samples;int16_t[4] x;int16_t[4] y;int16_t[4] z;",
        )
        .unwrap();
        let mut message = [0_u64.to_le_bytes(), 1_000_000_u64.to_le_bytes()].concat();
        message.extend(7_u32.to_le_bytes());
        message.extend([125.5_f32.to_le_bytes(), 0.5_f32.to_le_bytes()].concat());
        message.push(3);
        for count in [1_i16, 2, 3, 9, -1, -2, -3, 9, 10, 20, 32_766, 9] {
            message.extend(count.to_le_bytes());
        }
        let channel = layout.gyroscope.as_ref().unwrap();
        let mut samples = Vec::new();
        let stamp_ns = layout.stamp_ns(&message).unwrap();
        let taken = channel.take(&message, stamp_ns, &mut samples);
        assert_eq!(taken, Taken { malformed: false, clipped: true });
        assert_eq!(channel.device(&message), Some(7.0));
        let sample = |stamp_ns, value| Sample { stamp_ns, value };
        assert_eq!(
            samples,
            [
                sample(999_749_000, [0.5, -0.5, 5.0]),
                sample(999_874_500, [1.0, -1.0, 10.0]),
                sample(1_000_000_000, [1.5, -1.5, 16_383.0]),
            ]
        );
        // More samples than the message has room for.
        message[28] = 5;
        assert!(channel.take(&message, 0, &mut samples).malformed);
        assert_eq!(samples.len(), 3);
        assert_eq!(channel.count(&message), 5);
    }

    #[test]
    fn a_batch_of_more_than_there_can_be_counts_nothing() {
        for (samples, bytes, count) in [
            ("uint64_t", 255_u64.to_le_bytes(), 255),
            ("uint64_t", 256_u64.to_le_bytes(), 0),
            ("uint64_t", u64::MAX.to_le_bytes(), 0),
            ("double", f64::INFINITY.to_le_bytes(), 0),
            ("double", f64::NAN.to_le_bytes(), 0),
            ("int64_t", (-1_i64).to_le_bytes(), 0),
        ] {
            let layout = layout(&format!(
                "sensor_gyro_fifo:{samples} samples;uint64_t timestamp;float dt;float scale;\
                 int16_t[255] x;int16_t[255] y;int16_t[255] z;"
            ));
            let channel = layout.unwrap().gyroscope.unwrap();
            assert_eq!(channel.count(&bytes), count, "{samples} {bytes:?}");
        }
    }

    #[test]
    fn increments_are_divided_by_their_time() {
        let layout = layout(
            "vehicle_imu:uint64_t timestamp_sample;float[3] delta_angle;float[3] delta_velocity;\
             uint16_t delta_angle_dt;uint16_t delta_velocity_dt;uint8_t delta_velocity_clipping;",
        )
        .unwrap();
        let mut message = 5_u64.to_le_bytes().to_vec();
        for value in [0.25_f32, 0.5, 1.0, 2.0, 4.0, 8.0] {
            message.extend(value.to_le_bytes());
        }
        message.extend([0, 0]);
        message.extend(50_000_u16.to_le_bytes());
        message.push(4);
        let mut samples = Vec::new();
        let gyroscope = layout.gyroscope.as_ref().unwrap();
        assert!(gyroscope.take(&message, 5000, &mut samples).malformed);
        let accelerometer = layout.accelerometer.as_ref().unwrap();
        assert!(accelerometer.take(&message, 5000, &mut samples).clipped);
        assert_eq!(samples[0].stamp_ns, 5000);
        for (got, want) in samples[0].value.iter().zip([40.0, 80.0, 160.0]) {
            // Two roundings: of dt·1e-6 and of the quotient.
            assert!((got - want).abs() <= want * 4e-16, "{got} {want}");
        }
    }

    #[test]
    fn a_combined_message_may_lack_its_force() {
        let layout = layout(
            "sensor_combined:uint64_t timestamp;float[3] gyro_rad;\
             int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;",
        )
        .unwrap();
        let mut message = vec![0; 8];
        message.extend([0; 12]);
        message.extend((-3_i32).to_le_bytes());
        message.extend([0; 12]);
        let accelerometer = layout.accelerometer.as_ref().unwrap();
        let mut samples = Vec::new();
        assert!(!accelerometer.take(&message, 10_000, &mut samples).malformed);
        assert_eq!(samples[0].stamp_ns, 7000);
        message[20..24].copy_from_slice(&0x7fff_ffff_u32.to_le_bytes());
        assert!(!accelerometer.take(&message, 10_000, &mut samples).malformed);
        assert_eq!(samples.len(), 1);
    }

    #[test]
    fn a_missing_field_is_named() {
        for (text, lacking) in [
            ("sensor_gyro:uint64_t timestamp;float x;float y;", "has no field z"),
            ("sensor_gyro:float x;float y;float z;", "has no field timestamp"),
            ("sensor_gyro:float timestamp;float x;", "has a stamp of unknown type"),
            ("sensor_accel_fifo:uint64_t timestamp;float dt;", "has no field scale"),
            (
                "vehicle_imu:uint64_t timestamp;float[2] delta_angle;",
                "has no three axes in delta_angle",
            ),
        ] {
            assert_eq!(layout(text).unwrap_err(), lacking);
        }
    }
}
