//! When a live sensor's messages are read: a sensor's clock, a USB adapter's frames, a host's stalls;
//! and how well [`imu_tools::live::clock`] finds out when they were sampled.
//!
//! A message is sent when its sample was taken; the adapter hands over all it has when its timer
//! fires, the scheduler is late by an exponential time, and now and then nothing is read for 50 to
//! 300 ms. Timer and sensor are not in phase, and their rates have nothing to do with each other.

use std::collections::VecDeque;

use imu_core::noise::Xoshiro256PlusPlus;
use imu_tools::live::clock::{Clock, ClockStatus, Source};
use imu_tools::live::{Count, Message, Ticks};
use rand_core::{Rng, SeedableRng};

/// A sensor, its adapter and its host.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Messages a second of the sensor's clock.
    pub rate_hz: f64,
    /// The adapter's timer, s.
    pub frame_s: f64,
    /// How much faster than the host's the sensor's clock runs, on average.
    pub clock_ppm: f64,
    /// Amplitude of its slow change, millionths, with a period of [`DRIFT_S`].
    pub drift_ppm: f64,
    /// Mean time between stalls, s.
    pub stalls_s: f64,
    /// The part of the messages that is lost, each by itself.
    pub lost: f64,
    /// What messages carry.
    pub source: Source,
    /// Ticks a second, where they carry those.
    pub ticks_hz: u64,
}

/// A room that warms up and cools down: one period, s.
pub const DRIFT_S: f64 = 3600.0;

/// What a run came to, after it settled.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Error of stamps without its mean, s: root mean square.
    pub error_s: f64,
    /// Error of the time from one stamp to the next, s: root mean square.
    pub spacing_s: f64,
    /// Gaps that there were, and those of them that were found where they were, as long as they were.
    pub gaps: (u64, u64),
    /// Gaps that were reported where there were none, or others.
    pub false_gaps: u64,
    /// Messages that were lost, and those that were reported, in all.
    pub lost: (u64, u64),
    /// The last rate minus the true one, in its own standard deviations.
    pub rate_z: f64,
    /// How often the phase of sensor and timer went round: teeth of the beat that were seen.
    pub beats: u64,
    /// What the clock said in the end.
    pub status: ClockStatus,
}

fn uniform(rng: &mut Xoshiro256PlusPlus) -> f64 {
    // Never 0: its logarithm is wanted.
    ((rng.next_u64() >> 11) as f64 + 0.5) * 2_f64.powi(-53)
}

impl Line {
    /// The greatest common measure of frame and period, s: the height of a beat's tooth.
    #[must_use]
    pub fn tooth_s(&self) -> f64 {
        let (mut a, mut b) = ((self.frame_s * 1e6).round(), (1e6 / self.rate_hz).round());
        while b > 0.0 {
            (a, b) = (b, a % b);
        }
        a * 1e-6
    }

