//! A second of samples that is held back until it is known whether the sensor was at rest in it.

use serde::{Deserialize, Serialize};

use super::usual::WindowStatistics;
use crate::recording::Event;

/// What a window holds, in order.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub(super) enum Piece {
    Values(usize),
    Missing(u64),
    Restart,
}

/// A stretch of about a second.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct Window {
    pub(super) start: u64,
    /// Instants in it, missing ones counted.
    pub(super) length: u64,
    pub(super) pieces: Vec<Piece>,
    pub(super) values: Vec<[f64; 3]>,
    /// `None` where too few samples are there.
    pub(super) statistics: Option<WindowStatistics>,
    pub(super) disturbed: bool,
    /// The axes that stand still in it.
    pub(super) frozen: [bool; 3],
    /// The sensor stands otherwise from here on.
    pub(super) shifts: bool,
}

impl Window {
    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    pub(super) fn is_frozen(&self) -> bool {
        self.frozen.contains(&true)
    }

    /// Its mean, where it is at rest and no hole of `far` instants is in it.
    pub(super) fn neighbour(&self, far: u64) -> Option<[f64; 3]> {
        let statistics = self.statistics.filter(|_| !self.disturbed && self.length <= far)?;
        Some(statistics.mean)
    }

    pub(super) fn restarts(&self) -> bool {
        self.pieces.iter().any(|piece| matches!(piece, Piece::Restart))
    }

    /// Tells all that it holds.
    pub(super) fn tell(&self, to: &mut impl FnMut(Event<'_>)) {
        let mut values = self.values.as_slice();
        for piece in &self.pieces {
            match *piece {
                Piece::Values(n) => {
                    let (now, later) = values.split_at(n.min(values.len()));
                    to(Event::Values(now));
                    values = later;
                }
                Piece::Missing(n) => to(Event::Missing(n)),
                Piece::Restart => to(Event::Restart),
            }
        }
    }
}

/// Samples a window at this rate (Hz). Ladders are fastest where windows end with their chunks of 64.
pub(super) fn window(rate: f64) -> usize {
    const CHUNK: usize = 64;
    let second = (rate as usize).clamp(16, 2048);
    if second < CHUNK { second } else { (second + CHUNK / 2) / CHUNK * CHUNK }
}
