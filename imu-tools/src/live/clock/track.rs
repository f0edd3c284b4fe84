//! One stretch of messages on one line: where each belongs, and how the line follows the arrivals.

use super::envelope::{self, Curve, Point};
use super::reading::{Reading, Source};
use super::strip;
use crate::live::Message;

/// Of so many seconds and messages the earliest arrival counts.
const BLOCK_S: f64 = 1.0;
const BLOCK_MESSAGES: u64 = 4;

/// Bursts of a block that are looked at for a cycle, at most.
const MOST_BURSTS: usize = 1024;

/// What was read within less time, ns, had waited for its reader, and says nothing of the line.
const BLOCK_READ_NS: i64 = 500_000_000;

/// So many of them make the curve.
const MOST_POINTS: usize = 600;

/// The line is led to the curve in a quarter of the time that was seen, within these, s.
const SOON_S: (f64, f64) = (2.0, 20.0);

/// The line is led to the curve no faster than this, ns/s: what follows stamps can follow that.
const FASTEST: f64 = 1e6;

/// No message is sent after it was read. Where one seems to be by more than this, ns (and 1e-4 of the
/// time since the last), a counter was set.
const AHEAD_NS: f64 = 50e6;

/// Before the first block is seen: what waited for its reader was sent long before.
const UNKNOWN_NS: f64 = 1e9;

/// A silence, ns, in which a counter may have gone round.
const SILENCE_NS: i64 = 1_000_000_000;

/// A silence, ns, after which nothing tells how many messages were missed, without a counter.
const LOST_TRACK_NS: i64 = 10_000_000_000;

/// A shorter one, of so many ns and periods at least, is the reader's if what waited comes behind it at once, or
/// the sensor's: which, is seen from what comes next.
const PAUSE_NS: f64 = 500e6;
const PAUSE_PERIODS: f64 = 20.0;

/// Messages with ticks that are all so late, ns, were stamped by a clock that was set.
const SET_NS: f64 = 1e9;

/// With fewer points the curve does not show a lost message.
const SETTLED: f64 = 60.0;

/// The part of a reading's distance from the even line of messages by which that line follows: a second or so.
const FOLLOWED: f64 = 1.0 / 128.0;

/// With less than so many times the rounding of a reading between messages, one that is missing cannot be told
/// from it.
const FINE: f64 = 4.0;

/// How far the line may be too low, in periods, and how late the earliest of a second may be read, ns.
const UNSURE: f64 = 0.05;
const UNSURE_NS: f64 = 50e3;

/// And so many standard deviations of its level.
const FAR: f64 = 3.0;

/// So many points under the line, each by half a period, show that it was too high.
const LOW: u32 = 3;

/// Where a message belongs, as seen from the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Next {
    pub units: u64,
    pub lost: u64,
    pub certain: bool,
    pub restart: bool,
}

/// How a stretch begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub source: Source,
    /// Arrival of its first message, ns.
    pub origin_ns: i64,
    /// Units from a message to the next, on average.
    pub stride: f64,
    /// Messages that showed it.
    pub learnt_from: u64,
    /// Readings are whole numbers of so many units; 0: they are exact.
    pub grain: u64,
    /// Host time of a unit.
    pub unit_ns: f64,
    /// What the sensor says that it is, where that is so.
    pub tick_ns: Option<f64>,
    /// Units in a second, as the sensor says.
    pub per_second: Option<u64>,
    pub reading: Option<Reading>,
    /// When the first message was sent, as seen from its arrival.
    pub offset_ns: f64,
}

