//! A sensor's [`Pipeline`] on a thread of its own: the two sensors of an IMU have nothing to do with
//! each other, and computing takes longer than reading.

use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::{Scope, ScopedJoinHandle};

use super::SensorNoise;
use super::sensor::Pipeline;
use crate::error::Error;
use crate::recording::Sample;

/// Orders that wait, at most.
const AHEAD: usize = 4;

/// What a lane is told.
enum Order {
    /// The next samples; of them, this range counts.
    Take(Vec<Sample>, std::ops::Range<usize>),
    /// Another record follows.
    NextRecord,
}

/// One sensor's thread.
pub(super) struct Lane<'scope> {
    orders: SyncSender<Order>,
    /// Lists whose samples were taken: their memory is used again.
    used: Receiver<Vec<Sample>>,
    noise: ScopedJoinHandle<'scope, Option<SensorNoise>>,
}

impl<'scope> Lane<'scope> {
    /// Starts a thread for this pipeline.
    pub(super) fn new(scope: &'scope Scope<'scope, '_>, mut pipeline: Pipeline) -> Self {
        let (orders, to_do) = sync_channel(AHEAD);
        let (done, used) = sync_channel(AHEAD + 2);
        let noise = scope.spawn(move || {
            for order in to_do {
                match order {
                    Order::Take(samples, range) => {
                        pipeline.push(samples.get(range).unwrap_or_default());
                        // Nobody may want the memory any more.
                        let _ = done.try_send(samples);
                    }
                    Order::NextRecord => pipeline.next_record(),
                }
            }
            pipeline.finish()
        });
        Self { orders, used, noise }
    }

    /// Hands the samples over, of which `range` counts, and leaves an empty list.
    pub(super) fn take(&self, samples: &mut Vec<Sample>, range: std::ops::Range<usize>) {
        if samples.is_empty() {
            return;
        }
        let empty = match self.used.try_recv() {
            Ok(mut list) => {
                list.clear();
                list
            }
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => Vec::new(),
        };
        self.order(Order::Take(std::mem::replace(samples, empty), range));
    }

    /// Another record follows.
    pub(super) fn next_record(&self) {
        self.order(Order::NextRecord);
    }

    fn order(&self, order: Order) {
        // A thread that is gone says so when it is joined.
        let _ = self.orders.send(order);
    }

    /// There are no more samples: the thread works out the noise while others go on.
    pub(super) fn close(self) -> Closed<'scope> {
        Closed(self.noise)
    }
}

/// A lane that knows of its last sample.
pub(super) struct Closed<'scope>(ScopedJoinHandle<'scope, Option<SensorNoise>>);

impl Closed<'_> {
    /// The noise, or nothing if there was not a sample.
    ///
    /// # Errors
    /// If the thread has failed, which is a fault of the program.
    pub(super) fn noise(self) -> Result<Option<SensorNoise>, Error> {
        self.0.join().map_err(|_| Error::data("the computation stopped unexpectedly"))
    }
}
