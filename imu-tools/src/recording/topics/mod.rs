//! Which topics hold the IMU: the only one of its type, the one that was asked for, or a pair whose
//! names say that one is the gyroscope's and the other the accelerometer's.
//!
//! A reader describes every connection that it finds ([`Topics::add`]), has the choice made
//! ([`Topics::choose`]) whenever one is new, and takes from a message what the [`Role`] of its
//! connection wants. A thermometer is taken along where there is exactly one. Who wants poses gets those
//! of one topic (`poses`), and nothing else.

mod connections;
mod poses;
mod wanted;
mod words;

use std::path::Path;

use super::pose_body::PoseMessage;
use super::poses::PoseTopic;
use super::{Note, ReadOptions, Stream};
use crate::error::Error;
use connections::{Connections, same};
use wanted::Wanted;
use words::twins;

pub use connections::{Connection, Holds};

/// Which sensors are taken from a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Role {
    /// Of the connection.
    pub number: u32,
    /// Its angular rates are wanted.
    pub gyroscope: bool,
    /// Its specific forces are wanted.
    pub accelerometer: bool,
    /// It is the thermometer's, and nothing else.
    pub temperature: bool,
    /// Its poses are wanted, and nothing else.
    pub pose: Option<PoseMessage>,
}

impl Role {
    /// None yet.
    pub const fn of(number: u32) -> Self {
        Self { number, gyroscope: false, accelerometer: false, temperature: false, pose: None }
    }

    /// Whether readings of an IMU are wanted.
    pub fn is_imu(&self) -> bool {
        self.gyroscope || self.accelerometer
    }
}

/// What was asked for, what there is, and what is taken.
#[derive(Clone, Debug)]
pub struct Topics {
    asked: Option<Wanted>,
    /// Poses are wanted, and no IMU.
    wanted_poses: Option<PoseTopic>,
    /// Of several IMUs the first is taken.
    survey: bool,
    connections: Connections,
    roles: Vec<Role>,
    /// What there is to say about the choice, until it was taken.
    notes: Vec<Note>,
    told: bool,
    /// Where angular rates are found, as the recording writes it; empty where they are not.
    pub gyroscope: String,
    /// Where specific forces are found.
    pub accelerometer: String,
    /// Where poses are found.
    poses: String,
}

impl Topics {
    /// Nothing is known yet but what is asked for.
    pub fn new(options: &ReadOptions) -> Self {
        Self {
            asked: options.topic.as_deref().map(Wanted::asked),
            wanted_poses: options.poses.clone(),
            survey: options.survey,
            connections: Connections::default(),
            roles: Vec::new(),
            notes: Vec::new(),
            told: false,
            gyroscope: String::new(),
            accelerometer: String::new(),
            poses: String::new(),
        }
    }

    /// What is wanted of this connection's messages.
    #[inline]
    pub fn role(&self, number: u32) -> Option<Role> {
        self.roles.iter().copied().find(|role| role.number == number)
    }

    /// Whether all that was asked for was found, or, if nothing was, an IMU. There may be no poses.
    pub fn complete(&self) -> bool {
        let found = |wanted: &Option<String>, topic: &str| wanted.is_none() || !topic.is_empty();
        match &self.asked {
            _ if self.wanted_poses == Some(PoseTopic::Only) => true,
            None => self.any(),
            Some(asked) => {
                found(&asked.gyroscope, &self.gyroscope)
                    && found(&asked.accelerometer, &self.accelerometer)
            }
        }
    }

    /// Whether the topic of a sensor was found, or that of the poses.
    pub fn any(&self) -> bool {
        !self.gyroscope.is_empty() || !self.accelerometer.is_empty() || !self.poses.is_empty()
    }

    /// Whether there is nothing to read, where all topics are known (`listed`) or all was looked through.
    pub fn lack(&self, listed: bool) -> bool {
        !self.complete() && (listed || !self.any())
    }

    /// Whether the recording described this connection.
    pub fn knows(&self, number: u32) -> bool {
        self.connections.knows(number)
    }

