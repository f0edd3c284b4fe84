//! Between a session and its user, whatever shows it: a dashboard, lines, objects for programs.

use std::time::Duration;

use super::session::View;
use crate::error::Error;

/// What the user wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A checkpoint and the results now.
    Save,
    /// Pass over samples, or take them again.
    Pause,
    /// Mark this moment.
    Mark,
    /// End with the report.
    Quit,
    /// End as the signal does that a terminal sends at Ctrl-C.
    Interrupt,
}

/// Who shows a session to the user.
pub trait Face {
    /// The time between views.
    fn every(&self) -> Duration;

    /// Shows what there is to see.
    ///
    /// # Errors
    /// When it cannot be written.
    fn show(&mut self, view: &View) -> Result<(), Error>;

    /// A sentence.
    fn say(&mut self, sentence: &str);

    /// A key that was pressed.
    fn key(&mut self) -> Option<Key> {
        None
    }
}