/// The line `origin + unit·units + offset`, whose offset drifts, and what it is led by.
#[derive(Clone, Debug)]
pub(super) struct Track {
    source: Source,
    origin_ns: i64,
    /// Units from a message to the next, as the first of them showed: no whole number where ticks are coarse.
    stride: f64,
    learnt_from: u64,
    /// How far a reading may be from the truth, units.
    rounding: f64,
    unit_ns: f64,
    tick_ns: Option<f64>,
    per_second: Option<u64>,
    reading: Option<Reading>,
    /// Units of the messages since, which had no reading.
    unread: u64,
    /// A message may seem to be sent so long after it was read, ns: as far as the line is known to be too late.
    ahead_ns: f64,
    /// Units passed, up to the last message.
    units: u64,
    /// Messages among them, lost ones counted.
    messages: u64,
    /// How far the last reading was from the even line of messages, units: milliseconds are 2 and 3 apart at
    /// 400 Hz.
    uneven: f64,
    last_arrival_ns: i64,
    /// Offset at `since` (sensor time, s) in ns, and its drift, ns/s.
    since: f64,
    offset: f64,
    drift: f64,
    /// Units that were found to be missing, and are passed over with the next message.
    passed_over: u64,
    /// Nothing connects the next message with the last.
    lost_track: bool,
    /// The sensor may have been switched off since.
    reopened: bool,
    /// The silence before the next message was the reader's.
    waited: bool,
    /// The present block: its beginning, messages, the earliest arrival and its distance.
    block_since: f64,
    block_since_ns: i64,
    block_messages: u64,
    earliest: Point,
    earliest_late: f64,
    low: u32,
    points: Vec<Point>,
    curve: Curve,
    /// Messages of the present burst, and of those of the block before it.
    burst: u64,
    bursts: Vec<u64>,
}

impl Track {
    pub fn new(start: Start) -> Self {
        Self {
            source: start.source,
            origin_ns: start.origin_ns,
            stride: start.stride,
            learnt_from: start.learnt_from.max(1),
            rounding: 0.5 * start.grain as f64,
            unit_ns: start.unit_ns,
            tick_ns: start.tick_ns,
            per_second: start.per_second,
            reading: start.reading,
            unread: 0,
            ahead_ns: UNKNOWN_NS,
            units: 0,
            messages: 0,
            uneven: 0.0,
            last_arrival_ns: start.origin_ns,
            since: 0.0,
            offset: start.offset_ns,
            drift: 0.0,
            passed_over: 0,
            lost_track: false,
            reopened: false,
            waited: false,
            block_since: 0.0,
            block_since_ns: start.origin_ns,
            block_messages: 0,
            earliest: Point::default(),
            earliest_late: f64::INFINITY,
            low: 0,
            points: Vec::new(),
            curve: Curve::default(),
            burst: 0,
            bursts: Vec::new(),
        }
    }

    pub fn source(&self) -> Source {
        self.source
    }

    /// Units in a second, as the sensor says, if it does.
    pub fn per_second(&self) -> Option<u64> {
        self.per_second
    }

    /// Host time of a unit, ns, as it is known by now.
    pub fn unit_ns(&self) -> f64 {
        self.unit_ns * (1.0 + 1e-9 * self.curve.slope)
    }

    /// Units from a message to the next, on average, lost ones counted.
    fn mean_stride(&self) -> f64 {
        let many = self.messages >= self.learnt_from;
        if many { self.units as f64 / self.messages as f64 } else { self.stride }
    }

    /// Units from a message to the next, as one reading can tell them.
    fn step(&self) -> u64 {
        self.stride.round() as u64
    }

    /// Host time from a message to the next, ns.
    pub fn period_ns(&self) -> f64 {
        self.mean_stride() * self.unit_ns()
    }

    /// Messages a second, and the standard deviation of that.
    pub fn rate(&self) -> (f64, f64) {
        let rate = 1e9 / self.period_ns();
        let Curve { slope_sd, points, .. } = self.curve;
        // The first and the last reading are rounded, each evenly.
        let rounded = self.rounding * (2.0_f64 / 3.0).sqrt() / self.units.max(1) as f64;
        let sd = (1e-9 * slope_sd).hypot(rounded);
        (rate, if points > 2.0 { rate * sd } else { f64::INFINITY })
    }

    /// How much faster than the host's the sensor's clock runs, in millionths.
    pub fn ppm(&self) -> Option<f64> {
        self.tick_ns.map(|tick_ns| (tick_ns / self.unit_ns() - 1.0) * 1e6)
    }

    /// Moves the line, ns.
    pub fn shift(&mut self, by_ns: f64) {
        self.offset += by_ns;
        self.ahead_ns += by_ns.max(0.0);
    }

    /// Sensor time of a number of units, s.
    fn seconds(&self, units: f64) -> f64 {
        units * self.unit_ns * 1e-9
    }

    /// Units up to the last message, less the rounding of its reading.
    fn position(&self) -> f64 {
        self.units as f64 - self.uneven
    }

    /// The line's offset, ns, at a sensor time in s.
    fn offset_at(&self, t: f64) -> f64 {
        self.offset + self.drift * (t - self.since)
    }

