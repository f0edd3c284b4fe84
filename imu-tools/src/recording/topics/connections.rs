//! What a recording has: its connections, the messages of each, and how they are listed.

use std::collections::HashSet;

use crate::recording::pose_body::PoseMessage;

/// Topics listed in an error, at most.
const LISTED: usize = 40;

/// Connections remembered, at most: a recording has a few dozen.
const CONNECTIONS: usize = 4096;

/// What the messages of a connection are to us.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Holds {
    /// Readings of an IMU in a layout that we know.
    Imu,
    /// Readings of a thermometer in a layout that we know.
    Temperature,
    /// Readings of an IMU that cannot be read, and why: a whole sentence without its beginning.
    Unreadable(String),
    /// Where a body is, in a layout that we know.
    Pose(PoseMessage),
    /// Something else.
    Other,
}

/// A publisher of a topic, as the recording describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connection {
    /// By which the recording calls it.
    pub number: u32,
    /// As the recording writes it.
    pub topic: String,
    /// Name of its messages' type.
    pub type_name: String,
    /// What they hold.
    pub holds: Holds,
}

/// `imu` and `/imu` are the same topic.
pub fn same(a: &str, b: &str) -> bool {
    bare(a) == bare(b)
}

fn bare(topic: &str) -> &str {
    topic.trim_start_matches('/')
}

/// All that the recording has described so far.
#[derive(Clone, Debug, Default)]
pub struct Connections {
    all: Vec<Connection>,
    /// Messages seen of each.
    messages: Vec<u64>,
}

impl Connections {
    /// In the order of the recording.
    pub fn iter(&self) -> std::slice::Iter<'_, Connection> {
        self.all.iter()
    }

    /// With the messages seen of each.
    pub fn counted(&self) -> impl Iterator<Item = (&Connection, u64)> {
        self.all.iter().zip(self.messages.iter().copied())
    }

    /// Whether this one was described.
    pub fn knows(&self, number: u32) -> bool {
        self.all.iter().any(|connection| connection.number == number)
    }

    /// Takes note of a connection; whether it is new, so that a choice is to be made. One that is
    /// described again keeps its first description, unless only the second can be used: then the
    /// first was damaged.
    pub fn add(&mut self, connection: Connection) -> bool {
        let known = self.all.iter_mut().find(|known| known.number == connection.number);
        if let Some(known) = known {
            let better = known.holds == Holds::Other && connection.holds != Holds::Other;
            if better {
                *known = connection;
            }
            return better;
        }
        if self.all.len() >= CONNECTIONS {
            return false;
        }
        self.all.push(connection);
        self.messages.push(0);
        true
    }

    /// Counts messages of a connection.
    pub fn count(&mut self, number: u32, messages: u64) {
        let place = self.all.iter().position(|c| c.number == number);
        if let Some(count) = place.and_then(|place| self.messages.get_mut(place)) {
            *count += messages;
        }
    }

    /// The names of topics, each once, in the order of the recording.
    pub fn names(&self, which: impl Fn(&Connection) -> bool) -> Vec<&str> {
        let mut seen = HashSet::new();
        let topics = self.all.iter().filter(|c| which(c)).map(|c| c.topic.as_str());
        topics.filter(|topic| seen.insert(bare(topic))).collect()
    }

    /// The topics in words, each once.
    pub fn list(&self, which: impl Fn(&Connection) -> bool) -> String {
        let mut seen = HashSet::new();
        let topics = self.all.iter().filter(|c| which(c)).map(|c| (&c.topic, &c.type_name));
        let mut topics = topics.filter(|(topic, kind)| seen.insert((bare(topic), *kind)));
        let listed = topics.by_ref().take(LISTED).map(|(topic, kind)| format!("{topic} ({kind})"));
        let listed: Vec<String> = listed.collect();
        let more = topics.count();
        let mut list = listed.join(", ");
        if more > 0 {
            list.push_str(&format!(" and {more} more"));
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_named_and_counted_once() {
        let mut connections = Connections::default();
        for number in 0..4 * 50 {
            let slash = if number % 2 == 0 { "/" } else { "" };
            let topic = format!("{slash}{}", number / 2 % 50);
            let type_name = "a".to_owned();
            connections.add(Connection { number, topic, type_name, holds: Holds::Imu });
        }
        let names = connections.names(|_| true);
        assert_eq!((names.len(), &names[..3]), (50, &["/0", "/1", "/2"][..]));
        let list = connections.list(|_| true);
        assert!(list.starts_with("/0 (a), /1 (a), "), "{list}");
        assert!(list.ends_with(", /39 (a) and 10 more"), "{list}");
    }
}
