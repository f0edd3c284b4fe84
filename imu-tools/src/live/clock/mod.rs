//! Sample times out of arrival times, a sensor's clock, and counters.
//!
//! A chunk of bytes is read when the USB adapter, the kernel and the scheduler please: up to 16 ms
//! late, many messages at once, after a stall 300 ms late. When a message was sent is told by the
//! sensor's ticks or, without them, by its count or by the mere number of messages before it; these
//! are mapped to the host's clock by a curve under the earliest arrivals (`envelope.rs`). A sample's
//! stamp is a point of a line that is bent towards that curve once a second and never breaks: no
//! jitter of arrival gets into the spacing of samples. `docs/live-clock.md` derives the method and
//! says how good it is.
//!
//! The first two seconds of a stretch are held back until rate and phase are known. Messages that
//! are known to be missing leave a gap between stamps; [`crate::recording::Timeline`] finds it there.
//!
//! ```
//! use imu_tools::live::{Message, Ticks, clock::Clock};
//! let mut clock = Clock::default();
//! let mut stamps = Vec::new();
//! for i in 0..1000_u64 {
//!     // 200 Hz, read in bursts every 16 ms; the sensor's clock counts microseconds.
//!     let arrival_ns = ((i * 5_000_000) / 16_000_000 + 1) * 16_000_000;
//!     let ticks = Ticks { value: i * 5000, per_second: 1_000_000, wraps_at: Some(1 << 32) };
//!     let message = Message { ticks: Some(ticks), ..Message::default() };
//!     clock.take(arrival_ns as i64, &message, |_, taken| stamps.push(taken.stamp_ns));
//! }
//! clock.finish(|_, taken| stamps.push(taken.stamp_ns));
//! assert_eq!(stamps.len(), 1000);
//! assert!(stamps.windows(2).all(|w| (w[1] - w[0] - 5_000_000).abs() < 5_000));
//! ```

mod envelope;
mod learn;
mod reading;
mod strip;
mod track;

pub use reading::Source;
use track::{Next, Track};

use super::Message;

/// A stretch of messages is held back for so long, ns, and until there are [`LEAST_HELD`], or
/// [`MOST_HELD`] of them.
const HOLD_NS: i64 = 2_000_000_000;
const LEAST_HELD: usize = 16;
const MOST_HELD: usize = 4096;

/// What is known of a message's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taken {
    /// When it was sampled, plus a latency that does not change: ns on the host's epoch, later than
    /// the message before.
    pub stamp_ns: i64,
    /// How long the sensor took for it, s: from the message before, had none been lost.
    pub interval_s: f64,
    /// Messages missing before this one.
    pub lost: u64,
    /// Whether a counter said so, or the arrivals.
    pub certain: bool,
    /// Nothing connects this message with those before: the sensor or its counter began anew, the
    /// port was opened again, or it is of another stream.
    pub restart: bool,
}

/// How a sensor's clock is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockStatus {
    /// Messages in a second of the host's clock, lost ones included; 0 before the first stamp.
    pub rate_hz: f64,
    /// Its standard deviation, Hz; infinite in the first seconds.
    pub rate_sd_hz: f64,
    /// How much faster than the host's clock the sensor's runs, in millionths; `None` without ticks,
    /// or where they are of another unit than they say.
    pub clock_ppm: Option<f64>,
    /// How arrivals scatter about stamps: standard deviation, s.
    pub jitter_s: f64,
    /// Messages missing in all.
    pub lost: u64,
    /// Whether counters say so, all of them.
    pub lost_is_certain: bool,
    /// Times that a stretch began anew.
    pub restarts: u64,
    /// What sample times come from.
    pub source: Source,
}

/// Stamps messages. Its memory does not grow: 600 points of a curve, and at the start of a stretch
/// at most 4096 messages.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    /// Arrivals and messages of a stretch whose rate and phase are not known yet.
    held: Vec<(i64, Message)>,
    track: Option<Track>,
    /// The stretch before, for its rate.
    before: Option<Track>,
    last_stamp: Option<i64>,
    lost: u64,
    /// Some of the losses are not certain.
    guessed: bool,
    /// Which of its sender's streams the latest message was of.
    stream: u8,
    /// The next stretch is of another stream than the one before.
    turned: bool,
    restarts: u64,
    arrivals: Spread,
}

/// Mean and sum of squared distances from it (Welford 1962).
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Spread {
    fn take(&mut self, value: f64) {
        self.count += 1;
        let distance = value - self.mean;
        self.mean += distance / self.count as f64;
        self.squares += distance * (value - self.mean);
    }
}

impl Clock {
    /// Takes a message whose last byte was in the chunk that was read at `arrival_ns` of a monotonic
    /// clock. Hands on every message whose time is known by now, in order; fewer than 16 that were the very first
    /// are left out where another stream takes their place.
    pub fn take(
        &mut self,
        arrival_ns: i64,
        message: &Message,
        mut to: impl FnMut(&Message, Taken),
    ) {
        if message.stream != self.stream {
            self.turn(message.stream, &mut to);
        }
        if let Some(track) = &mut self.track {
            match track.next(arrival_ns, message) {
                Some(next) => return self.stamp(arrival_ns, message, next, &mut to),
                None => self.before = self.track.take(),
            }
        }
        if !learn::goes_on(&self.held, arrival_ns, message) {
            self.release(&mut to);
            self.before = self.track.take();
        }
        self.held.push((arrival_ns, *message));
        let since = self.held.first().map_or(0, |(first, _)| arrival_ns.saturating_sub(*first));
        let enough = since >= HOLD_NS && self.held.len() >= LEAST_HELD;
        if enough || self.held.len() >= MOST_HELD {
            self.release(&mut to);
        }
    }

