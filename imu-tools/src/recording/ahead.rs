//! Reading on a thread of its own, a few blocks ahead of whoever takes them.

use std::sync::mpsc::sync_channel;

use super::{Block, Source};
use crate::error::Error;

/// What is known when a block has been read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    /// Bytes read up to and with the block.
    pub bytes: u64,
    /// Which record the block belongs to ([`Source::record_number`]).
    pub record: usize,
}

/// Blocks that wait to be taken, at most.
const AHEAD: usize = 4;

/// Reads all blocks, and hands them to `take` in order until it fails. Blocks are used again, so
/// memory does not grow. The source comes back at the end of the recording.
pub(crate) fn read_ahead(
    mut source: Box<dyn Source>,
    mut take: impl FnMut(&mut Block, Position) -> Result<(), Error>,
) -> Result<Box<dyn Source>, Error> {
    std::thread::scope(|scope| {
        let (full, filled) = sync_channel::<(Block, Position)>(AHEAD);
        let (used, empty) = sync_channel::<Block>(AHEAD + 2);
        let reader = scope.spawn(move || {
            loop {
                let mut block = empty.try_recv().unwrap_or_default();
                if !source.next_block(&mut block)? {
                    return Ok(source);
                }
                let position =
                    Position { bytes: source.bytes_read(), record: source.record_number() };
                if full.send((block, position)).is_err() {
                    return Ok(source); // nobody listens any more
                }
            }
        });
        for (mut block, position) in filled {
            // A failure closes the channel behind it, and so ends the reader.
            take(&mut block, position)?;
            // The reader may have ended: then the block is simply dropped.
            let _ = used.try_send(block);
        }
        reader.join().unwrap_or_else(|_| Err(Error::data("the reader stopped unexpectedly")))
    })
}
