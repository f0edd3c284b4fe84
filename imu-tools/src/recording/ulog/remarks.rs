//! What is strange about a log, counted as it goes by and put into words at its end.

use std::path::Path;

use crate::recording::Note;

/// Places of damage told one by one, at most.
const TOLD: usize = 20;

/// What was strange so far.
#[derive(Clone, Debug, Default)]
pub struct Remarks {
    /// The file ends in the middle of a message.
    pub cut: bool,
    /// So does the part before appended data.
    pub cut_before_appended: bool,
    /// Gaps that the autopilot knows of.
    pub dropouts: u64,
    /// Their length in all.
    pub dropout_ms: u64,
    /// Data of numbers that stand for no topic.
    pub undescribed: u64,
    /// Messages of kinds that we do not know.
    pub unknown_kinds: u64,
    /// Formats and subscriptions that are none, or contradict earlier ones.
    pub refused: u64,
    /// Where bytes are lost, and how many; the first ones.
    damage: Vec<(u64, u64)>,
    /// Further places and bytes.
    more: (u64, u64),
    /// Where the rest of the file is lost, and how many bytes of it.
    rest: Option<(u64, u64)>,
}

impl Remarks {
    /// Bytes at `at` were no messages.
    pub fn damaged(&mut self, at: u64, bytes: u64) {
        if self.damage.len() < TOLD {
            self.damage.push((at, bytes));
        } else {
            self.more = (self.more.0 + 1, self.more.1 + bytes);
        }
    }

    /// No bytes from `at` on were messages.
    pub fn damaged_to_the_end(&mut self, at: u64, bytes: u64) {
        self.rest = Some((at, bytes));
    }

    /// All of it as warnings.
    pub fn warnings(&self, path: &Path) -> Vec<Note> {
        let mut notes = Vec::new();
        let mut warn = |what: String| {
            notes.push(Note::Warning(format!("{} {what}", path.display())));
        };
        for (at, bytes) in &self.damage {
            warn(format!("is damaged at byte {at}: {bytes} bytes are lost"));
        }
        if let (places @ 1.., bytes) = self.more {
            warn(format!("is damaged at {places} more places: {bytes} bytes are lost there"));
        }
        if let Some((at, bytes)) = self.rest {
            warn(format!("is damaged at byte {at}: the rest, {bytes} bytes, is lost"));
        }
        if self.cut_before_appended {
            warn(
                "was cut off in the middle of a message before data was appended to it: that \
                 message is lost"
                    .into(),
            );
        }
        if self.cut {
            warn(
                "ends in the middle of a message, as logs do when the power is cut: what comes \
                 before is used"
                    .into(),
            );
        }
        if self.dropouts > 0 {
            let Self { dropouts, dropout_ms, .. } = self;
            warn(format!(
                "has {dropouts} dropouts, {dropout_ms} ms in all, in which the autopilot could not \
                 write: samples are missing there"
            ));
        }
        if self.refused > 0 {
            warn(format!(
                "has {} definitions that are none or contradict earlier ones: they are passed over",
                self.refused
            ));
        }
        if self.undescribed > 0 {
            warn(format!("has {} messages of topics that it does not name", self.undescribed));
        }
        if self.unknown_kinds > 0 {
            warn(format!(
                "has {} messages of unknown kinds: they are passed over",
                self.unknown_kinds
            ));
        }
        notes
    }
}
