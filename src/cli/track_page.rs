//! The track as a page: what `glidepolar track --out` writes.

use crate::report::{Axis, Cell, Figure, Layer, Panel, Report, Section, Table};
use crate::track::plausibility::shown_duration;
use crate::track::{DiveTrack, Drift, Fix, Track, displacement_m};

/// Points of the track that a figure shows at most.
const MOST_POINTS: usize = 50_000;

/// 95 % of a normal distribution lie within so many standard errors.
const Z95: f64 = 1.96;

/// What a page says beyond the track itself.
pub(super) struct Remarks<'a> {
    pub vehicle: &'a str,
    pub is_builtin: bool,
    pub has_uncertainty: bool,
    pub declination_deg: f64,
    /// Standard error of the polar's speed beyond the vehicle's own figures, relative.
    pub speed_error: f64,
    /// The fixes, and the currents between each two of them.
    pub fixes: &'a [Fix],
    pub drifts: &'a [Drift],
    /// Currents that the table of fixes has: time of the fix, east, north.
    pub stored: &'a [(f64, f64, f64)],
    /// One sentence on how they compare.
    pub comparison: Option<String>,
}

/// The page, to which the caller adds the files that were read.
pub(super) fn page(track: &Track, remarks: &Remarks<'_>) -> Report {
    let dives = &track.dives;
    let (east, north) = dives.iter().fold((0.0, 0.0), |(e, n), dive| (e + dive.east_m, n + dive.north_m));
    let mut report = Report::new("Track", remarks.vehicle).finding(format!(
        "{} dives: {:.2} km east and {:.2} km north through the water.",
        dives.len(),
        east / 1e3,
        north / 1e3
    ));
    let currents: Vec<&DiveTrack> = dives.iter().filter(|dive| dive.current.is_some()).collect();
    if !currents.is_empty() {
        let mean =
            |of: fn(&DiveTrack) -> f64| currents.iter().map(|dive| of(dive)).sum::<f64>() / currents.len() as f64;
        report = report.finding(format!(
            "Currents between fixes on {} dives, on the mean {:+.3} m/s east and {:+.3} m/s north.",
            currents.len(),
            mean(|dive| dive.current.map_or(f64::NAN, |c| c.east_m_s)),
            mean(|dive| dive.current.map_or(f64::NAN, |c| c.north_m_s))
        ));
    }
    report.findings.extend(remarks.comparison.clone());
    for warning in warnings(dives, remarks) {
        report = report.warning(warning);
    }
    if currents.is_empty() && !remarks.drifts.is_empty() {
        let n = remarks.drifts.len() as f64;
        let mean = |of: fn(&Drift) -> f64| remarks.drifts.iter().map(of).sum::<f64>() / n;
        report = report.finding(format!(
            "Currents between {} pairs of fixes, on the mean {:+.3} m/s east and {:+.3} m/s north.",
            remarks.drifts.len(),
            mean(|drift| drift.current.east_m_s),
            mean(|drift| drift.current.north_m_s)
        ));
    }
    let mut ways = Section::new("Way through the water").figure(way(track, remarks.fixes));
    if remarks.fixes.is_empty() {
        ways = ways.text("Without fixes (--fixes) nothing can be said about currents: the way over ground is another.");
    } else if currents.is_empty() && remarks.drifts.is_empty() {
        ways = ways.text(format!(
            "None of the {} fixes has a second one beside it within the time of the log: no current follows from them.",
            remarks.fixes.len()
        ));
    }
    report = report.section(ways);
    if currents.is_empty() && !remarks.drifts.is_empty() {
        report = report.section(Section::new("Currents between fixes").table(drift_table(remarks.drifts)));
    }
    if !currents.is_empty() {
        report = report.section(Section::new("Currents").figure(currents_figure(&currents, remarks)));
    }
    report.section(Section::new("Dives").folded().table(table(dives)))
}

fn warnings(dives: &[DiveTrack], remarks: &Remarks<'_>) -> Vec<String> {
    let mut warnings = Vec::new();
    if remarks.is_builtin {
        warnings.push(
            "The polar is a built-in vehicle's, not one identified from this glider's own flight: speeds can be wrong by \
             tens of per cent."
                .to_owned(),
        );
    }
    if !remarks.has_uncertainty {
        warnings.push(if knows_speed_errors(remarks) {
            format!(
                "The vehicle states no [uncertainty]: the errors of the way are those of the compass and of {:.0} % of the speed.",
                100.0 * remarks.speed_error
            )
        } else {
            "The vehicle states no [uncertainty]: the errors of the way are those of the compass alone.".to_owned()
        });
    }
    if remarks.declination_deg == 0.0 {
        warnings.push(
            "No declination was given (--declination-deg): headings are taken for true. Where the log's are magnetic, the \
             way is turned."
                .to_owned(),
        );
    }
    let without: usize = dives.iter().map(|dive| dive.without_glide).sum();
    if without > 0 {
        warnings
            .push(format!("No steady glide balances at {without} samples; the glider is taken to stand still there."));
    }
    let gaps: f64 = dives.iter().map(|dive| dive.gaps_s).sum();
    if gaps > 0.0 {
        warnings.push(format!("{} of gaps in the log were not bridged.", shown_duration(gaps)));
    }
    warnings
}

