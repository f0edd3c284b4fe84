//! Which topic holds the IMU: the only one of its type, or the one that was asked for.

use std::path::Path;

use super::Stream;
use crate::error::Error;

/// Topics listed in an error, at most.
const LISTED: usize = 40;

/// Connections remembered, at most: a recording has a few dozen.
const CONNECTIONS: usize = 4096;

/// What the messages of a connection are to us.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Holds {
    /// Readings of an IMU in a layout that we know.
    Imu,
    /// Readings of an IMU that cannot be read, and why: a whole sentence without its end.
    Unreadable(String),
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

/// Which sensors are taken from a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Role {
    /// Of the connection.
    pub number: u32,
    /// Its angular rates are wanted.
    pub gyroscope: bool,
    /// Its specific forces are wanted.
    pub accelerometer: bool,
}

/// What was asked for, what there is, and what is taken.
#[derive(Clone, Debug)]
pub struct Topics {
    /// Topics of gyroscope and accelerometer.
    asked: Option<(String, String)>,
    connections: Vec<Connection>,
    /// Messages seen of each.
    messages: Vec<u64>,
    roles: Vec<Role>,
    /// Topics that were found, as the recording writes them.
    pub gyroscope: String,
    /// As above.
    pub accelerometer: String,
}

/// `imu` and `/imu` are the same topic.
fn same(a: &str, b: &str) -> bool {
    a.trim_start_matches('/') == b.trim_start_matches('/')
}

impl Topics {
    /// `asked` is one topic, or two joined by a comma: gyroscope's, accelerometer's.
    pub fn new(asked: Option<&str>) -> Self {
        let asked = asked.map(|asked| {
            let (gyroscope, accelerometer) = asked.split_once(',').unwrap_or((asked, asked));
            (gyroscope.trim().to_owned(), accelerometer.trim().to_owned())
        });
        Self {
            asked,
            connections: Vec::new(),
            messages: Vec::new(),
            roles: Vec::new(),
            gyroscope: String::new(),
            accelerometer: String::new(),
        }
    }

    /// What is wanted of this connection's messages.
    #[inline]
    pub fn role(&self, number: u32) -> Option<Role> {
        self.roles.iter().copied().find(|role| role.number == number)
    }

    /// Whether the bag described this connection.
    pub fn knows(&self, number: u32) -> bool {
        self.connections.iter().any(|connection| connection.number == number)
    }

    /// Whether the topics of both sensors were found.
    pub fn complete(&self) -> bool {
        !self.gyroscope.is_empty() && !self.accelerometer.is_empty()
    }

    /// Whether the topic of a sensor was found.
    pub fn any(&self) -> bool {
        !self.roles.is_empty()
    }

    /// Takes note of a connection, once.
    pub fn add(&mut self, connection: Connection) {
        if self.knows(connection.number) || self.connections.len() >= CONNECTIONS {
            return;
        }
        self.connections.push(connection);
        self.messages.push(0);
    }

    /// Counts a message of a connection.
    pub fn count(&mut self, number: u32) {
        let place = self.connections.iter().position(|c| c.number == number);
        if let Some(count) = place.and_then(|place| self.messages.get_mut(place)) {
            *count += 1;
        }
    }

    /// All topics, those of one name and type as one.
    pub fn streams(&self) -> Vec<Stream> {
        let mut streams: Vec<Stream> = Vec::new();
        for (connection, &messages) in self.connections.iter().zip(&self.messages) {
            let same =
                |s: &&mut Stream| s.name == connection.topic && s.type_name == connection.type_name;
            if let Some(stream) = streams.iter_mut().find(same) {
                stream.messages += messages;
            } else {
                streams.push(Stream {
                    name: connection.topic.clone(),
                    type_name: connection.type_name.clone(),
                    messages,
                    used: self.role(connection.number).is_some(),
                });
            }
        }
        streams
    }

    /// Decides who plays which role, of all connections known by now.
    ///
    /// # Errors
    /// When there are several Imu topics and none was asked for, or the one asked for is none.
    pub fn choose(&mut self, path: &Path) -> Result<(), Error> {
        let (gyroscope, accelerometer) = match &self.asked {
            Some(asked) => asked.clone(),
            None => {
                let mut imus = self.connections.iter().filter(|c| c.holds != Holds::Other);
                let Some(first) = imus.next() else { return Ok(()) };
                if imus.any(|other| !same(&other.topic, &first.topic)) {
                    return Err(Error::usage(format!(
                        "{} has several Imu topics: {}; choose one with --topic TOPIC, or \
                         --topic GYROSCOPE,ACCELEROMETER where each sensor has its own",
                        path.display(),
                        self.list(|c| c.holds != Holds::Other),
                    )));
                }
                (first.topic.clone(), first.topic.clone())
            }
        };
        self.roles.clear();
        for connection in &self.connections {
            let role = Role {
                number: connection.number,
                gyroscope: same(&connection.topic, &gyroscope),
                accelerometer: same(&connection.topic, &accelerometer),
            };
            if !role.gyroscope && !role.accelerometer {
                continue;
            }
            check(connection, path)?;
            if role.gyroscope {
                self.gyroscope.clone_from(&connection.topic);
            }
            if role.accelerometer {
                self.accelerometer.clone_from(&connection.topic);
            }
            self.roles.push(role);
        }
        Ok(())
    }

    /// The error for a bag whose end was reached, or whose list is complete, without finding the
    /// topics.
    pub fn not_found(&self, path: &Path) -> Error {
        let path = path.display();
        if self.connections.is_empty() {
            return Error::data(format!("{path} holds no messages"));
        }
        let all = self.list(|_| true);
        match &self.asked {
            None => Error::data(format!(
                "{path} has no topic of an IMU (type sensor_msgs/Imu); it has {all}"
            )),
            Some((gyroscope, accelerometer)) => {
                let found = |topic: &str| self.connections.iter().any(|c| same(&c.topic, topic));
                let topic = if found(gyroscope) { accelerometer } else { gyroscope };
                Error::usage(format!("{path} has no topic {topic}; it has {all}"))
            }
        }
    }

    /// The topics in words, each once.
    fn list(&self, which: impl Fn(&Connection) -> bool) -> String {
        let mut listed: Vec<String> = Vec::new();
        let mut more = 0;
        for connection in self.connections.iter().filter(|c| which(c)) {
            let one = format!("{} ({})", connection.topic, connection.type_name);
            if listed.contains(&one) {
            } else if listed.len() < LISTED {
                listed.push(one);
            } else {
                more += 1;
            }
        }
        let mut list = listed.join(", ");
        if more > 0 {
            list.push_str(&format!(" and {more} more"));
        }
        list
    }
}

/// A chosen topic must hold the message that we know.
fn check(connection: &Connection, path: &Path) -> Result<(), Error> {
    let Connection { topic, type_name, .. } = connection;
    let path = path.display();
    match &connection.holds {
        Holds::Imu => Ok(()),
        Holds::Unreadable(why) => Err(Error::data(format!("topic {topic} of {path} {why}"))),
        Holds::Other => Err(Error::usage(format!(
            "topic {topic} of {path} holds {type_name}, not sensor_msgs/Imu: choose another one"
        ))),
    }
}
