//! Which topic holds the IMU: the only one of its type, or the one that was asked for.

use std::path::Path;

use super::imu_message::{MD5SUM, TYPE_NAME};
use super::record::Header;
use crate::error::Error;

/// Topics listed in an error, at most.
const LISTED: usize = 40;

/// Connections remembered, at most: a bag has a few dozen.
const CONNECTIONS: usize = 4096;

/// A publisher of a topic, as the bag describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Connection {
    number: u32,
    topic: String,
    type_name: String,
    md5sum: String,
}

/// Which sensors are taken from a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Role {
    number: u32,
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
    roles: Vec<Role>,
    /// Topics that were found, as the bag writes them.
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

    /// Takes note of connection `number`, described by `header` and `data`; without a topic or a
    /// type it is ignored.
    pub fn add(&mut self, number: u32, header: &Header<'_>, data: &Header<'_>) {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let Some(topic) = header.topic.or(data.topic) else { return };
        let Some(type_name) = data.type_name else { return };
        if self.knows(number) || self.connections.len() >= CONNECTIONS {
            return;
        }
        self.connections.push(Connection {
            number,
            topic: text(topic),
            type_name: text(type_name),
            md5sum: text(data.md5sum.unwrap_or_default()),
        });
    }

    /// Decides who plays which role, of all connections known by now.
    ///
    /// # Errors
    /// When there are several Imu topics and none was asked for, or the one asked for is none.
    pub fn choose(&mut self, path: &Path) -> Result<(), Error> {
        let (gyroscope, accelerometer) = match &self.asked {
            Some(asked) => asked.clone(),
            None => {
                let mut imus = self.connections.iter().filter(|c| c.type_name == TYPE_NAME);
                let Some(first) = imus.next() else { return Ok(()) };
                if imus.any(|other| !same(&other.topic, &first.topic)) {
                    return Err(Error::usage(format!(
                        "{} has several Imu topics: {}; choose one with --topic TOPIC, or \
                         --topic GYROSCOPE,ACCELEROMETER where each sensor has its own",
                        path.display(),
                        self.list(|c| c.type_name == TYPE_NAME),
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
            None => Error::data(format!("{path} has no topic of type {TYPE_NAME}; it has {all}")),
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
    let Connection { topic, type_name, md5sum, .. } = connection;
    let path = path.display();
    if type_name != TYPE_NAME {
        return Err(Error::usage(format!(
            "topic {topic} of {path} holds {type_name}, not {TYPE_NAME}: choose another one"
        )));
    }
    if md5sum != MD5SUM && md5sum != "*" && !md5sum.is_empty() {
        return Err(Error::data(format!(
            "topic {topic} of {path} holds an unknown layout of {TYPE_NAME} (md5sum {md5sum}, \
             where {MD5SUM} is expected)"
        )));
    }
    Ok(())
}
