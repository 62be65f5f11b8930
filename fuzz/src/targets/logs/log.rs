//! Flight logs: CSV and NetCDF, up to samples that a fit can use.

use glidepolar_flightlog::{Channel, Columns, LogFiles, Opened, Preparation, PreparationSettings, open};
use glidepolar_virtual_sea::{Options, generate};

use crate::Target;
use crate::files::{Folder, thinned};

#[path = "../../../../crates/flightlog/src/tests/classic.rs"]
mod classic;

pub const CSV: Target = Target {
    name: "log_csv",
    what: "a flight log or a table of glides in CSV",
    run: csv,
    seeds: logs,
    catches_panics: false,
};

pub const NETCDF: Target = Target {
    name: "log_netcdf",
    what: "a flight log in NetCDF",
    run: netcdf,
    seeds: netcdf_logs,
    catches_panics: true,
};

/// Rows of a log that are read at once: few, so that pieces meet.
const PIECE_ROWS: usize = 50;

fn csv(data: &[u8]) {
    read("log.csv", data);
}

fn netcdf(data: &[u8]) {
    // What is no NetCDF goes another way, which has a target of its own.
    if data.starts_with(b"CDF") || data.starts_with(b"\x89HDF\r\n\x1a\n") {
        read("log.nc", data);
    }
}

fn read(name: &str, data: &[u8]) {
    let folder = Folder::new();
    let path = folder.write(name, data);
    let mut columns = Columns::default();
    if name.ends_with(".nc") {
        columns.choose(Channel::Speed, "ad2cp");
        if let Ok(mut files) = LogFiles::open(std::slice::from_ref(&path), &columns) {
            while let Ok(Some(_)) = files.next_piece(PIECE_ROWS) {}
        }
    }
    let Ok(Opened::Series(mut series)) = open(&path, &Columns::default()) else { return };
    let mut preparation =
        Preparation::new(PreparationSettings { density_kg_m3: Some(1025.0), ..PreparationSettings::default() });
    let mut observations = Vec::new();
    while let Ok(Some(piece)) = series.next_piece(PIECE_ROWS) {
        preparation.push(piece, &mut observations);
    }
    preparation.finish(&mut observations);
    assert!(observations.iter().all(|o| o.pressure_dbar.is_finite() && o.time_s.is_finite()));
}

/// Two short dives of a simulated glider, and a table of glides.
pub fn logs() -> Vec<Vec<u8>> {
    let sea = generate(&Options { hours: 1.0, dives: 2, ..Options::seeded(1) });
    let glides = "glide,start_s,duration_s,mean_depth_m,pitch_rad,vbd_cc,w_m_s,density_kg_m3,temperature_C\n\
        0,0,300,40,-0.45,-220,-0.16,1026.1,9\n1,400,300,40,0.44,230,0.17,1026.2,9\n\
        2,800,310,45,-0.40,-200,-0.15,1026.1,8.5\n3,1200,305,45,0.41,210,0.15,1026.2,8.5\n\
        4,1600,310,45,-0.50,-210,-0.17,1026.1,8.5\n5,2000,305,45,0.49,220,0.18,1026.2,8.5\n";
    vec![thinned(&sea.log.to_csv(), 12).into_bytes(), glides.as_bytes().to_vec()]
}

/// The two kinds in the classic format, small; and the real ones that are in data/, the small ones of them.
fn netcdf_logs() -> Vec<Vec<u8>> {
    const ROWS: usize = 40;
    let series = |value: &dyn Fn(f64) -> f64| (0..ROWS).map(|i| value(i as f64)).collect::<Vec<_>>();
    let time = series(&|i| 10.0 * i);
    let pressure = series(&|i| 5.0 + 3.0 * (20.0 - (i - 20.0).abs()));
    let pitch = series(&|i| if i < 20.0 { -25.0 } else { 25.0 });
    let ballast = series(&|i| if i < 20.0 { -200.0 } else { 200.0 });
    let og1 = classic::File::new(ROWS)
        .variable("TIME", "seconds since 1970-01-01", &time)
        .variable("PRES", "dbar", &pressure)
        .variable("PITCH", "degrees", &pitch)
        .variable("vbd_cc", "cc", &ballast)
        .bytes();
    let seaglider = classic::File::new(ROWS)
        .variable("time", "seconds since 1970-01-01", &time)
        .variable("ctd_pressure", "dbar", &pressure)
        .variable("eng_pitchAng", "degrees", &pitch)
        .variable("eng_vbdCC", "cc", &ballast)
        .variable("temperature", "degC", &series(&|i| 12.0 - 0.1 * i))
        .variable("salinity", "1", &series(&|_| 35.0))
        .with_moves(&[(190.0, 200.0), (300.0, 305.0)])
        .attribute("dive_number", 7)
        .bytes();
    let (ctd, pings) = ([("ctd_data_point", 30)], [("ad2cp_data_data_point", 2)]);
    let thirty = |value: &dyn Fn(f64) -> f64| (0..30).map(|i| value(f64::from(i))).collect::<Vec<_>>();
    let cells = [("ad2cp_data_data_point", 2), ("ad2cp_cell_data_point", 4)];
    let clocks = classic::File::new(ROWS)
        .text("platform_id", "SG001")
        .variable("time", "seconds since 1970-01-01", &time)
        .variable("pressure", "dbar", &pressure)
        .variable("eng_pitchAng", "degrees", &pitch)
        .variable("eng_vbdCC", "cc", &ballast)
        .variable_on(&ctd, "ctd_time", "seconds since 1970-01-01", &thirty(&|i| 5.0 + 13.0 * i))
        .variable_on(&ctd, "temperature", "degC", &thirty(&|i| 12.0 - 0.1 * i))
        .variable_on(&ctd, "salinity", "1", &thirty(&|_| 35.0))
        .variable_on(&pings, "ad2cp_time", "seconds since 1970-01-01", &[60.0, 120.0])
        .variable_on(&pings, "ad2cp_heading", "degrees", &[90.0, 91.0])
        .variable_on(&cells, "ad2cp_velX", "m/s", &[-0.3; 8])
        .variable_on(&cells, "ad2cp_velY", "m/s", &[0.0; 8])
        .variable_on(&cells, "ad2cp_velZ", "m/s", &[0.3; 8])
        .variable_on(&[], "log_C_VBD", "", &[3000.0])
        .bytes();
    let mut logs = vec![og1, seaglider, clocks];
    logs.extend(real_logs());
    logs
}

/// NetCDF files in the checkout's data/ that are small enough to be changed often.
fn real_logs() -> Vec<Vec<u8>> {
    const MOST_BYTES: u64 = 200_000;
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let folders = std::fs::read_dir(data).into_iter().flatten().flatten();
    folders
        .flat_map(|folder| std::fs::read_dir(folder.path()).into_iter().flatten().flatten())
        .filter(|file| file.path().extension().is_some_and(|extension| extension == "nc"))
        .filter(|file| file.metadata().is_ok_and(|about| about.len() <= MOST_BYTES))
        .filter_map(|file| std::fs::read(file.path()).ok())
        .collect()
}
