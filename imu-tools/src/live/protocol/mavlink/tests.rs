use super::*;
use crate::live::protocol::{Protocol, tests};

/// What `sent` says, frame after frame.
fn messages(frames: &[&[u8]]) -> Vec<Message> {
    tests::decoded(Protocol::Mavlink, &frames.concat())
}

#[test]
fn frames_of_pymavlink_in_both_versions() {
    for [heartbeat, raw, scaled, highres] in [
        [&HEARTBEAT_V1[..], &RAW_IMU_V1[..], &SCALED_IMU_V1[..], &HIGHRES_IMU_V1[..]],
        [&HEARTBEAT_V2[..], &RAW_IMU_V2[..], &SCALED_IMU_V2[..], &HIGHRES_IMU_V2[..]],
    ] {
        for frame in [heartbeat, raw, scaled, highres] {
            assert_eq!(Mavlink::default().check(frame), Check::Whole(frame.len()));
        }
        let [message] = messages(&[heartbeat, raw]).try_into().unwrap();
        assert_eq!(message.accelerometer, Some([10.0, -20.0, -1000.0].map(|v| v * MILLI_G)));
        assert_eq!(message.gyroscope, Some([1.0, -2.0, 300.0].map(|v| v * MILLI)));
        let ticks = message.ticks.unwrap();
        assert_eq!((ticks.value, ticks.per_second), (123_456_789_012, 1_000_000));
        let [scaled] = messages(&[scaled]).try_into().unwrap();
        assert_eq!(scaled.accelerometer, message.accelerometer);
        assert_eq!(scaled.gyroscope, message.gyroscope);
        let ticks = scaled.ticks.unwrap();
        assert_eq!((ticks.value, ticks.per_second), (4_000_000_000, 1000));
        let [highres] = messages(&[highres]).try_into().unwrap();
        assert_eq!(highres.accelerometer, Some([0.5, -0.25, -9.75]));
        assert_eq!(highres.gyroscope, Some([0.125, -0.0625, 2.0]));
        assert_eq!(highres.celsius, Some(33.5));
        assert_eq!(highres.ticks.unwrap().value, 987_654_321);
    }
    let [signed] = messages(&[&SIGNED]).try_into().unwrap();
    assert_eq!(signed.gyroscope, Some([4.0, 5.0, 6.0].map(|v| v * MILLI)));
    assert_eq!(signed.celsius, Some(21.5));
}

#[test]
fn of_one_sensor_the_best_message_is_taken() {
    let of = |frames: &[&[u8]]| messages(frames).iter().map(|m| m.ticks.unwrap().value).collect();
    let both: Vec<u64> =
        of(&[&RAW_IMU_V2, &SCALED_IMU_V2, &RAW_IMU_V2, &HIGHRES_IMU_V1, &SCALED_IMU_V2]);
    assert_eq!(both, [123_456_789_012, 4_000_000_000, 987_654_321]);
}

/// A frame of version 2 whose bytes at `at` are others, with the CRC of that.
fn with<const N: usize>(mut frame: [u8; N], at: usize, bytes: &[u8]) -> [u8; N] {
    frame[at..at + bytes.len()].copy_from_slice(bytes);
    let extra = crc_extra::of(View(&frame).message()).unwrap();
    let crc = crc(frame[1..N - CRC].iter().chain([&extra]));
    frame[N - CRC..].copy_from_slice(&crc.to_le_bytes());
    frame
}

/// Which streams were handed out, by their ticks, one after the other, and by their numbers.
fn streams(frames: &[&[u8]]) -> Vec<(u64, u8)> {
    let mut streams: Vec<_> =
        messages(frames).iter().map(|m| (m.ticks.unwrap().value, m.stream)).collect();
    streams.dedup();
    streams
}

const HIGHRES_TICKS: u64 = 987_654_321;
const SCALED_TICKS: u64 = 4_000_000_000;
const RAW_TICKS: u64 = 123_456_789_012;

