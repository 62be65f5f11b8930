//! Reads files and prints how fast: `dbd_rate [--select NAME,NAME] FILE...`.

use std::time::Instant;

use glidepolar_dbd::{Caches, Reader};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut files: Vec<String> = std::env::args().skip(1).collect();
    let mut names: Option<Vec<String>> = None;
    if files.first().is_some_and(|first| first == "--select") {
        names = files.get(1).map(|list| list.split(',').map(str::to_owned).collect());
        files.drain(..2.min(files.len()));
    }
    let begin = Instant::now();
    let (mut bytes, mut cycles, mut sum) = (0, 0u64, 0.0);
    for file in &files {
        let mut reader = Reader::open(file, &Caches::default())?;
        if let Some(names) = &names {
            reader.select(names);
        }
        while let Some(cycle) = reader.next_cycle()? {
            cycles += 1;
            sum += cycle.values.iter().copied().filter(|value| value.is_finite()).sum::<f64>();
        }
        bytes += std::fs::metadata(file)?.len();
    }
    let seconds = begin.elapsed().as_secs_f64();
    println!(
        "{cycles} cycles, {bytes} bytes in {seconds:.4} s: {:.1} MB/s (sum {sum:e})",
        bytes as f64 / 1e6 / seconds
    );
    Ok(())
}
