//! Glider files read: beside netCDF4, xarray, pandas and dbdreader on the same files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use glidepolar::log::{Channel, Columns, LogFiles, Piece};
use glidepolar_dbd::{Caches, Reader};
use serde_json::{Value, json};

use super::Context;
use crate::arguments::Sized;
use crate::contest::{Contender, contest};
use crate::peer::{Peer, number};
use crate::report::{Goal, Part, Row, Unit};

/// Files of one maker, how often they are read in a turn, and who else reads them.
struct Files {
    what: &'static str,
    folder: &'static str,
    /// Beginnings and ends of the names.
    names: &'static [(&'static str, &'static str)],
    /// Folder with lists of sensors.
    cache: Option<&'static str>,
    readers: &'static [(&'static str, &'static str)],
    reading: Reading,
}

/// What is made of them.
#[derive(Clone, Copy, PartialEq)]
enum Reading {
    /// A log: the channels that matter, at the same times.
    Log,
    /// All sensors as they were recorded.
    Sensors,
}

const ALL: [Files; 5] = [
    Files {
        what: "Seaglider, 14 dives of SG542",
        folder: "sg542",
        names: &[("p542", ".nc")],
        cache: None,
        readers: &[("netCDF4", "netCDF4"), ("xarray", "xarray")],
        reading: Reading::Log,
    },
    Files {
        what: "SeaExplorer, 28 files of SEA035",
        folder: "pyglider/sea035",
        names: &[("sea035.", "")],
        cache: None,
        readers: &[("pandas", "pandas.read_csv")],
        reading: Reading::Log,
    },
    Files {
        what: "SeaExplorer, 10 gzipped files of SEA046",
        folder: "pyglider/sea046",
        names: &[("sea046.", ".gz")],
        cache: None,
        readers: &[("pandas", "pandas.read_csv")],
        reading: Reading::Log,
    },
    Files {
        what: "Slocum, 2 segments, flight and science",
        folder: "dbdreader",
        names: &[("sebastian-2014-204-05-00", "bd")],
        cache: Some("cac"),
        readers: &[("dbdreader", "dbdreader")],
        reading: Reading::Log,
    },
    Files {
        what: "the same, every sensor as recorded",
        folder: "dbdreader",
        names: &[("sebastian-2014-204-05-00", "bd")],
        cache: Some("cac"),
        readers: &[("dbdreader, all", "dbdreader")],
        reading: Reading::Sensors,
    },
];

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "Reading logs",
        "Real files (`cargo xtask fetch-data`) in the system's file cache, read in a process that runs already. A log takes \
         every channel that the fit or the track can use, brought to the times of the pressure by straight lines, and finds \
         out what a file is, its order and its glider. The others read the same variables or sensors and bring them to the \
         same times; they find out nothing.",
    );
    let mut peer = Peer::start(context.python(), context.root(), "log_readers.py", &[]);
    for files in &ALL {
        if let Err(error) = of(context, &mut part, files, &mut peer) {
            part.row(Row::new(files.what, Unit::Seconds, Err(error)));
        }
    }
    Ok(part)
}

fn of(context: &Context<'_>, part: &mut Part, files: &Files, peer: &mut Result<Peer>) -> Result<()> {
    let folder = context.root().join("data").join(files.folder);
    let paths = paths(&folder, files.names)?;
    let cache = files.cache.map(|name| folder.join(name));
    let times = context.choice.size(Sized { quick: 1, standard: 5, full: 10 });
    for (reader, shown) in files.readers {
        let question = json!({ "reader": reader, "files": paths, "cache": cache });
        let (mut ours, mut theirs) = (None, None);
        let [own, other] = contest(
            context.choice.rounds(),
            [
                Contender::new(files.what, || {
                    let begin = Instant::now();
                    for _ in 0..times {
                        ours = Some(read(&paths, cache.as_deref(), files.reading)?);
                    }
                    Ok(begin.elapsed().as_secs_f64() / f64::from(times))
                }),
                Contender::new(*shown, || {
                    let peer = peer.as_mut().map_err(|error| anyhow::anyhow!("{error:#}"))?;
                    let answer = peer.ask(&question)?;
                    let seconds = number(&answer, "seconds")?;
                    theirs = Some(answer);
                    Ok(seconds)
                }),
            ],
        );
        part.row(
            Row::new(files.what, Unit::Seconds, own.samples().cloned())
                .against(*shown, other.samples().cloned())
                .goal(Goal::Quicker(1.0)),
        );
        if let (Some(ours), Some(theirs)) = (ours, &theirs) {
            let bytes: u64 = paths.iter().map(|path| std::fs::metadata(path).map_or(0, |meta| meta.len())).sum();
            let rate = bytes as f64 / 1e6 / own.samples()?.least();
            part.remark(format!("{}: {rate:.0} MB/s at the best; {}", files.what, agreement(ours, shown, theirs)?));
        }
    }
    Ok(())
}

/// Rows or values, and the sum of the pressures \[dbar\].
type Found = (usize, f64);

fn read(paths: &[PathBuf], cache: Option<&Path>, reading: Reading) -> Result<Found> {
    match reading {
        Reading::Log => read_log(paths, cache),
        Reading::Sensors => read_sensors(paths, cache),
    }
}

fn read_log(paths: &[PathBuf], cache: Option<&Path>) -> Result<Found> {
    let mut columns = Columns::default();
    if let Some(cache) = cache {
        columns.cache(cache);
    }
    let (mut rows, mut sum) = (0, 0.0);
    let mut log = LogFiles::open(paths, &columns)?;
    while let Some(piece) = log.next_piece(50_000)? {
        let Piece::Series(piece) = piece else { bail!("no time series") };
        rows += piece.len();
        sum += piece.column(Channel::Pressure).iter().filter(|value| value.is_finite()).sum::<f64>();
    }
    Ok((rows, sum))
}

fn read_sensors(paths: &[PathBuf], cache: Option<&Path>) -> Result<Found> {
    let caches = Caches::new(cache.map(Path::to_owned));
    let mut values = 0;
    for path in paths {
        let mut reader = Reader::open(path, &caches)?;
        while let Some(cycle) = reader.next_cycle()? {
            values += cycle.values.iter().filter(|value| value.is_finite()).count();
        }
    }
    Ok((values, 0.0))
}

/// The files of a folder with such names, in order.
fn paths(folder: &Path, names: &[(&str, &str)]) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)
        .with_context(|| format!("{} is not there: cargo xtask fetch-data", folder.display()))?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if names.iter().any(|(begin, end)| name.starts_with(begin) && name.ends_with(end)) {
            found.push(path);
        }
    }
    if found.is_empty() {
        bail!("no such files in {}", folder.display());
    }
    found.sort();
    Ok(found)
}

/// Whether both found the same.
fn agreement((rows, sum): Found, who: &str, other: &Value) -> Result<String> {
    let (theirs, their_sum) = (number(other, "rows")?, number(other, "sum")?);
    let mut text = format!("{rows} rows or values here, {theirs} by {who}");
    if sum != 0.0 {
        text += &format!(", mean pressure {:.2} and {:.2} dbar", sum / rows as f64, their_sum / theirs);
    }
    Ok(text)
}
