//! Writes the values of a Slocum's binary file as they were read, for another program to compare:
//! `dbd_values FILE OUT [CACHE]...`. OUT holds the names of the sensors in a line, then for each cycle a byte and an eight-byte
//! number of each, the least significant byte first: whether the value is set (1: as before, 2: new), and the value.

use std::io::{BufWriter, Write};
use std::process::ExitCode;

use glidepolar_dbd::{Caches, Reader};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, out, caches @ ..] = &arguments[..] else {
        eprintln!("usage: dbd_values FILE OUT [CACHE]...");
        return ExitCode::from(2);
    };
    match write(file, out, Caches::new(caches.iter().map(Into::into))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn write(file: &str, out: &str, caches: Caches) -> Result<(), Box<dyn std::error::Error>> {
    let mut reader = Reader::open(file, &caches)?;
    let names: Vec<String> = reader.sensors().iter().map(|sensor| sensor.name.clone()).collect();
    let mut out = BufWriter::new(std::fs::File::create(out)?);
    writeln!(out, "{}", names.join(" "))?;
    while let Some(cycle) = reader.next_cycle()? {
        for sensor in 0..names.len() {
            let state = u8::from(cycle.is_set(sensor)) + u8::from(cycle.is_new(sensor));
            out.write_all(&[state])?;
            out.write_all(&cycle.values[sensor].to_le_bytes())?;
        }
    }
    out.flush()?;
    for damage in reader.damages() {
        eprintln!("{file}: {damage}");
    }
    if let Some(bytes) = reader.cut_off() {
        eprintln!("{file}: the last {bytes} bytes are a cycle that was cut off");
    }
    Ok(())
}
