//! Log files, read as the commands read them.

use std::path::PathBuf;

use glidepolar_flightlog::{Columns, LogFiles, Observation, Piece, Preparation, PreparationSettings};

/// The samples of files.
pub fn read(files: &[PathBuf], settings: PreparationSettings) -> Vec<Observation> {
    let columns = Columns::default();
    let mut log = LogFiles::open(files, &columns).expect("a log");
    let mut preparation = Preparation::new(settings);
    let mut all: Vec<Observation> = Vec::new();
    while let Some(piece) = log.next_piece(50_000).expect("a piece") {
        if let Piece::Series(piece) = piece {
            preparation.push(*piece, &mut all);
        }
    }
    preparation.finish(&mut all);
    all
}
