//! Edges of the clock: counters that wrap, stop or begin anew, silence, pauses, few messages. How
//! well it does over minutes is measured in `tests/src/arrivals.rs`.

use super::*;
use crate::live::{Count, Ticks};

const MS: i64 = 1_000_000;

fn with_ticks(value: u64, wraps_at: Option<u64>) -> Message {
    let ticks = Some(Ticks { value, per_second: 1_000_000, wraps_at });
    Message { ticks, ..Message::default() }
}

fn with_count(value: u64, wraps_at: u64) -> Message {
    let count = Some(Count { value: (value % wraps_at) as u32, wraps_at });
    Message { count, ..Message::default() }
}

/// What a new clock makes of arrivals and messages.
fn taken(messages: impl IntoIterator<Item = (i64, Message)>) -> (Clock, Vec<Taken>) {
    let (mut clock, mut all) = (Clock::default(), Vec::new());
    for (arrival_ns, message) in messages {
        clock.take(arrival_ns, &message, |_, taken| all.push(taken));
    }
    clock.finish(|_, taken| all.push(taken));
    assert!(all.windows(2).all(|w| w[0].stamp_ns < w[1].stamp_ns), "stamps go on");
    (clock, all)
}

/// Read when a timer of 16 ms fires.
fn read(sent_ns: i64) -> i64 {
    (sent_ns / (16 * MS) + 1) * 16 * MS
}

fn lost(taken: &[Taken]) -> Vec<(usize, u64)> {
    taken.iter().enumerate().filter(|(_, t)| t.lost > 0).map(|(i, t)| (i, t.lost)).collect()
}

#[test]
fn no_message_and_one_message() {
    assert!(taken([]).1.is_empty());
    let (clock, one) = taken([(77, Message::default())]);
    assert_eq!(one.iter().map(|t| t.stamp_ns).collect::<Vec<_>>(), [77]);
    assert_eq!((clock.status().lost, clock.status().restarts), (0, 0));
}

#[test]
fn ticks_wrap_where_they_say_and_losses_are_seen() {
    // 100 Hz by a clock of 24 bits, which wraps every 16.8 s; 7 messages are lost.
    let sent = (0..5000_i64).filter(|k| !(3000..3007).contains(k));
    let wrap = 1 << 24;
    let (clock, all) =
        taken(sent.map(|k| (read(k * 10 * MS), with_ticks(k as u64 * 10_000 % wrap, Some(wrap)))));
    assert_eq!(lost(&all), [(3000, 7)]);
    let status = clock.status();
    assert_eq!((status.source, status.restarts, status.lost), (Source::Ticks, 0, 7));
    assert!(status.lost_is_certain && all[3000].certain);
    // An increment behind a gap is of one period.
    assert!((all[3000].interval_s - 0.01).abs() < 1e-5, "{:?}", all[3000]);
    assert!((all[3000].stamp_ns - all[2999].stamp_ns - 80 * MS).abs() < MS / 10);
}

#[test]
fn ticks_coarser_than_messages() {
    // 400 Hz by a clock of milliseconds: steps of 2 and 3. The mean over 2 s is known to a tick of 2000.
    let ticks = |k: i64| Ticks { value: (k as u64 * 5) / 2, per_second: 1000, wraps_at: None };
    let message = |k| Message { ticks: Some(ticks(k)), ..Message::default() };
    let sent = (0..8000_i64).filter(|k| !(5000..5003).contains(k));
    let (clock, all) = taken(sent.map(|k| (read(k * 5 * MS / 2), message(k))));
    assert_eq!(lost(&all), [(5000, 3)]);
    let status = clock.status();
    assert!(status.lost_is_certain && (status.rate_hz - 400.0).abs() < 0.4, "{status:?}");
    // A reading is rounded by less than a millisecond: over 800 messages and more that is 1.3 µs a message.
    let unit = |taken: &Taken| (taken.interval_s - 0.0025).abs();
    let worst = all.iter().map(unit).fold(0.0, f64::max);
    assert!(worst < 1.3e-6, "{worst}");
    // Two messages of each instant: their number is the rate.
    let ticks = |k: i64| Ticks {
        value: k as u64 / 2 * 10_000,
        ..Ticks { per_second: 1_000_000, ..ticks(0) }
    };
    let message = |k| Message { ticks: Some(ticks(k)), ..Message::default() };
    let (clock, all) = taken((0..8000).map(|k| (read(k * 5 * MS), message(k))));
    assert_eq!((lost(&all), clock.status().restarts), (vec![], 0));
    assert!((clock.status().rate_hz - 200.0).abs() < 0.2, "{:?}", clock.status());
}

