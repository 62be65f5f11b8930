//! Reads a campaign back and turns readings into forces, in the plainest way.

use std::path::{Path, PathBuf};

use glidepolar_virtual_tank::{EffectRequest, HullTruth, Options, PHOENIX, RunTruth, TableRow, Truth, write_campaign};
use tempfile::TempDir;

/// A campaign on disk.
pub struct Campaign {
    pub truth: Truth,
    pub rows: Vec<Row>,
    pub folder: PathBuf,
    _temporary: TempDir,
}

/// A row of `runs.csv` with its place in the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub number: usize,
    pub hull: String,
    pub kind: String,
    pub speed: f64,
    pub yaw_deg: Option<f64>,
    pub amplitude_m: Option<f64>,
    pub yaw_amplitude_deg: Option<f64>,
    pub frequency_hz: Option<f64>,
    pub radius_m: Option<f64>,
    pub temperature_c: f64,
    pub file: String,
    pub note: String,
    pub start_s: f64,
}

/// One sample: time, speed, yaw, sway, AF, SF, YM.
pub type Sample = [f64; 7];

/// AF, SF, YM as a force of the water plus inertia about the moment centre.
pub type Force = [f64; 3];

impl Campaign {
    /// Writes and reads a campaign without noise for one hull.
    pub fn quiet(hull: &str, effect: &str) -> Self {
        Self::write(&Options {
            seed: 11,
            noise: 0.0,
            hulls: vec![hull.to_owned()],
            effects: requests(effect),
            ..Options::default()
        })
    }

    pub fn write(options: &Options) -> Self {
        let temporary = tempfile::tempdir().unwrap();
        let folder = temporary.path().join("pmm_runs");
        let truth = write_campaign(&folder, options).unwrap();
        Self { truth, rows: rows(&folder), folder, _temporary: temporary }
    }

    pub fn hull(&self) -> (&HullTruth, &'static TableRow) {
        let truth = &self.truth.hulls[0];
        (truth, PHOENIX.iter().find(|row| row.id == truth.id).unwrap())
    }

    pub fn run(&self, row: &Row) -> &RunTruth {
        &self.truth.runs[row.number]
    }

    pub fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.kind == kind)
    }

    pub fn samples(&self, row: &Row) -> Vec<Sample> {
        let mut reader = csv::Reader::from_path(self.folder.join(&row.file)).unwrap();
        reader.records().map(|record| std::array::from_fn(|i| record.as_ref().unwrap()[i].parse().unwrap())).collect()
    }

    /// Samples of the stated steady part.
    pub fn steady(&self, row: &Row) -> Vec<Sample> {
        let run = self.run(row);
        let mut samples = self.samples(row);
        samples.retain(|sample| (run.steady_from_s..=run.steady_to_s).contains(&sample[0]));
        samples
    }

    /// Zero `into` seconds into a run, in a straight line between the means of the zero runs around it.
    pub fn zero(&self, row: &Row, into: f64) -> Force {
        let day = |row: &Row| (row.start_s / 86_400.0).floor();
        let zeros: Vec<&Row> = self.of_kind("zero").filter(|zero| day(zero) == day(row)).collect();
        let mean = |zero: &Row| {
            let samples = self.samples(zero);
            [4, 5, 6].map(|i| samples.iter().map(|sample| sample[i]).sum::<f64>() / samples.len() as f64)
        };
        // A zero run of twenty seconds stands for its middle.
        let (now, middle) = (row.start_s + into, |zero: &Row| zero.start_s + 10.0);
        let before = zeros.iter().rev().find(|zero| middle(zero) <= now).expect("a zero before, the same day");
        let Some(after) = zeros.iter().find(|zero| middle(zero) > now) else {
            return mean(before);
        };
        let share = (now - middle(before)) / (middle(after) - middle(before));
        let (first, second) = (mean(before), mean(after));
        [0, 1, 2].map(|i| first[i] + share * (second[i] - first[i]))
    }

    /// Force = C (reading - zero).
    pub fn force(&self, reading: &Force, zero: &Force) -> Force {
        self.truth.balance.interaction.map(|row| (0..3).map(|j| row[j] * (reading[j] - zero[j])).sum())
    }

    /// Mean force of the last five seconds of the steady part.
    pub fn mean_force(&self, row: &Row) -> Force {
        let steady = self.steady(row);
        let end = self.run(row).steady_to_s;
        let last: Vec<&Sample> = steady.iter().filter(|sample| sample[0] > end - 5.0).collect();
        let reading = [4, 5, 6].map(|i| last.iter().map(|sample| sample[i]).sum::<f64>() / last.len() as f64);
        self.force(&reading, &self.zero(row, end - 2.5))
    }

    /// Mean force less that of the strut alone at the same speed and yaw.
    pub fn tared(&self, row: &Row) -> Force {
        let tare = self
            .of_kind("tare")
            .find(|tare| tare.speed == row.speed && tare.yaw_deg == Some(row.yaw_deg.unwrap_or(0.0)));
        let (with, alone) = (self.mean_force(row), self.mean_force(tare.expect("a tare run")));
        [0, 1, 2].map(|i| with[i] - alone[i])
    }

    /// CL, CD and CM about the centre of buoyancy of a static run, with the recorded speed and temperature.
    pub fn coefficients(&self, row: &Row) -> [f64; 3] {
        self.coefficients_of(row, self.tared(row))
    }

    /// The same from a given force about the moment centre.
    pub fn coefficients_of(&self, row: &Row, [af, sf, ym]: Force) -> [f64; 3] {
        let (_, hull) = self.hull();
        let (sine, cosine) = row.yaw_deg.unwrap().to_radians().sin_cos();
        let scale = 0.5 * density(row.temperature_c) * row.speed * row.speed * area();
        let moment = ym + (hull.cb_m - hull.mc_m) * sf;
        [(sf * cosine - af * sine) / scale, (af * cosine + sf * sine) / scale, moment / (scale * hull.loa_m)]
    }
}

