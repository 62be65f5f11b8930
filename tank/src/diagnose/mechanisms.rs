//! The mechanisms by which a towing tank and its hulls depart from `CL = a alpha, CD = b + c alpha^2, CM = d alpha`: one
//! table. An entry is a name, its physics in a line with the source, its size, where it shows, and how widely it acts.
//! To add one: an entry here, its term in `model`. Knows no data.

use super::model::{STATION, Term, WAVE_TOP, WAVE_WIDTH};

/// How far a mechanism reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// One size for all hulls: balance, carriage, water.
    Campaign,
    /// Every hull has its own size.
    Hull,
    /// One day.
    Day,
    /// A channel's zero in the course of the days.
    Drift,
    /// A run by the load of the run before.
    Before,
    /// Steady drift runs cannot show it: the fitted coefficients absorb it.
    Absorbed,
}

/// How far the law of a mechanism can be relied on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Geometry, a property of water, or the definition of the fault: a zero is the same force in every run.
    Exact,
    /// An approximation: the flow about a hull, or what a balance does over time.
    Approximate,
}

/// One mechanism in the tank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanism {
    /// Name, as the diagnosis gives it.
    pub name: &'static str,
    /// The physics in a line.
    pub physics: &'static str,
    /// Who describes it.
    pub source: &'static str,
    /// Name, unit and term of each parameter; the first is its size.
    pub parameters: &'static [Parameter],
    /// How it is reported, where not by the parameters themselves: name, unit, and the share of each parameter in it.
    pub reported_as: &'static [(&'static str, &'static str, &'static [f64])],
    /// How far it reaches.
    pub reach: Reach,
    /// How far its law can be relied on.
    pub law: Law,
    /// In which data it shows.
    pub regime: &'static str,
    /// The measurement that would show it where these runs do not.
    pub shown_by: &'static str,
}

/// One parameter of a mechanism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name with its unit.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Where it enters the model.
    pub term: Term,
    /// Where it has no effect.
    pub neutral: f64,
    /// How far from neutral it is usually found, a standard deviation; for forces and moments a share of the largest one
    /// that was measured.
    pub prior_sd: PriorSd,
    /// Smallest and largest value that physics allows.
    pub bounds: (f64, f64),
}

/// How far from neutral a parameter is usually found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PriorSd {
    /// In its own unit.
    Is(f64),
    /// As a share of the largest reading of its channel (AF, SF, YM).
    ShareOfChannel(usize, f64),
}

