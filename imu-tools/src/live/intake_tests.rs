//! Bytes to samples: what is found out, what waits, what is refused.

use super::*;
use crate::live::clock::Taken;
use crate::live::protocol::Encoder;
use crate::live::{Kind, Message, Ticks};

/// Frames of our own at 1 kHz.
fn bytes(range: std::ops::Range<u64>) -> Vec<u8> {
    let (mut bytes, mut encoder) = (Vec::new(), Encoder::new(Protocol::ImuFrame));
    for number in range {
        let ticks = Ticks { value: number * 1000, per_second: 1_000_000, wraps_at: None };
        let message = Message {
            gyroscope: Some([number as f64; 3]),
            accelerometer: Some([0.0, 0.0, 9.75]),
            kind: Kind::Rates,
            ticks: Some(ticks),
            ..Message::default()
        };
        encoder.encode(&message, &mut bytes);
    }
    bytes
}

#[test]
fn the_protocol_is_found_and_nothing_of_the_first_bytes_is_lost() {
    let bytes = bytes(0..5000);
    let mut intake = Intake::new("it", None, &ReadOptions::default()).unwrap();
    let mut steps = Vec::new();
    let length = bytes.len() / 5000;
    for (number, piece) in bytes.chunks(length * 16).enumerate() {
        let arrival_ns = 1_000_000_000 + (number as i64 + 1) * 16_000_000;
        intake.feed(arrival_ns, piece, &mut steps).unwrap();
    }
    intake.finish(&mut steps).unwrap();
    let blocks = steps.iter().map(|step| match step {
        Step::Samples(block, _) => block,
        Step::Restart => panic!("nothing began anew"),
    });
    let values: Vec<f64> =
        blocks.flat_map(|block| &block.gyroscope).map(|sample| sample.value[0]).collect();
    assert_eq!(values, (0..5000).map(f64::from).collect::<Vec<_>>());
    let mut link = Link::default();
    intake.tell(&mut link);
    assert_eq!((link.protocol, link.refused, link.messages), (Some("imu-frame"), 0, 5000));
    assert!((link.clock.unwrap().rate_hz - 1000.0).abs() < 1.0);
}

/// Feeds frames that were sent at 1 kHz, in bursts of 16 ms; ticks begin at `boot`.
fn feed(intake: &mut Intake, sent: std::ops::Range<u64>, boot: u64, to: &mut Vec<Step>) {
    let (from, length) = (sent.start, bytes(0..1).len());
    let frames = bytes(sent.start - boot..sent.end - boot);
    for (number, piece) in frames.chunks(length * 16).enumerate() {
        let arrival_ns = (from as i64 + 16 * (number as i64 + 1)) * 1_000_000;
        intake.feed(1_000_000_000 + arrival_ns, piece, to).unwrap();
    }
}

/// Stamps of all samples, and how often it began anew.
fn stamps(steps: &[Step]) -> (Vec<i64>, usize) {
    let blocks = steps.iter().filter_map(|step| match step {
        Step::Samples(block, _) => Some(block),
        Step::Restart => None,
    });
    let stamps: Vec<i64> = blocks.flat_map(|block| &block.gyroscope).map(|s| s.stamp_ns).collect();
    (stamps, steps.iter().filter(|step| matches!(step, Step::Restart)).count())
}

#[test]
fn behind_a_hang_up_ticks_tell_whether_the_sensor_went_on() {
    // It comes back 7 s later: having gone on, or booted a second ago.
    for (boot, restarts) in [(0, 0), (11_008, 1)] {
        let mut intake =
            Intake::new("it", Some(Protocol::ImuFrame), &ReadOptions::default()).unwrap();
        let mut steps = Vec::new();
        feed(&mut intake, 0..5008, 0, &mut steps);
        intake.reopened(&mut steps);
        feed(&mut intake, 12_000..17_008, boot, &mut steps);
        intake.finish(&mut steps).unwrap();
        let (stamps, began) = stamps(&steps);
        assert_eq!((stamps.len(), began), (10_016, restarts));
        // Ticks that went on measure the gap; else it is known to a burst, 16 ms.
        let gap_ns = stamps[5008] - stamps[5007];
        let within_ns = if restarts == 0 { 50_000 } else { 16_000_000 };
        assert!((gap_ns - 6_993_000_000).abs() <= within_ns, "{gap_ns}");
    }
}

