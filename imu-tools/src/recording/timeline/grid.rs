//! The grid of a sensor's clock, followed slowly, and the rules that place a stamp on it.

use serde::{Deserialize, Serialize};

use crate::recording::Sample;

/// A stamp within this part of a period from its place is in its place.
const NEAR: f64 = 0.5;

/// Where fewer of the stamps than this are in their place, a lost sample does not show in a few
/// stamps: only the slow mean can tell. Normal jitter of 0.3 periods (rms) leaves 90 % there.
const MOSTLY: f64 = 0.8;

/// Stamps that must stay away from the grid before anything is made of it, at least and at most:
/// twice as many as would come in a bunch after a stall of the length seen, and more while they are
/// catching up, since another stall may follow.
const AHEAD: (usize, usize) = (32, 1024);

/// Fewer stamps than this, at the end of a recording, prove nothing against usual jitter.
const PROOF: usize = 8;

/// Stamps behind a gap whose middle shows how long it is.
const FEW: usize = 5;

/// A gap of so many periods shows the phase anew better than the period could predict it.
const LONG: f64 = 100.0;

/// Nanoseconds beyond which a gap is a restart. Whoever leaves a sensor for an hour has switched
/// it off, or the clock was set (a computer that finds its time server): in both cases nothing
/// connects what lies before and after.
const LONGEST: f64 = 3600e9;

/// A clock set back by less (ns) was adjusted while samples went on; by more, it tells of another
/// recording.
const ADJUSTMENT: f64 = 1e9;

/// Memory, in samples, of the slow mean that finds losses hidden in jitter.
const SLOW: f64 = 256.0;

/// The slow mean is away by a sample when it exceeds this part of a period, or of what errors are
/// clipped to where that is less. Jitter of ±2 periods moves it by 0.05 (standard deviation
/// 1.15/√512).
const SLIP: f64 = 0.7;

/// Errors count at most so many periods, and less where jitter is less: neither a wild stamp nor a
/// stall may move the grid.
const CLIP: f64 = 2.0;

/// Memory, in samples, of the mean square of errors, and of how many stamps are in their place.
const JITTER: f64 = 4096.0;

/// Jitter (rms, periods) from which stamps are no longer taken at their word.
const JITTERY: f64 = 0.1;

/// What a stamp away from the grid means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Jitter: the sample is the next one.
    Next,
    /// So many samples did not come; `shift` is what the stamps say, in ns.
    Missing { count: u64, shift: f64 },
    /// The clock was adjusted: samples go on.
    Adjusted { shift: f64 },
    /// Nothing connects before and after.
    Restart { shift: f64 },
}

/// Phase and period of a sensor's clock. All times are nanoseconds after `origin`.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Grid {
    origin: i64,
    period: f64,
    /// Where the next sample is expected.
    next: f64,
    /// Where the first sample of this stretch was.
    start: f64,
    /// Grid points passed in this stretch.
    points: u64,
    /// Exponential mean of errors, ns.
    slow: f64,
    /// Exponential mean of squared errors, ns²: without those of `recent`.
    jitter: f64,
    /// Exponential mean of whether a stamp is in its place.
    in_place: f64,
    /// What follows from period and jitter.
    bounds: Bounds,
    /// Since period, jitter and bounds were computed.
    recent: Errors,
    /// Sum of squared errors (ns²) of all before, and how many there are of all.
    squares: f64,
    accepted: u64,
}

/// The sum of errors (ns), as far as the grid follows them, and of their squares.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
struct Errors {
    sum: f64,
    squares: f64,
}

/// Limits of errors in ns, and how fast the grid follows.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
struct Bounds {
    near: f64,
    widest: f64,
    usual: f64,
    slip: f64,
    phase_gain: f64,
    period_gain: f64,
}

impl Bounds {
    /// They, period and jitter are computed anew after so many samples.
    const EVERY: u64 = 64;

    fn of(period: f64, jitter: f64) -> Self {
        // A second-order loop, critically damped: clean stamps are followed eight times faster.
        let gain = if jitter < JITTERY * JITTERY * period * period { 512.0 } else { 4096.0 };
        let usual = (2.0 * jitter.sqrt()).clamp(NEAR * period, CLIP * period);
        Self {
            near: NEAR * period,
            widest: CLIP * period,
            usual,
            slip: SLIP * usual.min(period),
            phase_gain: 1.0 / gain,
            period_gain: 0.25 / (gain * gain),
        }
    }
}

