//! The page of a mission: depth and seabed against time, what pitch and ballast did, and the way over ground.

use crate::dynamics::Energy;
use crate::report::{Axis, Cell, Dash, Figure, InputFile, Layer, Panel, Report, Section, Table, paragraph};
use crate::simulate::mission::{Flight, LegKind, Mission, Moment};

/// More moments than a figure can show are thinned as they come: every second one goes, and only every second comes.
const MOST_MOMENTS: usize = 200_000;

/// The moments of a mission that its figures show, in bounded memory.
pub(super) struct Trace {
    moments: Vec<[f64; 6]>,
    stride: u64,
    count: u64,
}

impl Trace {
    pub fn new() -> Self {
        Trace { moments: Vec::new(), stride: 1, count: 0 }
    }

    pub fn add(&mut self, moment: &Moment) {
        if self.count.is_multiple_of(self.stride) {
            if self.moments.len() == MOST_MOMENTS {
                let mut keep = false;
                self.moments.retain(|_| {
                    keep = !keep;
                    keep
                });
                self.stride *= 2;
            }
            let [time_s, depth_m, x_m, pitch_rad, ..] = moment.row;
            let [ballast_m3, _, _, _, seabed_m, ..] = moment.around;
            let kept = [time_s / 3600.0, depth_m, x_m / 1e3, pitch_rad.to_degrees(), ballast_m3 * 1e6, seabed_m];
            self.moments.push(kept);
        }
        self.count += 1;
    }

    fn column(&self, i: usize) -> Vec<f64> {
        self.moments.iter().map(|moment| moment[i]).collect()
    }
}

/// The page. `vehicle` is the vehicle's name, `input` the mission file.
pub(super) fn page(vehicle: &str, mission: &Mission, flight: &Flight, trace: &Trace, input: InputFile) -> Report {
    let hours = trace.column(0);
    // Deep water below the largest dive would squeeze the dives; it is left out of the picture.
    let deepest = trace.column(1).into_iter().fold(mission.max_depth_m, f64::max) * 1.25;
    let has_seabed = trace.column(5).iter().any(|seabed| *seabed < deepest);
    let depth = || {
        let mut panel = Panel::new(Axis::new("Depth", "z", "m").reversed())
            .layer(Layer::line(hours.clone(), trace.column(1)).label("glider"));
        if has_seabed {
            panel = panel.layer(Layer::line(hours.clone(), trace.column(5)).label("seabed").dash(Dash::Dashed));
        }
        panel
    };
    let time = || Axis::new("Time", "t", "h");
    let saw_tooth = Figure::new("depth", time()).panel(depth()).caption(
        "Depth against time. The glider turns at its largest depth or at the altimeter's height above the seabed, and \
         comes up for a fix when it is time.",
    );
    let record = Figure::new("record", time())
        .panel(depth())
        .panel(Panel::new(Axis::new("Pitch", "θ", "deg")).layer(Layer::line(hours.clone(), trace.column(3))))
        .panel(Panel::new(Axis::new("Ballast volume", "V_b", "cc")).layer(Layer::line(hours.clone(), trace.column(4))))
        .caption("Depth, pitch and ballast volume (positive = more buoyant) against time.");
    let way = Figure::new("way", time())
        .panel(Panel::new(Axis::new("Way over ground", "x", "km")).layer(Layer::line(hours.clone(), trace.column(2))))
        .caption("Way over ground against time; current included.");
    let count = |kind: LegKind| flight.legs.iter().filter(|leg| leg.kind == kind).count();
    let mut section =
        Section::new("Flight").text(paragraph(&mission.source)).figure(saw_tooth).figure(record).figure(way);
    // A vehicle file may leave energy out, and noughts would claim that nothing was drawn.
    if flight.energy.total_J() > 0.0 {
        section = section.table(energy_table(&flight.energy));
    }
    Report::new("Mission", format!("{vehicle}: {}", mission.name))
        .finding(format!(
            "{:.1} km over ground in {:.2} h, {:.3} m/s on the mean; {} descents, {} stays at the surface, {} pumpings.",
            flight.distance_m / 1e3,
            flight.duration_s / 3600.0,
            flight.distance_m / flight.duration_s,
            count(LegKind::Descent),
            count(LegKind::Surface),
            flight.pumpings
        ))
        .section(section)
        .input(input)
}

/// What drew how much.
pub(super) fn energy_table(energy: &Energy<f64>) -> Table {
    let consumers = [
        ("Pump", energy.pump_J),
        ("Rudder, roll mass and moving mass", energy.steering_J),
        ("Surfacings", energy.surfacing_J),
        ("Hotel", energy.hotel_J),
    ];
    let table = Table::new("Energy as the vehicle file has it.", ["Consumer", "Energy [W.h]"]);
    let row = |table: Table, (name, energy_J): (&str, f64)| {
        table.row([Cell::Text(name.to_owned()), Cell::number(energy_J / 3600.0, 4)])
    };
    consumers.into_iter().fold(table, row)
}