#[test]
fn messages_without_ticks_are_counted_once() {
    for wraps_at in [None, Some(1 << 24)] {
        let (clock, all) = taken((0..1000_i64).map(|k| {
            let message = with_ticks(k as u64 * 10_000, wraps_at);
            let silent = (500..503).contains(&k) || k == 700;
            (read(k * 10 * MS), if silent { Message::default() } else { message })
        }));
        assert_eq!((clock.status().source, clock.status().restarts), (Source::Ticks, 0));
        assert_eq!(lost(&all), []);
        let whole = all[999].stamp_ns - all[0].stamp_ns;
        assert!((whole - 9990 * MS).abs() < 10 * MS, "{whole}");
    }
}

#[test]
fn a_reboot_is_a_restart_whatever_the_counter() {
    for wraps_at in [None, Some(1 << 32)] {
        let before = (0..1000_i64).map(|k| (read(k * 10 * MS), k + 100_000));
        let after = (0..1000_i64).map(|k| (read(k * 10 * MS + 12_000 * MS), k));
        let all = before.chain(after);
        let (clock, all) = taken(all.map(|(at, k)| (at, with_ticks(k as u64 * 10_000, wraps_at))));
        assert_eq!(clock.status().restarts, 1);
        assert!(all[1000].restart && !all[1000].certain);
        // 12 s after the first message, within the 16 ms that a message may wait.
        let gap = all[1000].stamp_ns - all[0].stamp_ns;
        assert!((gap - 12_000 * MS).abs() <= 16 * MS, "{gap}");
        assert_eq!(all.len(), 2000);
    }
}

#[test]
fn a_reboot_in_the_first_two_seconds() {
    let value = |k: i64| if k < 50 { k + 100_000 } else { k - 50 };
    let all =
        (0..1000_i64).map(|k| (read(k * 10 * MS), with_ticks(value(k) as u64 * 10_000, None)));
    let (clock, all) = taken(all);
    assert_eq!((all.len(), clock.status().restarts), (1000, 1));
    assert!(all[50].restart);
}

#[test]
fn a_small_counter_in_a_second_of_silence() {
    // 1 kHz and a count of 8 bits: 1000 lost messages are three rounds and 232.
    let sent = (0..20_000_i64).filter(|k| !(8000..9000).contains(k));
    let (clock, all) = taken(sent.map(|k| (read(k * MS), with_count(k as u64, 256))));
    assert_eq!(lost(&all), [(8000, 1000)]);
    assert!(clock.status().lost_is_certain);
}

#[test]
fn a_pause_of_the_reader_loses_nothing() {
    // What was sent in three seconds is read at once; every counter, and none.
    let at = |k: i64| {
        let at = read(k * 10 * MS);
        if (30_000..33_000).contains(&(at / MS)) { 33_000 * MS } else { at }
    };
    let kinds: [fn(u64) -> Message; 3] =
        [|k| with_ticks(k * 10_000, None), |k| with_count(k, 256), |_| Message::default()];
    for kind in kinds {
        let (clock, all) = taken((0..8000_i64).map(|k| (at(k), kind(k as u64))));
        assert_eq!(lost(&all), [], "{:?}", clock.status().source);
        assert_eq!(clock.status().restarts, 0);
        let steps = all.windows(2).map(|w| w[1].stamp_ns - w[0].stamp_ns);
        assert!(
            steps.into_iter().all(|s| (s - 10 * MS).abs() < MS / 50),
            "1000 ppm, and the rate's"
        );
    }
}

#[test]
fn a_reader_that_begins_late_does_not_hurry_the_sensors_clock() {
    // 8 kHz by ticks: what was sent in the first 0.6 s is read within 22 ms.
    let at = |k: i64| match k * 125_000 {
        sent if sent < 600 * MS => 600 * MS + (sent / (28 * MS) + 1) * MS,
        sent => read(sent).max(623 * MS),
    };
    let (clock, all) = taken((0..80_000).map(|k| (at(k), with_ticks(k as u64 * 125, None))));
    assert_eq!((lost(&all), clock.status().restarts), (vec![], 0));
    let mut steps = all.windows(2).map(|w| w[1].stamp_ns - w[0].stamp_ns);
    assert!(steps.all(|s| (s - 125_000).abs() < 250), "1000 ppm, and the rate's");
}

