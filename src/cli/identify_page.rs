//! The identification as a page, and its tables as CSV: what `glidepolar identify --out` writes.

use crate::dynamics::{PARAMETERS, Parameters};
use crate::identify::identifiability::profile;
use crate::identify::paper_form::IterativeReport;
use crate::identify::pitch_balance::{PitchBalance, predicted_pitch_rad};
use crate::identify::polar_points::{PolarPoint, polar_points};
use crate::identify::{Dive, Identification, IdentifyReport};
use crate::log::{Calibration, Observation};
use crate::output::{OutputError, OutputFolder};
use crate::report::{Cell, Report, Section, Table, significant};
use crate::vehicle::Vehicle;

use super::{housekeeping, identify_figures as figures, identify_write};

/// Standard errors on either side over which a profile is taken, and its points.
const PROFILE_AT_SE: [f64; 9] = [-3.0, -2.25, -1.5, -0.75, 0.0, 0.75, 1.5, 2.25, 3.0];

/// The page of the joint fit; tables go into the folder.
pub(super) fn of_joint(
    vehicle: &Vehicle,
    found: &Identification,
    report: &IdentifyReport,
    observations: &[Observation],
    calibration: Option<&Calibration>,
    folder: &mut OutputFolder,
) -> Result<Report, OutputError> {
    let parameters = &found.best_fit().parameters;
    let points = polar_points(parameters, observations, found.dives.iter().any(Dive::is_quasi_steady));
    folder.add("glides.csv", glides_csv(&points))?;
    folder.add("parameters.csv", parameters_csv(report))?;
    folder.add("correlation.csv", correlation_csv(report))?;
    folder.add("residuals.csv", residuals_csv(parameters, &found.dives))?;

    let mut page = Report::new("Identification", format!("{}, {} glides", vehicle.name, report.n_glides));
    page.warnings.extend(report.warnings.iter().cloned());
    page.findings.extend(answers(parameters, &points));
    page.findings.extend(findings(report));
    let mut profiles = Section::new("What the data identify, and what they do not")
        .figure(figures::lift_slope_profile(&found.profile))
        .text("A profile holds one parameter and fits all others again. It allows for the correlation of neighbouring samples by their number that says together what one independent sample would; the standard errors of the table leave out one dive at a time.");
    for (i, &row) in found.fit.free.iter().enumerate() {
        let info = &PARAMETERS[row];
        let (value, se) = (found.fit.value(row), found.fit.se(i));
        if info.name == "a_per_rad" || !(se > 0.0 && se.is_finite()) {
            continue;
        }
        let values: Vec<f64> = PROFILE_AT_SE.iter().map(|k| (value + k * se).clamp(info.min, info.max)).collect();
        if let Ok(points) = profile(&found.question, &found.fit.parameters, info.name, &values, &found.dives) {
            profiles = profiles.figure(figures::profile(info.name, info.unit, &points));
        }
    }
    let clouds = figures::residual_clouds(&found.fit.parameters, &found.dives);
    page = figures::dives_over_time(parameters, &found.dives)
        .into_iter()
        .fold(page.section(pilots_constants(vehicle, found, report, calibration)), |page, section| {
            page.section(section)
        });
    page = page
        .section(Section::new("Parameters").table(parameter_table(report)).table(correlation_table(report)))
        .section(
            Section::new("Glides")
                .figure(figures::path_and_speed(&points))
                .figure(figures::coefficients(&points, parameters)),
        )
        .section(Section::new("Through time").figure(figures::time_series(&found.best_fit().parameters, &found.dives)))
        .section(profiles)
        .section(clouds.into_iter().fold(Section::new("Residuals"), Section::figure).table(quality_table(report)));
    if let Some(balance) = &found.pitch_balance {
        page = page.section(moments(balance, &found.dives));
    }
    page = page.section(Section::new("Glide by glide").folded().table(glide_table(&points)));
    Ok(housekeeping(&report.notes).into_iter().fold(page, Report::section))
}

