//! PX4 logs that were cut or damaged, or hold what nobody knows: what is whole is read, the rest is told.

use imu_tests::ulog_outcomes::{expected, read, read_plainly, refusal};
use imu_tests::ulogs::{
    data, dropout, flags, format, line, message, plain, plain_definitions, plain_messages, reading,
    subscription,
};
use imu_tools::recording::ReadOptions;

#[test]
fn dropouts_clipping_and_senseless_messages_are_told_with_their_number() {
    let mut log = plain(1, 100);
    log.extend(dropout(30));
    log.extend(dropout(1000));
    for clipped in [1, 0, 7] {
        log.extend(data(0, &reading(20_600_000, 10, [0.0; 3], 40.0, clipped)));
    }
    // Its stamp does not fit 64 bits of nanoseconds.
    log.extend(data(1, &reading(u64::MAX - 300, 11, [0.0; 3], 40.0, 0)));
    let outcome = read_plainly(&log);
    assert_eq!(outcome.samples.accelerometer.len(), 100);
    assert_eq!(
        outcome.warnings(),
        [
            "a.ulg has 2 dropouts, 1030 ms in all, in which the autopilot could not write: \
             samples are missing there",
            "2 of 103 messages of sensor_gyro:0 in a.ulg were clipped: the motion exceeded the \
             sensor's range",
            "1 of 101 messages of sensor_accel:0 in a.ulg make no sense: they are passed over",
        ]
    );
}

#[test]
fn a_log_cut_anywhere_gives_all_whole_messages_before_the_cut() {
    let messages = plain_messages(1, 12);
    let mut whole = plain_definitions();
    let (mut ends, mut counts) = (vec![whole.len()], vec![[0, 0]]);
    for message in &messages {
        whole.extend(message);
        let mut count = *counts.last().unwrap();
        if message[2] == b'D' {
            count[usize::from(message[3])] += 1;
        }
        ends.push(whole.len());
        counts.push(count);
    }
    let subscribed = ends[1];
    for cut in 0..whole.len() {
        let outcome = read(&whole[..cut], &ReadOptions::default());
        if cut < subscribed {
            assert_eq!(outcome.unwrap_err().exit_code(), 1, "{cut}");
            continue;
        }
        let outcome = outcome.unwrap();
        let place = ends.iter().rposition(|&end| end <= cut).unwrap();
        let samples = &outcome.samples;
        let got = [samples.gyroscope.len(), samples.accelerometer.len()];
        assert_eq!(got, counts[place], "{cut}");
        let told = outcome.warnings().iter().any(|w| w.contains("ends in the middle of a message"));
        assert_eq!(told, ends[place] != cut, "{cut}: {:?}", outcome.notes);
    }
}

#[test]
fn damage_of_any_byte_costs_two_messages_at_most_and_is_told() {
    let (definitions, messages) = (plain_definitions(), plain_messages(1, 40));
    let head: usize = definitions.len() + messages[..2].iter().map(Vec::len).sum::<usize>();
    let whole = plain(1, 40);
    for at in head..whole.len() {
        for flip in [0x01, 0x20, 0xff] {
            let mut log = whole.clone();
            log[at] ^= flip;
            let outcome = read_plainly(&log);
            let samples = &outcome.samples;
            let count = samples.gyroscope.len() + samples.accelerometer.len();
            // Its own, and the one before it, which may have been hit as well for all one can see.
            assert!(count >= 78, "{at} {flip}: {count} {:?}", outcome.notes);
            if count < 80 {
                assert!(!outcome.warnings().is_empty(), "{at} {flip}");
            }
        }
    }
}

#[test]
fn a_damaged_stretch_is_told_in_bytes_and_reading_goes_on() {
    let messages = plain_messages(1, 200);
    let bytes = |messages: &[Vec<u8>]| messages.iter().map(Vec::len).sum::<usize>();
    // From within message 100 to within message 120.
    let start = plain_definitions().len() + bytes(&messages[..100]);
    let lost = bytes(&messages[100..121]);
    for filler in [0, 0xff, b'S', b'F', 0x80] {
        let mut log = plain(1, 200);
        log[start + 20..start + lost - 10].fill(filler);
        let outcome = read_plainly(&log);
        assert_eq!(
            outcome.warnings(),
            [format!("a.ulg is damaged at byte {start}: {lost} bytes are lost")],
            "{filler}"
        );
        let count = outcome.samples.gyroscope.len() + outcome.samples.accelerometer.len();
        let kept = messages[..100].iter().chain(&messages[121..]).filter(|m| m[2] == b'D').count();
        assert_eq!(count, kept, "{filler}");
        assert!(outcome.samples.gyroscope.iter().all(|s| expected(0, 200).gyroscope.contains(s)));
    }
}

