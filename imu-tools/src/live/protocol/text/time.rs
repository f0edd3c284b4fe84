//! The time that lines carry, as ticks of the sensor's clock.
//!
//! Where nothing tells the unit, the spacing of the first times does, as in tables; they have no ticks
//! yet. A count of whole milliseconds or microseconds that stayed below 2³² is taken for one of 32 bits,
//! which is what `millis()` and `micros()` of small boards are.

use super::Pointed;
use super::layout::Time;
use crate::live::Ticks;
use crate::recording::TimeUnit;
use crate::recording::csv::{number, time_unit};

/// Times from which the unit is told.
const LEARNT_FROM: usize = 16;

const NANOSECOND: u64 = 1_000_000_000;

/// A clock that lines show.
pub struct Clock {
    unit: Option<TimeUnit>,
    /// The first times.
    first: [Pointed; LEARNT_FROM],
    seen: usize,
    /// A time was beyond 32 bits, or in parts of a unit.
    is_wide: bool,
}

impl Clock {
    /// Of this unit, if it is told.
    pub fn new(unit: Option<TimeUnit>) -> Self {
        Self { unit, first: [Pointed::EMPTY; LEARNT_FROM], seen: 0, is_wide: false }
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
        let (Some(place), Some(time)) = (self.first.get_mut(self.seen), Pointed::of(written))
        else {
            return;
        };
        *place = time;
        self.seen += 1;
        if self.seen == LEARNT_FROM {
            self.unit = Some(time_unit::from_data(&self.first.each_ref().map(Pointed::get)));
        }
    }
}

/// Nanoseconds of a number of units with a decimal point or comma.
fn nanoseconds(written: &[u8], unit: TimeUnit) -> Option<i64> {
    number::nanoseconds(Pointed::of(written)?.get(), unit.exponent())
}
