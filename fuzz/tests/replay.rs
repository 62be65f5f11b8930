//! The targets without libFuzzer: on every input that once went wrong, on their seeds, and on seeds spoilt at random. Seeds
//! and their spoiling are the same in every run; `cargo xtask fuzz` looks further.

use std::path::Path;
use std::time::{Duration, Instant};

use glidepolar_fuzz::{Target, targets};

/// No input of these may take longer, on a slow machine with unoptimised code.
const PATIENCE: Duration = Duration::from_secs(30);

/// Spoilt inputs of each target, unless their time is over before.
const SPOILT: u64 = 300;
const TIME_FOR_SPOILT: Duration = Duration::from_secs(2);

fn run(target: &Target, data: &[u8], what: &str) {
    let begin = Instant::now();
    (target.run)(data);
    let took = begin.elapsed();
    assert!(took < PATIENCE, "{}: {what} took {took:?}", target.name);
}

#[test]
fn what_once_went_wrong_does_so_no_more() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("regressions");
    let mut replayed = 0;
    for folder in std::fs::read_dir(&root).unwrap().map(|entry| entry.unwrap()) {
        let name = folder.file_name().into_string().unwrap();
        let target = glidepolar_fuzz::target(&name).unwrap_or_else(|| panic!("regressions/{name} is of no target"));
        for input in std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()) {
            run(target, &std::fs::read(&input).unwrap(), &input.display().to_string());
            replayed += 1;
        }
    }
    assert!(replayed > 0, "no input in {}", root.display());
}

#[test]
fn every_target_takes_its_seeds_and_spoilt_ones() {
    for target in targets() {
        let seeds = (target.seeds)();
        assert!(!seeds.is_empty() && seeds.iter().any(|seed| !seed.is_empty()), "{} has no seeds", target.name);
        for (number, seed) in seeds.iter().enumerate() {
            run(target, seed, &format!("seed {number}"));
        }
        let begin = Instant::now();
        for number in (0..SPOILT).take_while(|_| begin.elapsed() < TIME_FOR_SPOILT) {
            let mut random = Random(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
            let mut data = seeds[random.below(seeds.len())].clone();
            (0..=random.below(4)).for_each(|_| spoil(&mut data, &mut random));
            run(target, &data, &format!("spoilt input {number}"));
        }
    }
}

/// One thing that happens to files: a byte changed, a piece lost, a piece twice, the end missing, a number gone wild.
fn spoil(data: &mut Vec<u8>, random: &mut Random) {
    if data.is_empty() {
        return data.push(random.next() as u8);
    }
    let (at, length) = (random.below(data.len()), 1 + random.below(40));
    let end = (at + length).min(data.len());
    match random.below(6) {
        0 => data[at] = random.next() as u8,
        1 => drop(data.drain(at..end)),
        2 => {
            let piece = data[at..end].to_vec();
            let to = random.below(data.len());
            drop(data.splice(to..to, piece));
        }
        3 => data.truncate(at),
        4 => data[at] ^= 1 << random.below(8),
        _ => {
            let wild = ["nan", "1e308", "-1e308", "-0", "1e-320", "", "99999999999999999999", "\u{fc}\u{202e}"];
            let digits = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-');
            let Some(from) = (at..data.len()).find(|i| digits(&data[*i])) else { return };
            let to = (from..data.len()).find(|i| !digits(&data[*i])).unwrap_or(data.len());
            drop(data.splice(from..to, wild[random.below(wild.len())].bytes()));
        }
    }
}

/// Random numbers (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}
