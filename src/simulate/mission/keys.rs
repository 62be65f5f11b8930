//! The keys of a mission file, in one table.

/// One key of a mission file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Section and name with a dot between.
    pub path: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value where the file says nothing; none where another key or nothing at all takes its place.
    pub default: Option<f64>,
    /// Whether nothing works without it.
    pub needed: bool,
    /// Whether it may be a list.
    pub list: bool,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// What it is.
    pub meaning: &'static str,
}

const POSITIVE: f64 = f64::MIN_POSITIVE;
const ANY: f64 = f64::MAX;

const fn key(path: &'static str, unit: &'static str, range: (f64, f64), meaning: &'static str) -> Key {
    Key { path, unit, default: None, needed: false, list: false, min: range.0, max: range.1, meaning }
}

impl Key {
    const fn or(self, default: f64) -> Self {
        Key { default: Some(default), ..self }
    }
    const fn needed(self) -> Self {
        Key { needed: true, ..self }
    }
    const fn list(self) -> Self {
        Key { list: true, ..self }
    }
}

/// Every key of a mission file.
pub const KEYS: &[Key] = &[
    key("voyage.duration_h", "h", (POSITIVE, 1e6), "The mission ends after this time").needed(),
    key(
        "voyage.distance_km",
        "km",
        (POSITIVE, ANY),
        "The mission ends after this way over ground, should it come first",
    ),
    key("dive.max_depth_m", "m", (POSITIVE, 12_000.0), "Turn up at this depth").needed(),
    key("dive.altimeter_m", "m", (0.0, 1000.0), "Turn up at this height above the seabed; 0: no altimeter").or(0.0),
    key("dive.climb_to_m", "m", (0.0, 12_000.0), "Turn down again at this depth, between two surfacings").or(5.0),
    key("glide.pitch_down_deg", "deg", (-89.0, -1.0), "Pitch on descents, nose-up positive").needed(),
    key("glide.pitch_up_deg", "deg", (1.0, 89.0), "Pitch on ascents").needed(),
    key("glide.ballast_down_cc", "cm3", (-1e7, 1e7), "Ballast volume on descents, positive = more buoyant").needed(),
    key("glide.ballast_up_cc", "cm3", (-1e7, 1e7), "Ballast volume on ascents").needed(),
    key(
        "surfacing.first_after_h",
        "h",
        (POSITIVE, 1e6),
        "Turn up for the surface this long after the start; default every_h",
    ),
    key(
        "surfacing.every_h",
        "h",
        (POSITIVE, 1e6),
        "Turn up for the surface this long after leaving it; default: after each dive",
    ),
    key("surfacing.stay_min", "min", (0.0, 1e5), "Stay at the surface").or(10.0),
    key("surfacing.ballast_cc", "cm3", (-1e7, 1e7), "Ballast volume at the surface; default ballast_up_cc"),
    key("surfacing.pitch_deg", "deg", (-89.0, 89.0), "Pitch at the surface, antenna out of the water").or(-20.0),
    key("control.period_s", "s", (1.0, 1e4), "Time between two looks at the pitch").or(60.0),
    key("control.deadband_deg", "deg", (0.0, 45.0), "Error of the pitch that is left alone").or(1.0),
    key(
        "control.gain",
        "1",
        (0.0, 2.0),
        "Share of the error that one move of the moving mass is meant to remove; 0: feed-forward only",
    )
    .or(0.5),
    key("seabed.distance_km", "km", (0.0, ANY), "Places of the seabed's depths, over ground").list(),
    key("seabed.depth_m", "m", (POSITIVE, 12_000.0), "Depth of the seabed").or(6000.0).list(),
    key("water.depth_m", "m", (0.0, 12_000.0), "Depths of density and temperature").list(),
    key(
        "water.density_kg_m3",
        "kg/m3",
        (900.0, 1300.0),
        "In-situ density of the water; default the vehicle's reference",
    )
    .list(),
    key("water.temperature_C", "degC", (-5.0, 50.0), "Temperature of the water; default the vehicle's reference")
        .list(),
    key("current.depth_m", "m", (0.0, 12_000.0), "Depths of the current").list(),
    key("current.along_m_s", "m/s", (-5.0, 5.0), "Current along the course, positive when it helps").or(0.0).list(),
    key("current.north_m_s", "m/s", (-5.0, 5.0), "Current to the north (--3d)").or(0.0).list(),
    key("current.east_m_s", "m/s", (-5.0, 5.0), "Current to the east (--3d)").or(0.0).list(),
    key("current.tide_m_s", "m/s", (-5.0, 5.0), "Largest velocity of the tide along the course, at all depths").or(0.0),
    // The principal lunar tide.
    key("current.tide_period_h", "h", (0.1, 1e4), "Period of the tide").or(12.4206),
    key("current.tide_most_at_h", "h", (-1e6, 1e6), "Time from the start at which the tide helps most").or(0.0),
    key("route.north_km", "km", (-1e4, 1e4), "Waypoints, so far north of the start (--3d)").list(),
    key("route.east_km", "km", (-1e4, 1e4), "The same waypoints, so far east of the start (--3d)").list(),
    key("route.latitude_deg", "deg", (-89.0, 89.0), "Waypoints by latitude, in the place of north_km (--3d)").list(),
    key("route.longitude_deg", "deg", (-360.0, 360.0), "The same waypoints by longitude (--3d)").list(),
    key("route.start_latitude_deg", "deg", (-89.0, 89.0), "Latitude of the start (--3d)").or(0.0),
    key("route.start_longitude_deg", "deg", (-360.0, 360.0), "Longitude of the start (--3d)").or(0.0),
    key("route.reached_m", "m", (POSITIVE, 1e5), "A waypoint counts as reached within this distance (--3d)").or(200.0),
    key(
        "steering.actuator",
        "1",
        (1.0, 2.0),
        "What steers: 1 rudder, 2 roll mass; default the one that the vehicle has (--3d)",
    ),
    key("steering.period_s", "s", (1.0, 1e5), "Time between two looks at the heading (--3d)").or(20.0),
    key("steering.deadband_deg", "deg", (0.0, 90.0), "Error of the heading up to which nothing moves (--3d)").or(4.0),
];
