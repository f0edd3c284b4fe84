//! Streams whose truth is known: each reading carries the number of its true grid point.

use super::*;
use proptest::prelude::*;

const PERIOD: i64 = 5_000_000;
const START: i64 = 1_700_000_000_000_000_000;

/// A generator for stamps (xorshift64*): the statistics here need no better one.
struct Random(u64);

impl Random {
    /// Uniform in [0, 1).
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal, by the sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

struct Outcome {
    summary: Summary,
    /// Place minus true number, for each reading.
    offsets: Vec<i64>,
    restarts: usize,
}

/// Feeds (true number, stamp) in pieces of `piece` and notes where readings are placed.
fn run(stream: &[(i64, i64)], piece: usize) -> Outcome {
    let mut timeline = Timeline::new();
    let (mut place, mut offsets, mut restarts) = (0_i64, Vec::new(), 0);
    let mut take = |event: Event<'_>| match event {
        Event::Values(values) => {
            for value in values {
                offsets.push(place - value[0] as i64);
                place += 1;
            }
        }
        Event::Missing(count) => place += count as i64,
        Event::Restart => restarts += 1,
    };
    let samples: Vec<Sample> =
        stream.iter().map(|&(i, stamp_ns)| Sample { stamp_ns, value: [i as f64; 3] }).collect();
    for piece in samples.chunks(piece) {
        timeline.push(piece, &mut take);
    }
    let summary = timeline.finish(&mut take);
    assert_eq!(summary.samples as usize, offsets.len());
    Outcome { summary, offsets, restarts }
}

/// `count` samples with stamps `PERIOD·i + late(i)`, of which those that `lost` names are left out.
fn stream(
    count: i64,
    mut late: impl FnMut(i64) -> f64,
    mut lost: impl FnMut(i64) -> bool,
) -> Vec<(i64, i64)> {
    let all = (0..count).map(|i| (i, START + i * PERIOD + late(i).round() as i64));
    all.filter(|&(i, _)| !lost(i)).collect()
}

/// A summary without its lists.
fn told(summary: &Summary) -> String {
    let (gaps, clock_steps) = (Vec::new(), Vec::new());
    let steps = summary.clock_steps.len();
    format!("{steps} steps, {:?}", Summary { gaps, clock_steps, ..summary.clone() })
}

fn assert_exact(outcome: &Outcome, missing: u64) {
    let wrong = outcome.offsets.iter().position(|&o| o != 0);
    assert_eq!(wrong, None, "{}", told(&outcome.summary));
    assert_eq!(outcome.summary.missing, missing);
    assert_eq!(outcome.restarts, 0);
}

fn assert_rate(outcome: &Outcome, relative: f64) {
    let rate = outcome.summary.rate_hz;
    assert!((rate / 200.0 - 1.0).abs() < relative, "{rate}");
}

#[test]
fn few_samples() {
    for n in 0..6 {
        let outcome = run(&stream(n, |_| 0.0, |_| false), 1);
        assert_exact(&outcome, 0);
        assert_eq!(outcome.summary.rate_hz > 0.0, n >= 2);
        if n >= 2 {
            assert_rate(&outcome, 1e-9);
            assert!((outcome.summary.span_s - (n - 1) as f64 * 0.005).abs() < 1e-9);
        }
    }
    let outcome = run(&stream(4, |_| 0.0, |i| i == 2), 1);
    assert_exact(&outcome, 1);
}

#[test]
fn samples_without_stamps_are_handed_on() {
    let zeros: Vec<_> = (0..10_000).map(|i| (i, 0)).collect();
    let outcome = run(&zeros, 777);
    assert_exact(&outcome, 0);
    assert_eq!((outcome.summary.rate_hz, outcome.summary.duplicates), (0.0, 9_999));
}

#[test]
fn one_lost_sample_anywhere() {
    for lost in [1, 2, 5, 1000, 4094, 4095, 4096, 4097, 5000, 9_998] {
        let outcome = run(&stream(10_000, |_| 0.0, |i| i == lost), 64);
        assert_exact(&outcome, 1);
        assert_eq!(outcome.summary.gaps.len(), 1);
        let at_s = outcome.summary.gaps[0].at_s;
        assert!((at_s - (lost - 1) as f64 * 0.005).abs() < 1e-6, "{at_s}");
        assert_rate(&outcome, 1e-9);
    }
}

