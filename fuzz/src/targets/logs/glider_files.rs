//! Files as gliders write them: binary ones of a Slocum, tables of a SeaExplorer.

use glidepolar_flightlog::{Columns, LogFiles};

use crate::Target;
use crate::files::{Folder, joined, parts};

pub const SLOCUM: Target = Target {
    name: "log_slocum",
    what: "a binary file of a Slocum, plain or compressed",
    run: slocum,
    seeds: slocum_files,
    catches_panics: false,
};

pub const SEAEXPLORER: Target = Target {
    name: "log_seaexplorer",
    what: "a table of a SeaExplorer's vehicle and one of its payload",
    run: seaexplorer,
    seeds: seaexplorer_files,
    catches_panics: false,
};

fn slocum(data: &[u8]) {
    // What is no such file goes another way, which has a target of its own.
    let start = &data[..data.len().min(64)];
    if start.starts_with(b"dbd_label") || start.windows(9).any(|bytes| bytes == b"dbd_label") {
        read(&[("a.dbd", data)]);
    }
}

fn seaexplorer(data: &[u8]) {
    let files: Vec<(&str, &[u8])> =
        ["sea001.1.gli.sub.1", "sea001.1.pld1.sub.1"].into_iter().zip(parts(data)).collect();
    if files.iter().all(|(_, bytes)| bytes.starts_with(b"Timestamp;") || bytes.starts_with(b"PLD_REALTIMECLOCK;")) {
        read(&files);
    }
}

fn read(files: &[(&str, &[u8])]) {
    let folder = Folder::new();
    let paths: Vec<_> = files.iter().map(|(name, bytes)| folder.write(name, bytes)).collect();
    let Ok(mut log) = LogFiles::open(&paths, &Columns::default()) else { return };
    while let Ok(Some(_)) = log.next_piece(50) {}
    assert!(log.fixes().iter().all(|fix| fix.lat_deg.abs() <= 90.0));
}

/// Ten cycles of four sensors, plain; and in two blocks that LZ4 leaves as they are.
fn slocum_files() -> Vec<Vec<u8>> {
    let list = "s: T 0 0 8 m_present_time timestamp\ns: T 1 1 4 m_depth m\ns: T 2 2 4 m_pitch rad\ns: T 3 3 4 m_ballast_pumped cc\n";
    let mut plain = format!(
        "dbd_label: DBD(dinkum_binary_data)file\nencoding_ver: 5\nnum_ascii_tags: 14\nall_sensors: F\n\
         the8x3_filename: 01600000\nfull_filename: unit_1-2020-257-0-0\nfilename_extension: dbd\nmission_name: a.mi\n\
         fileopen_time: Sun_Sep_13_12:26:40_2020\ntotal_num_sensors: 4\nsensors_per_cycle: 4\nstate_bytes_per_cycle: 1\n\
         sensor_list_crc: 00000000\nsensor_list_factored: 0\n{list}sa\x34\x12"
    )
    .into_bytes();
    plain.extend(123.456f32.to_le_bytes());
    plain.extend(123_456_789.123_45f64.to_le_bytes());
    for i in 0..10u8 {
        plain.extend(*b"d\xaa");
        plain.extend((1.6e9 + 4.0 * f64::from(i)).to_le_bytes());
        for value in [f32::from(i), -0.4, -200.0] {
            plain.extend(value.to_le_bytes());
        }
    }
    plain.push(b'X');
    // A block of literals only: fifteen in the token, the rest in bytes of 255 and a last one, then the bytes.
    let mut packed = Vec::new();
    for piece in plain.chunks(600) {
        let mut block = vec![0xf0];
        let mut rest = piece.len() - 15;
        while rest >= 255 {
            block.push(255);
            rest -= 255;
        }
        block.push(rest as u8);
        block.extend(piece);
        packed.extend((block.len() as u16).to_be_bytes());
        packed.extend(block);
    }
    vec![plain, packed]
}

fn seaexplorer_files() -> Vec<Vec<u8>> {
    let mut gli = "Timestamp;NavState;Heading;Pitch;Roll;Depth;Lat;Lon;BallastPos;LinPos;\n".to_owned();
    let mut pld = "PLD_REALTIMECLOCK;NAV_RESOURCE;GPCTD_CONDUCTIVITY;GPCTD_TEMPERATURE;GPCTD_PRESSURE;\n".to_owned();
    for i in 0..10 {
        gli += &format!("22/07/2019 05:24:{:02};100;270.0;-20.0;1.0;{i};4854.678;-13036.411;-200.0;40.0;\n", 5 * i);
        pld += &format!("22/07/2019 05:24:{:02}.500;100;4.0;12.0;{i};\n", 5 * i);
    }
    vec![joined(&[gli.as_bytes(), pld.as_bytes()]), gli.into_bytes()]
}
