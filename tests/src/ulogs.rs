//! PX4 logs put together by hand: every kind of message, whole and broken.

/// Format of a gyroscope's or accelerometer's topic of today, `sensor_gyro` or `sensor_accel`.
#[must_use]
pub fn sensor_format(topic: &str) -> String {
    format!(
        "{topic}:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;\
         float z;float temperature;uint32_t error_count;uint8_t[3] clip_counter;uint8_t samples;\
         uint8_t[4] _padding0;"
    )
}

/// Format of a FIFO's topic, `sensor_gyro_fifo` or `sensor_accel_fifo`.
#[must_use]
pub fn fifo_format(topic: &str) -> String {
    format!(
        "{topic}:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float dt;\
         float scale;int16_t[32] x;int16_t[32] y;int16_t[32] z;uint8_t samples;\
         uint8_t[3] _padding0;"
    )
}

/// Format of `vehicle_imu`.
pub const VEHICLE_IMU: &str = "vehicle_imu:uint64_t timestamp;uint64_t timestamp_sample;\
    uint32_t accel_device_id;uint32_t gyro_device_id;float[3] delta_angle;float[3] delta_velocity;\
    uint16_t delta_angle_dt;uint16_t delta_velocity_dt;uint8_t delta_angle_clipping;\
    uint8_t delta_velocity_clipping;uint8_t accel_calibration_count;\
    uint8_t gyro_calibration_count;uint8_t[4] _padding0;";

/// Format of `sensor_combined`.
pub const SENSOR_COMBINED: &str = "sensor_combined:uint64_t timestamp;float[3] gyro_rad;\
    uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;\
    float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;\
    uint8_t accelerometer_clipping;uint8_t[3] _padding0;";

/// The header of the file: version 1, started at 20 s.
#[must_use]
pub fn header() -> Vec<u8> {
    [&b"ULog\x01\x12\x35\x01"[..], &20_000_000_u64.to_le_bytes()].concat()
}

/// A message of any kind.
#[must_use]
pub fn message(kind: u8, body: &[u8]) -> Vec<u8> {
    let size = u16::try_from(body.len()).expect("a message is 64 KiB at most");
    [&size.to_le_bytes()[..], &[kind], body].concat()
}

/// Flags: where data was appended.
#[must_use]
pub fn flags(appended: &[u64]) -> Vec<u8> {
    let mut body = vec![0; 16];
    body[8] = u8::from(!appended.is_empty());
    for i in 0..3 {
        body.extend(appended.get(i).copied().unwrap_or(0).to_le_bytes());
    }
    message(b'B', &body)
}

/// A format.
#[must_use]
pub fn format(text: &str) -> Vec<u8> {
    message(b'F', text.as_bytes())
}

/// A piece of information or a parameter: `key` is a type and a name.
#[must_use]
pub fn value(kind: u8, key: &str, value: &[u8]) -> Vec<u8> {
    message(kind, &[&[key.len() as u8], key.as_bytes(), value].concat())
}

/// A subscription: data of this number is of this topic's instance.
#[must_use]
pub fn subscription(instance: u8, number: u16, topic: &str) -> Vec<u8> {
    message(b'A', &[&[instance], &number.to_le_bytes()[..], topic.as_bytes()].concat())
}

/// Data of this number.
#[must_use]
pub fn data(number: u16, fields: &[u8]) -> Vec<u8> {
    message(b'D', &[&number.to_le_bytes()[..], fields].concat())
}

/// A logged line.
#[must_use]
pub fn line(text: &str) -> Vec<u8> {
    message(b'L', &[&[b'6'][..], &20_000_000_u64.to_le_bytes(), text.as_bytes()].concat())
}

/// A mark of synchronization.
#[must_use]
pub fn sync() -> Vec<u8> {
    message(b'S', &[0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12])
}

/// A dropout of so many milliseconds.
#[must_use]
pub fn dropout(ms: u16) -> Vec<u8> {
    message(b'O', &ms.to_le_bytes())
}

/// The fields of a reading by [`sensor_format`], published 300 µs after it was taken.
#[must_use]
pub fn reading(stamp_us: u64, device: u32, xyz: [f32; 3], celsius: f32, clipped: u8) -> Vec<u8> {
    let mut fields = (stamp_us + 300).to_le_bytes().to_vec();
    fields.extend(stamp_us.to_le_bytes());
    fields.extend(device.to_le_bytes());
    fields.extend(xyz.into_iter().chain([celsius]).flat_map(f32::to_le_bytes));
    fields.extend([0; 4]);
    fields.extend([0, clipped, 0, 1]);
    fields
}

