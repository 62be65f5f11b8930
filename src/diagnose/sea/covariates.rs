//! What the residuals of a log may go with.

use crate::diagnose::evidence::Covariate;
use crate::diagnose::smooth::Kind;
use crate::identify::Bin;

/// Place along the water column: the share of all bins that lie higher.
pub fn places(bins: &[&Bin]) -> Vec<f64> {
    let mut sorted: Vec<f64> = bins.iter().map(|bin| bin.mean.pressure_dbar).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len().max(1) as f64;
    bins.iter().map(|bin| sorted.partition_point(|p| *p < bin.mean.pressure_dbar) as f64 / n).collect()
}

/// What was set or met, never what is to be explained: a curve along the measured velocity itself would fit its noise.
pub fn from_bins(bins: &[&Bin]) -> Vec<Covariate> {
    let mut found = Vec::new();
    let mut add = |name: &'static str, kind: Kind, value: fn(&Bin) -> f64| {
        let values: Vec<f64> = bins.iter().map(|bin| value(bin)).collect();
        if values.iter().all(|value| value.is_finite()) {
            found.push(Covariate { name, kind, values });
        }
    };
    add("depth", Kind::Line, |bin| bin.mean.pressure_dbar);
    // Water that moves in a layer is met by every leg, and a smooth curve passes it by.
    add("depth", Kind::Layers, |bin| bin.mean.pressure_dbar);
    add("time", Kind::Line, |bin| bin.mean.time_s);
    add("pitch", Kind::Line, |bin| bin.mean.pitch_rad.abs());
    add("ballast", Kind::Line, |bin| bin.mean.ballast_m3);
    add("temperature", Kind::Line, |bin| bin.mean.temperature_C);
    add("roll", Kind::Line, |bin| bin.mean.roll_rad);
    add("rudder", Kind::Line, |bin| bin.mean.rudder_rad);
    add("heading", Kind::Angle, |bin| bin.mean.heading_rad);
    // The moon's half day, 12.4206 h.
    add("tide", Kind::Angle, |bin| bin.mean.time_s * std::f64::consts::TAU / 44_714.16);
    found
}
