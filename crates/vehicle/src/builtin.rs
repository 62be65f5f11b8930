//! The vehicles that come with the program.

/// Their names.
pub const NAMES: &[&str] = &["rogue", "slocum-graver", "slocum-049", "adelaide", "seaglider", "seaexplorer", "seawing"];

/// The text of a built-in vehicle file.
pub fn text(name: &str) -> Option<&'static str> {
    match name {
        "rogue" => Some(include_str!("../../../vehicles/rogue.toml")),
        "slocum-graver" => Some(include_str!("../../../vehicles/slocum-graver.toml")),
        "slocum-049" => Some(include_str!("../../../vehicles/slocum-049.toml")),
        "adelaide" => Some(include_str!("../../../vehicles/adelaide.toml")),
        "seaglider" => Some(include_str!("../../../vehicles/seaglider.toml")),
        "seaexplorer" => Some(include_str!("../../../vehicles/seaexplorer.toml")),
        "seawing" => Some(include_str!("../../../vehicles/seawing.toml")),
        _ => None,
    }
}
