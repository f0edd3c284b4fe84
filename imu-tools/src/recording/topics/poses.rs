//! Which topic holds the poses: the one that was asked for, or the only one there is.

use std::path::Path;

use super::connections::{Connection, Holds, same};
use super::{Role, Topics};
use crate::error::Error;
use crate::recording::Note;
use crate::recording::pose_body::PoseMessage;
use crate::recording::poses::PoseTopic;

impl Topics {
    /// Gives the connections of the wanted topic their roles. Of several topics where none is named none is
    /// taken, unless one was before the others turned up.
    ///
    /// # Errors
    /// When the topic that is named holds no poses.
    pub(super) fn take_poses(
        &mut self,
        wanted: &PoseTopic,
        path: &Path,
        notes: &mut Vec<Note>,
    ) -> Result<(), Error> {
        let holds_poses = |c: &Connection| matches!(c.holds, Holds::Pose(_));
        let wanted = match wanted {
            PoseTopic::Named(topic) => {
                self.check_poses(topic, path)?;
                topic.clone()
            }
            PoseTopic::Only => match *self.connections.names(holds_poses).as_slice() {
                [only] => only.to_owned(),
                [] => return Ok(()),
                [..] if self.poses.is_empty() => return Ok(()),
                [..] => {
                    notes.push(Note::Warning(format!(
                        "{} has several topics of poses, which it does not tell at its end: {}; of them {}, the \
                         first, is read",
                        path.display(),
                        self.connections.list(holds_poses),
                        self.poses
                    )));
                    self.poses.clone()
                }
            },
        };
        for connection in self.connections.iter().filter(|c| same(&c.topic, &wanted)) {
            if let Holds::Pose(message) = connection.holds {
                self.poses.clone_from(&connection.topic);
                self.roles.push(Role { pose: Some(message), ..Role::of(connection.number) });
            }
        }
        Ok(())
    }

    /// A topic that is there must hold poses in a layout that we know.
    fn check_poses(&self, topic: &str, path: &Path) -> Result<(), Error> {
        let mut found = self.connections.iter().filter(|c| same(&c.topic, topic)).peekable();
        let Some(first) = found.peek() else { return Ok(()) };
        let Connection { topic, type_name, .. } = *first;
        if found.any(|c| matches!(c.holds, Holds::Pose(_))) {
            return Ok(());
        }
        let types = PoseMessage::ALL.map(PoseMessage::type_name).join(", ");
        Err(Error::usage(format!(
            "topic {topic} of {} holds {type_name}, and no poses in a layout that is known ({types}): choose \
             another one",
            path.display()
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::ReadOptions;

    fn topics(poses: PoseTopic, all: &[(&str, Holds)]) -> Topics {
        let mut topics = Topics::new(&ReadOptions { poses: Some(poses), ..ReadOptions::default() });
        for (number, (topic, holds)) in (0..).zip(all) {
            let (topic, type_name) = ((*topic).to_owned(), "a type".to_owned());
            topics.add(Connection { number, topic, type_name, holds: holds.clone() });
        }
        topics
    }

    const POSE: Holds = Holds::Pose(PoseMessage::Pose);

    #[test]
    fn the_only_one_is_taken_and_of_several_none() {
        let mut one = topics(PoseTopic::Only, &[("/imu", Holds::Imu), ("/p", POSE), ("p", POSE)]);
        one.choose("a".as_ref()).unwrap();
        let role = |number| one.role(number).and_then(|role| role.pose);
        assert_eq!([0, 1, 2].map(role), [None, Some(PoseMessage::Pose), Some(PoseMessage::Pose)]);
        assert_eq!(one.take_notes(), []);
        for all in [&[("/imu", Holds::Imu)][..], &[("/p", POSE), ("/q", POSE)]] {
            let mut none = topics(PoseTopic::Only, all);
            none.choose("a".as_ref()).unwrap();
            assert_eq!((none.role(0), none.role(1)), (None, None));
            assert!(!none.lack(true) && !none.lack(false));
        }
    }

    #[test]
    fn one_that_turns_up_later_changes_nothing_and_is_told() {
        let mut topics = topics(PoseTopic::Only, &[("/p", POSE)]);
        topics.choose("a".as_ref()).unwrap();
        let (topic, type_name) = ("/q".to_owned(), "a type".to_owned());
        assert!(topics.add(Connection { number: 1, topic, type_name, holds: POSE }));
        topics.choose("a".as_ref()).unwrap();
        assert!(topics.role(0).is_some() && topics.role(1).is_none());
        assert!(matches!(&topics.take_notes()[..], [Note::Warning(told)] if told.contains("/q")));
    }

    #[test]
    fn the_one_that_is_named_must_hold_poses() {
        let named = |name: &str| {
            let all = [("/p", POSE), ("/q", POSE), ("/imu", Holds::Imu)];
            topics(PoseTopic::Named(name.into()), &all)
        };
        let mut second = named("q");
        second.choose("a".as_ref()).unwrap();
        assert!(second.role(0).is_none() && second.role(1).is_some());
        assert_eq!(named("/imu").choose("a".as_ref()).unwrap_err().exit_code(), 2);
        let mut missing = named("/r");
        missing.choose("a".as_ref()).unwrap();
        assert!(missing.lack(true));
        assert!(missing.not_found("a".as_ref()).to_string().contains("has no topic /r; it has"));
    }
}