/// The page of the iterative scheme.
pub(super) fn of_iterative(
    vehicle: &Vehicle,
    report: &IterativeReport,
    folder: &mut OutputFolder,
) -> Result<Report, OutputError> {
    let own = report.campaigns.iter().take(2);
    let points: Vec<PolarPoint> = own.flat_map(|campaign| campaign.glides.iter().map(PolarPoint::from)).collect();
    folder.add("glides.csv", glides_csv(&points))?;
    let mut page =
        Report::new("Identification, iterative scheme", format!("{}, {} glides", vehicle.name, report.n_glides));
    page.warnings.extend(report.warnings.iter().cloned());
    let mut table = Table::new(
        "The tank paper's scheme over all glides of a leg, from three first guesses.",
        ["Leg", "First a [1/rad]", "a [1/rad]", "b", "c [1/rad²]", "Rounds", "Glides", "Correlation of CL"],
    );
    for campaign in &report.campaigns {
        let k = campaign.coefficients();
        table.push([
            Cell::from(if campaign.descends { "descents" } else { "ascents" }),
            Cell::number(campaign.first_guess.a, 3),
            Cell::number(k.a, 3),
            Cell::number(k.b, 3),
            Cell::number(k.c, 3),
            Cell::from(campaign.history.len()),
            Cell::from(campaign.glides.len()),
            Cell::fixed(campaign.lift_correlation, 3),
        ]);
    }
    Ok(page
        .section(Section::new("Coefficients").table(table).text("The balance of a glide is two equations for the four unknowns a, b, c and the angle of attack: the scheme returns the first guess, bent until it fits."))
        .section(
            Section::new("Glides")
                .figure(figures::path_and_speed(&points))
                .figure(figures::coefficients(&points, &report.solved)),
        )
        .section(Section::new("Glide by glide").folded().table(glide_table(&points))))
}

/// What a pilot asks first: how far, how slowly, and how fast as usual.
fn answers(parameters: &Parameters<f64>, points: &[PolarPoint]) -> Vec<String> {
    let mut answers = Vec::new();
    for (descends, leg) in [(true, "descents"), (false, "ascents")] {
        let own: Vec<&PolarPoint> = points.iter().filter(|point| point.descends() == descends).collect();
        if own.is_empty() {
            continue;
        }
        let mean = |of: fn(&PolarPoint) -> f64| own.iter().map(|point| of(point)).sum::<f64>() / own.len() as f64;
        answers.push(format!(
            "On {leg} at the usual pitch of {} deg: {} m/s through the water, {} m/s vertically, {} deg angle of attack.",
            significant(mean(|p| p.glide.pitch_rad).to_degrees(), 3),
            significant(mean(|p| p.speed_m_s), 3),
            significant(mean(|p| p.glide.sink_m_s.abs()), 3),
            significant(mean(|p| p.angle_of_attack_rad.abs()).to_degrees(), 2)
        ));
    }
    /// Net mass at which the best glide is stated \[kg\]; it hardly depends on it.
    const NET_MASS_KG: f64 = 0.15;
    if let Some((pitch_deg, ratio)) = super::compare::best_glide(parameters, NET_MASS_KG) {
        answers.push(format!(
            "Best glide: {} m forward for each metre of depth, at a pitch of {} deg down.",
            significant(ratio, 3),
            significant(pitch_deg, 3)
        ));
    }
    answers
}

/// What a Seaglider's pilot types in; an empty section for others.
fn pilots_constants(
    vehicle: &Vehicle,
    found: &Identification,
    report: &IdentifyReport,
    calibration: Option<&Calibration>,
) -> Section {
    let lines = identify_write::for_seagliders(vehicle, found, report, calibration);
    let mut table = Table::new(
        "The basestation's constants, with standard errors. VOLMAX or C_VBD, not both: they correct the same offset. As such they are given with --vehicle from-file.",
        ["Constant", "Value", "Standard error", "Unit"],
    );
    if lines.is_empty() {
        return Section::new("For the pilot").text("Best glide and usual speeds stand above; glidepolar plan and glidepolar track take the vehicle that --write writes.");
    }
    for line in lines {
        table.push(line.map(Cell::from));
    }
    Section::new("For the pilot: constants to type in").table(table)
}

