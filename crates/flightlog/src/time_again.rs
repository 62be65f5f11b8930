//! Times that begin again in each table of a log: laid one behind the other, so that no row comes before an earlier one.

use super::channels::{Channel, FlightLog};

/// So long after the last row of one table the next begins, since how long it was is not known: nothing is drawn across a gap
/// of this length, as between any two dives of which the time between is not in the log \[s\].
const BETWEEN_S: f64 = 3600.0;

/// Where the rows so far end, and by how much those of the table that is being read are moved.
#[derive(Debug)]
pub(super) struct TimeAgain {
    end_s: f64,
    last_dive: f64,
    /// By how much times and numbers of dives are moved; NaN where that follows from the next row.
    moved_s: f64,
    moved_dives: f64,
}

impl Default for TimeAgain {
    fn default() -> Self {
        TimeAgain { end_s: f64::NAN, last_dive: f64::NAN, moved_s: 0.0, moved_dives: 0.0 }
    }
}

impl TimeAgain {
    /// The rows that follow are those of another table.
    pub(super) fn begin(&mut self, begins_again: bool) {
        let moved = if begins_again && self.end_s.is_finite() { f64::NAN } else { 0.0 };
        (self.moved_s, self.moved_dives) = (moved, moved);
    }

    /// Lays the next rows of the table behind what was there before it.
    pub(super) fn lay(&mut self, piece: &mut FlightLog) {
        let first =
            |piece: &FlightLog, channel: Channel| piece.column(channel).iter().copied().find(|value| value.is_finite());
        if let Some(first_s) = first(piece, Channel::Time).filter(|_| self.moved_s.is_nan()) {
            self.moved_s = self.end_s + BETWEEN_S - first_s;
        }
        if let Some(dive) = first(piece, Channel::Dive).filter(|_| self.moved_dives.is_nan()) {
            // Numbers that go on by themselves are kept.
            self.moved_dives = if dive <= self.last_dive { self.last_dive + 1.0 - dive } else { 0.0 };
        }
        for (channel, moved, last) in
            [(Channel::Time, self.moved_s, &mut self.end_s), (Channel::Dive, self.moved_dives, &mut self.last_dive)]
        {
            if piece.has(channel) {
                piece.column_mut(channel).iter_mut().for_each(|value| *value += moved);
                *last = piece.column(channel).iter().copied().fold(*last, f64::max);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_table_comes_behind_the_one_before() {
        let mut again = TimeAgain::default();
        let mut laid = |begins_again: Option<bool>, times: &[f64], dives: &[f64]| {
            begins_again.iter().for_each(|begins| again.begin(*begins));
            let mut piece = FlightLog::default();
            piece.set(Channel::Time, times.to_vec());
            piece.set(Channel::Dive, dives.to_vec());
            again.lay(&mut piece);
            (piece.column(Channel::Time).to_vec(), piece.column(Channel::Dive).to_vec())
        };
        assert_eq!(laid(Some(false), &[0.0, 10.0], &[1.0, 2.0]), (vec![0.0, 10.0], vec![1.0, 2.0]));
        assert_eq!(laid(Some(true), &[0.0, 5.0], &[1.0, 1.0]), (vec![3610.0, 3615.0], vec![3.0, 3.0]));
        // The next piece of the same table.
        assert_eq!(laid(None, &[6.0], &[2.0]), (vec![3616.0], vec![4.0]));
        assert_eq!(laid(Some(true), &[0.0], &[9.0]), (vec![7216.0], vec![9.0]));
    }
}