/// Currents between each two fixes.
fn drift_table(drifts: &[Drift]) -> Table {
    let columns = ["From [h]", "To [h]", "Current east [m/s]", "Current north [m/s]"];
    let begin = drifts.first().map_or(0.0, |drift| drift.start_s);
    let caption =
        "Mean currents between fixes that follow one another, with standard errors; hours since the first fix.";
    drifts.iter().fold(Table::new(caption, columns), |table, drift| {
        let c = &drift.current;
        table.row([
            Cell::fixed((drift.start_s - begin) / 3600.0, 2),
            Cell::fixed((drift.end_s - begin) / 3600.0, 2),
            Cell::estimate(c.east_m_s, c.east_se_m_s),
            Cell::estimate(c.north_m_s, c.north_se_m_s),
        ])
    })
}

/// Fixes over ground from where the track is at the first of them.
fn over_ground(track: &Track, fixes: &[Fix]) -> (Vec<f64>, Vec<f64>) {
    let (Some(begin), Some(end)) = (track.points.first(), track.points.last()) else { return Default::default() };
    let within: Vec<&Fix> =
        fixes.iter().filter(|fix| fix.time_s >= begin.time_s - 3600.0 && fix.time_s <= end.time_s + 3600.0).collect();
    let Some(first) = within.first() else { return Default::default() };
    let after = track.points.partition_point(|point| point.time_s <= first.time_s);
    let at = &track.points[after.saturating_sub(1)];
    within
        .iter()
        .map(|fix| {
            let [east_m, north_m] = displacement_m(first, fix);
            ((at.east_m + east_m) / 1e3, (at.north_m + north_m) / 1e3)
        })
        .unzip()
}

fn way(track: &Track, fixes: &[Fix]) -> Figure {
    let stride = track.points.len().div_ceil(MOST_POINTS).max(1);
    let (east, north) = track.points.iter().step_by(stride).map(|p| (p.east_m / 1e3, p.north_m / 1e3)).unzip();
    let mut at = (0.0, 0.0);
    let (ends_east, ends_north): (Vec<f64>, Vec<f64>) = track
        .dives
        .iter()
        .map(|dive| {
            at = (at.0 + dive.east_m / 1e3, at.1 + dive.north_m / 1e3);
            at
        })
        .unzip();
    let (fixed_east, fixed_north) = over_ground(track, fixes);
    let mut panel = Panel::new(Axis::new("North", "y", "km"))
        .layer(Layer::line(east, north).label("way"))
        .layer(Layer::points(ends_east, ends_north).label("ends of dives"));
    if !fixed_east.is_empty() {
        panel = panel.layer(Layer::points(fixed_east, fixed_north).label("fixes, over ground"));
    }
    Figure::new("way", Axis::new("East", "x", "km"))
        .panel(panel)
        .map()
        .caption("The way through the water from the start of the log, and the fixes over ground from the first of them: what lies between is the current's.")
}

fn currents_figure(dives: &[&DiveTrack], remarks: &Remarks<'_>) -> Figure {
    let begin = dives.first().map_or(0.0, |dive| dive.start_s);
    let panel = |y: Axis, of: fn(&DiveTrack) -> Option<(f64, f64)>, stored: fn(&(f64, f64, f64)) -> f64| {
        let hours: Vec<f64> = dives.iter().map(|dive| (0.5 * (dive.start_s + dive.end_s) - begin) / 3600.0).collect();
        let (values, errors) = dives.iter().filter_map(|dive| of(dive)).map(|(v, se)| (v, Z95 * se)).unzip();
        let mut panel = Panel::new(y).layer(Layer::points(hours, values).y_error(errors).label("reckoned"));
        if !remarks.stored.is_empty() {
            let half = dives.first().map_or(0.0, |dive| 0.5 * (dive.end_s - dive.start_s));
            let (times, theirs) =
                remarks.stored.iter().map(|row| ((row.0 + half - begin) / 3600.0, stored(row))).unzip();
            panel = panel.layer(Layer::points(times, theirs).label("in the table of fixes"));
        }
        panel.layer(Layer::at_y(0.0))
    };
    let east = panel(
        Axis::new("Current to the east", "u", "m/s"),
        |dive| dive.current.map(|c| (c.east_m_s, c.east_se_m_s)),
        |row| row.1,
    );
    let north = panel(
        Axis::new("Current to the north", "v", "m/s"),
        |dive| dive.current.map(|c| (c.north_m_s, c.north_se_m_s)),
        |row| row.2,
    );
    let errors_of = if knows_speed_errors(remarks) { "compass, polar and fixes" } else { "compass and fixes" };
    Figure::new("currents", Axis::new("Time", "t", "h")).panel(east).panel(north).caption(format!(
        "Mean current over depth between fixes, drift at the surface included; bars: 95 % of {errors_of}.",
    ))
}

