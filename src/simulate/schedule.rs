//! Inputs against time: a CSV table with a column `time` and columns named as the FMU's inputs, as FMPy takes it.
//!
//! Between two rows an input changes linearly; two rows of the same time make it jump there. Before the first row and
//! after the last it stands still. An input without a column keeps its start value. A row with an empty cell says nothing of that
//! input: it changes linearly between the rows around it.

use std::path::Path;

use crate::dynamics::{Glider, Inputs};
use crate::input::{InputError, Place, nearest, printable};

/// Inputs against time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Schedule {
    names: &'static [&'static str],
    times_s: Vec<f64>,
    /// Which input each column is.
    inputs: Vec<usize>,
    /// Row by row.
    values: Vec<f64>,
}

impl Schedule {
    /// Reads the text of a table; `origin` is what errors name.
    ///
    /// # Errors
    /// An unknown column, a cell that is no finite number, a time before the one above it; with line and column.
    pub fn parse(text: &str, origin: &Path) -> Result<Schedule, InputError> {
        Schedule::of_names(Inputs::NAMES, text, origin)
    }

    /// The same of inputs with other names.
    ///
    /// # Errors
    /// As [`Schedule::parse`].
    pub fn of_names(names_of: &'static [&'static str], text: &str, origin: &Path) -> Result<Schedule, InputError> {
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let Some((header_line, header)) = lines.next() else {
            return Err(InputError::new(Place::file(origin), "the file is empty, expected a header `time,...`"));
        };
        let names: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
        let mut schedule = Schedule { names: names_of, ..Schedule::default() };
        let mut time_column = None;
        for (column, name) in names.iter().enumerate() {
            let place = Place::line(origin, header_line + 1).column(column + 1);
            let twice = |name: &str| Err(InputError::new(place.clone(), format!("a second column for `{name}`")));
            if matches!(*name, "time" | "time_s") {
                if time_column.replace(column).is_some() {
                    return twice("time");
                }
            } else if let Some(input) = schedule.names.iter().position(|known| known == name) {
                if schedule.inputs.contains(&input) {
                    return twice(name);
                }
                schedule.inputs.push(input);
            } else {
                let error = InputError::new(place, format!("unknown input `{}`", printable(name)));
                return Err(match nearest(name, schedule.names.iter().copied()) {
                    Some(near) => error.help(format!("did you mean `{near}`?")),
                    None => error.help(format!("the inputs are: {}", schedule.names.join(", "))),
                });
            }
        }
        let Some(time_column) = time_column else {
            let place = Place::line(origin, header_line + 1);
            return Err(InputError::new(place, "no column `time`, the time of each row in seconds"));
        };
        for (line, row) in lines {
            schedule.push_row(row, names.len(), time_column, &Place::line(origin, line + 1))?;
        }
        for column in 0..schedule.inputs.len() {
            if !schedule.fill(column) {
                let name = schedule.names[schedule.inputs[column]];
                let error = InputError::new(Place::file(origin), format!("not a single value of `{name}`"));
                return Err(error.help("leave the column out: the input then keeps its start value"));
            }
        }
        Ok(schedule)
    }

    fn push_row(&mut self, row: &str, columns: usize, time_column: usize, place: &Place) -> Result<(), InputError> {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != columns {
            let problem = format!("{} cells where the header has {columns}", cells.len());
            return Err(
                InputError::new(place.clone(), problem).help("a decimal comma splits a cell in two: use a point")
            );
        }
        for (column, cell) in cells.iter().enumerate() {
            let at = || place.clone().column(column + 1);
            if cell.is_empty() && column != time_column {
                self.values.push(f64::NAN);
                continue;
            }
            let value: f64 = cell
                .parse()
                .ok()
                .filter(|value: &f64| value.is_finite())
                .ok_or_else(|| InputError::new(at(), format!("`{}` is no finite number", printable(cell))))?;
            if column != time_column {
                self.values.push(value);
            } else if self.times_s.last().is_some_and(|last| value < *last) {
                return Err(InputError::new(at(), format!("time {value} s comes after a later time")));
            } else {
                self.times_s.push(value);
            }
        }
        Ok(())
    }

    /// Draws straight lines through the rows in which a column is empty; `false` where it has no value at all.
    fn fill(&mut self, column: usize) -> bool {
        let width = self.inputs.len();
        let rows = self.times_s.len();
        let known: Vec<usize> = (0..rows).filter(|row| self.values[row * width + column].is_finite()).collect();
        let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return rows == 0 };
        for row in (0..rows).filter(|row| known.binary_search(row).is_err()) {
            let after = known.partition_point(|known| *known < row);
            let (a, b) = (known.get(after.wrapping_sub(1)).unwrap_or(&first), known.get(after).unwrap_or(&last));
            let (from, to) = (self.values[a * width + column], self.values[b * width + column]);
            let duration_s = self.times_s[*b] - self.times_s[*a];
            let share = if duration_s > 0.0 { (self.times_s[row] - self.times_s[*a]) / duration_s } else { 0.0 };
            self.values[row * width + column] = from + share.clamp(0.0, 1.0) * (to - from);
        }
        true
    }

    /// A reader that goes through the table once, from inputs that hold where the table says nothing.
    pub fn cursor(&self, otherwise: Inputs<f64>) -> Cursor<'_> {
        Cursor { schedule: self, otherwise, next: 0 }
    }

    fn inputs(&self, row: usize, otherwise: &Inputs<f64>) -> Inputs<f64> {
        Inputs::from_array(self.values(row, otherwise.as_array()))
    }

    /// The inputs from a time on, how they change until the next row, when they held first and when their course changes
    /// next; none where the table is empty.
    pub fn from<const N: usize>(&self, time_s: f64, otherwise: [f64; N]) -> Option<Course<N>> {
        let next = self.times_s.partition_point(|row| *row <= time_s);
        let last = next.saturating_sub(1);
        let from_s = *self.times_s.get(last)?;
        let values = self.values(last, otherwise);
        let until_s = self.times_s.get(next).copied();
        let rates = until_s.filter(|_| next > 0).map(|until_s| {
            let ahead = self.values(next, otherwise);
            std::array::from_fn(|i| (ahead[i] - values[i]) / (until_s - from_s))
        });
        Some(Course { values, rates, from_s, until_s })
    }

    fn values<const N: usize>(&self, row: usize, otherwise: [f64; N]) -> [f64; N] {
        let mut values = otherwise;
        let width = self.inputs.len();
        for (input, value) in self.inputs.iter().zip(&self.values[row * width..(row + 1) * width]) {
            values[*input] = *value;
        }
        values
    }
}