impl Grid {
    /// A grid whose first sample is expected at `next` ns after `origin`; `jitter` is the mean square
    /// of errors in ns², each at most two periods, and `in_place` the part of the stamps that are in
    /// their place.
    pub fn new(origin: i64, period: f64, next: f64, jitter: f64, in_place: f64) -> Self {
        Self {
            origin,
            period,
            next,
            start: next,
            points: 0,
            slow: 0.0,
            jitter,
            in_place,
            bounds: Bounds::of(period, jitter),
            recent: Errors::default(),
            squares: 0.0,
            accepted: 0,
        }
    }

    /// Stamp minus expected stamp, ns.
    #[inline]
    pub fn error(&self, stamp_ns: i64) -> f64 {
        stamp_ns.saturating_sub(self.origin) as f64 - self.next
    }

    /// Whether a stamp with this error is in its place.
    #[inline]
    pub fn near(&self, error: f64) -> bool {
        error.abs() <= self.bounds.near
    }

    /// Takes a sample in as the next, and lets the grid follow; the number of samples that the
    /// slow mean shows to be missing before it.
    #[inline]
    pub fn accept(&mut self, error: f64) -> u64 {
        let Bounds { widest, usual, slip, phase_gain, .. } = self.bounds;
        let (mut wide, mut error) = (error, error);
        let near = self.near(error);
        self.in_place += (f64::from(u8::from(near)) - self.in_place) * (1.0 / JITTER);
        if !near {
            wide = wide.clamp(-widest, widest);
            error = error.clamp(-usual, usual);
        }
        self.recent.sum += error;
        self.recent.squares += wide * wide;
        self.slow += (error - self.slow) * (1.0 / SLOW);
        self.next = (self.next + self.period) + phase_gain * error;
        self.points += 1;
        self.accepted += 1;
        if self.accepted.is_multiple_of(Bounds::EVERY) {
            self.learn();
        }
        if self.slow.abs() > slip { self.slipped() } else { 0 }
    }

    /// Takes in samples as long as each is in its place, later than the one before, and shows none to
    /// be missing, as most do: the same as [`accept`](Self::accept) of each, faster. How many it took.
    pub fn follow(&mut self, samples: &[Sample], mut last_ns: i64) -> usize {
        let mut taken = 0;
        loop {
            let Bounds { near, slip, phase_gain, .. } = self.bounds;
            let Self {
                origin, mut next, period, mut recent, mut slow, in_place: mut placed, ..
            } = *self;
            let to_bounds = Bounds::EVERY - self.accepted % Bounds::EVERY;
            let mut followed = 0;
            for sample in samples.iter().skip(taken).take(to_bounds as usize) {
                let error = sample.stamp_ns.saturating_sub(origin) as f64 - next;
                let slower = slow + (error - slow) * (1.0 / SLOW);
                let in_place = error.abs() <= near && slower.abs() <= slip;
                if !in_place || sample.stamp_ns <= last_ns {
                    break;
                }
                last_ns = sample.stamp_ns;
                recent.sum += error;
                recent.squares += error * error;
                slow = slower;
                placed += (1.0 - placed) * (1.0 / JITTER);
                next = (next + period) + phase_gain * error;
                followed += 1;
            }
            *self = Self { next, recent, slow, in_place: placed, ..self.clone() };
            self.points += followed;
            self.accepted += followed;
            taken += followed as usize;
            if followed < to_bounds {
                return taken;
            }
            self.learn();
        }
    }

    /// What the recent errors, [`Bounds::EVERY`] of them, say of period and jitter.
    fn learn(&mut self) {
        const EVERY: f64 = Bounds::EVERY as f64;
        let Errors { sum, squares } = std::mem::take(&mut self.recent);
        self.period += self.bounds.period_gain * sum;
        self.jitter += (squares / EVERY - self.jitter) * (EVERY / JITTER);
        self.squares += squares;
        self.bounds = Bounds::of(self.period, self.jitter);
    }

    /// The slow mean is away by a sample: one is missing, or the clock was adjusted.
    #[cold]
    fn slipped(&mut self) -> u64 {
        let slow = std::mem::take(&mut self.slow);
        if slow > 0.0 {
            self.next += self.period;
            self.points += 1;
            return 1;
        }
        self.adjust(slow);
        0
    }