#[test]
fn a_checkpoint_while_samples_are_held_back_is_resumed_with_a_gap_and_no_sample_twice() {
    use crate::calibrate::Options;
    use crate::live::session::{Before, Session};
    let (protocol, options) = (Some(Protocol::ImuFrame), Options::default());
    let take = |session: &mut Session, steps: &mut Vec<Step>| {
        for step in steps.drain(..) {
            match step {
                Step::Samples(mut block, _) => session.take(&mut block),
                Step::Restart => session.restart(),
            }
        }
    };
    let mut intake = Intake::new("it", protocol, &ReadOptions::default()).unwrap();
    let (mut session, mut steps) = (Session::new("it", &options), Vec::new());
    feed(&mut intake, 0..4000, 0, &mut steps);
    // It booted: the last second is held back until its clock is known, when the program is killed.
    feed(&mut intake, 4000..4992, 4000, &mut steps);
    take(&mut session, &mut steps);
    let bytes = session.to_bytes(false).unwrap();
    let mut session = Session::resume("it", &options, &bytes, Before::IsPast).unwrap();
    let mut intake = Intake::new("it", protocol, &ReadOptions::default()).unwrap();
    feed(&mut intake, 6000..10_000, 4000, &mut steps);
    intake.finish(&mut steps).unwrap();
    take(&mut session, &mut steps);
    let view = session.view(&Link::default());
    let stamps = view.snapshot.calibration.gyroscope.unwrap().stamps;
    assert_eq!((stamps.samples, stamps.duplicates, stamps.backward), (8000, 0, 0));
    // From sample 3999 to 6000, known to a burst.
    assert!(stamps.missing.abs_diff(2000) <= 16, "{stamps:?}");
}

/// A device that was found at its rate, and is back at another: the session does not end of it.
#[test]
fn bytes_that_are_refused_later_are_told_of_until_others_come() {
    let options = ReadOptions::default();
    let noise: Vec<u8> =
        (0..40_000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let mut intake = Intake::new("it", Some(Protocol::ImuFrame), &options).unwrap();
    let error = intake.feed(0, &noise, &mut Vec::new()).unwrap_err().to_string();
    assert!(
        error.contains("of the bytes of it are no imu-frame: the baud rate is wrong"),
        "{error}"
    );
    let (mut link, mut steps) = (Link::default(), Vec::new());
    intake.tell(&mut link);
    assert_eq!(link.amiss, None, "it is told once");
    let mut intake = Intake::new("it", Some(Protocol::ImuFrame), &options).unwrap();
    feed(&mut intake, 0..5008, 0, &mut steps);
    for (is_noise, amiss) in [(false, false), (true, true), (false, false)] {
        if is_noise {
            intake.feed(7_000_000_000, &noise, &mut steps).unwrap();
        } else {
            feed(&mut intake, 12_000..17_008, 0, &mut steps);
        }
        intake.tell(&mut link);
        assert_eq!(link.amiss.is_some(), amiss, "{link:?}");
    }
}

/// What `intake` says of pieces that came at these times, ns.
fn heard<'a>(
    intake: &mut Intake,
    pieces: impl Iterator<Item = (i64, &'a [u8])>,
) -> (Vec<Step>, LinkClock) {
    let (mut steps, mut link) = (Vec::new(), Link::default());
    pieces.for_each(|(at_ns, piece)| intake.feed(at_ns, piece, &mut steps).unwrap());
    intake.finish(&mut steps).unwrap();
    intake.tell(&mut link);
    (steps, link.clock.unwrap())
}

/// The unit of time is known from the 17th line on; a WitMotion that is opened within a cycle has its first
/// message without a time.
#[test]
fn ticks_count_although_the_first_messages_have_none() {
    let sent = || (0..1000_u64).filter(|k| !(600..650).contains(k));
    let mut text = b"t,gx,gy,gz\n".to_vec();
    let mut witmotion = Vec::new();
    let mut encoder = Encoder::new(Protocol::WitMotion);
    for k in sent() {
        text.extend_from_slice(format!("{},0.1,0.2,{}\n", 5000 + k * 10, k % 7).as_bytes());
        let ticks = Ticks { value: k * 10_000, per_second: 1_000_000, wraps_at: None };
        let message = Message {
            gyroscope: Some([0.1, 0.2, 0.3]),
            accelerometer: Some([0.0, 0.0, 9.75]),
            ticks: Some(ticks),
            ..Message::default()
        };
        encoder.encode(&message, &mut witmotion);
    }
    let lines: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').skip(1).collect();
    let cycles: Vec<&[u8]> = witmotion.chunks(33).collect();
    let at = |k: u64| (k as i64 * 10 / 16 + 1) * 16_000_000;
    for (protocol, first, messages) in [
        (Protocol::Text, &b"t,gx,gy,gz\n"[..], lines),
        (Protocol::WitMotion, &cycles[0][11..], cycles.clone()),
    ] {
        let mut intake = Intake::new("it", Some(protocol), &ReadOptions::default()).unwrap();
        let messages = sent().map(at).zip(messages);
        let begun = std::iter::once((0, first)).chain(messages);
        let clock = heard(&mut intake, begun).1;
        assert_eq!((clock.lost, clock.lost_is_certain), (50, true), "{protocol}");
    }
}

#[test]
fn what_a_hang_up_cut_is_not_joined_to_what_comes_behind_it() {
    let columns = Some("gx,gy,gz".into());
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let mut intake = Intake::new("it", None, &options).unwrap();
    let mut steps = Vec::new();
    intake.feed(1_000_000, b"\n1,2,3\n4,5,", &mut steps).unwrap();
    intake.reopened(&mut steps);
    intake.feed(2_000_000, b"66\n7,8,9\n", &mut steps).unwrap();
    intake.finish(&mut steps).unwrap();
    let blocks = steps.iter().filter_map(|step| match step {
        Step::Samples(block, _) => Some(block),
        Step::Restart => None,
    });
    let values: Vec<_> = blocks.flat_map(|b| &b.gyroscope).map(|s| s.value).collect();
    assert_eq!(values, [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0]]);
}

