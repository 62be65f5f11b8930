//! Tables as CSV.

use crate::campaign::Kind;
use crate::results::Results;

/// `coefficients.csv`: one row per reduced steady run, with standard errors where they are known.
pub fn coefficients_csv(results: &Results) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header =
        ["run_id", "hull", "yaw_deg", "speed_m_s", "Re", "CL", "CD", "CM", "CL_se", "CD_se", "CM_se", "in_fit"];
    // Writing to memory does not fail.
    let _ = writer.write_record(header);
    for hull in &results.hulls {
        let rows = hull.fit.as_ref().map(|fit| fit.rows.as_slice()).unwrap_or_default();
        for (i, point) in hull.sweep.points.iter().enumerate() {
            let optional = |value: Option<f64>| value.map(|v| significant(v, 6)).unwrap_or_default();
            let mut record = vec![
                point.run_id.clone(),
                hull.hull.id.clone(),
                significant(point.yaw_deg, 7),
                optional(point.speed_m_s),
                optional(point.reynolds),
            ];
            record.extend(point.coefficients.iter().map(|c| significant(*c, 7)));
            record.extend(point.se.iter().map(|se| if *se > 0.0 { significant(*se, 3) } else { String::new() }));
            record.push(u8::from(rows.contains(&i)).to_string());
            let _ = writer.write_record(&record);
        }
    }
    writer.into_inner().unwrap_or_default()
}

/// `steps.csv`: every steady run from the reading to the force of the water, AF, SF, YM about the moment centre.
pub fn steps_csv(results: &Results) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header: Vec<String> =
        ["run_id", "kind", "speed_m_s", "yaw_deg", "window_from_s", "window_to_s"].map(str::to_owned).to_vec();
    for step in ["reading", "zero", "force", "tare", "inertia", "water"] {
        header.extend(["AF_N", "SF_N", "YM_N_m"].map(|channel| format!("{step}_{channel}")));
    }
    header.extend(["AF", "SF", "YM"].map(|channel| format!("effective_samples_{channel}")));
    let _ = writer.write_record(&header);
    for run in &results.runs {
        let Some(steps) = &run.steps else { continue };
        let mut record = vec![run.run.id.clone(), run.run.kind.name().to_owned()];
        let (from, to) = run.trace.window_s;
        record.extend([run.run.speed_m_s, run.run.yaw_deg, from, to].map(|x| significant(x, 7)));
        for step in [steps.reading, steps.zero, steps.force, steps.tare, steps.inertia, steps.water()] {
            record.extend(step.iter().map(|x| significant(*x, 7)));
        }
        let effective = run.effective.map_or([f64::NAN; 3], |(effective, _)| effective);
        record.extend(effective.map(|n| significant(n, 3)));
        let _ = writer.write_record(&record);
    }
    writer.into_inner().unwrap_or_default()
}

/// `derivatives.csv`: what the first harmonic of each oscillation alone says, the rest taken from the common fit.
pub fn derivatives_csv(results: &Results) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = [
        "run_id",
        "hull",
        "kind",
        "frequency_hz",
        "amplitude",
        "amplitude_unit",
        "cycles",
        "Y_damping",
        "Y_damping_se",
        "N_damping",
        "N_damping_se",
        "Y_inertia",
        "Y_inertia_se",
        "N_inertia",
        "N_inertia_se",
    ];
    let _ = writer.write_record(header);
    for hull in &results.hulls {
        for run in hull.dynamic.iter().flat_map(|d| &d.runs) {
            let unit = if run.kind == Kind::Sway { "m" } else { "deg" };
            let mut record = vec![run.run_id.clone(), hull.hull.id.clone(), run.kind.name().to_owned()];
            record.extend([significant(run.frequency_hz, 6), significant(run.amplitude, 6)]);
            record.extend([unit.to_owned(), run.cycles.to_string()]);
            for (value, se) in run.damping.into_iter().chain(run.inertia) {
                record.extend([significant(value, 7), significant(se, 3)]);
            }
            let _ = writer.write_record(&record);
        }
    }
    writer.into_inner().unwrap_or_default()
}

/// A number to so many significant digits, in the shortest form that `str::parse` reads back.
fn significant(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    rounded.to_string()
}
