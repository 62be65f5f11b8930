//! Short ways on the earth: the ellipsoid WGS 84 (semi-major axis 6378137 m, flattening 1/298.257223563).

/// A fix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Time \[s\].
    pub time_s: f64,
    /// Latitude, north positive \[deg\].
    pub lat_deg: f64,
    /// Longitude, east positive \[deg\].
    pub lon_deg: f64,
}

const SEMI_MAJOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// East and north from one fix to another \[m\], by the radii of curvature at the latitude halfway: within 1e-4 over
/// 100 km away from the poles.
pub fn displacement_m(from: &Fix, to: &Fix) -> [f64; 2] {
    let latitude = (0.5 * (from.lat_deg + to.lat_deg)).to_radians();
    let eccentricity_2 = FLATTENING * (2.0 - FLATTENING);
    let w = 1.0 - eccentricity_2 * latitude.sin().powi(2);
    let across_m = SEMI_MAJOR_M / w.sqrt();
    let along_m = SEMI_MAJOR_M * (1.0 - eccentricity_2) / w.powf(1.5);
    let east = (to.lon_deg - from.lon_deg + 540.0).rem_euclid(360.0) - 180.0;
    [east.to_radians() * across_m * latitude.cos(), (to.lat_deg - from.lat_deg).to_radians() * along_m]
}