    /// Takes note of a connection; whether a choice is to be made, as [`Connections::add`].
    pub fn add(&mut self, connection: Connection) -> bool {
        self.connections.add(connection)
    }

    /// Counts messages of a connection.
    #[inline]
    pub fn count(&mut self, number: u32, messages: u64) {
        self.connections.count(number, messages);
    }

    /// All topics, those of one name and type as one.
    pub fn streams(&self) -> Vec<Stream> {
        let mut streams: Vec<Stream> = Vec::new();
        for (connection, messages) in self.connections.counted() {
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
    /// When there are several Imu topics, no pair, and none was asked for, or the one asked for is
    /// none.
    pub fn choose(&mut self, path: &Path) -> Result<(), Error> {
        let mut notes = Vec::new();
        if let Some(wanted) = self.wanted_poses.clone() {
            self.roles.clear();
            self.take_poses(&wanted, path, &mut notes)?;
        } else {
            let wanted = match &self.asked {
                Some(asked) => Some(asked.clone()),
                None => self.find(path, &mut notes)?,
            };
            self.roles.clear();
            if let Some(wanted) = &wanted {
                self.take_sensors(wanted, path)?;
                notes.extend(self.half(wanted, path));
            }
            self.take_thermometer(path, &mut notes);
        }
        if self.notes != notes {
            (self.notes, self.told) = (notes, false);
        }
        Ok(())
    }

    /// What to take where nothing was asked for; nothing as long as there is no IMU.
    fn find(&self, path: &Path, notes: &mut Vec<Note>) -> Result<Option<Wanted>, Error> {
        let imu = |c: &Connection| matches!(c.holds, Holds::Imu | Holds::Unreadable(_));
        let found = self.connections.names(imu);
        let path = path.display();
        match *found.as_slice() {
            [] => Ok(None),
            [topic] => Ok(Some(Wanted::by_name(topic))),
            [one, other] if twins(one, other) => {
                let pair = Wanted::pair(one, other);
                if let Wanted { gyroscope: Some(g), accelerometer: Some(a) } = &pair {
                    notes.push(Note::Info(format!(
                        "{path} has a topic for each sensor: angular rates are taken from {g}, \
                         specific forces from {a}"
                    )));
                }
                Ok(Some(pair))
            }
            [first, ..] if self.survey => {
                let first = self
                    .connections
                    .names(|c| c.holds == Holds::Imu)
                    .first()
                    .copied()
                    .unwrap_or(first);
                let wanted = match found.iter().find(|other| twins(first, other)) {
                    Some(other) => Wanted::pair(first, other),
                    None => Wanted::by_name(first),
                };
                notes.push(Note::Warning(format!(
                    "{path} has several Imu topics: {}; of them {first} is read, --topic TOPIC \
                     reads another one",
                    self.connections.list(imu)
                )));
                Ok(Some(wanted))
            }
            _ => Err(Error::usage(format!(
                "{path} has several Imu topics: {}; choose one with --topic TOPIC, or \
                 --topic GYROSCOPE,ACCELEROMETER where each sensor has its own",
                self.connections.list(imu),
            ))),
        }
    }

    /// Gives the connections of the wanted topics their roles.
    fn take_sensors(&mut self, wanted: &Wanted, path: &Path) -> Result<(), Error> {
        let Self { connections, roles, .. } = self;
        let is = |topic: &str, wanted: &Option<String>| {
            wanted.as_deref().is_some_and(|wanted| same(topic, wanted))
        };
        for connection in connections.iter() {
            let Connection { number, topic, .. } = connection;
            let gyroscope = is(topic, &wanted.gyroscope);
            let accelerometer = is(topic, &wanted.accelerometer);
            if !gyroscope && !accelerometer {
                continue;
            }
            // A topic may carry two types of messages, of which one is meant.
            let other = |c: &Connection| c.holds == Holds::Imu && same(&c.topic, topic);
            if connection.holds == Holds::Other && connections.iter().any(other) {
                continue;
            }
            check(connection, path)?;
            if gyroscope {
                self.gyroscope.clone_from(topic);
            }
            if accelerometer {
                self.accelerometer.clone_from(topic);
            }
            roles.push(Role { gyroscope, accelerometer, ..Role::of(*number) });
        }
        Ok(())
    }

    /// Takes the thermometer, if there is exactly one.
    fn take_thermometer(&mut self, path: &Path, notes: &mut Vec<Note>) {
        let thermometer = |c: &Connection| c.holds == Holds::Temperature;
        if self.connections.names(thermometer).len() > 1 {
            notes.push(Note::Info(format!(
                "{} has several thermometers, of which none is read: {}",
                path.display(),
                self.connections.list(thermometer)
            )));
            return;
        }
        let of = |c: &Connection| Role { temperature: true, ..Role::of(c.number) };
        self.roles.extend(self.connections.iter().filter(|c| thermometer(c)).map(of));
    }

    /// What to say where a topic is named for one sensor, and its messages have fields for both.
    fn half(&self, wanted: &Wanted, path: &Path) -> Option<Note> {
        let (topic, named, left_out) = match wanted {
            Wanted { gyroscope: Some(_), accelerometer: None } => {
                (&self.gyroscope, "gyroscope", "specific forces")
            }
            Wanted { gyroscope: None, accelerometer: Some(_) } => {
                (&self.accelerometer, "accelerometer", "angular rates")
            }
            _ => return None,
        };
        (!topic.is_empty()).then(|| {
            Note::Info(format!(
                "topic {topic} of {} is named for the {named}, so its {left_out} are left out; \
                 --topic {topic},{topic} takes both",
                path.display()
            ))
        })
    }

    /// Takes what there is to tell about the choice; the same is told once.
    pub fn take_notes(&mut self) -> Vec<Note> {
        if std::mem::replace(&mut self.told, true) { Vec::new() } else { self.notes.clone() }
    }

    /// The error for a recording whose end was reached, or whose list is complete, without finding
    /// the topics.
    pub fn not_found(&self, path: &Path) -> Error {
        let path = path.display();
        if self.connections.iter().len() == 0 {
            return Error::data(format!("{path} holds no messages"));
        }
        let all = self.connections.list(|_| true);
        if let Some(PoseTopic::Named(topic)) = &self.wanted_poses {
            return Error::usage(format!("{path} has no topic {topic}; it has {all}"));
        }
        match &self.asked {
            None => Error::data(format!(
                "{path} has no topic of an IMU (type sensor_msgs/Imu); it has {all}"
            )),
            Some(Wanted { gyroscope, accelerometer }) => {
                let found = |topic: &str| self.connections.iter().any(|c| same(&c.topic, topic));
                let mut topics = [gyroscope, accelerometer].into_iter().flatten();
                let topic = topics.find(|topic| !found(topic)).map_or("", String::as_str);
                Error::usage(format!("{path} has no topic {topic}; it has {all}"))
            }
        }
    }
}

/// A chosen topic must hold the message that we know.
fn check(connection: &Connection, path: &Path) -> Result<(), Error> {
    let Connection { topic, type_name, .. } = connection;
    let path = path.display();
    match &connection.holds {
        Holds::Imu => Ok(()),
        Holds::Unreadable(why) => Err(Error::data(format!("topic {topic} of {path} {why}"))),
        Holds::Temperature | Holds::Pose(_) | Holds::Other => Err(Error::usage(format!(
            "topic {topic} of {path} holds {type_name}, not sensor_msgs/Imu: choose another one"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topics(options: &ReadOptions, all: &[(&str, Holds)]) -> Topics {
        let mut topics = Topics::new(options);
        for (number, (topic, holds)) in (0..).zip(all) {
            let (topic, type_name) = ((*topic).to_owned(), "a type".to_owned());
            assert!(topics.add(Connection { number, topic, type_name, holds: holds.clone() }));
        }
        topics
    }

    fn asked(topic: &str) -> ReadOptions {
        ReadOptions { topic: Some(topic.into()), ..ReadOptions::default() }
    }

    const GYRO: (&str, Holds) = ("/camera/gyro/sample", Holds::Imu);
    const ACCEL: (&str, Holds) = ("/camera/accel/sample", Holds::Imu);
    const IMU: (&str, Holds) = ("/imu", Holds::Imu);

    #[test]
    fn a_pair_is_found_in_either_order_and_told_once() {
        for all in [[GYRO, ACCEL], [ACCEL, GYRO]] {
            let mut topics = topics(&ReadOptions::default(), &all);
            topics.choose("a".as_ref()).unwrap();
            assert_eq!((&*topics.gyroscope, &*topics.accelerometer), (GYRO.0, ACCEL.0));
            for (number, (name, _)) in (0..).zip(&all) {
                let role = topics.role(number).unwrap();
                assert_eq!(role.gyroscope, *name == GYRO.0);
                assert_eq!(role.accelerometer, *name == ACCEL.0);
            }
            topics.choose("a".as_ref()).unwrap();
            assert!(matches!(&topics.take_notes()[..], [Note::Info(_)]));
            topics.choose("a".as_ref()).unwrap();
            assert_eq!(topics.take_notes(), []);
            assert!(topics.complete());
        }
    }

    #[test]
    fn a_topic_named_for_one_sensor_gives_that_one() {
        for (all, options) in [
            (vec![GYRO], ReadOptions::default()),
            (vec![IMU, GYRO, ACCEL], asked("camera/gyro/sample")),
        ] {
            let mut topics = topics(&options, &all);
            topics.choose("a".as_ref()).unwrap();
            assert_eq!((&*topics.gyroscope, &*topics.accelerometer), (GYRO.0, ""));
            assert!(topics.complete());
            assert!(matches!(&topics.take_notes()[..], [Note::Info(n)] if n.contains("left out")));
        }
        let mut topics = topics(&asked("/camera/gyro/sample,camera/gyro/sample"), &[GYRO]);
        topics.choose("a".as_ref()).unwrap();
        assert_eq!((&*topics.gyroscope, &*topics.accelerometer), (GYRO.0, GYRO.0));
        assert_eq!(topics.take_notes(), []);
    }

    #[test]
    fn of_several_a_survey_takes_the_first_with_its_twin() {
        let survey = ReadOptions { survey: true, ..ReadOptions::default() };
        for (all, expected) in [
            ([IMU, GYRO, ACCEL], ("/imu", "/imu")),
            ([GYRO, IMU, ACCEL], (GYRO.0, ACCEL.0)),
            ([("/odd", Holds::Unreadable("is odd".into())), IMU, ACCEL], ("/imu", "/imu")),
        ] {
            let mut topics = topics(&survey, &all);
            topics.choose("a".as_ref()).unwrap();
            assert_eq!((&*topics.gyroscope, &*topics.accelerometer), expected);
            let notes = topics.take_notes();
            let [Note::Warning(told)] = &notes[..] else { panic!("{notes:?}") };
            for (topic, _) in &all {
                assert!(told.contains(topic), "{told}");
            }
        }
        let error = topics(&ReadOptions::default(), &[IMU, GYRO, ACCEL]).choose("a".as_ref());
        assert_eq!(error.unwrap_err().exit_code(), 2);
    }

    #[test]
    fn the_only_thermometer_is_taken() {
        let one = [IMU, ("/t", Holds::Temperature), ("/t", Holds::Temperature)];
        let mut one = topics(&ReadOptions::default(), &one);
        one.choose("a".as_ref()).unwrap();
        assert!(one.role(1).unwrap().temperature && one.role(2).unwrap().temperature);
        assert_eq!(one.take_notes(), []);

        let two = [IMU, ("/t", Holds::Temperature), ("/u", Holds::Temperature)];
        let mut two = topics(&ReadOptions::default(), &two);
        two.choose("a".as_ref()).unwrap();
        assert_eq!((two.role(1), two.role(2)), (None, None));
        assert!(matches!(&two.take_notes()[..], [Note::Info(told)] if told.contains("/u")));
    }
}
