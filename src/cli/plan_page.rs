//! The plan as a page: what `glidepolar plan --out` writes.

use crate::estimate::Estimate;
use crate::plan::calibrate::{DiveFit, PumpFit, Stroke};
use crate::plan::{Ask, Outlook, outlook};
use crate::report::{Axis, Cell, Dash, Figure, Layer, Panel, Report, Section, Table};
use crate::vehicle::Vehicle;

/// Pitch angles at which the plan is drawn [deg].
const PITCHES_DEG: std::ops::RangeInclusive<i32> = 12..=50;

/// Beyond it, hotel and pump of one dive are of little use to anyone: fewer dives than this are no voyage.
const FEW_DIVES: f64 = 2.0;

/// A plan, and what it was asked.
pub(super) struct Planned<'a> {
    pub ask: &'a Ask,
    pub without: &'a Outlook,
    pub with_sensor: Option<&'a Outlook>,
}

/// A calibration, and what it was made from.
pub(super) struct Calibrated<'a> {
    pub pump: &'a PumpFit,
    pub dives: &'a DiveFit,
    pub strokes: &'a [Stroke],
}

/// The page, to which the caller adds the files that were read.
pub(super) fn page(vehicle: &Vehicle, plan: Option<&Planned<'_>>, calibration: Option<&Calibrated<'_>>) -> Report {
    let mut report = Report::new("Plan", &vehicle.name);
    if let Some(plan) = plan {
        report = planned(report, vehicle, plan);
    }
    if let Some(calibration) = calibration {
        report = calibrated(report, calibration);
    }
    report
}

