//! What a log says of itself: formats, and which topic each number of its data stands for.

use super::channel::{Kind, Layout};
use super::format::{Defined, Formats};

/// Subscriptions kept, at most: a log has a few hundred.
const SUBSCRIPTIONS: usize = 4096;

/// Length of a topic's name, at most.
pub const NAME: usize = 255;

/// A topic's instance, as data names it by its number.
#[derive(Clone, Debug)]
pub struct Subscription {
    /// Name of the topic, which is that of its format.
    pub topic: String,
    /// Which of several of its kind.
    pub instance: u8,
    /// Lengths of its data without padding at the end and with it, where its format tells.
    pub lengths: Option<(usize, usize)>,
    /// What it is to us.
    pub kind: Option<Kind>,
    /// How it is read, or why it cannot be; of a topic of an IMU.
    pub layout: Option<Result<Layout, String>>,
    /// Messages so far.
    pub messages: u64,
}

impl Subscription {
    /// As `--topic` and lists call it.
    pub fn label(&self) -> String {
        format!("{}:{}", self.topic, self.instance)
    }

    /// How it is read, where it is of an IMU and can be.
    pub fn readable(&self) -> Option<(Kind, &Layout)> {
        Some((self.kind?, self.layout.as_ref()?.as_ref().ok()?))
    }
}

/// What became of a subscription message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subscribed {
    /// A new one, at this place.
    New(usize),
    /// It was known, the same.
    Known,
    /// Its number stands for another topic.
    Contradicts,
    /// It is none, or there are too many.
    Refused,
}

/// Formats and subscriptions.
#[derive(Clone, Debug, Default)]
pub struct Definitions {
    /// Formats by name.
    pub formats: Formats,
    subscriptions: Vec<Subscription>,
    /// Place in `subscriptions` by number, plus 1.
    places: Vec<u16>,
}

impl Definitions {
    /// All topics, in the order of the log.
    pub fn subscriptions(&self) -> &[Subscription] {
        &self.subscriptions
    }

    /// Place of the topic that a number stands for.
    #[inline]
    pub fn place(&self, number: u16) -> Option<usize> {
        usize::from(*self.places.get(usize::from(number))?).checked_sub(1)
    }

    /// The topic at a place.
    #[inline]
    pub fn at(&self, place: usize) -> Option<&Subscription> {
        self.subscriptions.get(place)
    }

    /// Counts a message.
    #[inline]
    pub fn count(&mut self, place: usize) {
        if let Some(subscription) = self.subscriptions.get_mut(place) {
            subscription.messages += 1;
        }
    }

    /// Takes a format message.
    pub fn define(&mut self, body: &[u8]) -> Defined {
        self.formats.define(body)
    }

    /// Takes a subscription message.
    pub fn subscribe(&mut self, body: &[u8]) -> Subscribed {
        let Some(([instance, low, high], name)) = body.split_first_chunk() else {
            return Subscribed::Refused;
        };
        let (instance, number) = (*instance, u16::from_le_bytes([*low, *high]));
        let Ok(topic) = std::str::from_utf8(name) else { return Subscribed::Refused };
        if let Some(known) = self.place(number).and_then(|place| self.at(place)) {
            let same = known.topic == topic && known.instance == instance;
            return if same { Subscribed::Known } else { Subscribed::Contradicts };
        }
        let place = self.subscriptions.len();
        if topic.is_empty() || topic.len() > NAME || place >= SUBSCRIPTIONS {
            return Subscribed::Refused;
        }
        let sibling = self.subscriptions.iter().find(|other| other.topic == topic);
        let kind = Kind::of(topic);
        let (lengths, layout) = match sibling {
            Some(sibling) => (sibling.lengths, sibling.layout.clone()),
            None => (
                self.formats.lengths(topic),
                kind.map(|kind| Layout::of(kind, topic, &self.formats)),
            ),
        };
        let topic = topic.to_owned();
        let subscription = Subscription { topic, instance, lengths, kind, layout, messages: 0 };
        self.subscriptions.push(subscription);
        let needed = usize::from(number) + 1;
        if self.places.len() < needed {
            self.places.resize(needed, 0);
        }
        if let (Some(to), Ok(place)) =
            (self.places.get_mut(usize::from(number)), u16::try_from(place + 1))
        {
            *to = place;
        }
        Subscribed::New(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subscription(instance: u8, number: u16, topic: &str) -> Vec<u8> {
        let [low, high] = number.to_le_bytes();
        [&[instance, low, high], topic.as_bytes()].concat()
    }

    #[test]
    fn a_number_stands_for_the_first_topic_that_took_it() {
        let mut definitions = Definitions::default();
        definitions.define(b"sensor_gyro:uint64_t timestamp;float x;float y;float z;");
        let first = subscription(1, 300, "sensor_gyro");
        assert_eq!(definitions.subscribe(&first), Subscribed::New(0));
        assert_eq!(definitions.subscribe(&first), Subscribed::Known);
        let other = subscription(0, 300, "sensor_gyro");
        assert_eq!(definitions.subscribe(&other), Subscribed::Contradicts);
        assert_eq!(definitions.subscribe(&subscription(0, 2, "unknown")), Subscribed::New(1));
        assert_eq!(definitions.subscribe(&[0, 1]), Subscribed::Refused);
        assert_eq!(definitions.subscribe(&subscription(0, 3, "")), Subscribed::Refused);
        assert_eq!(definitions.place(300), Some(0));
        assert_eq!((definitions.place(0), definitions.place(9999)), (None, None));
        let topic = definitions.at(0).unwrap();
        assert_eq!((topic.label().as_str(), topic.lengths), ("sensor_gyro:1", Some((20, 20))));
        assert!(topic.readable().is_some());
        assert_eq!(definitions.at(1).unwrap().lengths, None);
    }
}