#[test]
fn what_waited_for_seconds_begins_anew_a_few_times() {
    // 8 kHz; the reader sleeps for 3 s, then has all that waited within 0.2 s: anew once a second of it at most.
    let sent = (0..80_000_i64).map(|k| (k, k * MS / 8));
    let arrivals = sent.map(|(k, t)| (k, if t < 3200 * MS { 3000 * MS + t / 16 } else { t }));
    let (clock, _) = taken(arrivals.map(|(k, t)| (t, with_ticks(k as u64 * 125, None))));
    let status = clock.status();
    assert!(status.lost == 0 && status.restarts <= 3, "{status:?}");
}

/// Increments are divided by it: one message too many in a mean over two seconds would be 50 mm/s² of gravity.
#[test]
fn an_interval_is_that_of_the_readings_from_the_first_message_on() {
    // 100 Hz by ticks of 0.1 ms, as Xsens has them, of a clock that is 200 ppm slow, read when a timer fires.
    let message = |k: i64| {
        let ticks = Ticks { value: k as u64 * 100, per_second: 10_000, wraps_at: Some(1 << 32) };
        Message { ticks: Some(ticks), ..Message::default() }
    };
    let (_, all) = taken((0..3000).map(|k| (read(k * (10 * MS + 2_000)), message(k))));
    assert!(
        all.iter().all(|taken| (taken.interval_s - 0.01).abs() < 1e-12),
        "it is the sensor's own"
    );
}

/// Of a text whose milliseconds were taken for nanoseconds, say: stamps are right, and so must increments be.
#[test]
fn an_interval_is_by_the_host_where_the_ticks_are_of_another_unit() {
    let message = |k: i64| with_ticks(k as u64 * 10, None);
    let (clock, all) = taken((0..3000).map(|k| (read(k * 10 * MS), message(k))));
    assert_eq!((clock.status().source, clock.status().clock_ppm), (Source::Ticks, None));
    // Bursts of 16 ms show it over two seconds to 1 %, the median of slopes far better.
    assert!(all.iter().all(|taken| (taken.interval_s - 0.01).abs() < 1e-4), "{:?}", all[0]);
    // Nor is it believed behind a restart that is too short to show it.
    let behind =
        (3000..3010).map(|k| (read(k * 10 * MS), with_ticks(k as u64 * 10 - 30_000, None)));
    let (_, all) = taken((0..3000).map(|k| (read(k * 10 * MS), message(k))).chain(behind));
    assert!(all[3000].restart && (all[3005].interval_s - 0.01).abs() < 1e-4, "{:?}", all[3005]);
}

/// A resonator of ceramic, say: by that the sensor integrates.
#[test]
fn an_interval_is_the_sensors_own_however_far_off_its_clock_is() {
    let message = |k: i64| with_ticks(k as u64 * 10_000, None);
    let (clock, all) = taken((0..3000).map(|k| (read(k * 101 * MS / 10), message(k))));
    assert!(all.iter().all(|taken| (taken.interval_s - 0.01).abs() < 1e-12), "{:?}", all[0]);
    assert!((clock.status().clock_ppm.unwrap() + 9901.0).abs() < 50.0, "{:?}", clock.status());
}

/// As where MAVLink's HIGHRES_IMU comes no more and RAW_IMU takes its place: both count microseconds of one clock.
#[test]
fn another_stream_is_a_restart_and_its_rate_no_loss() {
    let first = (0..4000_i64).map(|k| (read(k * 5 * MS), with_ticks(k as u64 * 5_000, None)));
    let second = (1050..2050_i64).map(|k| {
        let message = with_ticks(k as u64 * 20_000, None);
        (read(k * 20 * MS), Message { stream: 1, ..message })
    });
    for has_ticks in [true, false] {
        let bare = |m: Message| Message { ticks: m.ticks.filter(|_| has_ticks), ..m };
        let both = first.clone().chain(second.clone());
        let (clock, all) = taken(both.map(|(at, message)| (at, bare(message))));
        let status = clock.status();
        assert_eq!((all.len(), status.restarts), (5000, 1));
        assert!((status.rate_hz - 50.0).abs() < 0.05, "{status:?}");
        // One second without a message lies between them: of which stream messages were lost, nobody knows.
        assert_eq!(lost(&all), []);
        assert!(all[4000].restart && !all[4000].certain);
        let gap = all[4000].stamp_ns - all[3999].stamp_ns;
        assert!((gap - 1005 * MS).abs() <= 21 * MS, "{gap}");
    }
}

