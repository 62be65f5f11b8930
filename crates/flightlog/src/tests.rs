//! Logs written by hand, in each format, good and bad: what comes out is known from what went in.

mod bad_input;
mod classic;
mod condensing;
mod forward_filled_speeds;
mod interpolated_speeds;
mod lost_speeds;
mod netcdf_fixes;
mod preparing;
mod pressures;
mod seaglider_files;
mod segments;
mod several_tables;

use std::path::PathBuf;

use super::*;
use glidepolar_input::InputError;
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// A folder with one file in it.
struct OneFile {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl OneFile {
    fn new(name: &str, content: &[u8]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name);
        std::fs::write(&path, content).expect("a file");
        OneFile { _folder: folder, path }
    }

    fn open(&self) -> Result<Opened, InputError> {
        open(&self.path, &Columns::default())
    }

    /// The whole series.
    fn series(&self) -> Result<FlightLog, InputError> {
        match self.open()? {
            Opened::Series(mut pieces) => {
                let mut log = FlightLog::default();
                while let Some(piece) = pieces.next_piece(7)? {
                    log.append(&piece);
                }
                Ok(log)
            }
            Opened::Glides(_) => panic!("a time series"),
        }
    }
}

fn csv(text: &str) -> OneFile {
    OneFile::new("log.csv", text.as_bytes())
}

#[test]
fn csv_columns_are_found_by_name_in_any_order_and_unit() {
    let file =
        csv("# a comment\npitch_deg,note,time_s,vbd_m3,pressure_dbar\n-30,x,1,-2e-4,5.5\n,,2,,\n 12.5 ,y,3,1e-4,6\n");
    let log = file.series().unwrap();
    assert_eq!(log.column(Channel::Time), [1.0, 2.0, 3.0]);
    assert_eq!(log.column(Channel::Pressure)[0], 5.5);
    assert!((log.column(Channel::Pitch)[0] + 30f64.to_radians()).abs() < 1e-15);
    assert!((log.column(Channel::Ballast)[0] + 200.0).abs() < 1e-9);
    for channel in [Channel::Pressure, Channel::Pitch, Channel::Ballast] {
        assert!(log.at(channel, 1).is_nan());
    }
    assert!((log.column(Channel::Pitch)[2] - 12.5f64.to_radians()).abs() < 1e-15);
}

#[test]
fn a_column_can_be_chosen_and_keeps_its_unit() {
    let file = csv("time_s,pressure_dbar,pitch_deg,pitch_corr_deg,vbd_cc,U\n1,5,-30,-26,-200,0.3\n");
    let mut columns = Columns::default();
    columns.choose_text("pitch_rad=pitch_corr_deg").unwrap();
    columns.choose(Channel::Speed, "U");
    let Ok(Opened::Series(mut series)) = open(&file.path, &columns) else { panic!("a series") };
    let log = series.next_piece(10).unwrap().unwrap();
    assert!((log.at(Channel::Pitch, 0) + 26f64.to_radians()).abs() < 1e-15);
    assert_eq!(log.at(Channel::Speed, 0), 0.3);
}

#[test]
fn a_table_of_glides_is_distinguished_from_a_series() {
    let table =
        "glide,w_m_s,pitch_rad,vbd_cc,density_kg_m3\n0,-0.2,-0.45,-200,1025\n1,0.2,0.45,200,1025\n2,,0.4,1,1025\n";
    let Ok(Opened::Glides(glides)) = csv(table).open() else { panic!("a table") };
    assert_eq!(glides.len(), 2);
    assert_eq!((glides[0].sink_m_s, glides[1].sink_m_s), (0.2, -0.2));
    assert!(glides.iter().all(|glide| glide.steady));
    assert_eq!((glides[0].dive, glides[1].dive), (0, 0));
}

