//! The dashboard on a terminal: it draws what [`View`] says and hands keys on; it decides nothing.

mod draw;
mod plot;

use std::path::Path;
use std::time::Duration;

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};

use super::face::{Face, Key};
use super::session::View;
use crate::error::Error;
pub use draw::draw;

/// The dashboard is drawn so often, at most.
const EVERY: Duration = Duration::from_secs(1);

/// How a screen is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Axes have colours of the terminal's palette beside their letters.
    pub colours: bool,
    /// The part of N and K that is aimed at: how long until then is shown.
    pub within: f64,
}

/// A terminal that shows a session until it is dropped.
pub struct Screen {
    terminal: DefaultTerminal,
    style: Style,
    said: String,
}

impl Screen {
    /// Takes the terminal over.
    ///
    /// # Errors
    /// When it is none.
    pub fn open(within: f64) -> Result<Self, Error> {
        // https://no-color.org: set, and not empty.
        let colours = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        let terminal = ratatui::try_init().map_err(|e| Error::io("draw on", Path::new("-"), e))?;
        Ok(Self { terminal, style: Style { colours, within }, said: String::new() })
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // A terminal that is gone needs no restoring.
        let _ = ratatui::try_restore();
    }
}

impl Face for Screen {
    fn every(&self) -> Duration {
        EVERY
    }

    fn show(&mut self, view: &View) -> Result<(), Error> {
        let Self { terminal, style, said } = self;
        let drawn = terminal.draw(|frame| draw(frame, view, *style, said));
        drawn.map(drop).map_err(|e| Error::io("draw on", Path::new("-"), e))
    }

    fn say(&mut self, sentence: &str) {
        sentence.clone_into(&mut self.said);
    }

    fn key(&mut self) -> Option<Key> {
        if !event::poll(Duration::ZERO).ok()? {
            return None;
        }
        let Event::Key(key) = event::read().ok()? else { return None };
        if key.kind == KeyEventKind::Release {
            return None;
        }
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        match key.code {
            KeyCode::Char('c') if control => Some(Key::Interrupt),
            KeyCode::Char('q' | 'Q') => Some(Key::Quit),
            KeyCode::Char('s' | 'S') => Some(Key::Save),
            KeyCode::Char('p' | 'P') => Some(Key::Pause),
            KeyCode::Char('m' | 'M') => Some(Key::Mark),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