    /// Lets the line run for so long, and looks at what comes after `settle_s`.
    #[must_use]
    pub fn run(&self, seed: u64, settle_s: f64, run_s: f64) -> Outcome {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let phase = uniform(&mut rng) * self.frame_s;
        let turn = std::f64::consts::TAU * uniform(&mut rng);
        let wave = std::f64::consts::TAU / DRIFT_S;
        let sampled = |x: f64| {
            let drift = self.drift_ppm / wave * ((wave * x + turn).sin() - turn.sin());
            x - 1e-6 * (self.clock_ppm * x + drift)
        };
        // Any number of hours after the host was started.
        let epoch_ns = 4_000_000_000_000_i64;
        let mut clock = Clock::default();
        let mut seen = Seen { settle_s, ..Seen::default() };
        let mut waiting = VecDeque::new();
        let mut stall = (0.0, -1.0);
        let (mut frame, mut frame_noise, mut read_at) = (0.0, 0.0, 0.0_f64);
        let mut lost_before = 0;
        let tooth_s = self.tooth_s();
        let (mut tooth, mut beats) = ((-phase / tooth_s).floor(), 0);
        for k in 0..(run_s * self.rate_hz) as u64 {
            let x = k as f64 / self.rate_hz;
            if k > 0 && uniform(&mut rng) < self.lost {
                lost_before += 1;
                continue;
            }
            let true_s = sampled(x);
            let now = ((true_s - x - phase) / tooth_s).floor();
            beats += u64::from(now != tooth);
            tooth = now;
            let fires = ((true_s - phase) / self.frame_s).ceil() * self.frame_s + phase;
            if fires > frame {
                frame = fires;
                frame_noise = -2e-4 * uniform(&mut rng).ln();
            }
            let mut at = fires + frame_noise;
            while at > stall.1 {
                let begin = stall.1.max(0.0) - self.stalls_s * uniform(&mut rng).ln();
                stall = (begin, begin + 0.05 + 0.25 * uniform(&mut rng));
            }
            if at > stall.0 {
                at = stall.1;
            }
            read_at = read_at.max(at);
            let mut message = Message::default();
            match self.source {
                Source::Ticks => {
                    // A text's times have digits, and are read as nanoseconds.
                    let (per_second, grain) = (1_000_000_000, 1_000_000_000 / self.ticks_hz);
                    let value = (x * self.ticks_hz as f64).round() as u64 + 4_000_000_000;
                    let (value, wraps_at) = (value % (1 << 32) * grain, Some((1 << 32) * grain));
                    message.ticks = Some(Ticks { value, per_second, wraps_at });
                }
                Source::Count => {
                    message.count = Some(Count { value: (k % 256) as u32, wraps_at: 256 });
                }
                Source::Arrival => {}
            }
            waiting.push_back((true_s, std::mem::take(&mut lost_before)));
            let arrival_ns = epoch_ns + (read_at * 1e9).round() as i64;
            clock.take(arrival_ns, &message, |_, taken| {
                let Some((true_s, lost)) = waiting.pop_front() else { return };
                seen.take(true_s, (taken.stamp_ns - epoch_ns) as f64 * 1e-9, lost, taken.lost);
            });
        }
        assert!(waiting.is_empty(), "messages are held back at first only");
        let status = clock.status();
        let rate = self.rate_hz
            * (1.0 + 1e-6 * (self.clock_ppm + self.drift_ppm * (wave * run_s + turn).cos()));
        Outcome { beats, ..seen.outcome(status, (status.rate_hz - rate) / status.rate_sd_hz) }
    }
}

/// Sums over a run.
#[derive(Default)]
struct Seen {
    settle_s: f64,
    count: f64,
    sum: f64,
    squares: f64,
    last: Option<f64>,
    spacing: f64,
    gaps: (u64, u64),
    false_gaps: u64,
    lost: (u64, u64),
    first: Option<f64>,
}

impl Seen {
    fn take(&mut self, true_s: f64, stamp_s: f64, lost: u64, found: u64) {
        self.lost.0 += lost;
        self.lost.1 += found;
        self.gaps.0 += u64::from(lost > 0);
        self.gaps.1 += u64::from(lost > 0 && lost == found);
        self.false_gaps += u64::from(found > 0 && lost != found);
        if true_s < self.settle_s {
            return;
        }
        let error = stamp_s - true_s;
        let error = error - *self.first.get_or_insert(error);
        self.count += 1.0;
        self.sum += error;
        self.squares += error * error;
        let last = self.last.replace(error).unwrap_or(error);
        self.spacing += (error - last) * (error - last);
    }

    fn outcome(&self, status: ClockStatus, rate_z: f64) -> Outcome {
        let mean = self.sum / self.count;
        Outcome {
            error_s: (self.squares / self.count - mean * mean).max(0.0).sqrt(),
            spacing_s: (self.spacing / self.count).sqrt(),
            gaps: self.gaps,
            false_gaps: self.false_gaps,
            lost: self.lost,
            rate_z,
            beats: 0,
            status,
        }
    }
}