#[test]
fn where_the_best_comes_no_more_another_of_the_same_sensor_takes_its_place() {
    let many = PATIENCE as usize + 3;
    let mut frames = vec![&HIGHRES_IMU_V2[..]];
    frames.extend(vec![&RAW_IMU_V2[..]; many]);
    assert_eq!(messages(&frames).len(), 1 + 3);
    // It comes again, and another that is better than the present one.
    frames.extend([&HIGHRES_IMU_V2[..], &RAW_IMU_V2, &SCALED_IMU_V2, &HIGHRES_IMU_V2]);
    let mut wanted = vec![(HIGHRES_TICKS, 0), (RAW_TICKS, 1), (SCALED_TICKS, 2)];
    assert_eq!(streams(&frames), wanted);
    // That ceases, too: neither it nor the first are better any more.
    frames.extend(vec![&RAW_IMU_V2[..]; many]);
    frames.extend([&HIGHRES_IMU_V2[..], &SCALED_IMU_V2, &RAW_IMU_V2]);
    wanted.push((RAW_TICKS, 3));
    assert_eq!(streams(&frames), wanted);
    // And if nothing else is left it is gone back to.
    frames.extend(vec![&HIGHRES_IMU_V2[..]; many]);
    wanted.push((HIGHRES_TICKS, 4));
    assert_eq!(streams(&frames), wanted);
}

/// Another sender's, and another sensor's of the same sender.
#[test]
fn once_a_sensor_is_chosen_no_other_is_taken() {
    let many = (CHOICE + PATIENCE) as usize;
    let component = 6;
    let another_raw = with(RAW_IMU_V2, component, &[99]);
    let another_highres = with(HIGHRES_IMU_V2, component, &[99]);
    for other in [&another_raw[..], &another_highres, &SIGNED] {
        // However long the chosen one is silent,
        let mut frames = vec![&HIGHRES_IMU_V2[..]];
        frames.extend(vec![other; many]);
        assert_eq!(streams(&frames), [(HIGHRES_TICKS, 0)]);
        // and also where a worse message took its place.
        let mut frames = vec![&HIGHRES_IMU_V2[..]];
        frames.extend(vec![&RAW_IMU_V2[..]; many]);
        frames.extend(vec![other; many]);
        assert_eq!(streams(&frames), [(HIGHRES_TICKS, 0), (RAW_TICKS, 1)]);
    }
    // Before that the better one is.
    assert_eq!(streams(&[&another_raw, &SIGNED]).len(), 2);
    assert_eq!(streams(&[&another_raw]).len(), 1);
}

#[test]
fn a_frame_without_a_sample_is_of_no_stream() {
    let updated = 10 + 60;
    let empty = with(HIGHRES_IMU_V2, updated, &[0, 0]);
    let mut frames = vec![&HIGHRES_IMU_V2[..]];
    for _ in 0..=PATIENCE {
        frames.extend([&RAW_IMU_V2[..], &empty]);
    }
    assert_eq!(streams(&frames), [(HIGHRES_TICKS, 0), (RAW_TICKS, 1)]);
    assert_eq!(streams(&[&empty, &RAW_IMU_V2]), [(RAW_TICKS, 0)]);
}

#[test]
fn a_flag_that_nobody_knows_is_refused() {
    let mut frame = SCALED_IMU_V2;
    frame[2] = 2;
    assert_eq!(messages(&[&frame]), []);
}

#[test]
fn what_is_encoded_is_what_pymavlink_writes() {
    let message = Message {
        accelerometer: Some([0.5, -0.25, -9.75]),
        gyroscope: Some([0.125, -0.0625, 2.0]),
        celsius: Some(33.5),
        ticks: Some(Ticks { value: 987_654_321, per_second: 1_000_000, wraps_at: None }),
        ..Message::default()
    };
    let mut bytes = Vec::new();
    encode(&message, &mut bytes);
    // Sender, number and pressure are others, and so is the CRC.
    let differ =
        |at: usize| matches!(at, 4..=6) || (54..58).contains(&at) || at >= bytes.len() - CRC;
    for (at, (ours, theirs)) in bytes.iter().zip(HIGHRES_IMU_V2).enumerate() {
        assert!(differ(at) || *ours == theirs, "byte {at}");
    }
    assert_eq!(messages(&[&bytes]), [message]);
}

