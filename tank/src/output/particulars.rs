//! What a reader of a test report looks for first (ITTC 7.5-02-06-07): the models, the water, the conditions, the runs, and
//! where the uncertainty of each coefficient comes from.

use std::collections::BTreeMap;

use glidepolar_report::{Cell, Section, Table};
use nalgebra::DMatrix;

use crate::campaign::Kind;
use crate::fits::SweepFit;
use crate::results::{HullResults, Results};
use crate::trend::COEFFICIENTS;

/// Standard gravity \[m/s2\], for Froude numbers.
const GRAVITY_M_S2: f64 = 9.806_65;

/// Models, water and runs.
pub fn particulars(results: &Results) -> Section {
    let mut section = Section::new("Models, water, conditions");
    if !results.source.is_empty() {
        section = section.text(format!("Facility or source: {}.", results.source));
    }
    section = section.table(models(results)).table(conditions(results));
    if !results.runs.is_empty() {
        section = section.table(matrix(results));
    }
    section
}

fn models(results: &Results) -> Table {
    let mut table = Table::new(
        "Model particulars. Moment centre (MC) and centre of buoyancy (CB) are aft of the nose.",
        [
            "Hull",
            "L/d",
            "length [m]",
            "diameter [m]",
            "frontal area [m²]",
            "MC [m]",
            "CB [m]",
            "mass below the balance [kg]",
        ],
    );
    for hull in results.hulls.iter().map(|hull| &hull.hull) {
        table.push([
            Cell::from(hull.id.as_str()),
            Cell::number(hull.ldr, 4),
            Cell::number(hull.geometry.loa_m, 4),
            Cell::number(hull.geometry.diameter_m, 4),
            Cell::number(hull.frontal_area_m2(), 4),
            Cell::number(hull.mc_m, 4),
            Cell::number(hull.geometry.cb_m, 4),
            hull.live.map_or(Cell::from("-"), |live| Cell::number(live.mass_kg, 4)),
        ]);
    }
    table
}

fn conditions(results: &Results) -> Table {
    let mut table = Table::new(
        "Conditions of the steady runs. Reynolds number Re and Froude number Fr on the overall length.",
        [
            "Hull",
            "speed [m/s]",
            "yaw [deg]",
            "Re / 10⁶",
            "Fr",
            "water [°C]",
            "density [kg/m³]",
            "kinematic viscosity [10⁻⁶ m²/s]",
        ],
    );
    for hull in &results.hulls {
        let points = &hull.sweep.points;
        let range = |values: Vec<f64>, digits: usize| range(&values, digits);
        let speeds: Vec<f64> = points.iter().filter_map(|point| point.speed_m_s).collect();
        let root = (GRAVITY_M_S2 * hull.hull.geometry.loa_m).sqrt();
        let runs: Vec<_> = results.runs.iter().filter(|run| is_of(run.run.hull, results, hull)).collect();
        let water = |of: fn(&crate::water::Water) -> f64| {
            let mut values: Vec<f64> = runs.iter().map(|run| of(&run.run.water)).collect();
            values.extend(hull.water.iter().filter(|_| runs.is_empty()).map(of));
            values
        };
        table.push([
            Cell::from(hull.hull.id.as_str()),
            range(speeds.clone(), 3),
            range(points.iter().map(|point| point.yaw_deg).collect(), 3),
            range(points.iter().filter_map(|point| point.reynolds).map(|re| re / 1e6).collect(), 3),
            range(speeds.iter().map(|speed| speed / root).collect(), 3),
            range(water(|water| water.temperature_C), 3),
            range(water(|water| water.density_kg_m3), 5),
            range(water(|water| 1e6 * water.kinematic_viscosity_m2_s), 4),
        ]);
    }
    table
}

