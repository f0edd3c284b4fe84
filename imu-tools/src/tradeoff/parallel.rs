//! Work on many records, on all processors, with results in the order of the records: the same on any number of them.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;

/// Works on records 0 to `count`; `done` is called after each.
///
/// # Errors
/// The first that the work has.
pub(super) fn each<R: Send + Clone, E: Send>(
    count: u64,
    work: impl Fn(u64) -> Result<R, E> + Sync,
    mut done: impl FnMut(),
) -> Result<Vec<R>, E> {
    let next = AtomicU64::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut results = vec![None; count as usize];
    std::thread::scope(|scope| {
        let (to, from) = channel();
        for _ in 0..threads {
            let (to, next, work) = (to.clone(), &next, &work);
            scope.spawn(move || {
                loop {
                    let record = next.fetch_add(1, Ordering::Relaxed);
                    if record >= count || to.send((record, work(record))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(to);
        for (record, result) in from {
            if let Some(place) = results.get_mut(record as usize) {
                *place = Some(result?);
            }
            done();
        }
        Ok(())
    })?;
    Ok(results.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_and_the_first_error_is_told() {
        let mut done = 0;
        let squares = each(100, |k| Ok::<_, ()>(k * k), || done += 1).unwrap();
        assert!(done == 100 && squares.iter().enumerate().all(|(k, s)| *s == (k * k) as u64));
        assert_eq!(each(100, |k| if k == 70 { Err(k) } else { Ok(()) }, || {}), Err(70));
    }
}
