//! Handling, bumps and passing trucks: stretches in which a sensor that should be at rest is not.
//!
//! Samples are held back in windows of about a second. A window in which the sensor is touched has
//! a larger variance than the others, or a mean that jumps away from its neighbour's. What is usual
//! is learnt from the recording: centre and spread of the logarithm of the variance, and the size of
//! the steps between neighbouring means, both from the lower quartile of the last 512 windows,
//! so that they stay right while up to two thirds of those are disturbed. A window beyond
//! 8 spreads is disturbed, and so are eight in a row whose average is (a weak, long
//! vibration); with each go its two neighbours. So does a window in which an axis stands still that
//! otherwise never does: a sensor or a driver that hangs. Averages of more windows show a small change
//! that lasts ([`Shifts`]).
//!
//! What is disturbed becomes missing time, which costs the longer averaging times next to nothing.
//! But a sensor that was moved stands otherwise than before, and shows another part of gravity: if
//! the means after the stretch are not those before it, no difference may span it, and it becomes a
//! restart.
//!
//! Memory: the first [`START`] windows are held back, of 2048 samples at most, then some 50, and 40 more
//! after a disturbed stretch.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::held::{Piece, Window, window};
use super::limits::Limits;
use super::shifts::Shifts;
use super::usual::{GROUP, Usual, WindowStatistics};
use crate::recording::Event;

/// Windows that show what is usual before any is judged.
const START: usize = 256;
/// In a recording of fewer windows nothing is judged.
const FEWEST: usize = 16;
/// The usual is learnt anew after so many windows.
const RELEARN: u64 = 64;
/// A window waits for so many after it: a group may still condemn it, or its neighbour.
const WAIT: usize = GROUP + 2;
/// A window with a hole of so many is no neighbour of the others.
const FAR: u64 = 8;
/// Windows on either side of a disturbed stretch whose means are compared.
const LEVEL: usize = 32;
/// Fewer do not show a level.
const FEWEST_FOR_LEVEL: usize = 8;
/// Stretches that are listed, at most.
const LISTED: usize = 1000;

/// A stretch of samples on the grid, first and behind the last, missing ones counted.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
pub(super) struct Stretch {
    pub(super) from: u64,
    pub(super) to: u64,
    /// The axes that stood still in it.
    pub(super) frozen: [bool; 3],
}

/// Holds a sensor's samples back until it is known whether it was at rest.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Stillness {
    /// Samples a window; nothing is judged before it is known.
    window: usize,
    /// A reading beyond them is a glitch, which disturbs nobody.
    limits: Option<Limits>,
    /// Disturbed stretches are told, and passed on all the same.
    keep_all: bool,
    open: Window,
    position: u64,
    /// Windows that wait, oldest first.
    waiting: VecDeque<Window>,
    /// Emptied ones, whose memory is used again.
    spare: Vec<Window>,
    usual: Usual,
    judged: bool,
    windows: u64,
    shifts: Shifts,
    /// How many of those that wait were shown to `shifts`, and how many were examined by it.
    shown: usize,
    examined: usize,
    /// The number of the first that waits, and of the last one with a mean that was examined.
    first: u64,
    last_mean: u64,
    /// The window after a disturbed one goes with it.
    follows: bool,
    /// Means of the last windows that were passed on.
    before: VecDeque<[f64; 3]>,
    /// Instants left out since then; `None` while nothing is.
    left_out: Option<u64>,
    /// A restart lies in what was left out.
    restarted: bool,
    stretches: Vec<Stretch>,
}

impl Stillness {
    pub(super) fn new(keep_all: bool) -> Self {
        Self {
            window: 0,
            limits: None,
            keep_all,
            open: Window::default(),
            position: 0,
            waiting: VecDeque::new(),
            spare: Vec::new(),
            usual: Usual::default(),
            judged: false,
            windows: 0,
            shifts: Shifts::default(),
            shown: 0,
            examined: 0,
            first: 0,
            last_mean: 0,
            follows: false,
            before: VecDeque::new(),
            left_out: None,
            restarted: false,
            stretches: Vec::new(),
        }
    }