fn findings(report: &IdentifyReport) -> Vec<String> {
    let fit = &report.fit;
    let mm = |value: f64| significant(value * 1e3, 3);
    let mut findings = vec![format!(
        "Vertical velocity is met to {} mm/s rms{}.",
        mm(fit.w_rms_m_s),
        fit.w_rms_holdout_m_s.map_or(String::new(), |held| format!(", on held-out dives to {} mm/s", mm(held)))
    )];
    if let (Some(rms), Some(bias)) = (fit.speed_rms_m_s, fit.speed_bias_m_s) {
        findings.push(format!(
            "Speed is met to {} mm/s rms, with a mean of measured less model of {} mm/s.",
            mm(rms),
            mm(bias)
        ));
    }
    if let Some(legs) = &report.legs_apart {
        findings.push(format!(
            "Fitted apart without a ballast offset, descents give b = {} and ascents {}; together, with an offset of {} g, {}.",
            significant(legs.descent_b, 3),
            significant(legs.ascent_b, 3),
            significant(legs.ballast_offset_kg * 1e3, 2),
            significant(legs.joint_b, 3)
        ));
    }
    if let Some(c) = &report.unsteady {
        findings.push(format!(
            "Where the glider turns, too, below {} dbar: {} mm/s rms flown through time, {} mm/s as steady glides where these exist.",
            c.from_dbar,
            mm(c.unsteady.w_rms_m_s),
            mm(c.steady.w_rms_m_s)
        ));
    }
    findings.extend(report.pinned.iter().map(|(name, pin)| {
        format!("{name} is held at {} ({}): {}.", significant(pin.value, 4), pin.source, pin.reason)
    }));
    findings
}

fn parameter_table(report: &IdentifyReport) -> Table {
    let mut table = Table::new(
        format!(
            "Baseline: {}. Standard errors leave out one dive at a time, and hold the errors of what is held.",
            report.trim_meaning
        ),
        ["Parameter", "Value", "95 % interval", "Unit", "Identified by the data"],
    );
    for (name, quantity) in &report.parameters {
        let Some(q) = quantity else { continue };
        let held = report.pinned.contains_key(name);
        let is_estimated = q.se > 0.0;
        table.push([
            Cell::from(name.as_str()),
            if is_estimated { Cell::estimate(q.value, q.se) } else { Cell::number(q.value, 4) },
            if held { Cell::from("held") } else { Cell::interval((q.ci95[0], q.ci95[1])) },
            Cell::from(q.unit.as_str()),
            Cell::from(if report.identifiable.get(name).copied().unwrap_or(false) { "yes" } else { "no" }),
        ]);
    }
    table
}

fn correlation_table(report: &IdentifyReport) -> Table {
    let names = &report.correlation.names;
    let mut table = Table::new(
        format!("Correlations; condition number {}.", significant(report.condition_number, 3)),
        std::iter::once("").chain(names.iter().map(String::as_str)),
    );
    for (name, row) in names.iter().zip(&report.correlation.matrix) {
        table.push(std::iter::once(Cell::from(name.as_str())).chain(row.iter().map(|&value| Cell::fixed(value, 2))));
    }
    table
}

fn quality_table(report: &IdentifyReport) -> Table {
    let fit = &report.fit;
    let mut table = Table::new(
        format!("Residuals [mm/s]. Vertical velocity: {}.", fit.w_filter),
        ["Quantity", "Fitted", "Held out"],
    );
    let cell = |value: Option<f64>| value.map_or(Cell::from("-"), |v| Cell::fixed(v * 1e3, 2));
    for (what, in_sample, held) in [
        ("vertical velocity, rms", Some(fit.w_rms_m_s), fit.w_rms_holdout_m_s),
        ("the same, 9-point mean", fit.w_rms_9_point_m_s, fit.w_rms_9_point_holdout_m_s),
        ("speed, rms", fit.speed_rms_m_s, fit.speed_rms_holdout_m_s),
        ("speed, mean of measured less model", fit.speed_bias_m_s, fit.speed_bias_holdout_m_s),
    ] {
        table.push([Cell::from(what), cell(in_sample), cell(held)]);
    }
    table
}

fn moments(balance: &PitchBalance, dives: &[Dive]) -> Section {
    let p = &balance.fit.parameters;
    let with_slope = p.map(num_dual::Dual64::from);
    let samples: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    let every = samples.div_ceil(2000).max(1);
    let (mut read, mut predicted): ([Vec<f64>; 2], [Vec<f64>; 2]) = Default::default();
    for o in dives.iter().flat_map(|dive| &dive.observations).step_by(every) {
        if let Some(pitch) =
            predicted_pitch_rad::<f64>(p, &with_slope, o, p.pitch_scale * o.pitch_rad + p.pitch_offset_rad)
        {
            let side = usize::from(!o.descends());
            read[side].push(o.pitch_rad.to_degrees());
            predicted[side].push(pitch.to_degrees());
        }
    }
    let s = balance.summary();
    Section::new("Balance of pitching moments").figure(figures::pitch(read, predicted)).text(format!(
        "Pitch from battery and ballast: {} deg rms, {} without the hydrodynamic moment. The centre of gravity sits {} mm below the centre of buoyancy if the moving mass is {} kg: all of the balance scales with it.",
        significant(s.pitch_rms_rad.to_degrees(), 3),
        s.pitch_rms_without_d_rad.map_or("nothing that balances".to_owned(), |rms| significant(rms.to_degrees(), 3)),
        significant(s.cg_below_cb_m * 1e3, 3),
        significant(s.moving_mass_kg, 3)
    ))
}

