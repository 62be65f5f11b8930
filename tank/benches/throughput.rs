//! How fast a campaign streams through, beside the `csv` crate alone parsing the same columns of the same files.
//!
//! `cargo bench -p glidepolar-tank` (`THROUGHPUT_MB` sets the size of the campaign, 200 by default). Both are printed for one
//! core, and the reduction for all cores as well. The files are read once before, so that no disk is measured.

use std::path::PathBuf;
use std::time::Instant;

use glidepolar_tank::virtual_tank::{self, write_campaign};
use glidepolar_tank::{Options, reduce_campaign};

fn main() {
    let size_mb = std::env::var("THROUGHPUT_MB").ok().and_then(|mb| mb.parse().ok()).unwrap_or(200.0);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let campaign = folder.path().join("pmm_runs");
    let options = virtual_tank::Options { size_mb: Some(size_mb), ..Default::default() };
    let truth = write_campaign(&campaign, &options).expect("a campaign");
    let megabytes = truth.data_bytes as f64 / 1e6;
    let files: Vec<PathBuf> =
        std::fs::read_dir(campaign.join("data")).expect("the runs").map(|entry| entry.expect("a run").path()).collect();
    println!("{megabytes:.0} MB in {} runs", files.len());

    let bare = || files.iter().map(|file| parse_with_csv(file)).sum::<f64>();
    bare();
    let rate_of = |what: &str, work: &dyn Fn()| {
        // The best of three: other programs only ever slow it down.
        let seconds = (0..3).map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        });
        let rate = megabytes / seconds.fold(f64::INFINITY, f64::min);
        println!("{what:40} {rate:7.0} MB/s");
        rate
    };
    let csv = rate_of("csv crate, columns to f64, one core", &|| {
        std::hint::black_box(bare());
    });
    let reduce = || {
        let reduced = reduce_campaign(&campaign, &Options { range_deg: 10.0, strict: true }, &|_| ());
        std::hint::black_box(reduced.expect("a reduction"));
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let single = rate_of("tank-reduce, one core", &|| one.install(reduce));
    let all = rate_of("tank-reduce, all cores", &reduce);
    println!(
        "reduction over bare parsing: {:.0} % on one core, {:.0} % on all",
        100.0 * single / csv,
        100.0 * all / csv
    );
}

/// Every column of a file into f64, the way the crate's own guide does it fastest: one record used again and again.
fn parse_with_csv(file: &std::path::Path) -> f64 {
    let mut reader = csv::Reader::from_path(file).expect("a file");
    let mut record = csv::ByteRecord::new();
    let mut columns: [Vec<f64>; 7] = Default::default();
    while reader.read_byte_record(&mut record).expect("a row") {
        for (column, cell) in columns.iter_mut().zip(&record) {
            let text = std::str::from_utf8(cell).expect("text");
            column.push(text.parse().expect("a number"));
        }
    }
    columns.iter().map(|column| column[column.len() - 1]).sum()
}
