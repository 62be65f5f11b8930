//! The files of dbdreader's source package, value for value as dbdreader 0.6.3 reads them: `dbdreader_values.csv`, written by
//! `dbdreader_values.py`. `cargo xtask fetch-data` fetches the files; without them the test fails where `CI` is set.

use std::collections::BTreeMap;
use std::path::Path;

use glidepolar_dbd::{Caches, Reader};

/// What is read of one file: how many values, and the checksum over them.
fn read(path: &Path, caches: &Caches) -> Result<(usize, String, Reader), glidepolar_dbd::Error> {
    let mut reader = Reader::open(path, caches)?;
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let names: Vec<String> = reader.sensors().iter().map(|sensor| sensor.name.clone()).collect();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    while let Some(cycle) = reader.next_cycle()? {
        for (sensor, column) in values.iter_mut().enumerate().filter(|(sensor, _)| cycle.is_set(*sensor)) {
            column.push(cycle.values[sensor]);
        }
    }
    columns.extend(names.into_iter().zip(values));
    let mut checksum = crc32fast::Hasher::new();
    let mut total = 0;
    for (name, column) in &columns {
        checksum.update(name.as_bytes());
        checksum.update(&(column.len() as u64).to_le_bytes());
        column.iter().for_each(|value| checksum.update(&value.to_le_bytes()));
        total += column.len();
    }
    Ok((total, format!("{:08x}", checksum.finalize()), reader))
}

#[test]
fn every_file_is_read_as_dbdreader_reads_it() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/dbdreader");
    if !data.is_dir() {
        assert!(std::env::var_os("CI").is_none(), "no {}: run `cargo xtask fetch-data`", data.display());
        eprintln!("SKIPPED: the files are not there; fetch them by `cargo xtask fetch-data`");
        return;
    }
    let caches = Caches::new([data.join("cac")]);
    let mut compared = 0;
    for line in include_str!("dbdreader_values.csv").lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [name, count, checksum] = cells[..] else { panic!("{line}") };
        let found = read(&data.join(name), &caches);
        match (found, count) {
            // dbdreader refuses the file, or gives nothing of it: here it is refused by name, or its sound part is read and
            // the damage reported.
            (Err(error), "") => assert!(error.to_string().contains(name), "{error}"),
            (Ok((_, _, reader)), "" | "0") => assert!(!reader.damages().is_empty(), "{name} is damaged"),
            (Ok((total, crc, reader)), _) => {
                assert_eq!((total.to_string().as_str(), crc.as_str()), (count, checksum), "{name}");
                assert!(reader.damages().is_empty(), "{name}: {:?}", reader.damages());
                compared += 1;
            }
            (Err(error), _) => panic!("{error}"),
        }
    }
    assert!(compared >= 29, "{compared} files compared");
}
