//! What places a message in time: the sensor's ticks, its count, or that it is the next one.

use crate::live::Message;

/// What sample times come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Source {
    /// The sensor's clock.
    Ticks,
    /// The numbers of its messages.
    Count,
    /// That messages came, and when.
    #[default]
    Arrival,
}

/// A counter's reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reading {
    pub value: u64,
    pub wraps_at: Option<u64>,
    /// Of ticks: how many make a second. A sender of several messages may count in several units.
    pub per_second: Option<u64>,
}

impl Reading {
    /// What `source` reads in a message.
    pub fn of(source: Source, message: &Message) -> Option<Self> {
        match source {
            Source::Ticks => message.ticks.map(|t| Self {
                value: t.value,
                wraps_at: t.wraps_at.filter(|w| *w > 0),
                per_second: Some(t.per_second),
            }),
            Source::Count => message.count.map(|c| Self {
                value: u64::from(c.value),
                wraps_at: Some(c.wraps_at).filter(|w| *w > 0),
                per_second: None,
            }),
            Source::Arrival => None,
        }
    }

    /// Units from `before` to this, fewer than the counter counts to before it wraps; `None` where it
    /// went back and never wraps, or counts in another unit.
    pub fn since(self, before: Self) -> Option<u64> {
        if self.per_second != before.per_second {
            return None;
        }
        match self.wraps_at {
            // A value at or above the wrap is a sensor's mistake: taken as if it had wrapped.
            Some(wrap) => {
                let (now, then) = (self.value % wrap, before.value % wrap);
                Some(if now >= then { now - then } else { now + (wrap - then) })
            }
            None => self.value.checked_sub(before.value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_wrap_or_go_back() {
        let at = |value, wraps_at| Reading { value, wraps_at, per_second: None };
        assert_eq!(at(3, Some(256)).since(at(250, Some(256))), Some(9));
        assert_eq!(at(250, Some(256)).since(at(250, Some(256))), Some(0));
        assert_eq!(at(3, None).since(at(250, None)), None);
        assert_eq!(at(u64::MAX, None).since(at(0, None)), Some(u64::MAX));
        let micros = Reading { per_second: Some(1_000_000), ..at(5, None) };
        assert_eq!(micros.since(Reading { per_second: Some(1000), ..micros }), None);
        let all = Some(u64::MAX);
        assert_eq!(at(5, all).since(at(u64::MAX - 1, all)), Some(6));
    }
}
