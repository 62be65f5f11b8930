//! Names of parameters as people know them, and as the table of parameters has them.

/// Short names of the rows that people know under them.
pub const SHORT_NAMES: &[(&str, &str)] = &[("a", "a_per_rad"), ("c", "c_per_rad2"), ("d", "d_per_rad")];

/// The short name of a row, or its own.
pub fn short_name(row: &str) -> &str {
    SHORT_NAMES.iter().find(|(_, long)| *long == row).map_or(row, |(short, _)| short)
}

/// The row of a short or long name.
pub fn long_name(name: &str) -> &str {
    SHORT_NAMES.iter().find(|(short, _)| *short == name).map_or(name, |(_, long)| long)
}