#[test]
fn a_percent_lost_and_a_hole_of_a_minute() {
    // Jitter of 0.2 ms (normal): ±0.5 periods is 12 standard deviations away.
    let mut random = Random(1);
    let mut loss = Random(2);
    let hole = 100_000..112_000;
    let mut missing = 0;
    let stream = stream(
        300_000,
        |_| 2e5 * random.normal(),
        |i| {
            let lost = i > 0 && i < 299_999 && (hole.contains(&i) || loss.next() < 0.01);
            missing += u64::from(lost);
            lost
        },
    );
    let outcome = run(&stream, 4096);
    assert_exact(&outcome, missing);
    assert_rate(&outcome, 1e-6);
    assert!(outcome.summary.gap_count > Summary::GAPS_LISTED as u64);
    assert_eq!(outcome.summary.gaps.len(), Summary::GAPS_LISTED);
    let jitter = outcome.summary.jitter_s;
    assert!((jitter / 2e-4 - 1.0).abs() < 0.02, "{jitter}");
}

#[test]
fn jitter_of_two_periods_is_no_gap() {
    for seed in 1..=10 {
        let mut random = Random(seed);
        let outcome = run(&stream(60_000, |_| 1e7 * (2.0 * random.next() - 1.0), |_| false), 4096);
        assert_exact(&outcome, 0);
        assert_rate(&outcome, 1e-5);
        assert!(outcome.summary.backward > 10_000);
        // Uniform in ±10 ms: 10/√3.
        assert!((outcome.summary.jitter_s * 1e3 - 5.77).abs() < 0.1, "{:?}", outcome.summary);
    }
}

#[test]
fn bunches_are_no_gaps() {
    for seed in 1..=10 {
        // A bus is asked every 16 to 20 ms and hands over what has come, 20 µs apart.
        let mut random = Random(seed);
        let (mut poll, mut sent) = (0.0, 0.0);
        let late = |i: i64| {
            let taken = (i * PERIOD) as f64;
            while poll < taken {
                poll += 1.6e7 + 4e6 * random.next();
            }
            sent = if poll > sent { poll } else { sent + 2e4 };
            sent - taken
        };
        let outcome = run(&stream(60_000, late, |_| false), 1000);
        assert_exact(&outcome, 0);
        assert_rate(&outcome, 1e-5);
    }
}

#[test]
fn stalls_are_no_gaps() {
    // Now and then nothing comes for up to half a second, and then all at once.
    let mut random = Random(3);
    let mut free = 0.0;
    let late = |i: i64| {
        let taken = (i * PERIOD) as f64;
        if random.next() < 1e-3 {
            free = taken + 5e8 * random.next();
        }
        free = if free > taken { free + 1e4 } else { taken };
        free - taken
    };
    let outcome = run(&stream(100_000, late, |_| false), 4096);
    assert_exact(&outcome, 0);
}

#[test]
fn a_hole_is_counted_to_the_sample_in_jitter_of_a_period() {
    for seed in 1..=10 {
        let mut random = Random(seed);
        let late = |_| 2.5e6 * (2.0 * random.next() - 1.0);
        let outcome = run(&stream(60_000, late, |i| (30_000..42_000).contains(&i)), 4096);
        assert_eq!(outcome.summary.missing, 12_000);
        assert_eq!(outcome.offsets.last(), Some(&0));
    }
}

#[test]
fn a_drifting_clock_makes_no_gaps() {
    // ±50 ppm in ten minutes: the stamps move by 4.8 ms to both sides.
    let mut random = Random(4);
    let late = |i: i64| {
        let phase = (i as f64) * 0.005 / 600.0 * std::f64::consts::TAU;
        50e-6 * 600e9 / std::f64::consts::TAU * (1.0 - phase.cos()) + 1e5 * random.normal()
    };
    let outcome = run(&stream(720_000, late, |i| i == 500_000), 4096);
    assert_exact(&outcome, 1);
}

#[test]
fn wild_stamps_do_no_harm() {
    for wild in [0, START + 400_000 * PERIOD, START - 3, i64::MAX, i64::MIN] {
        for at in [1, 70, 3000, 6000, 9_990] {
            let mut stream = stream(10_000, |_| 0.0, |_| false);
            stream[at].1 = wild;
            let outcome = run(&stream, 512);
            assert_exact(&outcome, 0);
        }
    }
}

#[test]
fn a_clock_set_back_restarts_and_an_adjustment_does_not() {
    for at in [2000, 6000] {
        let back = |step: i64| -> Vec<_> {
            let stream = stream(10_000, |_| 0.0, |_| false);
            stream.iter().map(|&(i, t)| (i, if i < at { t } else { t - step })).collect()
        };
        let outcome = run(&back(30_000_000_000), 512);
        assert_eq!((outcome.restarts, outcome.summary.missing), (1, 0));
        assert_eq!((outcome.summary.backward, outcome.summary.samples), (1, 10_000));
        assert_rate(&outcome, 1e-9);
        assert!((outcome.summary.span_s - 9_998.0 * 0.005).abs() < 1e-6);
        assert_exact(&run(&back(300_000_000), 512), 0);
    }
}

