//! How many fields a row has: one with more may be two rows, between which the line end was lost.

/// Rows that show it.
const SHOWN_BY: u32 = 64;

/// Of those, as many of one number of fields are no damage, even if no two of them followed each other.
const OFTEN: u8 = 8;

/// Numbers of fields that are told apart.
const MOST: usize = 64;

/// Fields of a row, at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Width {
    most: usize,
    /// Rows that are still to show it.
    wanted: u32,
    /// How many rows had so many fields.
    times: [u8; MOST],
    latest: usize,
}

impl Width {
    /// A header named so many fields.
    pub const fn told(fields: usize) -> Self {
        Self { most: fields, wanted: 0, times: [0; MOST], latest: 0 }
    }

    /// Only the first columns are known: the first rows show how many more there are.
    pub const fn at_least(columns: usize) -> Self {
        Self { wanted: SHOWN_BY, ..Self::told(columns) }
    }

    /// The number of fields that no row has more of; `None` while rows have still to show it.
    pub fn known(&self) -> Option<usize> {
        (self.wanted == 0).then_some(self.most)
    }

    /// Learns from a row with so many fields; whether that is no more than rows were seen to have.
    pub fn see(&mut self, fields: usize) -> bool {
        let times = self.times.get_mut(fields).map_or(0, |times| {
            *times = times.saturating_add(1);
            *times
        });
        if fields == self.latest || times >= OFTEN {
            self.most = self.most.max(fields);
        }
        (self.latest, self.wanted) = (fields, self.wanted.saturating_sub(1));
        fields <= self.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of many rows fit, each with as many fields as the pattern says in turn.
    fn fit(columns: usize, pattern: &[usize]) -> Vec<bool> {
        let mut width = Width::at_least(columns);
        let rows = pattern.iter().cycle().take(SHOWN_BY as usize);
        let fit = rows.map(|fields| width.see(*fields)).collect();
        assert!(width.known().is_some());
        fit
    }

    #[test]
    fn rows_that_are_often_so_wide_fit() {
        // One after the other; in turn; now and then.
        let lost = |fit: Vec<bool>| fit.iter().filter(|fits| !**fits).count();
        assert_eq!(lost(fit(6, &[9])), 1);
        assert_eq!(lost(fit(6, &[7, 8])), 14);
        assert_eq!(lost(fit(6, &[6, 6, 6, 9])), 7);
        assert_eq!(lost(fit(6, &[5, 6])), 0);
    }

    #[test]
    fn one_that_is_seldom_so_wide_does_not() {
        let mut rows = [6; 15];
        rows[7] = 11;
        assert_eq!(fit(6, &rows).iter().filter(|fits| !**fits).count(), 4);
        assert_eq!(Width::told(6).known(), Some(6));
        // More fields than are told apart.
        assert!(fit(6, &[100]).iter().skip(1).all(|fits| *fits));
    }
}