#[test]
fn lines_of_which_nobody_says_what_they_are_end_with_the_way_out() {
    let lines = b"\n1,2,3,4,5,6\n".repeat(6000);
    let mut intake = Intake::new("tty", None, &ReadOptions::default()).unwrap();
    // It is told of soon.
    let (first, lines) = lines.split_at(8192);
    for piece in first.chunks(4096) {
        intake.feed(0, piece, &mut Vec::new()).unwrap();
    }
    let mut link = Link::default();
    intake.tell(&mut link);
    let amiss = link.amiss.unwrap();
    assert!(amiss.starts_with("text comes, and in it no sample yet: say"), "{amiss}");
    let mut fed = lines.chunks(4096).map(|piece| intake.feed(0, piece, &mut Vec::new()));
    let error = fed.find_map(Result::err).unwrap().to_string();
    assert!(
        error.starts_with("tty sends text, and none of 6") && error.contains("--columns"),
        "{error}"
    );
}

#[test]
fn increments_become_means() {
    let over_s = Some(0.001);
    let kinds = [Kind::Rates, Kind::Increments { over_s }];
    let mut steps = Vec::new();
    let mut pieces = Pieces::new(&mut steps);
    for (stamp_ns, kind) in (0..).zip(kinds) {
        let message = Message { gyroscope: Some([0.25; 3]), kind, ..Message::default() };
        let taken = Taken { stamp_ns, interval_s: 1.0, lost: 0, certain: true, restart: false };
        pieces.take(&message, &taken);
    }
    pieces.close();
    let told = steps.iter().map(|step| match step {
        Step::Samples(block, samples) => (block.gyroscope[0].value[0], *samples),
        Step::Restart => panic!("nothing began anew"),
    });
    let wanted = [(0.25, SampleKind::Instantaneous), (250.0, SampleKind::Mean)];
    assert_eq!(told.collect::<Vec<_>>(), wanted);
}

#[test]
fn noise_is_refused_with_its_first_bytes() {
    let noise: Vec<u8> =
        (0..20_000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let mut intake = Intake::new("tty", None, &ReadOptions::default()).unwrap();
    let error = intake.feed(0, &noise, &mut Vec::new()).unwrap_err().to_string();
    assert!(
        error.contains("what tty sends is of no known protocol (") && error.contains("00 "),
        "{error}"
    );
    let protocol = Some(Protocol::WitMotion);
    let mut intake = Intake::new("tty", protocol, &ReadOptions::default()).unwrap();
    let error = intake.feed(0, &noise, &mut Vec::new()).unwrap_err().to_string();
    assert!(error.contains("% of the bytes of tty are no witmotion: the baud rate"), "{error}");
    let refused = |protocol, bytes| refused(protocol, &ReadOptions::default(), bytes).unwrap();
    assert!(refused(None, &noise) > 0.5 && refused(protocol, &noise) > 0.5);
    let frames = bytes(0..100);
    assert_eq!(refused(None, &frames), 0.0);
    assert_eq!(refused(Some(Protocol::ImuFrame), &frames), 0.0);
    assert!(refused(protocol, &frames) > 0.5);
}
