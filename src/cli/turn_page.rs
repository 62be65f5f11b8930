//! Steady turns as a page: what `glidepolar turn --out` writes.

use crate::report::{Axis, Block, Cell, Dash, Figure, Layer, Panel, Report, Section, Table, paragraph};
use crate::spatial::Body;
use crate::spatial::turn::{ROLLS_DEG, SIDESLIPS_DEG, Setting, TURN_RATES_RAD_S, Trim, Turn, continued};
use crate::vehicle::Vehicle;

/// Points of a polar on each side of the straight glide.
const POINTS: usize = 30;

/// One setting and its steady turns.
pub(super) struct Case {
    pub setting: Setting,
    pub turns: Vec<Turn>,
}

/// The turns that were asked for, and the polar of everything that makes this vehicle turn.
pub(super) fn page(vehicle: &Vehicle, body: &Body<f64>, cases: &[Case]) -> Report {
    let mut report = Report::new("Steady turns", vehicle.name.clone());
    for turn in cases.iter().take(1).flat_map(|case| &case.turns) {
        report = report.finding(sentence(turn));
    }
    report = match sense(vehicle, body, &cases[0]) {
        Ok(Some(finding)) => report.finding(finding),
        Ok(None) => report,
        Err(warning) => report.warning(warning),
    };
    let mut polars = Section::new("Turn polar").text(
        "Turn rate, radius, sink rate and roll, continued from the straight glide at the same net mass and trim, on both legs. Broken lines: unstable.",
    );
    for steering in [Steering::RollMass, Steering::Rudder] {
        if let Some((figure, least)) = polar(body, &cases[0].setting, steering) {
            polars = polars.figure(figure);
            report = report.finding(least);
        }
    }
    report
        .section(polars)
        .section(Section::new("Turns").table(table(cases)).text(starts()))
        .section(Section::new("Eigenvalues").folded().table(eigenvalues(cases)))
        .section(Section::new("Source").block(Block::Text(paragraph(&vehicle.source))))
}