    /// Begins with another stream, whose times are not those of the one before.
    fn turn(&mut self, stream: u8, to: &mut impl FnMut(&Message, Taken)) {
        // Where a sender's better stream begins a moment after another, the few messages of that are left out.
        if self.last_stamp.is_none() && self.held.len() < LEAST_HELD {
            self.held.clear();
        }
        self.release(to);
        (self.track, self.before, self.stream, self.turned) = (None, None, stream, true);
    }

    /// Hands on what is held back. The next message continues where these end.
    pub fn finish(&mut self, mut to: impl FnMut(&Message, Taken)) {
        self.release(&mut to);
    }

    /// The port was closed and opened again: hands on what is held back. Ticks that went on meanwhile
    /// as long as the host's clock did connect the next message with it; nothing else does, but the
    /// rate is remembered.
    pub fn reopened(&mut self, mut to: impl FnMut(&Message, Taken)) {
        self.release(&mut to);
        match &mut self.track {
            Some(track) if track.source() == Source::Ticks => track.reopened(),
            _ => {
                self.before = self.track.take().or(self.before.take());
                self.before.iter_mut().for_each(Track::reopened);
            }
        }
    }

    /// What is known by now.
    #[must_use]
    pub fn status(&self) -> ClockStatus {
        let track = self.track.as_ref().or(self.before.as_ref());
        let (rate_hz, rate_sd_hz) = track.map_or((0.0, f64::INFINITY), Track::rate);
        let source = track.map_or(Source::default(), Track::source);
        let spread = &self.arrivals;
        ClockStatus {
            rate_hz,
            rate_sd_hz,
            clock_ppm: track.and_then(Track::ppm),
            jitter_s: (spread.squares / spread.count.max(1) as f64).sqrt() * 1e-9,
            lost: self.lost,
            lost_is_certain: source != Source::Arrival && !self.guessed,
            restarts: self.restarts,
            source,
        }
    }

    /// Finds rate and phase of what is held back, and hands it on.
    fn release(&mut self, to: &mut impl FnMut(&Message, Taken)) {
        // The memory is needed for a few seconds of a run of days: it is given back.
        let held = std::mem::take(&mut self.held);
        let mut messages = held.as_slice();
        if let Some(mut track) = self.before.take_if(|before| before.explains(messages)) {
            let next = messages.first().and_then(|(arrival_ns, m)| track.next(*arrival_ns, m));
            self.track = Some(track);
            messages = self.follow(messages, next, to);
        }
        while let Some(mut track) = learn::from(messages, self.before.as_ref()) {
            let first = self.join(&mut track);
            self.track = Some(track);
            messages = self.follow(messages, Some(first), to);
        }
    }

    /// Hands messages on as long as each is connected with the one before, and says which are left: a counter
    /// began anew while it was learnt from.
    fn follow<'a>(
        &mut self,
        mut messages: &'a [(i64, Message)],
        mut next: Option<Next>,
        to: &mut impl FnMut(&Message, Taken),
    ) -> &'a [(i64, Message)] {
        while let (Some(now), Some((head, rest))) = (next, messages.split_first()) {
            self.stamp(head.0, &head.1, now, to);
            messages = rest;
            next = rest.first().zip(self.track.as_mut()).and_then(|(m, t)| t.next(m.0, &m.1));
        }
        if !messages.is_empty() {
            self.before = self.track.take();
        }
        messages
    }

    /// Lets stamps go on: a stretch that would begin before the end of the last is moved.
    fn join(&mut self, track: &mut Track) -> Next {
        let first = Next { units: 0, lost: 0, certain: true, restart: false };
        let turned = std::mem::take(&mut self.turned);
        let Some(last) = self.last_stamp else { return first };
        let period = track.period_ns();
        let gap = track.stamp().saturating_sub(last) as f64;
        if gap < 1.0 {
            track.shift(period - gap);
        }
        // The end of one stream and the beginning of another tell of no losses.
        let lost = if turned { 0 } else { ((gap / period).round() as u64).saturating_sub(1) };
        Next { lost, certain: false, restart: true, ..first }
    }

    fn stamp(
        &mut self,
        arrival_ns: i64,
        message: &Message,
        next: Next,
        to: &mut impl FnMut(&Message, Taken),
    ) {
        let Some(track) = &mut self.track else { return };
        track.pass(arrival_ns, next.units);
        let interval_s = track.interval_ns(&next) * 1e-9;
        let least = self.last_stamp.map_or(i64::MIN, |last| last.saturating_add(1));
        let stamp_ns = track.stamp().max(least);
        self.last_stamp = Some(stamp_ns);
        self.arrivals.take(arrival_ns.saturating_sub(stamp_ns) as f64);
        let Next { lost, certain, restart, .. } = next;
        self.lost = self.lost.saturating_add(lost);
        self.guessed |= lost > 0 && !certain;
        self.restarts += u64::from(restart);
        to(message, Taken { stamp_ns, interval_s, lost, certain, restart });
    }
}

#[cfg(test)]
mod tests;