/// Whether the errors on the page have a share of the speed's.
fn knows_speed_errors(remarks: &Remarks<'_>) -> bool {
    remarks.has_uncertainty || remarks.speed_error > 0.0
}

fn table(dives: &[DiveTrack]) -> Table {
    let columns =
        ["Dive", "Duration [h]", "East [km]", "North [km]", "Current east [m/s]", "Current north [m/s]", "Gaps [min]"];
    let caption = "Ways through the water and currents, with standard errors; durations without the gaps.";
    dives.iter().fold(Table::new(caption, columns), |table, dive| {
        let current = |of: fn(&crate::track::Current) -> (f64, f64)| {
            dive.current.as_ref().map(of).map_or(Cell::from("-"), |(value, se)| Cell::estimate(value, se))
        };
        table.row([
            Cell::from(dive.dive as usize),
            Cell::fixed(dive.recorded_s() / 3600.0, 2),
            Cell::estimate(dive.east_m / 1e3, dive.east_se_m / 1e3),
            Cell::estimate(dive.north_m / 1e3, dive.north_se_m / 1e3),
            current(|c| (c.east_m_s, c.east_se_m_s)),
            current(|c| (c.north_m_s, c.north_se_m_s)),
            Cell::fixed(dive.gaps_s / 60.0, 1),
        ])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::Current;

    fn dive() -> DiveTrack {
        let current =
            Current { east_m_s: 0.1, north_m_s: 0.0, east_se_m_s: 0.02, north_se_m_s: 0.02, duration_s: 7200.0 };
        DiveTrack {
            dive: 0,
            start_s: 0.0,
            end_s: 7200.0,
            east_m: 2000.0,
            north_m: 300.0,
            east_se_m: 50.0,
            north_se_m: 50.0,
            without_glide: 0,
            gaps_s: 0.0,
            current: Some(current),
        }
    }

    /// What a page says of its errors: never that they are the compass's alone where the speed has a share in them.
    #[test]
    fn the_page_says_whose_errors_it_shows() {
        for (has_uncertainty, speed_error, alone) in
            [(false, 0.0, true), (false, 0.1, false), (true, 0.0, false), (true, 0.1, false)]
        {
            let remarks = Remarks {
                vehicle: "v",
                is_builtin: false,
                has_uncertainty,
                declination_deg: 1.0,
                speed_error,
                fixes: &[],
                drifts: &[],
                stored: &[],
                comparison: None,
            };
            let html = page(&Track { points: Vec::new(), dives: vec![dive()] }, &remarks).html();
            let case = format!("{has_uncertainty} {speed_error}");
            assert_eq!(html.contains("the errors of the way are those of the compass alone"), alone, "{case}");
            assert_eq!(html.contains("95 % of compass and fixes"), alone, "{case}");
            assert_eq!(html.contains("95 % of compass, polar and fixes"), !alone, "{case}");
            assert_eq!(html.contains("of 10 % of the speed"), !has_uncertainty && speed_error > 0.0, "{case}");
        }
    }

    #[test]
    fn the_way_is_a_map_with_the_fixes_on_it() {
        let point = |time_s: f64, east_m: f64| crate::track::Point {
            time_s,
            dive: 0,
            depth_m: 10.0,
            speed_m_s: 0.3,
            east_m,
            north_m: 0.0,
        };
        let track = Track { points: vec![point(0.0, 0.0), point(7200.0, 2000.0)], dives: vec![dive()] };
        let fix = |time_s: f64, lon_deg: f64| Fix { time_s, lat_deg: 0.0, lon_deg };
        let figure = way(&track, &[fix(0.0, 0.0), fix(7200.0, 0.02)]);
        assert!(figure.is_map, "a length to the east is as long to the north");
        assert_eq!(figure.panels[0].layers.len(), 3, "way, ends of dives, fixes");
    }
}
