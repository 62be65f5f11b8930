//! Files written here, by a writer that knows the format and none of the reader's code: whole, cut off, damaged.

use std::path::{Path, PathBuf};

use glidepolar_dbd::{Caches, Reader};

/// Sensors of the files: name, bytes of a value, unit.
const SENSORS: [(&str, usize, &str); 5] = [
    ("m_present_time", 8, "s"),
    ("m_depth", 4, "m"),
    ("m_mode", 1, "enum"),
    ("m_count", 2, "nodim"),
    ("m_pitch", 4, "rad"),
];

const START_S: f64 = 1.6e9;

/// How a file is written.
#[derive(Clone, Copy)]
struct Options {
    big_endian: bool,
    factored: bool,
    /// A header again in the middle.
    repeats: bool,
}

const PLAIN: Options = Options { big_endian: false, factored: false, repeats: false };

/// The list of sensors; every sensor is there twice, once stored and once not, as gliders list what they do not store.
fn list() -> String {
    let mut text = String::new();
    for (i, (name, bytes, unit)) in SENSORS.iter().enumerate() {
        text += &format!("s: T {:4} {i:4} {bytes} {name} {unit}\n", 2 * i);
        text += &format!("s: F {:4}   -1 {bytes} x_{name} {unit}\n", 2 * i + 1);
    }
    text
}