/// An autopilot sends its messages one after the other, the best of them wherever it stands.
#[test]
fn a_stream_that_is_left_in_the_first_moments_leaves_nothing() {
    let better = (0..1000_i64).map(|k| {
        let message = with_ticks(k as u64 * 20_000 + 3_000, None);
        (read(k * 20 * MS), Message { stream: 1, ..message })
    });
    for (worse, began) in [(2, 0), (40, 1)] {
        let first = (-worse..0).map(|k| (read(k * 20 * MS), with_ticks(k as u64, Some(1 << 32))));
        let (clock, all) = taken(first.chain(better.clone()));
        let status = clock.status();
        assert_eq!((status.restarts, status.lost), (began, 0), "{worse}");
        assert_eq!(all.len() as i64, 1000 + if began > 0 { worse } else { 0 });
        assert!(!all[0].restart && (status.rate_hz - 50.0).abs() < 0.05, "{status:?}");
    }
}

/// A device may hand over at once what it gathered while the port was closed, or all that it lost power with.
#[test]
fn a_port_that_was_opened_again_begins_anew_without_a_clock() {
    for (reopened, restarts) in [(false, 0), (true, 1)] {
        let (mut clock, mut all) = (Clock::default(), Vec::new());
        for k in 0..8000_i64 {
            if reopened && k == 4000 {
                clock.reopened(|_, taken| all.push(taken));
            }
            let sent = k * 10 * MS;
            let waited = (40_000 * MS..43_000 * MS).contains(&sent);
            let at = if waited { 43_000 * MS } else { read(sent) };
            clock.take(at, &Message::default(), |_, taken| all.push(taken));
        }
        assert_eq!(clock.status().restarts, restarts);
        assert!(all.windows(2).all(|w| w[0].stamp_ns < w[1].stamp_ns));
    }
}

#[test]
fn a_sensor_that_pauses_without_a_clock_leaves_one_gap() {
    for pause in [700, 3000, 9000] {
        // 100 Hz; nothing is sent for a while, and nothing waited.
        let sent = |k: i64| k * 10 * MS + if k < 4000 { 0 } else { pause * MS };
        let (clock, all) = taken((0..8000).map(|k| (read(sent(k)), Message::default())));
        let found = lost(&all);
        // Bursts of 16 ms hide a message or two.
        assert!(found.len() == 1 && found[0].0 == 4000, "{pause}: {found:?}");
        assert!(found[0].1.abs_diff(pause as u64 / 10) <= 3, "{pause}: {found:?}");
        let status = clock.status();
        assert!(status.restarts == 1 && (status.rate_hz - 100.0).abs() < 0.1, "{status:?}");
    }
}

#[test]
fn hours_of_silence() {
    let hours = 7 * 3600 * 1000 * MS;
    let at = |k: i64| if k < 4000 { k * 10 * MS } else { k * 10 * MS + hours };
    // The sensor's clock went on, and round five times.
    let ticks = |k: i64| with_ticks((at(k) / 1000) as u64 % (1 << 32), Some(1 << 32));
    let (clock, all) = taken((0..8000).map(|k| (read(at(k)), ticks(k))));
    assert_eq!(clock.status().restarts, 0);
    assert_eq!(lost(&all), [(4000, 7 * 360_000)]);
    // Without one nothing tells how many were missed.
    let (clock, all) = taken((0..8000).map(|k| (read(at(k)), Message::default())));
    assert_eq!(clock.status().restarts, 1);
    assert!(all[4000].restart && !all[4000].certain);
    assert!(all[4000].lost.abs_diff(7 * 360_000) <= 3, "{:?}", all[4000]);
}

#[test]
fn a_host_that_slept_while_its_clock_stood_still() {
    let ticks = |k: i64| if k < 4000 { k * 10_000 } else { k * 10_000 + 3_600_000_000 };
    let all = (0..8000).map(|k| (read(k * 10 * MS), with_ticks(ticks(k) as u64, None)));
    let (clock, _) = taken(all);
    assert_eq!(clock.status().restarts, 1);
}

#[test]
fn nonsense_does_no_harm() {
    let mut state = 1_u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 11
    };
    let (mut clock, mut last, mut count) = (Clock::default(), i64::MIN, 0);
    for _ in 0..20_000 {
        let ticks = Ticks {
            value: random() << (random() % 12),
            per_second: 1 + random() % 3,
            wraps_at: Some(random() % 3),
        };
        let wraps_at = random() % 3;
        let message = Message {
            ticks: (random() % 3 > 0).then_some(ticks),
            count: Some(Count { value: random() as u32, wraps_at }),
            ..Message::default()
        };
        clock.take((random() as i64).wrapping_sub(1 << 52), &message, |_, taken| {
            assert!(taken.stamp_ns > last || taken.stamp_ns == i64::MAX);
            last = taken.stamp_ns;
            count += 1;
        });
    }
    clock.finish(|_, _| count += 1);
    assert_eq!(count, 20_000);
}