/// Smallest to largest, one number where they are alike to these digits.
fn range(values: &[f64], digits: usize) -> Cell {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    if values.is_empty() {
        return Cell::from("-");
    }
    let (low, high) = (Cell::number(low, digits).to_string(), Cell::number(high, digits).to_string());
    Cell::from(if low == high { low } else { format!("{low} to {high}") })
}

/// The numbers of runs of each kind.
fn matrix(results: &Results) -> Table {
    let kinds = [Kind::Zero, Kind::Tare, Kind::Static, Kind::Sway, Kind::Yaw, Kind::Arc];
    let mut counts: BTreeMap<Option<usize>, [i64; 6]> = BTreeMap::new();
    for run in &results.runs {
        let row = counts.entry(run.run.hull).or_default();
        if let Some(place) = kinds.iter().position(|kind| *kind == run.run.kind) {
            row[place] += 1;
        }
    }
    let header = std::iter::once("Hull").chain(kinds.iter().map(|kind| kind.name()));
    let mut table = Table::new("Run matrix: number of runs of each kind that were reduced.", header);
    for (hull, counts) in counts {
        let name = hull.and_then(|hull| results.hulls.get(hull)).map_or("strut alone", |hull| hull.hull.id.as_str());
        table.push(std::iter::once(Cell::from(name)).chain(counts.map(Cell::Count)));
    }
    table
}

fn is_of(index: Option<usize>, results: &Results, hull: &HullResults) -> bool {
    index.and_then(|index| results.hulls.get(index)).is_some_and(|found| found.hull.id == hull.hull.id)
}

/// The uncertainty budget: what scatters from run to run, and what all runs share.
pub fn uncertainty(results: &Results) -> Section {
    let mut table = Table::new(
        "Uncertainty budget, standard uncertainties. Precision: what scatters from run to run and falls with the number of runs. Bias: what runs share (zeros, tare, 0.058 % of the carriage's speed, and the uncertainties that campaign.toml states for calibration, interaction, moment centre and centre of buoyancy). Combined: the root of the sum of squares. Expanded: half the 95 % interval.",
        ["Hull", "coefficient", "value", "precision", "bias", "combined", "expanded, 95 %"],
    );
    for hull in &results.hulls {
        let Ok(fit) = &hull.fit else { continue };
        for (name, value, parts) in budget(fit) {
            table.push([
                Cell::from(hull.hull.id.as_str()),
                Cell::from(name),
                Cell::number(value, 4),
                Cell::number(parts.precision, 2),
                Cell::number(parts.bias, 2),
                Cell::number(parts.combined, 2),
                Cell::number(parts.expanded, 2),
            ]);
        }
    }
    Section::new("Uncertainty budget").table(table).text(
        "Uncertainties of diameter, length, mass below the balance, moment of inertia and temperature are not in the budget: a campaign does not state them.",
    )
}

/// The parts of one coefficient's uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Parts {
    precision: f64,
    bias: f64,
    combined: f64,
    expanded: f64,
}

fn budget(fit: &SweepFit) -> Vec<(&'static str, f64, Parts)> {
    let estimates = [&fit.estimates.a, &fit.estimates.b, &fit.estimates.c, &fit.estimates.d];
    let place = |i: usize| (COEFFICIENTS[i].0, COEFFICIENTS[i].2, COEFFICIENTS[i].3);
    let of = |(i, estimate): (usize, &&glidepolar_hull::hull_tests::Estimate)| {
        let (name, which, parameter) = place(i);
        let fit = &fit.fits[which];
        let variance = |matrix: &DMatrix<f64>| matrix[(parameter, parameter)].max(0.0);
        let (own, all) = (variance(&fit.own_covariance), variance(&fit.covariance));
        let parts = Parts {
            precision: own.sqrt(),
            bias: (all - own).max(0.0).sqrt(),
            combined: all.sqrt(),
            expanded: 0.5 * (estimate.ci95[1] - estimate.ci95[0]),
        };
        (name, estimate.value, parts)
    };
    estimates.iter().enumerate().map(of).collect()
}