/// What the sense of turning on the two legs says of this vehicle. A roll mass turns public Seagliders and SeaExplorers one way
/// on descents and the other on ascents; a rudder turns to its side on both.
///
/// # Errors
/// The warning, where the vehicle turns otherwise.
pub(super) fn sense(vehicle: &Vehicle, body: &Body<f64>, case: &Case) -> Result<Option<String>, String> {
    // The ascent is flown at the descent's pitch, nose up: where its moving mass would stand is not known.
    let pitch = case.turns.first().map(|turn| Trim::Pitch(turn.pitch_rad));
    let setting = &Setting { trim: pitch.unwrap_or(case.setting.trim), ..case.setting };
    let steering = match (setting.rudder_rad != 0.0, setting.roll_mass_rad != 0.0) {
        (true, false) => Steering::Rudder,
        (false, true) => Steering::RollMass,
        _ => return Ok(None),
    };
    let command = steering.command(setting);
    let [descent, ascent] = [1.0, -1.0].map(|leg| continued(body, &steering.set(on_leg(setting, leg), command), None));
    let (Some(descent), Some(ascent)) = (descent, ascent) else { return Ok(None) };
    let side = |turn: &Turn| if turn.turn_rate_rad_s > 0.0 { "starboard" } else { "port" };
    let to = format!("{}: descents turn to {}, ascents to {}", steering.words(command), side(&descent), side(&ascent));
    let as_real = match steering {
        Steering::RollMass => {
            descent.turn_rate_rad_s * descent.roll_rad < 0.0 && ascent.turn_rate_rad_s * ascent.roll_rad > 0.0
        }
        Steering::Rudder => descent.turn_rate_rad_s * command > 0.0 && ascent.turn_rate_rad_s * command > 0.0,
    };
    match (as_real, steering) {
        (true, _) => Ok(Some(format!("{to}, as on real gliders."))),
        (false, Steering::RollMass) => Err(format!(
            "{}: {to}. Public Seagliders and SeaExplorers turn against their roll on descents and with it on ascents: \
             the coefficients of one of these legs do not hold on the other",
            vehicle.name
        )),
        (false, Steering::Rudder) => {
            Err(format!("{}: {to}. Real gliders turn to the side of their rudder", vehicle.name))
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Steering {
    RollMass,
    Rudder,
}

impl Steering {
    fn command(self, setting: &Setting) -> f64 {
        match self {
            Steering::RollMass => setting.roll_mass_rad,
            Steering::Rudder => setting.rudder_rad,
        }
    }

    fn set(self, setting: Setting, rad: f64) -> Setting {
        match self {
            Steering::RollMass => Setting { roll_mass_rad: rad, rudder_rad: 0.0, ..setting },
            Steering::Rudder => Setting { rudder_rad: rad, roll_mass_rad: 0.0, ..setting },
        }
    }

    fn words(self, rad: f64) -> String {
        let what = if self == Steering::RollMass { "Roll mass" } else { "Rudder" };
        format!("{what} at {:.1}°", rad.to_degrees())
    }
}

/// The same setting on the descent (1) or the ascent (-1): net mass and pitch of the other sign where they are another leg's.
fn on_leg(setting: &Setting, leg: f64) -> Setting {
    let turn_over = setting.net_mass_kg * leg < 0.0;
    let trim = match setting.trim {
        Trim::Pitch(pitch) if turn_over => Trim::Pitch(-pitch),
        trim => trim,
    };
    Setting { net_mass_kg: setting.net_mass_kg.abs() * leg, trim, ..*setting }
}

/// What a panel of the polar shows: label, symbol, unit, value.
type Quantity = (&'static str, &'static str, &'static str, fn(&Turn) -> f64);

/// The polar of one way to steer over its whole range, and the least radius; none where the vehicle has none.
fn polar(body: &Body<f64>, setting: &Setting, steering: Steering) -> Option<(Figure, String)> {
    let l = &body.lateral;
    let (low, high, is_there, name, label, symbol) = match steering {
        Steering::RollMass => {
            let is_there = l.roll_mass_kg * l.roll_mass_radius_m > 0.0;
            (l.roll_mass_min_rad, l.roll_mass_max_rad, is_there, "polar-roll-mass", "Roll mass", "γ")
        }
        Steering::Rudder => {
            let is_there = l.rudder_CN_per_rad != 0.0;
            (l.rudder_min_rad, l.rudder_max_rad, is_there, "polar-rudder", "Rudder", "δ")
        }
    };
    // Beyond a quarter turn a mass hangs upside down, and a rudder is a brake.
    let (low, high) = (f64::max(low, -std::f64::consts::FRAC_PI_2), f64::min(high, std::f64::consts::FRAC_PI_2));
    if !is_there || low >= high {
        return None;
    }
    let mut figure = Figure::new(name, Axis::new(label, symbol, "deg"));
    let legs = [(1.0, "descent"), (-1.0, "ascent")].map(|(leg, label)| {
        let setting = on_leg(setting, leg);
        let mut points = Vec::new();
        for end in [low, high] {
            let mut last: Option<Turn> = None;
            let mut side = Vec::new();
            for i in 0..=POINTS {
                let command = end * i as f64 / POINTS as f64;
                let Some(turn) = continued(body, &steering.set(setting, command), last.as_ref()) else { break };
                side.push((command.to_degrees(), turn.clone()));
                last = Some(turn);
            }
            if end == low {
                side.reverse();
                side.pop();
            }
            points.append(&mut side);
        }
        (label, points)
    });
    let quantities: [Quantity; 4] = [
        ("Turn rate", "ω", "deg/s", |t| t.turn_rate_rad_s.to_degrees()),
        ("Radius", "R", "m", |t| if t.is_straight() || t.radius_m > 1000.0 { f64::NAN } else { t.radius_m }),
        ("Sink rate", "V_z", "m/s", |t| t.vertical_velocity_m_s),
        ("Roll", "φ", "deg", |t| t.roll_rad.to_degrees()),
    ];
    for (label, symbol, unit, of) in quantities {
        let mut panel = Panel::new(Axis::new(label, symbol, unit));
        for (slot, (leg, points)) in legs.iter().enumerate() {
            for part in points.chunk_by(|a, b| a.1.stable == b.1.stable) {
                let (xs, ys) = part.iter().map(|(x, turn)| (*x, of(turn))).unzip();
                let line = Layer::line(xs, ys).label(*leg).slot(slot);
                panel = panel.layer(if part[0].1.stable { line } else { line.dash(Dash::Dotted) });
            }
        }
        figure = figure.panel(panel);
    }
    let least = legs.iter().map(|(leg, points)| {
        let tightest = points.iter().filter(|(_, t)| t.stable).min_by(|a, b| a.1.radius_m.total_cmp(&b.1.radius_m));
        match tightest {
            Some((at, turn)) => format!("{:.1} m on the {leg} at {:.0}°", turn.radius_m, at.abs()),
            None => format!("no stable turn on the {leg}"),
        }
    });
    let least: Vec<String> = least.collect();
    let found = format!("{label}: least radius of a stable turn {}.", least.join(", "));
    let caption = format!(
        "Steady turns against the angle of the {}, at a net mass of {:.3} kg heavy or light. Radii above 1000 m are left out.",
        label.to_lowercase(),
        setting.net_mass_kg.abs()
    );
    Some((figure.caption(caption), found))
}

fn sentence(turn: &Turn) -> String {
    let path = if turn.is_straight() {
        "straight".to_owned()
    } else {
        let side = if turn.turn_rate_rad_s > 0.0 { "starboard" } else { "port" };
        format!(
            "to {side} at {:.4} deg/s on a radius of {:.1} m",
            turn.turn_rate_rad_s.to_degrees().abs(),
            turn.radius_m
        )
    };
    format!(
        "{}: {path}, roll {:.2}°, pitch {:.2}°, {:.3} m/s, {:.3} m/s {}.",
        if turn.stable { "Stable" } else { "Unstable" },
        turn.roll_rad.to_degrees(),
        turn.pitch_rad.to_degrees(),
        turn.speed_m_s,
        turn.vertical_velocity_m_s.abs(),
        if turn.vertical_velocity_m_s > 0.0 { "down" } else { "up" }
    )
}

fn starts() -> String {
    let list = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    format!(
        "Solutions are found by Newton's method from every straight glide with this net mass and trim, followed as roll mass, rudder \
         and lists grow from zero, and from {} further starts about each: roll {} deg, turn rate {} rad/s, sideslip {} deg. \
         Others may exist.",
        ROLLS_DEG.len() * TURN_RATES_RAD_S.len() * SIDESLIPS_DEG.len(),
        list(&ROLLS_DEG),
        list(&TURN_RATES_RAD_S),
        list(&SIDESLIPS_DEG)
    )
}

fn table(cases: &[Case]) -> Table {
    let columns = [
        "Roll mass [deg]",
        "Rudder [deg]",
        "Roll [deg]",
        "Pitch [deg]",
        "Angle of attack [deg]",
        "Sideslip [deg]",
        "Speed [m/s]",
        "Down [m/s]",
        "Turn rate [deg/s]",
        "Radius [m]",
        "Moving mass [mm]",
        "Stable",
    ];
    let mut table =
        Table::new("Steady turns. Down is positive; turn rates are positive clockwise from above.", columns);
    for case in cases {
        for turn in &case.turns {
            let mut cells: Vec<Cell> = [
                (case.setting.roll_mass_rad.to_degrees(), 1),
                (case.setting.rudder_rad.to_degrees(), 1),
                (turn.roll_rad.to_degrees(), 3),
                (turn.pitch_rad.to_degrees(), 3),
                (turn.angle_of_attack_rad.to_degrees(), 3),
                (turn.sideslip_rad.to_degrees(), 3),
                (turn.speed_m_s, 4),
                (turn.vertical_velocity_m_s, 4),
                (turn.turn_rate_rad_s.to_degrees(), 5),
            ]
            .map(|(value, decimals)| Cell::fixed(value, decimals))
            .into();
            cells.push(if turn.is_straight() { Cell::from("straight") } else { Cell::fixed(turn.radius_m, 1) });
            cells.push(Cell::fixed(turn.moving_mass_m * 1e3, 2));
            cells.push(Cell::from(if turn.stable { "yes" } else { "no" }));
            table.push(cells);
        }
    }
    table
}

fn eigenvalues(cases: &[Case]) -> Table {
    let columns = ["Roll mass [deg]", "Rudder [deg]", "Turn rate [deg/s]", "Eigenvalues [1/s]"];
    let mut table = Table::new(
        "Eigenvalues of roll, pitch, velocities and rates about each turn, masses and rudder fixed.",
        columns,
    );
    for case in cases {
        for turn in &case.turns {
            let text: Vec<String> = turn
                .eigenvalues
                .iter()
                .map(|[re, im]| if *im == 0.0 { format!("{re:.4}") } else { format!("{re:.4}{im:+.4}i") })
                .collect();
            table.push([
                Cell::fixed(case.setting.roll_mass_rad.to_degrees(), 1),
                Cell::fixed(case.setting.rudder_rad.to_degrees(), 1),
                Cell::fixed(turn.turn_rate_rad_s.to_degrees(), 5),
                Cell::from(text.join(", ").as_str()),
            ]);
        }
    }
    table
}
