//! The time that lines carry, as ticks of the sensor's clock.
//!
//! Where nothing tells the unit, the spacing of the first times does, as in tables; they have no ticks
//! yet. A count of whole milliseconds or microseconds that stayed below 2³² is taken for one of 32 bits,
//! which is what `millis()` and `micros()` of small boards are.

use super::layout::Time;
use crate::live::Ticks;
use crate::recording::TimeUnit;
use crate::recording::csv::{number, time_unit};

/// Times from which the unit is told.
const LEARNT_FROM: usize = 16;
/// Bytes of such a time.
const LONGEST: usize = 32;

const NANOSECOND: u64 = 1_000_000_000;

/// A clock that lines show.
pub struct Clock {
    unit: Option<TimeUnit>,
    /// The first times as they were written.
    first: [[u8; LONGEST]; LEARNT_FROM],
    lengths: [usize; LEARNT_FROM],
    seen: usize,
    /// A time was beyond 32 bits, or in parts of a unit.
    is_wide: bool,
}

impl Clock {
    /// Of this unit, if it is told.
    pub fn new(unit: Option<TimeUnit>) -> Self {
        Self {
            unit,
            first: [[0; LONGEST]; LEARNT_FROM],
            lengths: [0; LEARNT_FROM],
            seen: 0,
            is_wide: false,
        }
    }

    /// The ticks at a line's time, once its unit is known.
    pub fn ticks(&mut self, time: Time<'_>) -> Option<Ticks> {
        let written = match time {
            Time::Units(written) => written,
            Time::Nanoseconds(value) => {
                let value = u64::try_from(value).ok()?;
                return Some(Ticks { value, per_second: NANOSECOND, wraps_at: None });
            }
        };
        let Some(unit) = self.unit else {
            self.learn(written);
            return None;
        };
        let value = u64::try_from(nanoseconds(written, unit)?).ok()?;
        let tick = 10_u64.checked_pow(unit.exponent())?;
        let wrap = tick.saturating_mul(1 << 32);
        self.is_wide |= value >= wrap || value % tick != 0;
        let counts = matches!(unit, TimeUnit::Milliseconds | TimeUnit::Microseconds);
        let wraps_at = (counts && !self.is_wide).then_some(wrap);
        Some(Ticks { value, per_second: NANOSECOND, wraps_at })
    }

    /// Keeps one of the first times, and finds the unit when there are enough.
    fn learn(&mut self, written: &[u8]) {
        let (Some(place), Some(length)) =
            (self.first.get_mut(self.seen), self.lengths.get_mut(self.seen))
        else {
            return;
        };
        *length = written.len().min(LONGEST);
        for (to, from) in place.iter_mut().zip(written) {
            *to = if *from == b',' { b'.' } else { *from };
        }
        self.seen += 1;
        if self.seen == LEARNT_FROM {
            let mut times: [&[u8]; LEARNT_FROM] = [&[]; LEARNT_FROM];
            for ((time, text), length) in times.iter_mut().zip(&self.first).zip(self.lengths) {
                *time = text.get(..length).unwrap_or_default();
            }
            self.unit = Some(time_unit::from_data(&times));
        }
    }
}

/// Nanoseconds of a number of units with a decimal point or comma.
fn nanoseconds(written: &[u8], unit: TimeUnit) -> Option<i64> {
    let mut pointed = [0; LONGEST];
    let place = pointed.get_mut(..written.len())?;
    for (to, from) in place.iter_mut().zip(written) {
        *to = if *from == b',' { b'.' } else { *from };
    }
    number::nanoseconds(place, unit.exponent())
}