#[test]
fn zeros_and_garbage_at_the_end_are_told() {
    let whole = plain(1, 100);
    // The last message is one of the accelerometer, and may be damaged as well.
    let last = plain_messages(1, 100).pop().unwrap().len();
    let log = [whole.clone(), vec![0; 700_000]].concat();
    let outcome = read_plainly(&log);
    let mut kept = expected(0, 100);
    kept.accelerometer.pop();
    assert_eq!(outcome.samples, kept);
    let (start, lost) = (whole.len() - last, 700_000 + last);
    let told = format!("a.ulg is damaged at byte {start}: the rest, {lost} bytes, is lost");
    assert_eq!(outcome.warnings(), [told]);
}

#[test]
fn a_lying_size_swallows_nothing() {
    let parts = plain_messages(1, 100);
    let start = plain_definitions().len() + parts[..50].iter().map(Vec::len).sum::<usize>();
    let inserted = [
        // A line of text and an unknown message that claim to be much longer than they are.
        [&[0xff, 0x0f, b'L', b'6'][..], &[b'x'; 40]].concat(),
        [&[0xff, 0xff, b'Z'][..], &[b'x'; 40]].concat(),
        [&[0x40, 0x00, b'D', 0x63, 0x63][..], &[0; 20]].concat(),
    ];
    for bytes in inserted {
        let mut log = plain(1, 100);
        log.splice(start..start, bytes.iter().copied());
        let outcome = read_plainly(&log);
        assert_eq!(outcome.samples, expected(0, 100));
        let told = format!("a.ulg is damaged at byte {start}: {} bytes are lost", bytes.len());
        assert_eq!(outcome.warnings(), [told]);
    }
}

#[test]
fn unknown_kinds_and_topics_are_passed_over_and_counted() {
    let mut log = plain(1, 10);
    log.extend(message(b'Z', &[0; 1000]));
    log.extend(data(700, &[0; 30]));
    log.extend(data(0, &reading(20_050_000, 10, [10.0, 0.0, -10.0], 40.0, 0)));
    let outcome = read_plainly(&log);
    assert_eq!(outcome.samples.gyroscope, expected(0, 11).gyroscope);
    assert_eq!(
        outcome.warnings(),
        [
            "a.ulg has 1 messages of topics that it does not name",
            "a.ulg has 1 messages of unknown kinds: they are passed over",
        ]
    );
}

#[test]
fn definitions_that_contradict_earlier_ones_are_refused_softly() {
    let mut log = plain(1, 10);
    log.extend(format("sensor_gyro:uint64_t timestamp;float x;"));
    log.extend(subscription(0, 0, "sensor_accel"));
    log.extend(subscription(0, 0, "sensor_gyro"));
    log.extend(data(0, &reading(20_050_000, 10, [10.0, 0.0, -10.0], 40.0, 0)));
    let outcome = read_plainly(&log);
    assert_eq!(outcome.samples.gyroscope, expected(0, 11).gyroscope);
    assert_eq!(
        outcome.warnings(),
        ["a.ulg has 2 definitions that are none or contradict earlier ones: they are passed \
             over"]
    );
}

#[test]
fn appended_data_follows_a_message_that_was_cut() {
    let first = plain(1, 10);
    for cut in 0..40 {
        let edge = first.len() + cut;
        let mut log = first.clone();
        log.extend(&data(0, &reading(0, 10, [0.0; 3], 40.0, 0))[..cut]);
        log.extend(line("hard fault"));
        log.extend(data(0, &reading(20_050_000, 10, [10.0, 0.0, -10.0], 40.0, 0)));
        let marked = flags(&[edge as u64]);
        log[16..16 + marked.len()].copy_from_slice(&marked);
        let outcome = read_plainly(&log);
        assert_eq!(outcome.samples.gyroscope, expected(0, 11).gyroscope, "{cut}");
        let warnings = outcome.warnings();
        assert_eq!(warnings.len(), usize::from(cut > 0), "{cut}: {warnings:?}");
        assert!(warnings.iter().all(|w| w.contains("before data was appended to it")));
    }
}

#[test]
fn a_feature_that_must_be_understood_is_refused() {
    let mut log = plain(1, 10);
    log[16 + 3 + 9] = 4;
    let (code, text) = refusal(&log, &ReadOptions::default());
    assert_eq!(code, 1);
    assert!(text.starts_with("a.ulg uses a feature of ULog newer than this program"), "{text}");
}
