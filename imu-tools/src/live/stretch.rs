//! Whether what comes lately is what a sensor sends: bytes are judged by the stretch that they are in, because
//! hours of good ones say nothing of a device that came back with another baud rate.

use super::protocol::Tally;

/// Bytes of a stretch, and of one behind bad ones: that all is well again shows sooner.
const STRETCH: u64 = 16_384;
const SHORT: u64 = 1024;

/// The part of a stretch that is refused with a wrong baud rate.
const TOO_MANY: f64 = 0.95;

/// So many messages are no chance: a sensor sent them.
const FEWEST: u64 = 8;

/// So many bytes without a sample are of a device that sends none any more; fewer before the first show it, but
/// that end may be worth waiting for.
const FRUITLESS: u64 = 65_536;
const FRUITLESS_SO_FAR: u64 = 4096;

/// What is wrong with bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amiss {
    /// This part of a stretch was of no frame.
    Refused(f64),
    /// Frames, and in so many bytes of them no sample.
    Fruitless(u64),
}

/// What came lately.
#[derive(Debug, Default)]
pub struct Stretch {
    /// What had come when this stretch began.
    began: Tally,
    /// What had come with the latest sample.
    sampled: Tally,
    amiss: Option<Amiss>,
}

impl Stretch {
    /// Looks at all that came so far.
    pub fn look(&mut self, tally: Tally) {
        if tally.messages > self.sampled.messages {
            self.sampled = tally;
            if matches!(self.amiss, Some(Amiss::Fruitless(_))) {
                self.amiss = None;
            }
        }
        let bytes = tally.bytes.saturating_sub(self.began.bytes);
        let is_bad = matches!(self.amiss, Some(Amiss::Refused(_)));
        if bytes > if is_bad { SHORT } else { STRETCH } {
            let share = tally.refused.saturating_sub(self.began.refused) as f64 / bytes as f64;
            self.amiss = (share > TOO_MANY).then_some(Amiss::Refused(share));
            self.began = tally;
        }
        let fruitless = tally.bytes.saturating_sub(self.sampled.bytes);
        let is_new = self.sampled.messages == 0;
        let is_refused = matches!(self.amiss, Some(Amiss::Refused(_)));
        if !is_refused && fruitless > if is_new { FRUITLESS_SO_FAR } else { FRUITLESS } {
            self.amiss = Some(Amiss::Fruitless(fruitless));
        }
    }

    /// What is wrong now.
    pub fn amiss(&self) -> Option<Amiss> {
        self.amiss
    }

    /// Whether that is the end of a session: no sensor was heard, and none will be.
    pub fn is_hopeless(&self) -> bool {
        !self.had_samples()
            && match self.amiss {
                Some(Amiss::Refused(_)) => true,
                Some(Amiss::Fruitless(bytes)) => bytes > FRUITLESS,
                None => false,
            }
    }

    /// Whether a sensor was heard before.
    pub fn had_samples(&self) -> bool {
        self.sampled.messages >= FEWEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many more of each.
    fn more(tally: &mut Tally, bytes: u64, refused: u64, messages: u64) -> Tally {
        tally.bytes += bytes;
        tally.refused += refused;
        tally.messages += messages;
        *tally
    }

    #[test]
    fn hours_of_good_bytes_hide_no_bad_stretch() {
        let (mut stretch, mut tally) = (Stretch::default(), Tally::default());
        for _ in 0..100_000 {
            stretch.look(more(&mut tally, 4096, 0, 100));
            assert_eq!(stretch.amiss(), None);
        }
        assert!(stretch.had_samples());
        // A frame in it is chance.
        for _ in 0..9 {
            stretch.look(more(&mut tally, 4096, 4096, 0));
        }
        stretch.look(more(&mut tally, 4096, 4050, 1));
        assert!(matches!(stretch.amiss(), Some(Amiss::Refused(share)) if share > TOO_MANY));
        // It stays so until good ones come, and those show at once.
        for _ in 0..9 {
            stretch.look(more(&mut tally, 512, 512, 0));
            assert!(matches!(stretch.amiss(), Some(Amiss::Refused(_))));
        }
        for _ in 0..3 {
            stretch.look(more(&mut tally, 512, 10, 10));
        }
        assert_eq!(stretch.amiss(), None);
    }

    #[test]
    fn a_few_messages_are_a_sensor_and_one_is_chance() {
        for (messages, was_heard) in [(1, false), (FEWEST, true)] {
            let (mut stretch, mut tally) = (Stretch::default(), Tally::default());
            stretch.look(more(&mut tally, 64 * messages, 0, messages));
            stretch.look(more(&mut tally, STRETCH, STRETCH, 0));
            assert!(matches!(stretch.amiss(), Some(Amiss::Refused(_))), "{messages}");
            assert_eq!((stretch.had_samples(), stretch.is_hopeless()), (was_heard, !was_heard));
        }
    }

    #[test]
    fn frames_without_a_sample_are_told_of_until_one_comes() {
        let (mut stretch, mut tally) = (Stretch::default(), Tally::default());
        stretch.look(more(&mut tally, 4096, 0, 0));
        assert_eq!(stretch.amiss(), None);
        for number in 2..=16 {
            stretch.look(more(&mut tally, 4096, 0, 0));
            assert_eq!(stretch.amiss(), Some(Amiss::Fruitless(4096 * number)));
            assert!(!stretch.is_hopeless());
        }
        stretch.look(more(&mut tally, 1, 0, 0));
        assert!(stretch.is_hopeless());
        stretch.look(more(&mut tally, 40_000, 0, FEWEST));
        assert_eq!(stretch.amiss(), None);
        for _ in 0..16 {
            stretch.look(more(&mut tally, 4096, 0, 0));
            assert_eq!(stretch.amiss(), None);
        }
        stretch.look(more(&mut tally, 4096, 0, 0));
        assert!(matches!(stretch.amiss(), Some(Amiss::Fruitless(_))) && !stretch.is_hopeless());
    }
}