#[test]
fn a_clock_that_finds_its_date_restarts() {
    let stream = stream(10_000, |_| 0.0, |_| false);
    let dated: Vec<_> =
        stream.iter().map(|&(i, t)| (i, if i < 6000 { t - START } else { t })).collect();
    let outcome = run(&dated, 512);
    assert_eq!((outcome.restarts, outcome.summary.missing), (1, 0));
    let [ClockStep { at_s, by_s }] = outcome.summary.breaks[..] else { panic!() };
    assert!((at_s - 5999.0 * 0.005).abs() < 1e-6 && (by_s / 1.7e9 - 1.0).abs() < 1e-9);
    // The step of 5e17 ns is a double: 64 ns in 20 s are lost at most.
    assert_rate(&outcome, 1e-8);
}

#[test]
fn doubled_samples_are_dropped() {
    let stream = stream(10_000, |_| 0.0, |_| false);
    let doubled: Vec<_> = stream
        .iter()
        .flat_map(|&s| std::iter::repeat_n(s, 1 + usize::from(s.0 % 10 == 0)))
        .collect();
    let outcome = run(&doubled, 512);
    assert_exact(&outcome, 0);
    assert_eq!(outcome.summary.duplicates, 1000);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Clean stamps of any rate: every loss is found, however the stream is cut into pieces.
    #[test]
    fn any_losses_in_clean_stamps(
        rate in 10.0_f64..8000.0,
        holes in prop::collection::vec((1_usize..8000, 1_u64..500), 0..20),
        piece in 1_usize..5000,
    ) {
        let mut lost = vec![false; 8100];
        for (at, length) in holes {
            for hole in lost.iter_mut().take(8000).skip(at).take(length as usize) {
                *hole = true;
            }
        }
        let stamp = |i: usize| START + (i as f64 * 1e9 / rate).round() as i64;
        let stream: Vec<_> =
            (0..8100).filter(|&i| !lost[i]).map(|i| (i as i64, stamp(i))).collect();
        let outcome = run(&stream, piece);
        assert_exact(&outcome, lost.iter().filter(|l| **l).count() as u64);
        prop_assert!((outcome.summary.rate_hz / rate - 1.0).abs() < 1e-6);
    }

    /// Any stamps at all: nothing panics and no reading is lost.
    #[test]
    fn any_stamps(stamps in prop::collection::vec(any::<i64>(), 0..300), near in any::<bool>()) {
        let stamp = |t: i64| if near { t >> 34 } else { t };
        let stream: Vec<_> =
            stamps.iter().enumerate().map(|(i, &t)| (i as i64, stamp(t))).collect();
        let outcome = run(&stream, 7);
        prop_assert_eq!(outcome.offsets.len(), stamps.len());
    }
}

/// The fast way through samples in their place is the slow way, to the bit.
#[test]
fn following_is_accepting() {
    let mut random = Random(5);
    let samples: Vec<Sample> = (0..5000)
        .map(|i| {
            // A lost sample at 2000, which only the slow mean shows.
            let late = 0.35 * PERIOD as f64 * random.normal().clamp(-2.0, 2.0);
            let place = i + i64::from(i >= 2000);
            Sample { stamp_ns: START + place * PERIOD + late as i64, value: [0.0; 3] }
        })
        .collect();
    let mut fast = Grid::new(START, PERIOD as f64 * 1.0001, 0.0, 0.0, 1.0);
    let mut slow = fast.clone();
    let (mut last_ns, mut rest, mut followed) = (i64::MIN, samples.as_slice(), 0);
    while !rest.is_empty() {
        let (taken, after) = rest.split_at(fast.follow(rest, last_ns));
        let slips = taken.iter().map(|s| slow.accept(slow.error(s.stamp_ns))).sum::<u64>();
        assert_eq!((format!("{fast:?}"), slips), (format!("{slow:?}"), 0));
        followed += taken.len();
        rest = after;
        if let Some((sample, after)) = after.split_first() {
            fast.accept(fast.error(sample.stamp_ns));
            slow.accept(slow.error(sample.stamp_ns));
            (rest, last_ns) = (after, sample.stamp_ns);
        }
    }
    assert!((2000..5000).contains(&followed), "{followed}");
}

