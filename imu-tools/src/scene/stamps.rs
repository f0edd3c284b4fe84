//! The clock of a recording: how its stamps differ from the true times, and which samples get lost.
//!
//! A sample due at t (after the start) is stamped t(1 + drift) + offset + jitter, jitter being the sum
//! of a normal and a uniform number; and no earlier than a nanosecond after the sample before, as in a
//! recording that is written in the order of arrival. Losses are those of Gilbert (1960), "Capacity of a
//! burst-noise channel", Bell System Technical Journal 39: a link that is up or down, a sample being
//! lost where it is down. With p the fraction lost and L the mean length of a burst it stays down with
//! 1 − 1/L, and goes down with p/(L(1 − p)); independent losses are L = 1/(1 − p). Both sensors share
//! clock and losses: they are of one message.
//!
//! Each kind of jitter and the losses draw from a stream of their own, so that none changes another's
//! numbers, nor the sensors'. What is switched off is no loop.

use imu_core::noise::{Axis, Channel, Normal as _, Sensor, TermId, Xoshiro256PlusPlus};
use rand_core::Rng as _;
use serde::Deserialize;

/// The errors of a clock and of the link behind it; zeros are left out.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct ClockErrors {
    /// What a stamp is late by at the start, s.
    pub offset_s: f64,
    /// What the clock gains, in millionths.
    pub drift_ppm: f64,
    /// Standard deviation of normal jitter, s.
    pub jitter_s: f64,
    /// Half the width of uniform jitter, s.
    pub jitter_uniform_s: f64,
    /// p, the fraction of samples lost.
    pub lost_fraction: f64,
    /// L, how many are lost in a row, on average; `None`: each is lost by itself.
    pub lost_burst: Option<f64>,
}

/// The place in the key of random streams: no IMU has so many devices.
const CLOCK: Sensor = Sensor(u16::MAX);
const NORMAL_JITTER: TermId = TermId(256);
const UNIFORM_JITTER: TermId = TermId(257);
const LOSSES: TermId = TermId(258);

/// A clock at work, from the first sample to the last.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    offset_ns: i64,
    drift: f64,
    jitter: Option<Jitter>,
    uniform: Option<Jitter>,
    losses: Option<Losses>,
    /// The stamp of the sample before.
    last_ns: i64,
}

#[derive(Clone, Debug)]
struct Jitter {
    size_ns: f64,
    rng: Xoshiro256PlusPlus,
}

#[derive(Clone, Debug)]
struct Losses {
    down: bool,
    /// Chances to go down, and to stay there.
    falls: f64,
    stays: f64,
    rng: Xoshiro256PlusPlus,
}