    /// Takes what the timeline says, `period_s` apart, and hands on what is decided.
    pub(super) fn take(
        &mut self,
        event: Event<'_>,
        period_s: f64,
        limits: Option<Limits>,
        to: &mut impl FnMut(Event<'_>),
    ) {
        if self.window == 0 {
            self.window = window(1.0 / period_s);
        }
        self.limits = limits;
        match event {
            Event::Values(values) => {
                let mut values = values;
                while !values.is_empty() {
                    let room = self.window - self.open.values.len();
                    let (now, later) = values.split_at(room.min(values.len()));
                    self.open.values.extend_from_slice(now);
                    match self.open.pieces.last_mut() {
                        Some(Piece::Values(n)) => *n += now.len(),
                        _ => self.open.pieces.push(Piece::Values(now.len())),
                    }
                    self.open.length += now.len() as u64;
                    if self.open.values.len() == self.window {
                        self.close(to);
                    }
                    values = later;
                }
            }
            Event::Missing(n) => {
                self.open.pieces.push(Piece::Missing(n));
                self.open.length += n;
                if n >= self.window as u64 {
                    self.close(to);
                }
            }
            Event::Restart => {
                self.close(to);
                self.open.pieces.push(Piece::Restart);
            }
        }
    }

    /// Hands on what still waits. What is usual of the next record is learnt anew.
    pub(super) fn next_record(&mut self, to: &mut impl FnMut(Event<'_>)) {
        self.close(to);
        if !self.judged && self.waiting.len() >= FEWEST {
            self.judge_all();
        }
        self.release(true, to);
        let next = Self::new(self.keep_all);
        let (position, stretches) = (self.position, std::mem::take(&mut self.stretches));
        *self = Self { position, stretches, ..next };
    }

    /// Hands on what still waits. Says which stretches are disturbed.
    pub(super) fn finish(mut self, to: &mut impl FnMut(Event<'_>)) -> Vec<Stretch> {
        self.next_record(to);
        self.stretches
    }

    /// Whether the sensor is not at rest, by the last complete window; `None` as long as too few show
    /// what is usual.
    pub(super) fn is_disturbed(&self) -> Option<bool> {
        self.waiting.back().filter(|_| self.judged).map(|window| window.disturbed)
    }

    /// A window is complete.
    fn close(&mut self, to: &mut impl FnMut(Event<'_>)) {
        if self.open.is_empty() {
            return;
        }
        let mut window = std::mem::replace(&mut self.open, self.spare.pop().unwrap_or_default());
        window.start = self.position;
        self.position += window.length;
        window.statistics = self
            .limits
            .and_then(|limits| WindowStatistics::of(&window.values, self.window, &limits));
        if let Some(statistics) = window.statistics {
            window.frozen = self.usual.frozen(&statistics);
            if !window.is_frozen() {
                let hung = self.waiting.back().is_some_and(Window::is_frozen);
                self.usual.push(statistics, hung || window.restarts());
                self.windows += 1;
            }
        }
        self.waiting.push_back(window);
        if self.judged {
            if self.windows.is_multiple_of(RELEARN) {
                self.usual.learn();
            }
            self.judge_last();
        } else if self.waiting.len() >= START {
            self.judge_all();
        }
        self.release(false, to);
    }

    /// Judges the windows that have waited for that.
    fn judge_all(&mut self) {
        self.judged = true;
        self.usual.learn();
        let mut waiting = std::mem::take(&mut self.waiting);
        let mut hung = false;
        self.usual.forget();
        for window in &mut waiting {
            let Some(statistics) = window.statistics else { continue };
            window.frozen = self.usual.frozen(&statistics);
            if !window.is_frozen() {
                self.usual.push(statistics, hung || window.restarts());
            }
            hung = window.is_frozen();
        }
        self.usual.learn();
        self.usual.rewind(self.usual.len());
        for window in waiting {
            if window.statistics.is_some() && !window.is_frozen() {
                self.usual.step();
            }
            self.waiting.push_back(window);
            self.judge_last();
        }
        self.show(WAIT);
        self.shifts.learn(self.usual.steps());
    }

    /// Shows all but the last `wait` windows to what finds shifts.
    fn show(&mut self, wait: usize) {
        let (steps, far) = (self.usual.steps(), FAR * self.window as u64);
        let until = self.waiting.len().saturating_sub(wait);
        for window in self.waiting.iter().take(until).skip(self.shown) {
            let mean = window.neighbour(far);
            if window.disturbed || window.length > far || window.restarts() {
                self.shifts.show_break();
            }
            if let Some(mean) = mean {
                self.shifts.show(mean, steps);
            }
        }
        self.shown = self.shown.max(until);
    }

    /// Looks for shifts in all but the last `wait` windows.
    fn examine(&mut self, wait: usize) {
        self.show(wait);
        let far = FAR * self.window as u64;
        while self.examined + wait < self.waiting.len() {
            let Some(window) = self.waiting.get(self.examined) else { return };
            let number = self.first + self.examined as u64;
            self.examined += 1;
            let mean = window.neighbour(far);
            let hole = window.length > far || number > self.last_mean + FAR;
            if window.disturbed || hole || window.restarts() {
                self.end_stretch();
            }
            if let Some(mean) = mean {
                self.last_mean = number;
                let found = self.shifts.push(number, mean);
                self.leave_out_shift(found);
            }
        }
    }

    /// The next window is no neighbour of those before it.
    fn end_stretch(&mut self) {
        for found in self.shifts.end_stretch() {
            self.leave_out_shift(Some(found));
        }
    }

    /// The windows in which the sensor goes from one level to another are not at rest.
    fn leave_out_shift(&mut self, found: Option<(u64, u64)>) {
        let Some((from, to)) = found else { return };
        for (number, window) in (self.first..).zip(&mut self.waiting) {
            if (from..=to).contains(&number) {
                window.disturbed = true;
                window.shifts = true;
            }
        }
    }

    /// Judges the last window, in the light of those before it.
    fn judge_last(&mut self) {
        let last = self.waiting.len() - 1;
        let has = self.waiting.back().is_some_and(|window| window.statistics.is_some());
        let frozen = self.waiting.back().is_some_and(Window::is_frozen);
        let alone = frozen || (has && self.usual.last_is_disturbed());
        let group = has && !frozen && self.usual.group_is_disturbed();
        let from = if group {
            last.saturating_sub(GROUP)
        } else if alone {
            last.saturating_sub(1)
        } else {
            last
        };
        let own = alone || group || self.follows;
        for window in self.waiting.iter_mut().skip(from) {
            window.disturbed |= own;
        }
        // A window without statistics hands the verdict on.
        self.follows = alone || group || (self.follows && !has);
    }

    /// Hands on windows that nothing can condemn any more.
    fn release(&mut self, at_end: bool, to: &mut impl FnMut(Event<'_>)) {
        if !self.judged && !at_end {
            return;
        }
        if self.judged {
            self.examine(if at_end { 0 } else { WAIT });
            if at_end {
                self.end_stretch();
            }
        }
        let held = self.shifts.holds().map(|number| number.saturating_sub(self.first) as usize);
        let examined = if at_end { self.waiting.len() } else { self.examined };
        let mut ready = held.unwrap_or(examined).min(examined);
        while ready > 0 {
            let disturbed = self.waiting.front().is_some_and(|window| window.disturbed);
            if !disturbed && let Some(gap) = self.left_out {
                let still = self.waiting.iter().take(ready).take_while(|w| !w.disturbed).count();
                if still == ready && still < LEVEL && !at_end {
                    return;
                }
                self.bridge(gap, still, to);
            }
            let Some(window) = self.waiting.pop_front() else { return };
            ready -= 1;
            self.first += 1;
            self.shown = self.shown.saturating_sub(1);
            self.examined = self.examined.saturating_sub(1);
            if disturbed {
                self.leave_out(&window, to);
            } else {
                window.tell(to);
                if let Some(statistics) = window.statistics {
                    if self.before.len() == LEVEL {
                        self.before.pop_front();
                    }
                    self.before.push_back(statistics.mean);
                }
            }
            self.reuse(window);
        }
    }

    /// Time passes in which the sensor was not at rest.
    fn leave_out(&mut self, window: &Window, to: &mut impl FnMut(Event<'_>)) {
        let (from, frozen) = (window.start, window.frozen);
        let stretch = Stretch { from, to: from + window.length, frozen };
        let room = self.stretches.len() < LISTED;
        match self.stretches.last_mut() {
            Some(last) if last.to == stretch.from => {
                last.to = stretch.to;
                last.frozen = [0, 1, 2].map(|axis| last.frozen[axis] | frozen[axis]);
            }
            _ if room => self.stretches.push(stretch),
            _ => {}
        }
        if self.keep_all {
            window.tell(to);
            return;
        }
        self.restarted |= window.shifts || window.restarts();
        *self.left_out.get_or_insert(0) += window.length;
    }

    /// Ends a stretch that was left out, before the `still` windows that wait at the front.
    fn bridge(&mut self, gap: u64, still: usize, to: &mut impl FnMut(Event<'_>)) {
        self.left_out = None;
        let means = |w: &Window| w.statistics.map(|statistics| statistics.mean);
        let after: Vec<[f64; 3]> =
            self.waiting.iter().take(still.min(LEVEL)).filter_map(means).collect();
        let many = after.len().min(self.before.len());
        let apart = gap.div_ceil(self.window.max(1) as u64) as usize;
        let same = many >= FEWEST_FOR_LEVEL && {
            let before = self.before.iter().rev().take(many).copied();
            let after = after.iter().take(many).copied();
            self.usual.same_level(before, after, many, apart, apart + self.waiting.len())
        };
        let restart = std::mem::take(&mut self.restarted) || !same;
        if restart {
            to(Event::Restart);
            self.before.clear();
        } else {
            to(Event::Missing(gap));
        }
    }

    fn reuse(&mut self, mut window: Window) {
        if self.spare.len() < 2 * WAIT {
            window.pieces.clear();
            window.values.clear();
            window.length = 0;
            window.statistics = None;
            window.disturbed = false;
            window.frozen = [false; 3];
            window.shifts = false;
            self.spare.push(window);
        }
    }
}

#[cfg(test)]
#[path = "stillness_tests.rs"]
mod tests;