pub fn requests(effect: &str) -> Vec<EffectRequest> {
    EffectRequest::parse_list(effect).unwrap()
}

/// Kell (1975), kg/m3: not the formula of the virtual tank.
pub fn density(t: f64) -> f64 {
    let above = 999.83952
        + t * (16.945176 + t * (-7.9870401e-3 + t * (-46.170461e-6 + t * (105.56302e-9 - 280.54253e-12 * t))));
    above / (1.0 + 16.87985e-3 * t)
}

/// Frontal area, m2.
pub fn area() -> f64 {
    std::f64::consts::PI * 0.203 * 0.203 / 4.0
}

/// Least squares for two unknowns.
pub fn regress(rows: impl Iterator<Item = (f64, f64, f64)>) -> (f64, f64) {
    let (mut pp, mut pq, mut qq, mut py, mut qy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (p, q, y) in rows {
        pp += p * p;
        pq += p * q;
        qq += q * q;
        py += p * y;
        qy += q * y;
    }
    let determinant = pp * qq - pq * pq;
    ((py * qq - qy * pq) / determinant, (qy * pp - py * pq) / determinant)
}

fn rows(folder: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(folder.join("runs.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let place =
        |name: &str| header.iter().position(|column| column == name).unwrap_or_else(|| panic!("no column {name}"));
    reader
        .records()
        .enumerate()
        .map(|(number, record)| {
            let record = record.unwrap();
            let cell = |name: &str| record[place(name)].to_owned();
            let number_in =
                |name: &str| Some(cell(name)).filter(|text| !text.is_empty()).map(|text| text.parse::<f64>().unwrap());
            Row {
                number,
                hull: cell("hull"),
                kind: cell("kind"),
                speed: number_in("speed_m_s").unwrap(),
                yaw_deg: number_in("yaw_deg"),
                amplitude_m: number_in("sway_amplitude_m"),
                yaw_amplitude_deg: number_in("yaw_amplitude_deg"),
                frequency_hz: number_in("frequency_hz"),
                radius_m: number_in("radius_m"),
                temperature_c: number_in("water_temperature_c").unwrap(),
                file: cell("file"),
                note: cell("note"),
                start_s: number_in("start_time_s").unwrap(),
            }
        })
        .collect()
}