/// A uniform number in [0, 1).
fn uniform(rng: &mut Xoshiro256PlusPlus) -> f64 {
    (rng.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
}

impl Clock {
    /// The clock of a scene with this seed; `None` for one that is right and loses nothing.
    pub(super) fn new(errors: &ClockErrors, seed: u64) -> Option<Self> {
        let channel = Channel::new(seed, CLOCK, Axis::X);
        let jitter = |size_s: f64, term| {
            (size_s > 0.0).then(|| Jitter { size_ns: 1e9 * size_s, rng: channel.stream(term) })
        };
        let p = errors.lost_fraction;
        let losses = (p > 0.0).then(|| {
            let burst = errors.lost_burst.unwrap_or(1.0 / (1.0 - p));
            let mut rng = channel.stream(LOSSES);
            let down = uniform(&mut rng) < p;
            Losses { down, falls: p / (burst * (1.0 - p)), stays: 1.0 - 1.0 / burst, rng }
        });
        (*errors != ClockErrors::default()).then(|| Self {
            offset_ns: (1e9 * errors.offset_s).round() as i64,
            drift: 1e-6 * errors.drift_ppm,
            jitter: jitter(errors.jitter_s, NORMAL_JITTER),
            uniform: jitter(errors.jitter_uniform_s, UNIFORM_JITTER),
            losses,
            last_ns: -1,
        })
    }

    /// Turns true times, `start_ns` being that of the first sample, into stamps.
    pub(super) fn stamp(&mut self, start_ns: i64, times_ns: &mut [i64]) {
        if self.drift != 0.0 {
            for time in times_ns.iter_mut() {
                let gained = (*time - start_ns) as f64 * self.drift;
                *time = time.saturating_add(gained.round() as i64);
            }
        }
        times_ns.iter_mut().for_each(|time| *time = time.saturating_add(self.offset_ns));
        if let Some(Jitter { size_ns, rng }) = &mut self.jitter {
            for time in times_ns.iter_mut() {
                let late = *size_ns * f64::standard_normal(rng);
                *time = time.saturating_add(late.round() as i64);
            }
        }
        if let Some(Jitter { size_ns, rng }) = &mut self.uniform {
            for time in times_ns.iter_mut() {
                let late = *size_ns * (2.0 * uniform(rng) - 1.0);
                *time = time.saturating_add(late.round() as i64);
            }
        }
        for time in times_ns.iter_mut() {
            *time = (*time).max(self.last_ns.saturating_add(1));
            self.last_ns = *time;
        }
    }

    /// Appends to `lost` whether each of the next `count` samples is lost; nothing if none ever is.
    pub(super) fn lose(&mut self, count: usize, lost: &mut Vec<bool>) {
        let Some(losses) = &mut self.losses else { return };
        lost.extend((0..count).map(|_| {
            let now = losses.down;
            let chance = if now { losses.stays } else { losses.falls };
            losses.down = uniform(&mut losses.rng) < chance;
            now
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 1_000_000;

    fn stamps(errors: ClockErrors, step_ns: i64) -> Vec<i64> {
        let mut times: Vec<i64> = (0..N as i64).map(|i| 1_000_000_000_000 + i * step_ns).collect();
        Clock::new(&errors, 7).unwrap().stamp(1_000_000_000_000, &mut times);
        times
    }

    fn lost(errors: ClockErrors) -> Vec<bool> {
        let mut lost = Vec::new();
        let mut clock = Clock::new(&errors, 7).unwrap();
        clock.lose(300, &mut lost);
        clock.lose(N - 300, &mut lost);
        lost
    }

    #[test]
    fn offset_and_drift_are_exact() {
        let errors = ClockErrors { offset_s: -0.25, drift_ppm: 20.0, ..ClockErrors::default() };
        for (i, stamp) in stamps(errors, 5_000_000).into_iter().enumerate() {
            assert_eq!(stamp, 1_000_000_000_000 - 250_000_000 + i as i64 * 5_000_100);
        }
        assert!(Clock::new(&ClockErrors::default(), 7).is_none());
    }

    /// The mean of n numbers scatters by σ/√n, their variance by √(2/n) of itself (normal), √(0.8/n)
    /// (uniform); 5.5 of each. Rounding to 1 ns adds 1/12 ns².
    #[test]
    fn jitter_has_its_size() {
        let normal = ClockErrors { jitter_s: 1e-4, ..ClockErrors::default() };
        let flat = ClockErrors { jitter_uniform_s: 2e-4, ..ClockErrors::default() };
        for (errors, sd, kurtosis) in [(normal, 1e5, 2.0), (flat, 2e5 / 3_f64.sqrt(), 0.8)] {
            let late: Vec<f64> = stamps(errors, 5_000_000)
                .into_iter()
                .enumerate()
                .map(|(i, stamp)| (stamp - 1_000_000_000_000 - i as i64 * 5_000_000) as f64)
                .collect();
            let n = N as f64;
            let mean = late.iter().sum::<f64>() / n;
            let variance = late.iter().map(|x| x * x).sum::<f64>() / n;
            assert!(mean.abs() < 5.5 * sd / n.sqrt(), "{mean}");
            assert!((variance / (sd * sd) - 1.0).abs() < 5.5 * (kurtosis / n).sqrt(), "{variance}");
        }
    }

    #[test]
    fn stamps_never_go_back_and_one_jitter_leaves_the_other_alone() {
        let wild = ClockErrors { jitter_s: 0.02, ..ClockErrors::default() };
        assert!(stamps(wild, 5_000_000).windows(2).all(|pair| pair[0] < pair[1]));
        let (a, b) = (
            ClockErrors { jitter_s: 1e-5, ..ClockErrors::default() },
            ClockErrors { jitter_uniform_s: 1e-5, ..ClockErrors::default() },
        );
        let both = ClockErrors { jitter_s: 1e-5, ..b };
        let (x, y, sum) = (stamps(a, 5_000_000), stamps(b, 5_000_000), stamps(both, 5_000_000));
        for (i, ((x, y), sum)) in x.into_iter().zip(y).zip(sum).enumerate() {
            assert_eq!(x + y - (1_000_000_000_000 + i as i64 * 5_000_000), sum);
        }
    }

    /// Fraction and mean burst of a two-state chain: its states are correlated by c = stays − falls from
    /// sample to sample, so the fraction scatters by √(p(1 − p)(1 + c)/((1 − c)n)), and the mean burst
    /// by √((L² − L)/bursts). 5.5 of each.
    #[test]
    fn losses_have_their_fraction_and_their_bursts() {
        for (p, burst) in [(0.01, None), (0.3, None), (0.02, Some(25.0)), (0.4, Some(1.0))] {
            let errors =
                ClockErrors { lost_fraction: p, lost_burst: burst, ..ClockErrors::default() };
            let lost = lost(errors);
            let length = burst.unwrap_or(1.0 / (1.0 - p));
            let (stays, falls) = (1.0 - 1.0 / length, p / (length * (1.0 - p)));
            let c: f64 = stays - falls;
            let count = lost.iter().filter(|lost| **lost).count() as f64;
            let scatter = (p * (1.0 - p) * (1.0 + c) / ((1.0 - c) * N as f64)).sqrt();
            assert!((count / N as f64 - p).abs() < 5.5 * scatter, "{p}: {count}");
            let bursts = lost.windows(2).filter(|pair| !pair[0] && pair[1]).count() as f64;
            let scatter = ((length * length - length) / bursts).sqrt();
            assert!((count / bursts - length).abs() < 5.5 * scatter + 2.0 * length / bursts);
        }
    }
}