/// CRC-32 bit by bit, without the inversion at the end.
fn crc(text: &str) -> String {
    let mut crc = u32::MAX;
    for byte in text.bytes() {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    format!("{crc:08x}")
}

fn header(options: Options) -> Vec<u8> {
    let lines = [
        ("dbd_label", "DBD(dinkum_binary_data)file".to_owned()),
        ("encoding_ver", "5".to_owned()),
        ("num_ascii_tags", "14".to_owned()),
        ("all_sensors", "T".to_owned()),
        ("the8x3_filename", "01600000".to_owned()),
        ("full_filename", "unit_1-2020-257-0-0".to_owned()),
        ("filename_extension", "dbd".to_owned()),
        ("mission_name", "LAKE.MI".to_owned()),
        ("fileopen_time", "Sun_Sep_13_12:26:40_2020".to_owned()),
        ("total_num_sensors", (2 * SENSORS.len()).to_string()),
        ("sensors_per_cycle", SENSORS.len().to_string()),
        ("state_bytes_per_cycle", SENSORS.len().div_ceil(4).to_string()),
        ("sensor_list_crc", crc(&list()).to_uppercase()),
        ("sensor_list_factored", u8::from(options.factored).to_string()),
    ];
    let mut bytes: Vec<u8> =
        lines.iter().flat_map(|(key, value)| format!("{key}:    {value}\n").into_bytes()).collect();
    if !options.factored {
        bytes.extend(list().bytes());
    }
    bytes.extend(b"sa");
    let mut put = |little: &[u8]| put(&mut bytes, little, options.big_endian);
    put(&0x1234i16.to_le_bytes());
    put(&123.456f32.to_le_bytes());
    put(&123_456_789.123_45f64.to_le_bytes());
    bytes
}

fn put(bytes: &mut Vec<u8>, little: &[u8], big_endian: bool) {
    let mut little = little.to_vec();
    if big_endian {
        little.reverse();
    }
    bytes.extend(little);
}

/// What cycle `i` says: time and depth new, mode as before after the first, count every third, pitch never set but in
/// every fifth.
fn row(i: usize) -> [(u8, f64); 5] {
    let is = |condition: bool, state: u8| if condition { state } else { 0 };
    [
        (2, START_S + 2.0 * i as f64),
        (2, 0.5 * i as f64),
        (if i == 0 { 2 } else { 1 }, -3.0),
        (is(i.is_multiple_of(3), 2), -1000.0 - i as f64),
        (is(i.is_multiple_of(5), 2), -0.25),
    ]
}

fn cycle(i: usize, big_endian: bool) -> Vec<u8> {
    let row = row(i);
    let mut bits = vec![0u8; SENSORS.len().div_ceil(4)];
    for (sensor, (state, _)) in row.iter().enumerate() {
        bits[sensor / 4] |= state << (6 - 2 * (sensor % 4));
    }
    let mut bytes = vec![b'd'];
    bytes.extend(bits);
    for ((state, value), (_, size, _)) in row.iter().zip(SENSORS) {
        if *state == 2 {
            match size {
                1 => bytes.push(*value as i8 as u8),
                2 => put(&mut bytes, &(*value as i16).to_le_bytes(), big_endian),
                4 => put(&mut bytes, &(*value as f32).to_le_bytes(), big_endian),
                _ => put(&mut bytes, &value.to_le_bytes(), big_endian),
            }
        }
    }
    bytes
}

fn file(cycles: usize, options: Options) -> Vec<u8> {
    let mut bytes = header(options);
    for i in 0..cycles {
        if options.repeats && i == cycles / 2 {
            bytes.extend(header(options));
        }
        bytes.extend(cycle(i, options.big_endian));
    }
    bytes.push(b'X');
    bytes
}

fn compressed(bytes: &[u8], block: usize) -> Vec<u8> {
    let mut out = Vec::new();
    for piece in bytes.chunks(block) {
        let packed = lz4_flex::block::compress(piece);
        out.extend((packed.len() as u16).to_be_bytes());
        out.extend(packed);
    }
    out
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// All cycles: which of them are there, by their depth, each held against what was written.
fn cycles(path: &Path, caches: &Caches) -> (Vec<usize>, Reader) {
    let mut reader = Reader::open(path, caches).unwrap_or_else(|error| panic!("{error}"));
    let mut found: Vec<usize> = Vec::new();
    while let Some(cycle) = reader.next_cycle().unwrap_or_else(|error| panic!("{error}")) {
        let i = ((cycle.values[0] - START_S) / 2.0) as usize;
        for (sensor, (state, value)) in row(i).iter().enumerate() {
            assert_eq!(cycle.is_set(sensor), *state != 0, "cycle {i}, sensor {sensor}");
            assert_eq!(cycle.is_new(sensor), *state == 2, "cycle {i}, sensor {sensor}");
            let value_is = cycle.values[sensor];
            // After damage a value that is as before may be unknown.
            assert!(*state != 2 || value_is == *value, "cycle {i}, sensor {sensor}: {value_is}");
            assert!(*state != 1 || value_is == *value || value_is.is_nan());
            assert!(*state != 0 || value_is.is_nan());
        }
        found.push(i);
    }
    (found, reader)
}

#[test]
fn every_value_is_read_in_either_order_of_bytes_with_headers_repeated_or_not() {
    let folder = Folder::new();
    for big_endian in [false, true] {
        for repeats in [false, true] {
            let options = Options { big_endian, repeats, factored: false };
            let path = folder.write("a.dbd", &file(100, options));
            let (found, reader) = cycles(&path, &Caches::default());
            assert_eq!(found, (0..100).collect::<Vec<_>>());
            assert_eq!((reader.damages(), reader.cut_off()), (&[][..], None));
            assert_eq!((reader.header().glider(), reader.header().opened_s()), ("unit_1", Some(START_S)));
        }
    }
}

#[test]
fn blocks_are_unpacked_and_lists_are_found_plain_or_packed() {
    let options = Options { factored: true, ..PLAIN };
    let plain = file(3000, options);
    for (name, cache) in [("cac", list().into_bytes()), ("ccc", compressed(list().as_bytes(), 200))] {
        let folder = Folder::new();
        let lists = Folder::new();
        lists.write(&format!("{}.{name}", crc(&list())), &cache);
        let path = folder.write("a.dcd", &compressed(&plain, 32 * 1024));
        let error = Reader::open(&path, &Caches::default()).err().expect("no list").to_string();
        assert!(error.contains(&crc(&list())) && error.contains("--cache") && error.contains("a.dcd"), "{error}");
        let (found, reader) = cycles(&path, &Caches::new([lists.0.path().to_owned()]));
        assert_eq!(found.len(), 3000);
        assert!(reader.damages().is_empty());
        // Beside the data it is found without being asked for.
        folder.write(&format!("{}.{name}", crc(&list())), &cache);
        assert_eq!(cycles(&path, &Caches::default()).0.len(), 3000);
    }
}

#[test]
fn the_list_of_another_file_is_refused() {
    let folder = Folder::new();
    let path = folder.write("a.dbd", &file(10, Options { factored: true, ..PLAIN }));
    let cache = format!("{}.cac", crc(&list()));
    // As many sensors, one of another name: only the checksum knows.
    folder.write(&cache, list().replace("m_depth", "m_death").as_bytes());
    let error = Reader::open(&path, &Caches::default()).err().expect("another list").to_string();
    assert!(error.contains(&cache) && error.contains("checksum"), "{error}");
    folder.write(&cache, b"s: T 0 0 4 m_depth m\n");
    let error = Reader::open(&path, &Caches::default()).err().expect("a short list").to_string();
    assert!(error.contains("1 sensors") && error.contains("another file"), "{error}");
    folder.write(&cache, b"no list\n");
    assert!(Reader::open(&path, &Caches::default()).is_err());
}

#[test]
fn a_file_that_is_cut_off_keeps_all_whole_cycles() {
    let folder = Folder::new();
    let whole = file(50, PLAIN);
    let begin = header(PLAIN).len();
    let mut counts = Vec::new();
    for length in begin..whole.len() {
        let path = folder.write("cut.dbd", &whole[..length]);
        let (found, reader) = cycles(&path, &Caches::default());
        assert_eq!(found, (0..found.len()).collect::<Vec<_>>(), "cut at {length}");
        assert!(reader.damages().is_empty(), "{:?}", reader.damages());
        counts.push(found.len());
    }
    assert!(counts.windows(2).all(|pair| pair[1] == pair[0] || pair[1] == pair[0] + 1));
    assert_eq!(*counts.last().unwrap(), 50);
    for length in 0..begin {
        let path = folder.write("cut.dbd", &whole[..length]);
        if let Ok(mut reader) = Reader::open(&path, &Caches::default()) {
            assert!(reader.next_cycle().unwrap().is_none(), "cut at {length}");
        }
    }
}

#[test]
fn damaged_bytes_cost_the_cycles_around_them_and_are_reported() {
    let folder = Folder::new();
    let whole = file(200, PLAIN);
    let begin = header(PLAIN).len();
    let mut lost_most = 0;
    for at in (begin..whole.len() - 400).step_by(37) {
        let mut bytes = whole.clone();
        bytes[at..at + 5].fill(0xFF);
        let path = folder.write("damaged.dbd", &bytes);
        let mut reader = Reader::open(&path, &Caches::default()).unwrap();
        let mut found = 0;
        while reader.next_cycle().unwrap().is_some() {
            found += 1;
        }
        lost_most = lost_most.max(200usize.saturating_sub(found));
    }
    assert!(lost_most <= 4, "{lost_most} cycles lost to five bytes");
    // A hole of forty bytes: reported with its place.
    let mut bytes = whole;
    bytes.drain(begin + 1000..begin + 1040);
    let path = folder.write("hole.dbd", &bytes);
    let (found, reader) = {
        let mut reader = Reader::open(&path, &Caches::default()).unwrap();
        let mut found = 0;
        while reader.next_cycle().unwrap().is_some() {
            found += 1;
        }
        (found, reader)
    };
    assert!((193..200).contains(&found), "{found}");
    let damage = reader.damages()[0].to_string();
    assert!(damage.contains("byte") && damage.contains("left out"), "{damage}");
}

#[test]
fn a_block_that_does_not_unpack_is_left_out_with_its_number() {
    let folder = Folder::new();
    let plain = file(3000, PLAIN);
    let packed = compressed(&plain, 4096);
    // The third block is spoilt.
    let mut at = 0;
    for _ in 0..2 {
        at += 2 + usize::from(u16::from_be_bytes([packed[at], packed[at + 1]]));
    }
    let length = usize::from(u16::from_be_bytes([packed[at], packed[at + 1]]));
    let mut bytes = packed.clone();
    bytes[at + 2..at + 2 + length].fill(0xFF);
    let path = folder.write("a.dcd", &bytes);
    let (found, reader) = cycles(&path, &Caches::default());
    // 4096 bytes are some 250 cycles.
    assert!(found.len() > 2650 && found.len() < 2850, "{}", found.len());
    assert!(found.contains(&2999));
    let damages: Vec<String> = reader.damages().iter().map(ToString::to_string).collect();
    assert!(damages[0].starts_with("block 3, byte 8192"), "{damages:?}");
    // Cut off in the middle of a block: what is before it is read.
    let path = folder.write("cut.dcd", &packed[..packed.len() * 2 / 3]);
    let (found, reader) = cycles(&path, &Caches::default());
    assert!(found.len() > 1500);
    assert!(reader.damages().iter().any(|damage| damage.to_string().contains("cut off")));
    let error = Reader::open(folder.write("first.dcd", &packed[..100]), &Caches::default()).err().expect("cut");
    assert!(error.to_string().contains("block 1"), "{error}");
}

#[test]
fn a_file_behind_another_is_read_on_and_one_of_another_kind_is_refused() {
    let folder = Folder::new();
    let mut bytes = file(20, PLAIN);
    let second: Vec<u8> = file(40, PLAIN);
    bytes.extend(&second);
    let path = folder.write("two.dbd", &bytes);
    let mut reader = Reader::open(&path, &Caches::default()).unwrap();
    let mut found = 0;
    while reader.next_cycle().unwrap().is_some() {
        found += 1;
    }
    assert_eq!(found, 60);
    for (name, bytes, expected) in [
        ("empty.dbd", &b""[..], "empty"),
        ("text.dbd", b"time_s,pressure_dbar\n", "dbd_label"),
        (
            "version.dbd",
            &String::from_utf8_lossy(&header(PLAIN)).replace("encoding_ver:    5", "encoding_ver:    6").into_bytes()[..],
            "version `6`",
        ),
    ] {
        let error =
            Reader::open(folder.write(name, bytes), &Caches::default()).err().expect("no such file").to_string();
        assert!(error.contains(expected) && error.contains(name), "{error}");
    }
}

#[test]
fn chosen_sensors_come_in_the_order_of_the_choice() {
    let folder = Folder::new();
    let path = folder.write("a.dbd", &file(10, PLAIN));
    let mut reader = Reader::open(&path, &Caches::default()).unwrap();
    reader.select(&["m_pitch", "sci_water_temp", "m_depth"]);
    let cycle = reader.next_cycle().unwrap().unwrap();
    assert_eq!((cycle.values[0], cycle.values[2]), (-0.25, 0.0));
    assert!(cycle.values[1].is_nan() && !cycle.is_set(1));
    let cycle = reader.next_cycle().unwrap().unwrap();
    assert!(cycle.values[0].is_nan());
    assert_eq!(cycle.values[2], 0.5);
}