/// Jitter (rms, ms) and losses of a sensor of 200 Hz: every loss is found, and the rate. Of jitter of
/// a fifth of the period with one sample of twenty lost, the rate to 1e-3.
#[test]
fn losses_in_jitter_are_found() {
    for (jitter_ms, loss) in [(0.5, 0.01), (0.5, 0.05), (1.0, 0.001), (1.0, 0.01), (1.0, 0.05)] {
        for seed in 1..=5 {
            let (mut random, mut losses) = (Random(seed), Random(seed + 100));
            let mut missing = 0;
            let stream = stream(
                60_000,
                |_| 1e6 * jitter_ms * random.normal(),
                |i| {
                    let lost = i > 0 && i < 59_999 && losses.next() < loss;
                    missing += u64::from(lost);
                    lost
                },
            );
            let outcome = run(&stream, 4096);
            if jitter_ms * loss > 0.04 {
                assert_rate(&outcome, 1e-3);
                continue;
            }
            let summary = &outcome.summary;
            let told = told(summary);
            // The ends jitter by 2e-5 of 300 s at most (six standard deviations).
            assert_rate(&outcome, 2e-5);
            assert_eq!((outcome.offsets.last(), outcome.restarts), (Some(&0), 0), "{told}");
            assert_eq!((summary.missing, summary.clock_steps.len()), (missing, 0), "{told}");
            // Near a loss a few are a place off.
            let off = outcome.offsets.iter().filter(|offset| **offset != 0).count();
            assert!(off * 100 < outcome.offsets.len(), "{off}; {told}");
        }
    }
}

/// Stamps in whole milliseconds, or hundredths of a second, of sensors whose period is no whole
/// number of them: nothing is lost, and the rate is that of count and span.
#[test]
fn coarse_stamps_are_no_losses() {
    for (rate, tick) in [
        (119.0, 1_000_000),
        (225.0, 1_000_000),
        (238.0, 1_000_000),
        (300.0, 1_000_000),
        (375.0, 1_000_000),
        (417.0, 1_000_000),
        (560.0, 1_000_000),
        (600.0, 1_000_000),
        (800.0, 1_000_000),
        (833.0, 1_000_000),
        (1125.0, 1_000_000),
        (1600.0, 1_000_000),
        (2000.0, 1_000_000),
        (3200.0, 1_000_000),
        (80.0, 10_000_000),
        (83.3, 10_000_000),
        (112.5, 10_000_000),
        (160.0, 10_000_000),
    ] {
        let stamp = |i: i64| START + (i as f64 * 1e9 / rate / tick as f64) as i64 * tick;
        let stream: Vec<_> = (0..60_000).map(|i| (i, stamp(i))).collect();
        let outcome = run(&stream, 4096);
        let summary = &outcome.summary;
        let told = format!("{rate} Hz: {}", told(summary));
        assert_eq!(
            (summary.missing, summary.clock_steps.len(), summary.restarts),
            (0, 0, 0),
            "{told}"
        );
        assert!((summary.rate_hz / rate - 1.0).abs() < 1e-4, "{told}");
    }
}

/// Half of the samples lost, and more, in stamps that are exact.
#[test]
fn most_samples_lost() {
    for loss in [0.2, 0.4, 0.5, 0.7] {
        let (mut losses, mut missing) = (Random(9), 0);
        let stream = stream(
            60_000,
            |_| 0.0,
            |i| {
                let lost = i > 0 && i < 59_999 && losses.next() < loss;
                missing += u64::from(lost);
                lost
            },
        );
        let outcome = run(&stream, 4096);
        assert_exact(&outcome, missing);
        assert_rate(&outcome, 1e-9);
    }
}

/// Stamps that go back and forth by more than they go on: a line through them is flat, and is not to
/// be taken for billions of samples a nanosecond.
#[test]
fn stamps_without_a_rate_get_a_possible_one() {
    let (far, farther) = (5_032_820_502_762_703_307, 6_651_262_939_525_212_660);
    for stamps in [
        &[3, 3, 0, 2, 3, 3, 2, far + 5, far + 2, far, far][..],
        &[3, 0, 4, 2, 2, farther, farther + 4],
        &[-7_453_879_827_220, 1, 2, 1_261_240_077_690, 4, -1_067_010_223_227, 6],
    ] {
        let samples: Vec<Sample> = (0..)
            .zip(stamps)
            .map(|(i, &stamp_ns)| Sample { stamp_ns, value: [f64::from(i); 3] })
            .collect();
        let mut timeline = Timeline::new();
        timeline.push(&samples, |_| {});
        let summary = timeline.finish(|_| {});
        assert!(summary.rate_hz <= 2e9, "{summary:?}");
        assert_eq!(summary.samples, samples.len() as u64);
    }
}

/// Jitter that is spread evenly gives steps of two lengths only, of which the shorter is no period.
#[test]
fn steps_of_two_lengths_are_jitter() {
    let stamp = |i: i64| START + i * 20_000_000 + (i * 7_639_320_225) % 12_000_001 - 6_000_000;
    let stream: Vec<_> = (0..60_000).map(|i| (i, stamp(i))).collect();
    let outcome = run(&stream, 4096);
    assert_exact(&outcome, 0);
    assert!((outcome.summary.rate_hz / 50.0 - 1.0).abs() < 1e-5, "{}", told(&outcome.summary));
}
