//! Tables as CSV.

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

/// A number to so many significant digits, in the shortest form that `str::parse` reads back.
fn significant(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    rounded.to_string()
}