// What pymavlink 2.4.50 wrote (tests/peers/mavlink_frames.py).
#[rustfmt::skip]
const HEARTBEAT_V1: [u8; 17] = [
    0xFE, 0x09, 0xC8, 0x03, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x03, 0x00, 0x03,
    0x03, 0x90, 0xBE,
];
#[rustfmt::skip]
const RAW_IMU_V1: [u8; 34] = [
    0xFE, 0x1A, 0xC9, 0x03, 0x07, 0x1B, 0x14, 0x1A, 0x99, 0xBE, 0x1C, 0x00, 0x00, 0x00,
    0x0A, 0x00, 0xEC, 0xFF, 0x18, 0xFC, 0x01, 0x00, 0xFE, 0xFF, 0x2C, 0x01, 0x04, 0x00,
    0x05, 0x00, 0x06, 0x00, 0xF5, 0x60,
];
#[rustfmt::skip]
const SCALED_IMU_V1: [u8; 30] = [
    0xFE, 0x16, 0xCA, 0x03, 0x07, 0x1A, 0x00, 0x28, 0x6B, 0xEE, 0x0A, 0x00, 0xEC, 0xFF,
    0x18, 0xFC, 0x01, 0x00, 0xFE, 0xFF, 0x2C, 0x01, 0x04, 0x00, 0x05, 0x00, 0x06, 0x00,
    0xC5, 0x39,
];
#[rustfmt::skip]
const HIGHRES_IMU_V1: [u8; 70] = [
    0xFE, 0x3E, 0xCB, 0x03, 0x07, 0x69, 0xB1, 0x68, 0xDE, 0x3A, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x3F, 0x00, 0x00, 0x80, 0xBE, 0x00, 0x00, 0x1C, 0xC1, 0x00, 0x00,
    0x00, 0x3E, 0x00, 0x00, 0x80, 0xBD, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x50, 0x7D, 0x44, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x06, 0x42, 0x3F, 0x10, 0xAD, 0x40,
];
#[rustfmt::skip]
const HEARTBEAT_V2: [u8; 21] = [
    0xFD, 0x09, 0x00, 0x00, 0xC8, 0x03, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x02, 0x03, 0x00, 0x03, 0x03, 0xA5, 0x27,
];
#[rustfmt::skip]
const RAW_IMU_V2: [u8; 37] = [
    0xFD, 0x19, 0x00, 0x00, 0xC9, 0x03, 0x07, 0x1B, 0x00, 0x00, 0x14, 0x1A, 0x99, 0xBE,
    0x1C, 0x00, 0x00, 0x00, 0x0A, 0x00, 0xEC, 0xFF, 0x18, 0xFC, 0x01, 0x00, 0xFE, 0xFF,
    0x2C, 0x01, 0x04, 0x00, 0x05, 0x00, 0x06, 0x85, 0x26,
];
#[rustfmt::skip]
const SCALED_IMU_V2: [u8; 33] = [
    0xFD, 0x15, 0x00, 0x00, 0xCA, 0x03, 0x07, 0x1A, 0x00, 0x00, 0x00, 0x28, 0x6B, 0xEE,
    0x0A, 0x00, 0xEC, 0xFF, 0x18, 0xFC, 0x01, 0x00, 0xFE, 0xFF, 0x2C, 0x01, 0x04, 0x00,
    0x05, 0x00, 0x06, 0x0E, 0x64,
];
#[rustfmt::skip]
const HIGHRES_IMU_V2: [u8; 74] = [
    0xFD, 0x3E, 0x00, 0x00, 0xCB, 0x03, 0x07, 0x69, 0x00, 0x00, 0xB1, 0x68, 0xDE, 0x3A,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3F, 0x00, 0x00, 0x80, 0xBE, 0x00, 0x00,
    0x1C, 0xC1, 0x00, 0x00, 0x00, 0x3E, 0x00, 0x00, 0x80, 0xBD, 0x00, 0x00, 0x00, 0x40,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x50,
    0x7D, 0x44, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x06, 0x42,
    0x3F, 0x10, 0xC0, 0xB1,
];
#[rustfmt::skip]
const SIGNED: [u8; 49] = [
    0xFD, 0x18, 0x01, 0x00, 0x00, 0x03, 0x07, 0x74, 0x00, 0x00, 0x05, 0x00, 0x00, 0x00,
    0x01, 0x00, 0x02, 0x00, 0x03, 0x00, 0x04, 0x00, 0x05, 0x00, 0x06, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x66, 0x08, 0x27, 0xB0, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x91, 0x37, 0x7A, 0xA2, 0xAD, 0x6C,
];