/// The fields of a batch by [`fifo_format`], whose last sample was taken at `stamp_us`.
#[must_use]
pub fn batch(stamp_us: u64, device: u32, dt_us: f32, scale: f32, counts: &[[i16; 3]]) -> Vec<u8> {
    let mut fields = (stamp_us + 300).to_le_bytes().to_vec();
    fields.extend(stamp_us.to_le_bytes());
    fields.extend(device.to_le_bytes());
    fields.extend([dt_us, scale].into_iter().flat_map(f32::to_le_bytes));
    for axis in 0..3 {
        for k in 0..32 {
            fields.extend(counts.get(k).map_or(0, |count| count[axis]).to_le_bytes());
        }
    }
    fields.push(counts.len() as u8);
    fields
}

/// The fields of increments by [`VEHICLE_IMU`].
#[must_use]
pub fn increments(stamp_us: u64, angle: [f32; 3], velocity: [f32; 3], dt_us: u16) -> Vec<u8> {
    let mut fields = (stamp_us + 300).to_le_bytes().to_vec();
    fields.extend(stamp_us.to_le_bytes());
    fields.extend([11_u32, 10_u32].into_iter().flat_map(u32::to_le_bytes));
    fields.extend(angle.into_iter().chain(velocity).flat_map(f32::to_le_bytes));
    fields.extend([dt_us, dt_us].into_iter().flat_map(u16::to_le_bytes));
    fields.extend([0; 4]);
    fields
}

/// The fields of means by [`SENSOR_COMBINED`]; the force is taken `relative_us` later.
#[must_use]
pub fn means(stamp_us: u64, rate: [f32; 3], force: [f32; 3], relative_us: i32) -> Vec<u8> {
    let mut fields = stamp_us.to_le_bytes().to_vec();
    fields.extend(rate.into_iter().flat_map(f32::to_le_bytes));
    fields.extend(5000_u32.to_le_bytes());
    fields.extend(relative_us.to_le_bytes());
    fields.extend(force.into_iter().flat_map(f32::to_le_bytes));
    fields.extend(5000_u32.to_le_bytes());
    fields.push(0);
    fields
}

/// Definitions as an autopilot writes them: flags, information, parameters and these formats.
#[must_use]
pub fn definitions(formats: &[&str]) -> Vec<u8> {
    let mut log = [header(), flags(&[])].concat();
    log.extend(value(b'I', "char[3] sys_name", b"PX4"));
    log.extend(message(b'M', b"\x00\x0fchar[4] console>>>>"));
    log.extend(formats.iter().flat_map(|text| format(text)));
    log.extend(value(b'P', "int32_t SYS_AUTOSTART", &4001_i32.to_le_bytes()));
    log.extend(message(b'Q', b"\x01\x09float A_B\x00\x00\x80\x3f"));
    log
}

/// Messages of a plain log, one by one behind the definitions: `count` readings of each of
/// `instances` gyroscopes and accelerometers at 200 Hz from 20 s on, with lines and marks between.
///
/// Reading i of instance n is (i, n, -i) of the gyroscope and (n, i, 9.8) of the accelerometer; the
/// number of a gyroscope is 2n, of an accelerometer 2n + 1, those of the chips 10 and 11 more.
#[must_use]
pub fn plain_messages(instances: u8, count: u16) -> Vec<Vec<u8>> {
    let mut messages = Vec::new();
    for n in 0..instances {
        messages.push(subscription(n, u16::from(2 * n), "sensor_gyro"));
        messages.push(subscription(n, u16::from(2 * n + 1), "sensor_accel"));
    }
    for i in 0..count {
        if i % 8 == 3 {
            messages.push(sync());
            messages.push(line("[commander] still"));
        }
        for n in 0..instances {
            let (at, v, w) = (20_000_000 + 5000 * u64::from(i), f32::from(i), f32::from(n));
            let number = u16::from(2 * n);
            let device = u32::from(number) + 10;
            let gyroscope = reading(at, device, [v, w, -v], 40.0 + w, 0);
            messages.push(data(number, &gyroscope));
            let accelerometer = reading(at + 7, device + 1, [w, v, 9.8], 50.0 + w, 0);
            messages.push(data(number + 1, &accelerometer));
        }
    }
    messages
}

/// Definitions of a plain log.
#[must_use]
pub fn plain_definitions() -> Vec<u8> {
    definitions(&[&sensor_format("sensor_gyro"), &sensor_format("sensor_accel")])
}

/// A plain log: [`plain_definitions`] and [`plain_messages`].
#[must_use]
pub fn plain(instances: u8, count: u16) -> Vec<u8> {
    [plain_definitions(), plain_messages(instances, count).concat()].concat()
}
