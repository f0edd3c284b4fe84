//! A file of which nothing can be read, or nothing that is wanted.

use super::{Block, Note, Source, Stream};
use crate::error::Error;

/// Is at its end.
pub struct Nothing;

impl Source for Nothing {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        Ok(false)
    }

    fn streams(&self) -> Vec<Stream> {
        Vec::new()
    }

    fn gyroscope(&self) -> &str {
        ""
    }

    fn accelerometer(&self) -> &str {
        ""
    }

    fn take_notes(&mut self) -> Vec<Note> {
        Vec::new()
    }

    fn bytes_read(&self) -> u64 {
        0
    }

    fn bytes_total(&self) -> Option<u64> {
        Some(0)
    }
}