    /// Arrival minus line, ns.
    fn late(&self, arrival_ns: i64, units: f64) -> f64 {
        let line = units * self.unit_ns + self.offset_at(self.seconds(units));
        arrival_ns.saturating_sub(self.origin_ns) as f64 - line
    }

    /// The stamp of the last message.
    pub fn stamp(&self) -> i64 {
        let units = self.position();
        let line = units * self.unit_ns + self.offset_at(self.seconds(units));
        self.origin_ns.saturating_add(line.round() as i64)
    }

    /// Time that the sensor took for the message that was passed on to last, ns: by its own clock where it sends
    /// that, because by that it integrates.
    pub fn interval_ns(&self, next: &Next) -> f64 {
        let unit_ns = self.tick_ns.unwrap_or_else(|| self.unit_ns());
        let stride = self.mean_stride();
        let units = next.units as f64 / next.lost.saturating_add(1) as f64;
        // Two readings are rounded: what they can explain is no other interval.
        let same = next.restart || next.units == 0 || (units - stride).abs() <= 2.0 * self.rounding;
        unit_ns * if same { stride } else { units }
    }

    /// The port was opened again: the next message must show that the sensor went on; the mere arrivals do not.
    pub fn reopened(&mut self) {
        self.reopened = true;
    }

    /// Where a message belongs; `None` where nothing connects it with the last.
    pub fn next(&mut self, arrival_ns: i64, message: &Message) -> Option<Next> {
        if self.lost_track {
            return None;
        }
        let silence = arrival_ns.saturating_sub(self.last_arrival_ns);
        let mut units = self.step();
        let now = Reading::of(self.source, message);
        if let (Some(now), Some(before)) = (now, self.reading) {
            units = now.since(before)?.saturating_sub(self.unread);
            if let Some(wrap) = now.wraps_at
                && silence >= SILENCE_NS
                && units != self.step()
            {
                let late = self.late(arrival_ns, self.units.saturating_add(units) as f64);
                let round = (late / (wrap as f64 * self.unit_ns) + 0.25).floor().max(0.0);
                units = units.saturating_add((round as u64).saturating_mul(wrap));
            }
        } else if self.source == Source::Arrival
            && silence as f64 >= PAUSE_NS.max(PAUSE_PERIODS * self.period_ns())
            && !std::mem::take(&mut self.waited)
        {
            return None;
        }
        units = units.saturating_add(std::mem::take(&mut self.passed_over));
        let late = self.late(arrival_ns, self.units.saturating_add(units) as f64);
        if self.source != Source::Arrival && late < -self.ahead_ns - 1e-4 * silence as f64 {
            return None;
        }
        if std::mem::take(&mut self.reopened) && late > SET_NS + 1e-4 * silence as f64 {
            return None;
        }
        self.unread = if now.is_some() { 0 } else { self.unread.saturating_add(self.step()) };
        self.reading = now.or(self.reading);
        let (lost, certain) = self.lost_among(units);
        Some(Next { units, lost, certain: certain || lost == 0, restart: false })
    }

    /// Whether what came behind a silence had been sent in it, and waited for its reader: then these messages
    /// go on with the line.
    pub fn explains(&mut self, held: &[(i64, Message)]) -> bool {
        let (Some((first_ns, _)), Some((last_ns, _))) = (held.first(), held.last()) else {
            return false;
        };
        let silence = first_ns.saturating_sub(self.last_arrival_ns);
        let unconnected = self.lost_track || self.reopened || silence >= LOST_TRACK_NS;
        if self.source != Source::Arrival || unconnected {
            return false;
        }
        let elapsed = last_ns.saturating_sub(*first_ns) as f64;
        let sent = held.len() as f64 * self.period_ns();
        self.waited = sent >= 2.0 * elapsed || sent - elapsed >= 0.5 * silence as f64;
        self.waited
    }

    /// How many messages are missing where so many units passed up to the next, and whether that is certain.
    fn lost_among(&mut self, units: u64) -> (u64, bool) {
        let (stride, rounding) = (self.stride, self.rounding);
        let beyond = units as f64 + self.uneven - stride;
        let fine = stride >= FINE * rounding;
        let explained = if fine { 0.0 } else { rounding };
        let lost = ((beyond - explained) / stride).round().max(0.0);
        let left = beyond - lost * stride;
        // The mean of the first, so that it does not matter how the very first was rounded.
        let follow = (1.0 / (self.messages as f64 + 1.0)).max(FOLLOWED);
        self.uneven = (1.0 - follow) * left.clamp(-2.0 * rounding, 2.0 * rounding);
        self.messages = self.messages.saturating_add(1).saturating_add(lost as u64);
        // Half-way between two numbers nothing is certain.
        let sure = fine && left.abs() < 0.25 * stride + 0.5 * rounding;
        (lost as u64, sure && self.source != Source::Arrival)
    }