#[test]
fn a_dive_of_the_seaglider_basestation_is_read() {
    let n = 4;
    let file = classic::File::new(n)
        .variable("ctd_time", "seconds since 1970-1-1 00:00:00", &[100.0, 110.0, 120.0, 130.0])
        .variable("ctd_pressure", "dbar", &[1.0, 3.0, 5.0, 7.0])
        .variable("eng_pitchAng", "degrees", &[-20.0, -21.0, -22.0, -23.0])
        .variable("eng_vbdCC", "", &[-100.0; 4])
        .variable("eng_pitchCtl", "", &[-0.6; 4])
        .variable("temperature", "degrees_Celsius", &[10.0; 4])
        .variable("salinity", "PSU", &[35.0; 4])
        .with_moves(&[(118.0, 119.0)])
        .attribute("dive_number", 42)
        .bytes();
    let log = OneFile::new("p5420042.nc", &file).series().unwrap();
    assert_eq!(log.column(Channel::Time), [100.0, 110.0, 120.0, 130.0]);
    assert_eq!(log.column(Channel::Dive), [42.0; 4]);
    assert!((log.at(Channel::Pitch, 3) + 23f64.to_radians()).abs() < 1e-12);
    assert!((log.at(Channel::PitchMass, 0) + 0.006).abs() < 1e-12);
    // A move at 118 to 119 s shows within 6 s.
    assert_eq!(log.column(Channel::MotorMoving), [0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn a_pressure_is_in_the_unit_that_netcdf_states() {
    for (unit, factor) in [("Pa", 1e4), ("kPa", 10.0), ("hPa", 100.0), ("bar", 0.1), ("dbar", 1.0), ("", 1.0)] {
        let pressure = [1.0, 3.0, 5.0].map(|dbar| dbar * factor);
        let basestation = classic::File::new(3)
            .variable("ctd_time", "seconds since 1970-1-1 00:00:00", &[100.0, 110.0, 120.0])
            .variable("ctd_pressure", unit, &pressure)
            .variable("eng_pitchAng", "degrees", &[-20.0, -21.0, -22.0])
            .variable("eng_vbdCC", "", &[-100.0; 3])
            .with_moves(&[(118.0, 119.0)])
            .bytes();
        let series = classic::File::new(3)
            .variable("TIME", "seconds since 1970-01-01T00:00:00Z", &[10.0, 20.0, 30.0])
            .variable("PRES", unit, &pressure)
            .variable("PITCH", "degrees", &[-25.0, -26.0, -27.0])
            .variable("vbd_cc", "cm3", &[-200.0; 3])
            .bytes();
        for (name, bytes) in [("p5420042.nc", basestation), ("glider.nc", series)] {
            let log = OneFile::new(name, &bytes).series().unwrap();
            assert!(
                (log.at(Channel::Pressure, 2) - 5.0).abs() < 1e-9,
                "{name}, {unit}: {:?}",
                log.column(Channel::Pressure)
            );
        }
    }
}

#[test]
fn the_name_of_a_chosen_column_says_its_unit() {
    let file = csv("time_s,pressure_dbar,pitch_deg,vbd_cc,speed_cm_s,oil_g\n1,5,-30,-200,30,-205\n");
    let mut columns = Columns::default();
    columns.choose(Channel::Speed, "speed_cm_s");
    let Ok(Opened::Series(mut series)) = open(&file.path, &columns) else { panic!("a series") };
    assert!((series.next_piece(10).unwrap().unwrap().at(Channel::Speed, 0) - 0.3).abs() < 1e-12);
    columns.choose(Channel::Ballast, "oil_g");
    let Err(error) = open(&file.path, &columns) else { panic!("a mass is no volume") };
    assert!(error.to_string().contains("`oil_g` is a mass"), "{error}");
}

#[test]
fn names_of_oil_volumes_are_ballast_and_masses_are_refused() {
    for name in ["m_de_oil_vol", "de_oil_volume", "oil_volume", "ballast (ml)"] {
        let log = csv(&format!("time_s,pressure_dbar,pitch_deg,{name}\n1,5,-30,-200\n2,6,-30,-999.25\n")).series();
        let log = log.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(log.at(Channel::Ballast, 0), -200.0, "{name}");
        assert!(log.at(Channel::Ballast, 1).is_nan(), "{name}");
    }
    for name in ["ballast_g", "ballast (kg)", "vbd_kg"] {
        let error = csv(&format!("time_s,pressure_dbar,pitch_deg,{name}\n1,5,-30,-200\n")).series().unwrap_err();
        assert!(error.to_string().contains("is a mass") && error.to_string().contains("1.025"), "{name}: {error}");
    }
}

#[test]
fn units_below_the_names_may_be_those_of_a_salinity() {
    let units = "seconds since 1970-01-01T00:00:00Z,dbar,degrees,cm3,degree_C,1e-3";
    let text = format!("time,pressure,pitch,ballast_pumped,temperature,salinity\n{units}\n1.6e9,20,-30,-200,10,35\n");
    let log = csv(&text).series().expect("a log");
    assert_eq!((log.len(), log.at(Channel::Salinity, 0), log.at(Channel::Ballast, 0)), (1, 35.0, -200.0));
    assert!((log.at(Channel::Pitch, 0) + 30f64.to_radians()).abs() < 1e-12);
}

#[test]
fn a_name_of_several_words_is_known_with_its_unit() {
    let text = "Time (s),Pressure (dbar),Pitch (deg),Ballast volume (cm^3)\n1,20,-30,-200\n";
    assert_eq!(csv(text).series().expect("a log").at(Channel::Ballast, 0), -200.0);
    let said = |text: &str| csv(text).series().expect_err("a name that is not known").to_string();
    let found = said("Time (s),Pressure (dbar),Pitch (deg),Ballast of the day (cm^3)\n1,20,-30,-200\n");
    assert!(found.contains("--column \"vbd_cc=Ballast of the day (cm^3)\","), "{found}");
    let found = said("ctd_time_dt64,pressure_dbar,pitch_deg,vbd_cc\n1,20,-30,-200\n");
    assert!(found.contains("is it `ctd_time_dt64`? say --column time_s=ctd_time_dt64"), "{found}");
}

#[test]
fn a_last_line_that_was_cut_off_is_left_out_and_no_other() {
    let table = "time_s,pressure_dbar,pitch_rad,vbd_cc\n1,5,-0.4,-200\n2,6,-0.4,-200\n";
    for end in ["3,7,-0", "3,7,-0.4,1e", "3"] {
        let file = csv(&format!("{table}{end}"));
        let Ok(Opened::Series(mut series)) = file.open() else { panic!("a series") };
        assert_eq!(series.next_piece(100).unwrap().expect("two rows").len(), 2, "{end}");
        let said = series.take_warnings();
        assert!(said.len() == 1 && said[0].contains("cut off") && said[0].contains("log.csv"), "{said:?}");
        let error = csv(&format!("{table}{end}\n")).series().unwrap_err();
        assert!(error.to_string().contains("log.csv:4"), "{error}");
    }
    let whole = csv(&format!("{table}3,7,-0.4,-200")).series().unwrap();
    assert_eq!(whole.len(), 3);
}

#[test]
fn an_og1_time_series_is_read_with_its_units() {
    let file = classic::File::new(3)
        .variable("TIME", "seconds since 1970-01-01T00:00:00Z", &[10.0, 20.0, 30.0])
        .variable("PRES", "dbar", &[1.0, 2.0, f64::NAN])
        .variable("PITCH", "degrees", &[-25.0, -26.0, -27.0])
        .variable("vbd_cc", "m3", &[-2e-4, -2e-4, -2e-4])
        .variable("TEMP", "degree_Celsius", &[9.0; 3])
        .variable("CNDC", "mS cm-1", &[35.0; 3])
        .bytes();
    let log = OneFile::new("glider.nc", &file).series().unwrap();
    assert!((log.at(Channel::Pitch, 0) + 25f64.to_radians()).abs() < 1e-12);
    assert!((log.at(Channel::Ballast, 1) + 200.0).abs() < 1e-9);
    assert!((log.at(Channel::Conductivity, 1) - 3.5).abs() < 1e-12);
    assert!(log.at(Channel::Pressure, 2).is_nan());
}

/// As pyglider writes what a glider without a known ballast sensor has recorded: which variable it is only a person can say.
#[test]
fn a_time_series_without_a_known_ballast_is_read_where_a_column_is_named() {
    let file = classic::File::new(3)
        .variable("time", "seconds since 1970-01-01T00:00:00Z", &[10.0, 20.0, 30.0])
        .variable("pressure", "dbar", &[1.0, 2.0, 3.0])
        .variable("pitch", "degree", &[-25.0, -26.0, -27.0])
        .variable("bladder", "mL", &[-200.0; 3])
        .bytes();
    let file = OneFile::new("pyglider.nc", &file);
    let error = file.series().unwrap_err().to_string();
    for expected in ["ballast volume", "--column vbd_cc=VARIABLE", "bladder"] {
        assert!(error.contains(expected), "{expected} is not in {error}");
    }
    let mut columns = Columns::default();
    columns.choose(Channel::Ballast, "bladder");
    let (log, _) = segments::whole(std::slice::from_ref(&file.path), &columns).unwrap();
    assert_eq!(log.column(Channel::Ballast), [-200.0; 3]);
}

#[test]
fn radians_that_a_file_labels_degrees_are_found_and_a_stated_unit_goes_first() {
    let file = classic::File::new(3)
        .variable("time", "nanoseconds since 1970-01-01", &[1.6e18, 1.600000001e18, 1.600000002e18])
        .variable("pressure", "dbar", &[1.0, 2.0, 3.0])
        .variable("pitch", "degrees", &[-0.45, -0.46, -0.47])
        .variable("roll", "degrees", &[-0.05, -0.04, -0.05])
        .variable("heading", "degrees", &[350.0, 351.0, 352.0])
        .variable("BallastPos", "ml", &[-200.0; 3])
        .bytes();
    let file = OneFile::new("rosie.nc", &file);
    let read = |unit: Option<&str>| {
        let mut columns = Columns::default();
        if let Some(unit) = unit {
            columns.unit_text(unit).unwrap();
        }
        let mut files = LogFiles::open(std::slice::from_ref(&file.path), &columns).unwrap();
        let Ok(Some(Piece::Series(log))) = files.next_piece(10) else { panic!("a series") };
        (*log, files.warnings().join("\n"))
    };
    let (log, warning) = read(None);
    assert_eq!(log.column(Channel::Time), [1.6e9, 1.6e9 + 1.0, 1.6e9 + 2.0]);
    assert!((log.at(Channel::Pitch, 0) + 0.45).abs() < 1e-12 && (log.at(Channel::Roll, 0) + 0.05).abs() < 1e-12);
    assert!((log.at(Channel::Heading, 0) - 350f64.to_radians()).abs() < 1e-12, "no radians");
    assert!(warning.contains("rosie.nc") && warning.contains("radians") && warning.contains("--unit"), "{warning}");
    let (log, warning) = read(Some("pitch=deg"));
    assert!((log.at(Channel::Pitch, 0) + 0.45f64.to_radians()).abs() < 1e-12);
    assert!(warning.is_empty(), "{warning}");
    assert!((read(Some("pitch_rad=rad")).0.at(Channel::Pitch, 0) + 0.45).abs() < 1e-12);
}

#[test]
fn density_is_that_of_teos_10() {
    // The tables of the UNESCO equation of state, which TEOS-10 meets within a few thousandths of a kg/m3 at SP = 35.
    for (salinity, temperature, pressure, expected) in
        [(35.0, 5.0, 0.0, 1027.675), (35.0, 25.0, 0.0, 1023.343), (35.0, 5.0, 1e4, 1069.489)]
    {
        // Longitude and latitude unknown.
        let found = in_situ_density_kg_m3(salinity, temperature, pressure, f64::NAN, f64::NAN);
        assert!((found - expected).abs() < 0.02, "{found} against {expected}");
    }
}

#[test]
fn a_straight_line_has_its_slope_and_noise_is_found() {
    let time: Vec<f64> = (0..200).map(|i| 1.466e9 + f64::from(i) * 1.1).collect();
    let straight: Vec<f64> = time.iter().map(|t| 3.0 + 0.17 * (t - time[0])).collect();
    let found = vertical_velocity(&time, &straight, 4.0);
    assert!(found.rate_dbar_s[0].is_nan() && found.rate_dbar_s[199].is_nan());
    assert!(found.rate_dbar_s[1..199].iter().all(|rate| (rate - 0.17).abs() < 1e-9));
    // Alternating noise of +-0.01 is as strong as second differences make it: e = 0.02, over sqrt(1.5) and 0.6745.
    let noisy: Vec<f64> = straight.iter().enumerate().map(|(i, p)| p + if i % 2 == 0 { 0.01 } else { -0.01 }).collect();
    let found = vertical_velocity(&time, &noisy, 4.0);
    assert!((found.noise_dbar - 0.02 / 1.5f64.sqrt() / 0.6745).abs() < 1e-6, "{}", found.noise_dbar);
}

/// Of samples every 2 s, whose clock errs by up to 0.2 s, the second neighbour lies within 4 s by chance alone. Were it taken where it seems near,
/// the mean velocity would be 1.1 % too large.
#[test]
fn a_clock_that_jitters_does_not_change_the_mean_velocity() {
    for (seed, step_s) in [2.0, 4.0, 1.0, 1.6].into_iter().enumerate() {
        let mut rng = StdRng::seed_from_u64(seed as u64);
        let at: Vec<f64> = (0..20_000).map(|i| step_s * f64::from(i)).collect();
        let time: Vec<f64> = at.iter().map(|t| t + 0.1 * step_s * rng.random_range(-1.0..1.0)).collect();
        let pressure: Vec<f64> = at.iter().map(|t| 0.3 * t).collect();
        let found = vertical_velocity(&time, &pressure, 4.0).rate_dbar_s;
        let mean = found[1..19_999].iter().sum::<f64>() / 19_998.0;
        // Of a window of three samples every 4 s the mean of 1/t is larger by the square of the error: 0.0017 at most.
        assert!((mean / 0.3 - 1.0).abs() < 0.002, "{step_s} s: {mean}");
    }
}

#[test]
fn half_of_an_oscillation_of_two_and_a_half_windows_remains() {
    let h = 4.0;
    let time: Vec<f64> = (0..4000).map(|i| f64::from(i) * 0.05).collect();
    let period = 2.5 * h;
    let omega = std::f64::consts::TAU / period;
    let wave: Vec<f64> = time.iter().map(|t| (omega * t).sin() / omega).collect();
    let found = vertical_velocity(&time, &wave, h);
    let highest = found.rate_dbar_s[500..3500].iter().copied().fold(0.0, f64::max);
    // The weights 1 - (t/h)^2 of a moving average: 3 (sin x - x cos x)/x^3 with x = omega h.
    let x = omega * h;
    let expected = 3.0 * (x.sin() - x * x.cos()) / x.powi(3);
    assert!((highest - expected).abs() < 0.01, "{highest} against {expected}");
    assert!((expected - 0.5).abs() < 0.06);
}

/// Three samples see the even mean between the outer ones; many see the parabolic weights, whose standard deviation is `h / sqrt 5`.
#[test]
fn the_window_of_a_velocity_has_the_moments_of_its_weights() {
    let sparse = [0.0, 20.0, 40.0, 50.0, 90.0];
    let found = vertical_velocity(&sparse, &[0.0; 5], 4.0);
    let [from, to] = found.window_s[1];
    assert!((from + 20.0).abs() < 1e-9 && (to - 20.0).abs() < 1e-9, "{from} {to}");
    // A rate that grows evenly is met at the middle of the window, whatever the spacing.
    let grows: Vec<f64> = sparse.iter().map(|t| 0.5e-3 * t * t).collect();
    let found = vertical_velocity(&sparse, &grows, 4.0);
    for ((time_s, [from, to]), rate) in sparse.iter().zip(&found.window_s).zip(&found.rate_dbar_s).skip(1).take(3) {
        assert!((rate - 1e-3 * (time_s + 0.5 * (from + to))).abs() < 1e-12);
    }
    let dense: Vec<f64> = (0..2000).map(|i| f64::from(i) * 0.01).collect();
    let [from, to] = vertical_velocity(&dense, &[0.0; 2000], 4.0).window_s[1000];
    let expected = 4.0 * (3.0f64 / 5.0).sqrt();
    assert!((from + expected).abs() < 0.01 && (to - expected).abs() < 0.01, "{from} {to}");
}
