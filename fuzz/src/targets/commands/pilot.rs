//! Tables that a pilot or a modeller gives to the command line beside a log: fixes, battery counters, inputs, variants.

use super::glidepolar;
use crate::Target;

use crate::files::{Folder, joined};

pub const TRACK: Target = Target {
    name: "track",
    what: "a log with a table of fixes",
    run: track,
    seeds: || vec![joined(&[LOG, FIXES]), joined(&[LOG, FIXES_OF_DIVES])],
    catches_panics: false,
};

pub const CALIBRATION: Target = Target {
    name: "calibration",
    what: "battery counters: strokes of the pump, and dives",
    run: calibration,
    seeds: || vec![joined(&[STROKES, DIVES])],
    catches_panics: false,
};

pub const INPUTS: Target = Target {
    name: "inputs",
    what: "inputs against time, and the glider flown by them for a minute",
    run: inputs,
    seeds: || {
        vec![INPUTS_TABLE.as_bytes().to_vec(), include_bytes!("../../../../tests/missions/sawtooth.csv").to_vec()]
    },
    catches_panics: false,
};

pub const SWEEP: Target = Target {
    name: "sweep",
    what: "a table of variants, each flown for a few seconds",
    run: sweep,
    seeds: || vec![b"# two\nb,moving_mass_kg\n0.13,9\n0.2,8.5\n".to_vec(), b"hull_mass_kg\n40\n".to_vec()],
    catches_panics: false,
};

const LOG: &str = "time_s,pressure_dbar,pitch_rad,vbd_cc,density_kg_m3,temperature_C,heading_rad\n\
    0,1,-0.4,-200,1025,12,1\n30,6,-0.42,-205,1025.2,12,1\n60,11,-0.42,-205,1025.4,11,1.1\n90,16,-0.42,-205,1025.6,10,1\n\
    120,15,0.4,210,1025.6,10,1\n150,10,0.42,210,1025.4,11,1\n180,5,0.42,210,1025.2,12,1\n210,0,0.5,210,1025,12,1\n";
const FIXES: &str =
    "time_s,lat_deg,lon_deg,dac_east_m_s,dac_north_m_s\n0,47.5,-52.5,0.1,0\n210,47.5004,-52.4992,0.1,0.05\n";
const FIXES_OF_DIVES: &str =
    "dive,start_time_s,duration_s,lat_deg,lon_deg\n1,0,100,47.5,-52.5\n2,150,60,47.5004,-52.4992\n";
const STROKES: &str = "dive,depth_m,vbd_ad_start,vbd_ad_end,vbd_secs,vbd_A,vbd_V\n\
    1,900,3000,1500,400,1.6,24\n1,500,2800,1500,300,1.2,24\n2,200,2600,1500,200,0.8,24\n3,990,3100,1500,450,1.7,24\n";
const DIVES: &str = "dive,duration_s,VBD_CNV_cc_per_count,ah24_cum_Ah,ah24_min_V,ah10_cum_Ah,ah10_min_V\n\
    1,20000,-0.245,10.0,24,5.0,10\n2,8000,-0.245,10.6,24,5.3,10\n3,21000,-0.245,11.2,24,5.6,10\n4,20500,-0.245,11.9,24,5.9,10\n";
const INPUTS_TABLE: &str = "time,ballast_command_m3,current_x_m_s,seabed_depth_m\n0,-2e-4,0,100\n10,-2e-4,0.2,100\n10,2e-4,0.2,20\n40,2e-4,0,20\n";

fn track(data: &[u8]) {
    let folder = Folder::new();
    folder.write_parts(data, &["log.csv", "fixes.csv"]);
    let (log, fixes) = (shown(&folder, "log.csv"), shown(&folder, "fixes.csv"));
    glidepolar(folder.root(), &["track", &log, "--vehicle", "slocum-049", "--fixes", &fixes]);
}

fn calibration(data: &[u8]) {
    let folder = Folder::new();
    folder.write_parts(data, &["moves.csv", "dives.csv"]);
    let (moves, dives) = (shown(&folder, "moves.csv"), shown(&folder, "dives.csv"));
    glidepolar(folder.root(), &["plan", "seaglider", "--moves", &moves, "--dives", &dives]);
}

fn inputs(data: &[u8]) {
    let folder = Folder::new();
    folder.write("inputs.csv", data);
    let table = shown(&folder, "inputs.csv");
    let words =
        ["simulate", "slocum-graver", "--inputs", &table, "--stop", "60", "--interval", "10", "--tolerance", "1e-4"];
    glidepolar(folder.root(), &words);
}

fn sweep(data: &[u8]) {
    // What is looked at is one variant, not how many fit into an input.
    const MOST_ROWS: usize = 4;
    if data.iter().filter(|byte| **byte == b'\n').count() > MOST_ROWS {
        return;
    }
    let folder = Folder::new();
    folder.write("variants.csv", data);
    let table = shown(&folder, "variants.csv");
    let words =
        ["simulate", "slocum-graver", "--sweep", &table, "--stop", "2", "--interval", "1", "--tolerance", "1e-4"];
    glidepolar(folder.root(), &words);
}

fn shown(folder: &Folder, name: &str) -> String {
    folder.path(name).to_string_lossy().into_owned()
}
