//! A virtual sea: flight logs of underwater gliders with a hidden effect and known truth, to test a diagnosis blind.
//!
//! It shares nothing with the glidepolar library but the physics that both describe: equations of motion, ocean, pilot
//! and instruments are written here anew, from momentum balances in the inertial frame, so that an error of the one is
//! not repeated by the other. Seed and effect name give a log, the vehicle file that its owner believes in, and the truth:
//!
//! ```
//! use glidepolar_virtual_sea::{Options, catalogue, generate};
//! let sea = generate(&Options { effects: catalogue::parse_requests("leak=0.008")?, hours: 1.0, ..Options::seeded(7) });
//! assert_eq!(sea.truth.parameter("leak_kg_per_hour"), Some(0.008));
//! assert_eq!(sea.log.time_s[0], 0.0);
//! # Ok::<(), catalogue::RequestError>(())
//! ```
//!
//! What each effect is, exactly, stands in one table: [`catalogue::TABLE`]. What is always there, hidden effect or not:
//! internal waves of 10 min to 6 h that heave the stratification with them, shear, turbulence, unsteady flight with
//! added mass, lift that leans in a bank, measurement noise, slow wander of the pitch sensor, gaps. Roll, sideslip and yaw follow
//! from equations of motion where an effect turns the glider, or [`Options::lateral`] asks for them. Not there: waves at the
//! surface, hull temperature lagging the water's, thermal lag of the conductivity cell.

pub mod catalogue;
pub mod effects;
pub mod flight;
pub mod hidden;
pub mod lateral;
pub mod log;
pub mod motion;
pub mod ocean;
pub mod outside;
pub mod pilot;
pub mod random;
pub mod sensors;
pub mod shown;
pub mod truth;
pub mod vehicle;
pub mod worlds;

use catalogue::{Request, Turns};
use effects::Hidden;
use flight::{Instant, Voyage};
use lateral::LateralFigures;
use log::Log;
use ocean::{Ocean, Weather};
use random::{Part, chance, stream};
use sensors::{Instruments, Quality};
use truth::Truth;
use vehicle::Hull;

/// What to generate.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Everything that is drawn follows from it.
    pub seed: u64,
    /// The effects to hide.
    pub effects: Vec<Request>,
    /// Whether the log has a measured speed through the water.
    pub speed: bool,
    /// Duration of the log, hours.
    pub hours: f64,
    /// Dives that the pilot aims to make in this time; a coastal glider at its depth limit makes a few more.
    pub dives: u32,
    /// Kind of glider; drawn among the two Slocums where absent.
    pub hull: Option<Hull>,
    /// How rough the ocean is.
    pub weather: Weather,
    /// The instruments; drawn where absent.
    pub quality: Option<Quality>,
    /// Whether roll, sideslip and yaw follow from equations of motion; so it is where an effect needs them.
    pub lateral: bool,
}

impl Options {
    /// The usual log under a seed: 12 h, 14 dives, measured speed, nothing hidden.
    pub fn seeded(seed: u64) -> Self {
        Self {
            seed,
            effects: Vec::new(),
            speed: true,
            hours: 12.0,
            dives: 14,
            hull: None,
            weather: Weather::default(),
            quality: None,
            lateral: false,
        }
    }
}

/// A log with its vehicle file and its truth.
#[derive(Debug, Clone)]
pub struct Sea {
    /// What the glider recorded.
    pub log: Log,
    /// The vehicle as its owner believes it to be.
    pub vehicle_toml: String,
    /// What really happened.
    pub truth: Truth,
}

/// Generates a log.
pub fn generate(options: &Options) -> Sea {
    generate_observed(options, |_| {})
}

/// Generates a log and shows every step of the true flight to `observe`.
pub fn generate_observed(options: &Options, mut observe: impl FnMut(&Instant)) -> Sea {
    let seed = options.seed;
    let ocean = Ocean::draw(&mut stream(seed, Part::Ocean), options.weather);
    let random = &mut stream(seed, Part::Vehicle);
    let drawn_hull = if chance(random, 0.5) { Hull::Slocum200 } else { Hull::SlocumDeep };
    let turns = options.effects.iter().find_map(|request| request.effect.turns());
    // Of the gliders drawn here the Seaglider alone is steered by a roll mass.
    let drawn_hull = if turns == Some(Turns::ByRollMass) { Hull::Seaglider } else { drawn_hull };
    let hull = options.hull.unwrap_or(drawn_hull);
    let vehicle = hull.draw(random, &ocean);
    let believed = vehicle.believed(random);
    let effects = catalogue::draw(&options.effects, &vehicle, seed, options.hours);
    let mut hidden = Hidden::new(&effects, &vehicle);
    let lateral = (options.lateral || turns.is_some())
        .then(|| LateralFigures::draw(&mut stream(seed, Part::LateralFigures), hull));
    hidden.roll_offset_rad += lateral.map_or(0.0, |figures| figures.roll_zero_rad);
    hidden.pitch_per_roll += lateral.map_or(0.0, |figures| figures.pitch_per_roll);
    let legs = pilot::plan(&vehicle, &ocean, &mut stream(seed, Part::Mission), options.hours, options.dives.max(1));

    let mut random = stream(seed, Part::Sensors);
    let quality = options.quality.unwrap_or(Quality::draw(&mut random));
    let mut instruments = Instruments::new(&hidden, quality, random, options.speed);
    let mut dives = 0;
    let voyage = Voyage {
        vehicle: &vehicle,
        believed: &believed,
        ocean: &ocean,
        hidden: &hidden,
        legs: &legs,
        duration_s: options.hours * 3600.0,
        seed,
        lateral,
    };
    flight::fly(&voyage, |now| {
        instruments.see(now);
        dives = dives.max(now.dive);
        observe(now);
    });
    let vehicle_toml = believed.to_toml(&format!("glider {seed:03}"));
    let log = instruments.into_log();
    Sea { log, vehicle_toml, truth: Truth { seed, effects, hull, vehicle, believed, ocean, quality, dives, lateral } }
}