fn planned(report: Report, vehicle: &Vehicle, plan: &Planned<'_>) -> Report {
    let Planned { ask, without, with_sensor } = plan;
    let mut report = report
        .finding(format!(
            "{} dives to {:.0} m in {} days take the glider {} km through the water (95 % intervals).",
            shown(&without.dives),
            ask.dive.depth_m,
            shown(&without.days),
            shown(&without.distance_km)
        ))
        .finding(format!(
            "A dive lasts {} h, takes the glider {} km and draws {} kJ.",
            shown(&without.dive_duration_h),
            shown(&without.dive_distance_km),
            shown(&without.dive_energy_kJ)
        ))
        .warning("Distances are through the water. Currents come on top, and no interval here knows them.");
    if vehicle.uncertainty.is_empty() {
        report = report.warning(
            "The vehicle file states no [uncertainty]: the intervals hold the error of the energy account alone.",
        );
    }
    if vehicle.is_builtin {
        report = report.warning(
            "A built-in vehicle is not your own glider: its pump, hotel and polar are those of another, or assumed.",
        );
    }
    if without.dives.value < FEW_DIVES {
        report = report.warning("The battery lasts for fewer than two dives; is its energy right?");
    }
    let mut voyage = Table::new("The voyage, 95 % intervals.", heading("Quantity", with_sensor.is_some()));
    let mut dive = Table::new("One dive, 95 % intervals.", heading("Quantity", with_sensor.is_some()));
    /// Name, whether it is the voyage's and not the dive's, and the quantity.
    type Quantity = (&'static str, bool, fn(&Outlook) -> &Estimate);
    let rows: [Quantity; 12] = [
        ("Days", true, |o| &o.days),
        ("Dives", true, |o| &o.dives),
        ("Pumpings", true, |o| &o.pumpings),
        ("Distance through the water [km]", true, |o| &o.distance_km),
        ("Energy drawn [W h]", true, |o| &o.energy_Wh),
        ("Left in the battery [W h]", true, |o| &o.battery_left_Wh),
        ("Left in the battery [%]", true, |o| &o.battery_left_percent),
        ("Duration [h]", false, |o| &o.dive_duration_h),
        ("Distance [km]", false, |o| &o.dive_distance_km),
        ("Pump [kJ]", false, |o| &o.dive_pump_kJ),
        ("Hotel [kJ]", false, |o| &o.dive_hotel_kJ),
        ("Whole energy [kJ]", false, |o| &o.dive_energy_kJ),
    ];
    for (name, is_voyage, of) in rows {
        let cells = [Cell::from(name), cell(of(without))].into_iter().chain(with_sensor.map(|w| cell(of(w))));
        if is_voyage { voyage.push(cells) } else { dive.push(cells) }
    }
    report
        .section(Section::new("Voyage").table(voyage).figure(against_pitch(vehicle, ask, *with_sensor)))
        .section(Section::new("One dive").figure(account(without)).table(dive))
}

fn heading(first: &str, sensor: bool) -> Vec<String> {
    let more: &[&str] = if sensor { &["As it is", "With the sensor"] } else { &["Value"] };
    [first].iter().chain(more).map(|name| (*name).to_owned()).collect()
}

/// A value with its interval, where it has any width.
fn cell(q: &Estimate) -> Cell {
    // What is left of a width in the last digits of a difference is none.
    if q.ci95[1] - q.ci95[0] <= 1e-7 * q.value.abs() { Cell::number(q.value, 4) } else { Cell::from(q) }
}

fn shown(q: &Estimate) -> String {
    cell(q).to_string()
}

/// Which consumer takes how much of a dive.
fn account(outlook: &Outlook) -> Figure {
    let shares = [&outlook.dive_pump_kJ, &outlook.dive_hotel_kJ, &outlook.dive_steering_kJ, &outlook.dive_surfacing_kJ];
    let (at, values): (Vec<f64>, Vec<f64>) = (0..).map(f64::from).zip(shares.map(|q| q.value)).unzip();
    let errors = shares.map(|q| 0.5 * (q.ci95[1] - q.ci95[0])).to_vec();
    let names = Axis::of_names("Consumer", ["pump", "hotel", "steering", "surfacing"]);
    let points = Layer::points(values, at).x_error(errors);
    Figure::new("account", Axis::new("Energy of one dive", "E", "kJ"))
        .panel(Panel::new(names).layer(points).layer(Layer::at_x(0.0)))
        .caption(
            "What draws how much in one dive, surfacing shared among the dives from one to the next; 95 % intervals.",
        )
}

/// Days and distance at other pitch angles, everything else as asked.
fn against_pitch(vehicle: &Vehicle, ask: &Ask, with_sensor: Option<&Outlook>) -> Figure {
    let at = |degrees: i32, sensor: bool| {
        let pitch_rad = f64::from(degrees).to_radians();
        let mut ask = ask.clone();
        ask.dive.descent.pitch_rad = -pitch_rad;
        ask.dive.ascent.pitch_rad = pitch_rad;
        if !sensor {
            ask.sensor = Default::default();
        }
        outlook(vehicle, &ask).ok().map(|found| (f64::from(degrees), found))
    };
    let plain: Vec<(f64, Outlook)> = PITCHES_DEG.filter_map(|degrees| at(degrees, false)).collect();
    let sensor: Vec<(f64, Outlook)> = match with_sensor {
        Some(_) => PITCHES_DEG.filter_map(|degrees| at(degrees, true)).collect(),
        None => Vec::new(),
    };
    let panel = |y: Axis, of: fn(&Outlook) -> &Estimate| {
        let column = |rows: &[(f64, Outlook)], size: &dyn Fn(&Estimate) -> f64| -> Vec<f64> {
            rows.iter().map(|(_, outlook)| size(of(outlook))).collect()
        };
        let xs = |rows: &[(f64, Outlook)]| -> Vec<f64> { rows.iter().map(|(degrees, _)| *degrees).collect() };
        let low = column(&plain, &|q| q.ci95[0]);
        let high = column(&plain, &|q| q.ci95[1]);
        let label = if sensor.is_empty() { "plan" } else { "as it is" };
        let mut panel = Panel::new(y)
            .layer(Layer::band(xs(&plain), low, high).label(label))
            .layer(Layer::line(xs(&plain), column(&plain, &|q| q.value)).label(label))
            .layer(Layer::at_x(ask.dive.ascent.pitch_rad.to_degrees()));
        if !sensor.is_empty() {
            let line = Layer::line(xs(&sensor), column(&sensor, &|q| q.value));
            panel = panel.layer(line.label("with the sensor").dash(Dash::Dashed));
        }
        panel
    };
    Figure::new("against-pitch", Axis::new("Pitch of both legs", "θ", "deg"))
        .panel(panel(Axis::new("Days", "", "d"), |o| &o.days))
        .panel(panel(Axis::new("Distance", "", "km"), |o| &o.distance_km))
        .panel(panel(Axis::new("Energy of one dive", "E", "kJ"), |o| &o.dive_energy_kJ))
        .caption("The same voyage at other pitch angles, band: 95 % interval; vertical line: the pitch asked for.")
}

fn calibrated(report: Report, calibration: &Calibrated<'_>) -> Report {
    let Calibrated { pump, dives, strokes } = calibration;
    let (k1, k2) = (pump.pump_J_per_dbar_cc.value, pump.pump_J_per_cc.value);
    let (pressures, energies): (Vec<f64>, Vec<f64>) =
        strokes.iter().map(|s| (s.pressure_dbar, s.energy_J / s.volume_cc)).unzip();
    let deepest = pressures.iter().copied().fold(1.0, f64::max);
    let figure = Figure::new("strokes", Axis::new("Gauge pressure", "P", "dbar"))
        .panel(
            Panel::new(Axis::new("Energy per volume", "E/ΔV", "J/cc"))
                .layer(Layer::points(pressures, energies).label("strokes of the pump"))
                .layer(Layer::curve(0.0, deepest, |p| k1 * p + k2).label("fit")),
        )
        .caption("Each stroke of the pump, and the line k1 P + k2 of the fit, in which large strokes weigh more.");
    let rows: [(&str, &Estimate); 5] = [
        ("Pump, per pressure k1 [J/(dbar cc)]", &pump.pump_J_per_dbar_cc),
        ("Pump, per volume k2 [J/cc]", &pump.pump_J_per_cc),
        ("Battery energy over the pump's", &dives.pump_factor),
        ("Hotel [W]", &dives.hotel_W),
        ("Each dive besides [J]", &dives.surfacing_J),
    ];
    let table = rows
        .into_iter()
        .fold(Table::new("The constants of the account, 95 % intervals.", ["Constant", "Value"]), |table, (name, q)| {
            table.row([Cell::from(name), Cell::from(q)])
        })
        .row([Cell::from("Residual of a stroke [%]"), Cell::fixed(100.0 * pump.relative_rms, 1)])
        .row([
            Cell::from("Charge of a dive left out of both fits [%]"),
            Cell::fixed(100.0 * dives.charge_error_left_out, 1),
        ])
        .row([
            Cell::from("The same by the mean of the other dives [%]"),
            Cell::fixed(100.0 * dives.charge_error_of_the_mean, 1),
        ]);
    report
        .finding(format!(
            "Calibrated from {} strokes of the pump and {} dives; the charge of a dive that neither fit has seen is \
             predicted within {:.1} %.",
            pump.strokes,
            dives.dives,
            100.0 * dives.charge_error_left_out
        ))
        .section(Section::new("Calibration").figure(figure).table(table))
}