const GLIDE_COLUMNS: [&str; 12] = [
    "leg",
    "descent",
    "samples",
    "pitch_rad",
    "sink_m_s",
    "net_weight_N",
    "angle_of_attack_rad",
    "glide_angle_rad",
    "speed_m_s",
    "CL",
    "CD",
    "measured_speed_m_s",
];

fn glide_row(p: &PolarPoint) -> [f64; 12] {
    [
        f64::from(p.glide.leg),
        f64::from(u8::from(p.descends())),
        p.samples as f64,
        p.glide.pitch_rad,
        p.glide.sink_m_s,
        p.glide.net_weight_N,
        p.angle_of_attack_rad,
        p.glide_angle_rad,
        p.speed_m_s,
        p.lift_coefficient,
        p.drag_coefficient,
        p.measured_speed_m_s,
    ]
}

fn glide_table(points: &[PolarPoint]) -> Table {
    let mut table = Table::new("The means of each glide.", GLIDE_COLUMNS);
    for point in points {
        table.push(
            glide_row(point).map(|value| if value.is_finite() { Cell::number(value, 5) } else { Cell::from("-") }),
        );
    }
    table
}

fn glides_csv(points: &[PolarPoint]) -> Vec<u8> {
    csv(&GLIDE_COLUMNS, points.iter().map(|point| glide_row(point).map(number).to_vec()))
}

fn parameters_csv(report: &IdentifyReport) -> Vec<u8> {
    let header = ["parameter", "value", "se", "ci95_low", "ci95_high", "unit", "identifiable", "held"];
    let rows = report.parameters.iter().filter_map(|(name, quantity)| {
        let q = quantity.as_ref()?;
        let mut row = vec![name.clone()];
        row.extend([q.value, q.se, q.ci95[0], q.ci95[1]].map(number));
        row.push(q.unit.clone());
        row.push(report.identifiable.get(name).copied().unwrap_or(false).to_string());
        row.push(report.pinned.contains_key(name).to_string());
        Some(row)
    });
    csv(&header, rows)
}

fn correlation_csv(report: &IdentifyReport) -> Vec<u8> {
    let names: Vec<&str> =
        std::iter::once("parameter").chain(report.correlation.names.iter().map(String::as_str)).collect();
    let rows = report.correlation.names.iter().zip(&report.correlation.matrix);
    csv(&names, rows.map(|(name, row)| std::iter::once(name.clone()).chain(row.iter().copied().map(number)).collect()))
}

fn residuals_csv(parameters: &Parameters<f64>, dives: &[Dive]) -> Vec<u8> {
    let header = [
        "time_s",
        "leg",
        "pressure_dbar",
        "sink_m_s",
        "sink_residual_m_s",
        "speed_m_s",
        "model_speed_m_s",
        "angle_of_attack_rad",
    ];
    let rows = dives.iter().flat_map(|dive| {
        let found = dive.residuals(parameters);
        dive.observations
            .iter()
            .zip(found)
            .map(|(o, r)| {
                let mut row = vec![number(o.time_s), o.leg.to_string()];
                row.extend(
                    [
                        o.pressure_dbar,
                        o.sink_m_s,
                        r.sink_m_s,
                        o.speed_m_s,
                        r.predicted_speed_m_s,
                        r.angle_of_attack_rad,
                    ]
                    .map(number),
                );
                row
            })
            .collect::<Vec<_>>()
    });
    csv(&header, rows)
}

/// A number as CSV holds it: eight digits, an empty cell for none.
fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{}", format!("{value:.7e}").parse::<f64>().unwrap_or(value))
    } else {
        String::new()
    }
}

fn csv(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Vec<u8> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = writer.write_record(header);
    for row in rows {
        let _ = writer.write_record(&row);
    }
    writer.into_inner().unwrap_or_default()
}
