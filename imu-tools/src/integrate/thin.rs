//! A curve for a picture: evenly thinned as it grows, so that its memory does not.

/// Points kept at most.
const MOST: usize = 2048;

/// Every so many-th of the points that were pushed, and the last one.
#[derive(Clone, Debug, PartialEq)]
pub struct Thin<P> {
    kept: Vec<P>,
    last: Option<P>,
    every: u64,
    seen: u64,
}

impl<P> Default for Thin<P> {
    fn default() -> Self {
        Self { kept: Vec::new(), last: None, every: 1, seen: 0 }
    }
}

impl<P: Copy> Thin<P> {
    pub(super) fn push(&mut self, point: P) {
        self.last = None;
        if self.seen.is_multiple_of(self.every) {
            self.kept.push(point);
            if self.kept.len() == MOST {
                let mut place = 0_usize;
                self.kept.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.every *= 2;
            }
        } else {
            self.last = Some(point);
        }
        self.seen += 1;
    }

    /// What is left to draw.
    pub fn points(&self) -> impl Iterator<Item = P> + Clone {
        self.kept.iter().copied().chain(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stays_small_and_keeps_both_ends() {
        let mut thin = Thin::default();
        for i in 0..100_000_u32 {
            thin.push(i);
        }
        let points: Vec<u32> = thin.points().collect();
        assert!((MOST / 2..=MOST + 1).contains(&points.len()), "{}", points.len());
        assert_eq!((points.first(), points.last()), (Some(&0), Some(&99_999)));
        let even = points.windows(2).rev().skip(1).all(|pair| pair[1] - pair[0] == points[1]);
        assert!(even);
    }
}