    /// Passes on to a message, and learns from its arrival.
    pub fn pass(&mut self, arrival_ns: i64, units: u64) {
        self.units = self.units.saturating_add(units);
        if arrival_ns != self.last_arrival_ns && self.bursts.len() < MOST_BURSTS {
            self.bursts.push(std::mem::take(&mut self.burst));
        }
        self.burst = self.burst.saturating_add((units as f64 / self.stride).round() as u64);
        self.last_arrival_ns = arrival_ns;
        let t = self.seconds(self.position());
        let late = self.late(arrival_ns, self.position());
        if self.block_messages == 0 {
            self.block_since = t;
            self.block_since_ns = arrival_ns;
            self.earliest_late = f64::INFINITY;
        }
        self.block_messages += 1;
        if late < self.earliest_late {
            self.earliest_late = late;
            let y = arrival_ns.saturating_sub(self.origin_ns) as f64 - 1e9 * t;
            self.earliest = Point { t, y, cycle: 0 };
        }
        let read_ns = arrival_ns.saturating_sub(self.block_since_ns);
        let whole = t - self.block_since >= BLOCK_S && read_ns >= BLOCK_READ_NS;
        if whole && self.block_messages >= BLOCK_MESSAGES {
            let block_s = t - self.block_since;
            self.ahead_ns = AHEAD_NS + (-self.earliest_late).max(0.0);
            self.block_messages = 0;
            self.earliest.cycle = strip::cycle_of(&self.bursts);
            self.bursts.clear();
            if !self.shows_a_step() {
                self.learn(t, block_s);
            }
        }
    }

    /// Whether all of a block came too late for the line: messages were lost that no counter told of,
    /// or a clock was set.
    fn shows_a_step(&mut self) -> bool {
        let late = self.earliest_late;
        let wrap = self.reading.and_then(|r| r.wraps_at);
        if self.source == Source::Arrival {
            // The last message of a burst waited less than a period, or it would not be the last.
            let curve = self.curve.level + self.curve.slope * (self.earliest.t - self.curve.t);
            let sure = self.earliest.y - curve - FAR * self.curve.level_sd;
            let periods = sure / self.period_ns() - UNSURE;
            if self.curve.points < SETTLED || sure < self.period_ns() + UNSURE_NS || periods < 1.0 {
                return false;
            }
            self.passed_over = periods as u64;
            return true;
        }
        let Some(wrap) = wrap else {
            self.lost_track = self.source == Source::Ticks && late > SET_NS;
            return self.lost_track;
        };
        let round = (late / (wrap as f64 * self.unit_ns)).round();
        if round >= 1.0 && late > 0.75 * wrap as f64 * self.unit_ns {
            self.passed_over = (round as u64).saturating_mul(wrap);
            return true;
        }
        self.lost_track = self.source == Source::Ticks && late > SET_NS;
        self.lost_track
    }

    /// Takes the block's earliest arrival in, and leads the line to the curve under them all.
    fn learn(&mut self, t: f64, block_s: f64) {
        let low = self.earliest_late < -(0.5 * self.period_ns()).max(2e6);
        self.low = if low { self.low + 1 } else { 0 };
        if self.low >= LOW {
            self.points.drain(..self.points.len().saturating_sub(LOW as usize - 1));
            self.low = 0;
        }
        if self.points.len() >= MOST_POINTS {
            self.points.remove(0);
        }
        self.points.push(self.earliest);
        let mut hull = Vec::with_capacity(self.points.len());
        let Some(curve) = envelope::under(&self.points, &mut hull) else { return };
        let curve = strip::mean(&self.points, self.period_ns(), curve).unwrap_or(curve);
        self.curve = curve;
        let (offset, soon) = (self.offset_at(t), (curve.span / 4.0).clamp(SOON_S.0, SOON_S.1));
        let to = curve.level + curve.slope * (t - curve.t);
        let soon = soon.max(2.0 * block_s);
        self.drift = curve.slope + ((to - offset) / soon).clamp(-FASTEST, FASTEST);
        self.offset = offset;
        self.since = t;
    }
}
