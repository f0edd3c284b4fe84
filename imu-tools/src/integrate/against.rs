//! What a recording is compared with: the truth in a file, poses in a topic of its own, or nothing.

use std::path::Path;

use super::truth::Truth;
use crate::error::Error;
use crate::recording::ReadOptions;
use crate::recording::poses::{InRecording, PoseTopic, Poses};

/// What a recording is compared with.
pub enum Against {
    /// Nothing is known.
    Nothing,
    /// The recording has several topics of poses, of which none was chosen: a list in words.
    Unchosen(String),
    /// The truth.
    Truth {
        /// What messages call it.
        name: String,
        /// What reads it.
        truth: Box<Truth>,
        /// A line each: what was taken for granted.
        told: Vec<String>,
    },
}

impl Against {
    /// The truth in a file: a trajectory of TUM, EuRoC's ground truth, or what [`crate::scene::TruthWriter`] writes.
    ///
    /// # Errors
    /// When there is no such file, or it holds no poses.
    pub fn file(path: &Path) -> Result<Self, Error> {
        let truth = Box::new(Truth::of(Poses::open(path)?));
        Ok(Self::Truth { name: path.display().to_string(), truth, told: Vec::new() })
    }

    /// The poses in a topic of the recording itself: in the one that is named, or in the only one.
    ///
    /// # Errors
    /// When the topic that is named is not there or holds no poses, or the file cannot be read.
    pub fn topic(
        recording: &Path,
        named: Option<&str>,
        options: &ReadOptions,
    ) -> Result<Self, Error> {
        let wanted = named.map_or(PoseTopic::Only, |topic| PoseTopic::Named(topic.to_owned()));
        let (topic, type_name, poses) = match Poses::in_recording(recording, &wanted, options)? {
            InRecording::None => return Ok(Self::Nothing),
            InRecording::Several(list) => return Ok(Self::Unchosen(list)),
            InRecording::One { topic, type_name, poses } => (topic, type_name, poses),
        };
        let path = recording.display();
        let mut told = Vec::new();
        if named.is_none() {
            told.push(format!(
                "the poses of topic {topic} ({type_name}) of {path} are taken for the truth: --truth FILE names \
                 another, --no-truth goes without"
            ));
        }
        if type_name.ends_with("/Odometry") {
            told.push(format!(
                "the velocities of topic {topic} are not used: they should be in the axes of the body, and not \
                 every program keeps to that"
            ));
        }
        let truth = Box::new(Truth::of(poses));
        Ok(Self::Truth { name: format!("topic {topic} of {path}"), truth, told })
    }
}