/// A clock error for each of `runs`, evenly between ∓200 millionths.
#[must_use]
pub fn clock_ppm(run: u64, runs: u64) -> f64 {
    400.0 * ((run as f64 + 0.5) / runs as f64 - 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: Line = Line {
        rate_hz: 100.0,
        frame_s: 0.016,
        clock_ppm: 120.0,
        drift_ppm: 3.0,
        stalls_s: 30.0,
        lost: 0.0,
        source: Source::Ticks,
        ticks_hz: 1_000_000,
    };

    /// What is asked for. `examples/clock_recovery.rs` finds 0.2 to 0.4 % (rms) at this clock error; the
    /// seeds are fixed, so chance has no part in it.
    #[test]
    fn stamps_err_less_than_a_hundredth_of_a_period_with_bursts() {
        for source in [Source::Ticks, Source::Count, Source::Arrival] {
            for (rate_hz, frame_s) in [(100.0, 0.016), (200.0, 0.016), (1000.0, 0.001)] {
                let outcome = Line { rate_hz, frame_s, source, ..LINE }.run(1, 120.0, 300.0);
                let part = outcome.error_s * rate_hz;
                assert!(part < 0.01, "{source:?} at {rate_hz} Hz: {part}");
                // No jitter of arrival enters: the line bends by less than 1000 ppm once a second.
                assert!(outcome.spacing_s * rate_hz < 1e-4, "{outcome:?}");
                assert_eq!((outcome.lost, outcome.status.restarts), ((0, 0), 0));
                assert_eq!(outcome.status.source, source);
            }
        }
    }

    #[test]
    fn every_lost_message_is_found_with_a_counter_and_guessed_without() {
        for source in [Source::Ticks, Source::Count] {
            let outcome = Line { lost: 0.01, source, ..LINE }.run(2, 60.0, 300.0);
            // All of the about 300: a counter leaves no room for chance.
            assert!(outcome.gaps.0 > 200, "{outcome:?}");
            assert_eq!((outcome.gaps.0, outcome.false_gaps), (outcome.gaps.1, 0), "{outcome:?}");
            assert!(outcome.status.lost_is_certain);
        }
        let outcome = Line { lost: 1e-4, source: Source::Arrival, ..LINE }.run(3, 60.0, 600.0);
        assert!(!outcome.status.lost_is_certain);
        assert!(outcome.lost.0 > 0 && outcome.lost.1 <= outcome.lost.0 + 1, "{outcome:?}");
    }

    /// Stamps of a table have digits: milliseconds, hundredths of a second.
    #[test]
    fn ticks_that_are_no_part_of_a_period() {
        for (rate_hz, ticks_hz) in [(30.0, 1000), (400.0, 1000), (1600.0, 1000), (200.0, 100)] {
            let line = Line { rate_hz, ticks_hz, ..LINE };
            let outcome = line.run(5, 120.0, 300.0);
            assert_eq!((outcome.lost, outcome.status.source), ((0, 0), Source::Ticks), "{rate_hz}");
            assert!(outcome.rate_z.abs() < 5.0, "{outcome:?}");
            // Rounding is even over a tick, 0.29 rms, and the stamps' line follows it by 1/128.
            let ticks = ticks_hz as f64;
            assert!(outcome.error_s * ticks < 0.1, "{rate_hz}: {}", outcome.error_s * ticks);
            assert!(outcome.spacing_s * ticks < 0.29 / 100.0, "{outcome:?}");
            // What is lost is found as far as ticks can tell it.
            let outcome = Line { lost: 0.01, ..line }.run(6, 120.0, 300.0);
            let fine = ticks >= 2.0 * rate_hz;
            assert_eq!(outcome.status.lost_is_certain, fine, "{rate_hz}");
            if fine {
                let (gaps, found) = outcome.gaps;
                assert_eq!((found, outcome.false_gaps), (gaps, 0), "{rate_hz}: {outcome:?}");
            }
        }
    }

    #[test]
    fn the_error_of_the_sensors_clock_is_shown() {
        let outcome = LINE.run(4, 120.0, 300.0);
        let ppm = outcome.status.clock_ppm.unwrap();
        // 120 ± 3 of drift, and 0.2 ms of a period's error over a few minutes: ± 2.
        assert!((ppm - 120.0).abs() < 5.0, "{ppm}");
        assert!((outcome.status.rate_hz - 100.0 * (1.0 + 1e-6 * ppm)).abs() < 1e-6);
    }
}