const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// The mechanisms.
pub const IN_TANK: &[Mechanism] = &[
    Mechanism {
        name: "crossflow",
        physics: "Viscous crossflow: a normal force in proportion to sin(alpha)|sin(alpha)|, with its moment",
        source: "Allen and Perkins 1951, NACA Report 1048",
        parameters: &[
            Parameter {
                name: "crossflow_fore_per_rad2",
                unit: "1/rad^2",
                term: Term::CrossflowFore,
                neutral: 0.0,
                prior_sd: PriorSd::Is(6.0),
                bounds: (0.0, 40.0),
            },
            Parameter {
                name: "crossflow_aft_per_rad2",
                unit: "1/rad^2",
                term: Term::CrossflowAft,
                neutral: 0.0,
                prior_sd: PriorSd::Is(6.0),
                bounds: (0.0, 40.0),
            },
            Parameter {
                name: "crossflow_suction",
                unit: "1",
                term: Term::CrossflowSuction,
                neutral: 0.0,
                prior_sd: PriorSd::Is(0.3),
                bounds: (-1.0, 1.0),
            },
        ],
        reported_as: &[
            ("crossflow_per_rad2", "1/rad^2", &[1.0, 1.0, 0.0]),
            ("crossflow_moment_per_rad2", "1/rad^2", &[-STATION, STATION, 0.0]),
            ("crossflow_suction", "1", &[0.0, 0.0, 1.0]),
        ],
        reach: Reach::Hull,
        law: Law::Approximate,
        regime: "large angles, opposite on the two sides in lift and moment, alike in drag",
        shown_by: "angles of 10 degrees and more on both sides",
    },
    Mechanism {
        name: "yaw_misalignment",
        physics: "The model sits askew on the yaw table: the true angle is the recorded one plus this",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[Parameter {
            name: "yaw_misalignment_deg",
            unit: "deg",
            term: Term::Misalignment,
            neutral: 0.0,
            prior_sd: PriorSd::Is(1.0),
            bounds: (-15.0, 15.0),
        }],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Exact,
        regime: "lift and moment at zero angle, in proportion to their slopes at every speed",
        shown_by: "the same angles on both sides, at two speeds or more",
    },
    Mechanism {
        name: "side_force_zero",
        physics: "The zero of SF under way differs from that at rest",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[Parameter {
            name: "side_force_zero_N",
            unit: "N",
            term: Term::Zero(1),
            neutral: 0.0,
            prior_sd: PriorSd::ShareOfChannel(1, 0.05),
            bounds: ANY,
        }],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Exact,
        regime: "lift, the more the slower, alike at all angles",
        shown_by: "both sides, at two speeds or more",
    },
    Mechanism {
        name: "axial_force_zero",
        physics: "The zero of AF under way differs from that at rest",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[Parameter {
            name: "axial_force_zero_N",
            unit: "N",
            term: Term::Zero(0),
            neutral: 0.0,
            prior_sd: PriorSd::ShareOfChannel(0, 0.1),
            bounds: ANY,
        }],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Exact,
        regime: "drag, with the inverse square of the speed",
        shown_by: "several tow speeds",
    },
    Mechanism {
        name: "yaw_moment_zero",
        physics: "The zero of YM under way differs from that at rest",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[Parameter {
            name: "yaw_moment_zero_N_m",
            unit: "N m",
            term: Term::Zero(2),
            neutral: 0.0,
            prior_sd: PriorSd::ShareOfChannel(2, 0.05),
            bounds: ANY,
        }],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Exact,
        regime: "moment, the more the slower, alike at all angles",
        shown_by: "both sides, at two speeds or more",
    },
    Mechanism {
        name: "interaction",
        physics: "AF shows a share of SF that the interaction matrix does not remove",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[Parameter {
            name: "af_from_sf",
            unit: "1",
            term: Term::AxialFromSide,
            neutral: 0.0,
            prior_sd: PriorSd::Is(0.05),
            bounds: (-0.5, 0.5),
        }],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Exact,
        regime: "drag, opposite on the two sides",
        shown_by: "the same angles on both sides",
    },
    Mechanism {
        name: "zero_drift",
        physics: "A channel's zero runs away after switching on and settles: a straight line between zeros misses it",
        source: "warming up of strain-gauge balances",
        parameters: &[
            Parameter {
                name: "zero_drift_N_per_hour",
                unit: "N/h",
                term: Term::None,
                neutral: 0.0,
                prior_sd: PriorSd::ShareOfChannel(1, 0.1),
                bounds: ANY,
            },
            Parameter {
                name: "time_constant_h",
                unit: "h",
                term: Term::None,
                neutral: 0.7,
                prior_sd: PriorSd::Is(0.7),
                bounds: (0.05, 10.0),
            },
        ],
        reported_as: &[],
        reach: Reach::Drift,
        law: Law::Approximate,
        regime: "between the zeros of the first hours of a day",
        shown_by: "start_time_s in runs.csv, and zeros often enough",
    },
    Mechanism {
        name: "reynolds_drag",
        physics: "Friction: b falls with Reynolds number along the ITTC-57 line, scaled to this exponent of the dynamic pressure",
        source: "ITTC 1957, 7.5-02-02-01",
        parameters: &[Parameter {
            name: "drag_exponent",
            unit: "1",
            term: Term::DragExponent,
            neutral: 0.0,
            prior_sd: PriorSd::Is(0.2),
            // Laminar friction has -1/4 (Blasius), turbulent friction less, form drag none: what grows with the Reynolds number is
            // a transition or a wave. By chance one hull of several may show 0.02, which is 3 % of b for twice the speed.
            bounds: (-0.3, 0.02),
        }],
        reported_as: &[],
        reach: Reach::Hull,
        law: Law::Approximate,
        regime: "drag, with speed",
        shown_by: "several tow speeds",
    },
    Mechanism {
        name: "water_temperature",
        physics: "The temperature entered for one day is wrong: density and viscosity are another's",
        source: "ITTC 7.5-02-01-03, properties of water",
        parameters: &[Parameter {
            name: "water_temperature_error_c",
            unit: "degC",
            term: Term::Temperature,
            neutral: 0.0,
            prior_sd: PriorSd::Is(5.0),
            bounds: (-20.0, 20.0),
        }],
        reported_as: &[],
        reach: Reach::Day,
        law: Law::Exact,
        regime: "one day against the others",
        shown_by: "the same runs repeated on several days",
    },
    Mechanism {
        name: "port_starboard_asymmetry",
        physics: "Lift and moment slope differ between the sides: the hull, its strut or its vortices are not symmetrical",
        source: "Roddy 1990, DTRC/SHD-1298-08",
        parameters: &[Parameter {
            name: "asymmetry_ratio",
            unit: "1",
            term: Term::Asymmetry,
            neutral: 1.0,
            prior_sd: PriorSd::Is(0.15),
            bounds: (0.3, 3.0),
        }],
        reported_as: &[],
        reach: Reach::Hull,
        law: Law::Approximate,
        regime: "lift and moment, one side against the other",
        shown_by: "the same angles on both sides",
    },
    Mechanism {
        name: "blockage",
        physics: "Walls and bottom speed the water up past a model that stands across the tank: the dynamic pressure grows with the section that it and its wake take up",
        source: "Maskell 1963, ARC R&M 3400; Tamura 1972, SNAJ 131, 17-28",
        parameters: &[
            Parameter {
                name: "blockage_per_rad",
                unit: "1/rad",
                term: Term::BlockageLinear,
                neutral: 0.0,
                prior_sd: PriorSd::Is(0.3),
                bounds: (-0.5, 3.0),
            },
            Parameter {
                name: "blockage_per_rad2",
                unit: "1/rad^2",
                term: Term::BlockageSquare,
                neutral: 0.0,
                prior_sd: PriorSd::Is(1.0),
                bounds: (-2.0, 6.0),
            },
        ],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Approximate,
        regime: "lift, drag and moment alike, the more the larger the angle, on both sides",
        shown_by: "angles of 10 degrees and more, models of different length",
    },
    Mechanism {
        name: "free_surface",
        physics: "Waves: a bump of drag where the hull's length fits the waves of its speed",
        source: "Havelock 1931, Proc. Roy. Soc. A 131, 275-285",
        parameters: &[
            Parameter {
                name: "wave_drag_cd",
                unit: "1",
                term: Term::WaveDrag,
                neutral: 0.0,
                prior_sd: PriorSd::Is(0.02),
                bounds: (0.0, 0.3),
            },
            Parameter {
                name: "wave_froude_number",
                unit: "1",
                term: Term::WaveTop,
                neutral: WAVE_TOP,
                prior_sd: PriorSd::Is(0.05),
                bounds: (0.3, 0.7),
            },
            Parameter {
                name: "wave_width",
                unit: "1",
                term: Term::WaveWidth,
                neutral: WAVE_WIDTH,
                prior_sd: PriorSd::Is(0.03),
                bounds: (0.03, 0.3),
            },
        ],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Approximate,
        regime: "drag about one Froude number on the length, alike at all angles",
        shown_by: "several tow speeds with hulls of several lengths",
    },
    Mechanism {
        name: "wall_interference",
        physics: "A wall nearer on one side draws the model: a side force and a moment in proportion to the dynamic pressure, alike at all angles",
        source: "Norrbin 1974, 10th Symposium on Naval Hydrodynamics",
        parameters: &[
            Parameter {
                name: "wall_side_force",
                unit: "1",
                term: Term::WallSide,
                neutral: 0.0,
                prior_sd: PriorSd::Is(0.02),
                bounds: (-0.3, 0.3),
            },
            Parameter {
                name: "wall_moment",
                unit: "1",
                term: Term::WallMoment,
                neutral: 0.0,
                prior_sd: PriorSd::Is(0.02),
                bounds: (-0.3, 0.3),
            },
        ],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Approximate,
        regime: "lift and moment at zero angle, not in proportion to their slopes, at every speed",
        shown_by: "the same angles on both sides with several hulls, at two speeds or more",
    },
    Mechanism {
        name: "strut_interference",
        physics: "The strut's wake and its junction push the hull where it is held: a side force at the moment centre in proportion to sin(alpha)|sin(alpha)|, which no run of the strut alone shows",
        source: "Hoerner 1965, Fluid-dynamic drag, chapter 8",
        parameters: &[Parameter {
            name: "strut_interference_per_rad2",
            unit: "1/rad^2",
            term: Term::StrutInterference,
            neutral: 0.0,
            prior_sd: PriorSd::Is(1.0),
            bounds: (-20.0, 20.0),
        }],
        reported_as: &[],
        reach: Reach::Campaign,
        law: Law::Approximate,
        regime: "large angles, opposite on the two sides, in lift and not in the moment about where the model is held",
        shown_by: "a second strut without a function, or the model held by its tail",
    },
    Mechanism {
        name: "balance_hysteresis",
        physics: "The balance keeps a share of the last load: the zero of a run depends on the run before",
        source: "ISO 376, reversibility of force transducers; ITTC 7.5-02-06-02",
        parameters: &[Parameter {
            name: "hysteresis_share",
            unit: "1",
            term: Term::None,
            neutral: 0.0,
            prior_sd: PriorSd::Is(0.01),
            bounds: (-0.2, 0.2),
        }],
        reported_as: &[],
        reach: Reach::Before,
        law: Law::Approximate,
        regime: "runs after large loads, opposite after the two sides",
        shown_by: "random order of the runs, no zero between most of them",
    },
    Mechanism {
        name: "speed_scale",
        physics: "The carriage is faster than it reads by this factor",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[],
        reported_as: &[],
        reach: Reach::Absorbed,
        law: Law::Exact,
        regime: "all coefficients grow by its square, at every angle and speed alike",
        shown_by: "a check of the speed over a measured distance, or pure sway, whose drift velocity the mechanism sets and not the carriage",
    },
    Mechanism {
        name: "moment_centre_error",
        physics: "The moment centre of the balance lies elsewhere than the manifest says",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[],
        reported_as: &[],
        reach: Reach::Absorbed,
        law: Law::Exact,
        regime: "the moment gains a share of the side force, and d with it",
        shown_by: "a known side load hung on the model at a measured place, or runs about two moment centres",
    },
    Mechanism {
        name: "strut_tare",
        physics: "The strut's own force is still in the readings",
        source: "ITTC 7.5-02-06-02, captive model tests",
        parameters: &[],
        reported_as: &[],
        reach: Reach::Absorbed,
        law: Law::Approximate,
        regime: "b gains the strut's drag, a and c its side force",
        shown_by: "runs of the strut alone (kind `tare`) at the same speeds and angles",
    },
];

/// The mechanism of this name.
pub fn in_tank(name: &str) -> Option<&'static Mechanism> {
    IN_TANK.iter().find(|mechanism| mechanism.name == name)
}