/// Inputs that change linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course<const N: usize> {
    /// Their values at `from_s`.
    pub values: [f64; N],
    /// Their rates; none where they stand still.
    pub rates: Option<[f64; N]>,
    /// When they had these values \[s\].
    pub from_s: f64,
    /// When their course changes next \[s\].
    pub until_s: Option<f64>,
}

/// Where a flight stands in its [`Schedule`].
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    schedule: &'a Schedule,
    otherwise: Inputs<f64>,
    /// The first row after the present time.
    next: usize,
}

impl Cursor<'_> {
    /// The next time after `time_s` at which the inputs change their course.
    pub fn next_change_s(&self, time_s: f64) -> Option<f64> {
        self.schedule.times_s[self.next..].iter().copied().find(|row| *row > time_s)
    }

    /// Gives the glider the inputs that hold from `time_s` on; `true` where their course changed.
    pub fn apply(&mut self, time_s: f64, glider: &mut Glider) -> bool {
        let times = &self.schedule.times_s;
        let behind = self.next;
        while self.next < times.len() && times[self.next] <= time_s {
            self.next += 1;
        }
        if (behind == self.next && time_s > 0.0) || times.is_empty() {
            return false;
        }
        let last = self.next.saturating_sub(1);
        glider.inputs = self.schedule.inputs(last, &self.otherwise);
        glider.inputs_at_s = times[last];
        glider.input_rates = (self.next > 0 && self.next < times.len()).then(|| {
            let duration = times[self.next] - times[last];
            let ahead = self.schedule.inputs(self.next, &self.otherwise).as_array();
            let here = glider.inputs.as_array();
            Inputs::from_array(std::array::from_fn(|i| (ahead[i] - here[i]) / duration))
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Actuation, Parameters};

    fn parse(text: &str) -> Result<Schedule, InputError> {
        Schedule::parse(text, Path::new("inputs.csv"))
    }

    #[test]
    fn inputs_change_linearly_and_jump_where_a_time_stands_twice() {
        let schedule = parse("time,current_x_m_s\n10,0\n20,1\n20,5\n30,5\n").unwrap();
        let otherwise = Inputs::still_water(1027.0, 15.0);
        let mut glider = Glider::new(Parameters::default(), Actuation::Servo, otherwise);
        let mut cursor = schedule.cursor(otherwise);
        let mut at = |time: f64| {
            cursor.apply(time, &mut glider);
            glider.inputs_at(time).current_x_m_s
        };
        assert_eq!(
            [0.0, 10.0, 15.0, 19.0, 20.0, 25.0, 30.0, 99.0].map(&mut at),
            [0.0, 0.0, 0.5, 0.9, 5.0, 5.0, 5.0, 5.0]
        );
        assert_eq!(glider.inputs.water_density_kg_m3, 1027.0);
    }

    #[test]
    fn an_empty_cell_says_nothing_of_its_input() {
        let schedule = parse("time,current_x_m_s,u1_N\n0,,5\n10,1,\n20,,\n30,3,8\n40,,\n").unwrap();
        assert_eq!(schedule.values, [1.0, 5.0, 1.0, 6.0, 2.0, 7.0, 3.0, 8.0, 3.0, 8.0]);
        let error = parse("time,u1_N\n0,\n5,\n").unwrap_err().to_string();
        assert!(error.contains("not a single value of `u1_N`"), "{error}");
    }

    #[test]
    fn bad_tables_are_refused_with_line_and_column() {
        for (text, expected) in [
            ("", "inputs.csv: the file is empty"),
            (
                "time,ballast_comand_m3\n",
                "inputs.csv:1:2: unknown input `ballast_comand_m3`; did you mean `ballast_command_m3`?",
            ),
            ("current_x_m_s\n1\n", "no column `time`"),
            ("time,current_x_m_s\n0,1\n5,x\n", "inputs.csv:3:2: `x` is no finite number"),
            ("time,current_x_m_s\n0,nan\n", "inputs.csv:2:2"),
            ("time,current_x_m_s\n0,1,5\n", "3 cells where the header has 2"),
            ("time,u1_N,time_s\n0,1,0\n", "inputs.csv:1:3: a second column for `time`"),
            ("time,u1_N,u1_N\n0,1,2\n", "inputs.csv:1:3: a second column for `u1_N`"),
            ("time,current_x_m_s\n5,1\n4,1\n", "inputs.csv:3:1: time 4 s comes after a later time"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error:?} lacks {expected:?}");
        }
    }
}
