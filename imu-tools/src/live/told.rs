//! What a user is told of a stream while it runs: that nothing comes, what was found out, what is wrong.

use std::time::{Duration, Instant};

use super::face::Face;
use super::link::Link;
use super::port::Arrival;

/// Nothing came for so long: the user is told. Of a sensor that is merely slow, once.
const SILENCE: Duration = Duration::from_secs(10);

/// When something came last.
pub(super) struct Heard {
    at: Instant,
    patience: Duration,
}

impl Default for Heard {
    fn default() -> Self {
        Self { at: Instant::now(), patience: SILENCE }
    }
}

impl Heard {
    /// Notes that something came, if it did: a port that is open hands on empty pieces, too. That it went away
    /// is told elsewhere.
    pub(super) fn note(&mut self, arrival: &Arrival, link: &mut Link, face: &mut dyn Face) {
        match arrival {
            Arrival::Bytes { bytes, .. } if !bytes.is_empty() => {}
            Arrival::Gone(_) | Arrival::Back => {
                (self.at, link.silent_s) = (Instant::now(), None);
                return;
            }
            _ => return,
        }
        if let Some(silent_s) = link.silent_s.take() {
            face.say(&format!("{} sends again, after {silent_s:.0} s of silence", link.name));
            self.patience = 2 * self.at.elapsed();
        }
        self.at = Instant::now();
    }

    /// Says that it is silent, if it is; what went away was said.
    pub(super) fn look(&self, link: &mut Link, face: &mut dyn Face) {
        let silence = self.at.elapsed();
        if link.gone.is_some() || silence < self.patience {
            return;
        }
        if link.silent_s.replace(silence.as_secs_f64()).is_none() {
            face.say(&format!(
                "{}: nothing came for {} s: see that the sensor has power and sends by itself",
                link.name,
                silence.as_secs()
            ));
        }
    }
}

/// What is amiss and was well for so long is said again.
const WELL: Duration = Duration::from_secs(60);

/// What the user was told of the stream.
pub(super) struct Told {
    learnt: Option<String>,
    amiss: Option<String>,
    /// Since when nothing is amiss, as was seen.
    well: Option<Instant>,
    patience: Duration,
}

impl Default for Told {
    fn default() -> Self {
        Self { learnt: None, amiss: None, well: None, patience: WELL }
    }
}

impl Told {
    /// Says what was found out about it, and what is wrong with it: once, and again where it was well meanwhile.
    pub(super) fn tell(&mut self, link: &Link, face: &mut dyn Face) {
        if link.learnt != self.learnt {
            self.learnt.clone_from(&link.learnt);
            self.learnt.iter().for_each(|sentence| face.say(sentence));
        }
        let Some(why) = &link.amiss else {
            self.well.get_or_insert_with(Instant::now);
            return;
        };
        let was_well = self.well.take().is_some_and(|since| since.elapsed() >= self.patience);
        if was_well || link.amiss != self.amiss {
            self.amiss.clone_from(&link.amiss);
            face.say(&format!("warning: {}: {why}", link.name));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::error::Error;
    use crate::live::session::View;

    /// Remembers what was said.
    #[derive(Default)]
    struct Said(Vec<String>);

    impl Face for Said {
        fn every(&self) -> Duration {
            Duration::MAX
        }

        fn show(&mut self, _: &View) -> Result<(), Error> {
            Ok(())
        }

        fn say(&mut self, sentence: &str) {
            self.0.push(sentence.to_owned());
        }
    }

    #[test]
    fn what_is_amiss_is_said_once_and_again_where_it_was_well_for_long() {
        let (mut told, mut said) = (Told::default(), Said::default());
        let of = |amiss: Option<&str>| Link {
            name: "it".into(),
            amiss: amiss.map(str::to_owned),
            ..Link::default()
        };
        for amiss in [None, Some("a"), Some("a"), None, Some("a"), Some("b")] {
            told.tell(&of(amiss), &mut said);
        }
        assert_eq!(said.0, ["warning: it: a", "warning: it: b"]);
        // However long after the last time it is looked at,
        told.patience = Duration::ZERO;
        told.tell(&of(Some("b")), &mut said);
        assert_eq!(said.0.len(), 2);
        // it must have been well in between.
        told.tell(&of(None), &mut said);
        told.tell(&of(Some("b")), &mut said);
        assert_eq!(said.0[2..], ["warning: it: b"]);
    }

    #[test]
    fn a_port_where_nothing_comes_is_told_of_once_and_when_it_sends_again() {
        let mut watch = Said::default();
        let mut link = Link { name: "it".into(), ..Link::default() };
        let piece = |bytes: &[u8]| Arrival::Bytes { arrival_ns: 0, bytes: bytes.to_vec() };
        let mut heard = Heard { at: Instant::now(), patience: Duration::ZERO };
        // A port that is open hands on empty pieces; one that went away was told of.
        heard.note(&piece(b""), &mut link, &mut watch);
        link.silent_s = Some(12.0);
        heard.note(&Arrival::Gone("unplugged".into()), &mut link, &mut watch);
        link.gone = Some("unplugged".into());
        heard.look(&mut link, &mut watch);
        assert_eq!((watch.0.len(), link.silent_s), (0, None));
        link.gone = None;
        for _ in 0..3 {
            heard.look(&mut link, &mut watch);
        }
        assert_eq!(
            watch.0,
            ["it: nothing came for 0 s: see that the sensor has power and sends by itself"]
        );
        assert!(link.silent_s.is_some());
        heard.note(&piece(b"1"), &mut link, &mut watch);
        assert_eq!(watch.0[1..], ["it sends again, after 0 s of silence"]);
        assert_eq!(link.silent_s, None);
        // Of a sensor that is merely slow it is told once.
        heard.patience = heard.at.elapsed() + SILENCE;
        heard.look(&mut link, &mut watch);
        assert_eq!(watch.0.len(), 2);
    }
}