    /// What a stamp away from its place means, in the light of those `after` it; `None` when more
    /// of them are needed, and come.
    ///
    /// A late stamp is followed by others in their places. So stamps that stay away are counted
    /// against those that do not, and as soon as the latter are more, it was jitter. Where fewer than
    /// [`MOSTLY`] are in their place a single one is enough.
    pub fn judge(&self, stamp_ns: i64, after: &[Sample], at_end: bool) -> Option<Verdict> {
        let first = self.error(stamp_ns);
        let side = first.signum();
        let (least, most) = AHEAD;
        let near = NEAR * self.period;
        let coarse = self.in_place < MOSTLY;
        let stamps = std::iter::once(stamp_ns).chain(after.iter().map(|s| s.stamp_ns));
        let mut errors = Vec::with_capacity(2 * least);
        let (mut balance, mut farthest, mut wanted) = (0_i64, 0.0_f64, least);
        for (j, stamp) in stamps.take(most).enumerate() {
            let error = side * (self.error(stamp) - j as f64 * self.period);
            balance += if error > near { 1 } else { -1 };
            if balance < 0 || (coarse && error <= near) {
                return Some(Verdict::Next);
            }
            farthest = farthest.max(error);
            wanted = wanted.max((2.0 * farthest / self.period).min(most as f64) as usize);
            errors.push(error);
            // As long as they are catching up, more are wanted.
            if errors.len() >= wanted {
                let (early, late) = quarters(&errors);
                if late > early - self.period {
                    break;
                }
                wanted = (2 * wanted).min(most);
            }
            if errors.len() == most {
                break;
            }
        }
        let seen = errors.len();
        if seen < wanted && !at_end {
            return None;
        }
        let jitter = self.jitter.sqrt();
        let nearest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        if seen < PROOF && nearest - 3.0 * jitter <= near {
            return Some(Verdict::Next);
        }
        let (_, late) = quarters(&errors);
        if late <= near {
            return Some(Verdict::Next);
        }
        // Clean stamps are taken at their word, others by the middle of a few: more may be lost
        // among those that follow.
        let clean = jitter <= JITTERY * self.period && nearest > near;
        let level = if clean { nearest } else { median(errors.get(..FEW).unwrap_or(&errors)) };
        let shift = side * level.min(late);
        Some(if !(-ADJUSTMENT..=LONGEST).contains(&shift) {
            Verdict::Restart { shift }
        } else if shift < 0.0 {
            Verdict::Adjusted { shift }
        } else {
            Verdict::Missing { count: (shift / self.period).round().max(1.0) as u64, shift }
        })
    }

    /// Passes over `count` grid points; after many, the phase is taken from the stamps.
    pub fn miss(&mut self, count: u64, shift: f64) {
        let periods = count as f64;
        self.next += if periods < LONG { periods * self.period } else { shift };
        self.points += count;
    }

    /// Follows a clock that was set.
    pub fn adjust(&mut self, shift: f64) {
        self.next += shift;
        self.start += shift;
    }

    /// Starts a new stretch, `shift` away from where the next sample was expected.
    pub fn restart(&mut self, shift: f64) {
        self.origin = self.origin.saturating_add(shift as i64);
        self.start = self.next;
        self.points = 0;
        self.slow = 0.0;
    }

    /// Intervals between the grid points of this stretch.
    pub fn intervals(&self) -> f64 {
        self.points.saturating_sub(1) as f64
    }

    /// Nanoseconds from the first to the last grid point of this stretch.
    pub fn elapsed(&self) -> f64 {
        if self.points == 0 { 0.0 } else { (self.next - self.period - self.start).max(0.0) }
    }

    /// Sum of squared errors, ns², and how many there were.
    pub fn squared_errors(&self) -> (f64, u64) {
        (self.squares + self.recent.squares, self.accepted)
    }

    /// Nanoseconds between samples.
    pub fn period(&self) -> f64 {
        self.period
    }
}

/// Medians of the first and last quarter of errors, or of all of a few.
fn quarters(errors: &[f64]) -> (f64, f64) {
    let quarter = if errors.len() < 16 { errors.len() } else { errors.len() / 4 };
    let (early, late) = (errors.get(..quarter), errors.get(errors.len() - quarter..));
    (median(early.unwrap_or_default()), median(late.unwrap_or_default()))
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
