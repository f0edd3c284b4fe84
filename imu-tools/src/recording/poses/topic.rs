//! The poses of a topic: a second reading of the recording, beside that of its IMU.
//!
//! No reading keeps the recording, so that neither has to wait for the other where the recorder wrote poses
//! long after the samples of their time. A pipe can be read once only.

use std::path::Path;

use super::{Origin, Pose, PoseTopic, Poses};
use crate::error::Error;
use crate::recording::nothing::Nothing;
use crate::recording::pose_body::PoseMessage;
use crate::recording::{self, Block, Note, ReadOptions, Source, Stream};

/// What a recording has of poses.
pub enum InRecording {
    /// No topic of them.
    None,
    /// Several topics of which none was chosen: a list in words.
    Several(String),
    /// Those of one topic.
    One {
        /// Its name.
        topic: String,
        /// What its messages are, as the recording calls it.
        type_name: String,
        /// What reads it.
        poses: Poses,
    },
}

/// The poses of one topic, front to back.
pub struct Topic {
    source: Box<dyn Source>,
    block: Block,
    /// So many of the block were handed on.
    at: usize,
}

/// Opens the recording for its poses.
pub fn find(path: &Path, topic: &PoseTopic, bag_time: bool) -> Result<InRecording, Error> {
    if path == Path::new("-") {
        return match topic {
            PoseTopic::Only => Ok(InRecording::None),
            PoseTopic::Named(topic) => Err(Error::usage(format!(
                "a pipe is read once, and the poses of {topic} want a second reading: write it into a file"
            ))),
        };
    }
    let options = ReadOptions { poses: Some(topic.clone()), bag_time, ..ReadOptions::default() };
    let source = recording::open(path, &options)?;
    let streams = source.streams();
    if let Some(Stream { name, type_name, .. }) = streams.iter().find(|stream| stream.used) {
        let (topic, type_name) = (name.clone(), type_name.clone());
        let poses = Poses(Origin::Topic(Topic { source, block: Block::default(), at: 0 }));
        return Ok(InRecording::One { topic, type_name, poses });
    }
    let several = streams.iter().filter(|stream| PoseMessage::named(&stream.type_name).is_some());
    let several: Vec<_> = several.map(|s| format!("{} ({})", s.name, s.type_name)).collect();
    Ok(if several.len() > 1 { InRecording::Several(several.join(", ")) } else { InRecording::None })
}

/// What to read of a recording that has no topics.
pub fn without_topics(path: &Path, wanted: &PoseTopic) -> Result<Box<dyn Source>, Error> {
    match wanted {
        PoseTopic::Only => Ok(Box::new(Nothing)),
        PoseTopic::Named(topic) => Err(Error::usage(format!(
            "{} is no recording of ROS, and has no topic {topic}: name a file of poses with --truth FILE",
            path.display()
        ))),
    }
}

impl Topic {
    /// The next pose in the order of the recording.
    pub fn next_pose(&mut self) -> Result<Option<Pose>, Error> {
        loop {
            if let Some(pose) = self.block.poses.get(self.at) {
                self.at += 1;
                return Ok(Some(*pose));
            }
            self.at = 0;
            if !self.source.next_block(&mut self.block)? {
                return Ok(None);
            }
        }
    }

    /// What there is to tell at the end of the recording.
    pub fn finish(&mut self) -> Result<Vec<Note>, Error> {
        while self.source.next_block(&mut self.block)? {}
        Ok(self.source.take_notes())
    }
}
