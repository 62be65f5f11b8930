//! The glide polar as a page: what `glidepolar glide --out` writes.

use crate::dynamics::forces::Flow;
use crate::dynamics::{Parameters, Surroundings};
use crate::glide::{Attitude, SteadyGlide, at_pitch, shallowest};
use crate::report::{
    Axis, Block, Cell, Explorer, Figure, Layer, Panel, Quantity, Report, Section, Slider, Table, paragraph, significant,
};
use crate::vehicle::Vehicle;

/// Beyond the angles at which hulls are towed the laws of lift and drag say nothing: a polar ends here \[deg\].
pub(super) const WIDEST_ANGLE_OF_ATTACK_DEG: f64 = 20.0;

type Glide = SteadyGlide<f64>;

/// Within it the laws of lift and drag are fitted to hull tests [deg].
const SMALL_ANGLE_DEG: f64 = 10.0;

/// The page of one glide or of the polar that was asked for, among the polars of the whole buoyancy engine.
pub(super) fn page(
    vehicle: &Vehicle,
    parameters: &Parameters<f64>,
    water: &Surroundings<f64>,
    glides: &[Glide],
) -> Report {
    let asked = glides.first().map_or(0.0, |glide| glide.net_mass_kg);
    let polars = Polars::new(parameters, water, asked);
    let limits = shallowest(parameters, water, glides.first().map_or(0.3, |glide| glide.speed_m_s));
    let subject = format!("{}, water of {:.1} kg/m³", vehicle.name, water.density_kg_m3);
    let mut report = Report::new("Glide polar", subject).finding(format!(
        "Paths shallower than {:.1}° down and {:.1}° up cannot be flown.",
        limits.descent_rad.to_degrees().abs(),
        limits.ascent_rad.to_degrees()
    ));
    if let [glide] = glides {
        report = report.finding(sentence("This glide", glide));
    } else {
        let best = |name: &str, size: fn(&Glide) -> f64| {
            let at = (0..glides.len()).min_by(|&i, &j| size(&glides[i]).total_cmp(&size(&glides[j])))?;
            let is_edge = at == 0 || at + 1 == glides.len();
            let name = if is_edge {
                format!("{name} (the edge of the range of pitch, not an optimum)")
            } else {
                name.to_owned()
            };
            let is_beyond = glides[at].angle_of_attack_rad.to_degrees().abs() > SMALL_ANGLE_DEG;
            let name = if is_beyond { format!("{name} (extrapolated, beyond ±{SMALL_ANGLE_DEG:.0}°)") } else { name };
            Some(sentence(&name, &glides[at]))
        };
        let ratio = best("Best glide ratio", |g| g.glide_angle_rad.abs());
        report.findings.extend(ratio.into_iter().chain(best("Minimum sink", |g| g.vertical_velocity_m_s.abs())));
    }
    let most = glides.iter().map(|g| g.angle_of_attack_rad.to_degrees().abs()).fold(0.0, f64::max);
    if most > SMALL_ANGLE_DEG {
        report = report.warning(format!(
            "Angles of attack reach {most:.0}°. The laws of lift and drag are those of small angles, fitted within ±{SMALL_ANGLE_DEG:.0}°; \
             beyond, speeds and paths are extrapolations, and beyond ±{WIDEST_ANGLE_OF_ATTACK_DEG:.0}° the polar ends."
        ));
    }
    for glide in glides {
        let reach = parameters.moving_mass_min_m..=parameters.moving_mass_max_m;
        if glides.len() == 1 && !reach.contains(&glide.moving_mass_m) {
            report = report.warning(format!(
                "The moving mass would have to stand {:.1} mm forward of the centre of buoyancy, and reaches {:.1} to {:.1} mm.",
                glide.moving_mass_m * 1e3,
                reach.start() * 1e3,
                reach.end() * 1e3
            ));
        }
    }
    report
        .section(
            Section::new("Polar")
                .text("Where the glider goes through the water, for the net masses that its buoyancy engine gives: a straight line from the origin is a glide path, and its steepness the glide angle.")
                .figure(polars.velocities(glides)),
        )
        .section(by_hand(parameters, water))
        .section(Section::new("Against pitch").figure(polars.against_pitch(parameters)))
        .section(Section::new("Coefficients").figure(coefficients(parameters, water, &polars)).block(source(vehicle)))
        .section(Section::new("Glides").folded().table(table(glides)))
}

fn sentence(what: &str, glide: &Glide) -> String {
    format!(
        "{what}: pitch {:.1}°, path {:.1}°, angle of attack {:.1}°, {:.3} m/s along the path, {:.3} m/s horizontally, {:.3} m/s {}.",
        glide.pitch_rad.to_degrees(),
        glide.glide_angle_rad.to_degrees(),
        glide.angle_of_attack_rad.to_degrees(),
        glide.speed_m_s,
        glide.horizontal_velocity_m_s,
        glide.vertical_velocity_m_s.abs(),
        if glide.vertical_velocity_m_s > 0.0 { "down" } else { "up" }
    )
}

fn source(vehicle: &Vehicle) -> Block {
    Block::Text(if vehicle.source.is_empty() {
        String::new()
    } else {
        format!("Source: {}", paragraph(&vehicle.source))
    })
}

/// One polar: all glides at one net mass, by pitch.
struct Polar {
    label: String,
    glides: Vec<Glide>,
}

struct Polars {
    /// The one that was asked for first, then others of the buoyancy engine, each for both legs.
    all: Vec<Polar>,
}

impl Polars {
    fn new(parameters: &Parameters<f64>, water: &Surroundings<f64>, asked: f64) -> Self {
        let heaviest = parameters.net_mass_kg(parameters.ballast_min_m3, water);
        let lightest = parameters.net_mass_kg(parameters.ballast_max_m3, water);
        let mut masses = vec![asked.abs()];
        // Halves and wholes of what the engine can do, where they differ visibly from what was asked for.
        let most = heaviest.abs().min(lightest.abs());
        let steps = [0.25, 0.5, 1.0].map(|share| share * most);
        masses.extend(steps.into_iter().filter(|m| *m > 0.0 && (m - asked.abs()).abs() > 0.1 * asked.abs()));
        let polar = |mass: f64| {
            let label = format!("{} kg heavy or light", significant(mass, 3));
            Polar { label, glides: [mass, -mass].into_iter().flat_map(|m| leg(parameters, water, m)).collect() }
        };
        Polars { all: masses.into_iter().filter(|m| *m > 0.0).map(polar).collect() }
    }

    fn velocities(&self, glides: &[Glide]) -> Figure {
        let all = self.all.iter().flat_map(|p| &p.glides).chain(glides);
        let fastest = all.map(|g| g.horizontal_velocity_m_s).fold(0.0, f64::max);
        let x = Axis::new("Horizontal speed", "V_x", "m/s").range(0.0, 1.04 * fastest);
        let mut panel = Panel::new(Axis::new("Vertical speed", "V_z", "m/s").reversed()).layer(Layer::at_y(0.0));
        for polar in &self.all {
            panel = panel.layers(legs(polar).map(|leg| {
                let (xs, ys) = columns(leg, |g| (g.horizontal_velocity_m_s, g.vertical_velocity_m_s));
                Layer::line(xs, ys).label(&polar.label)
            }));
        }
        if let [glide] = glides {
            let point = Layer::points(vec![glide.horizontal_velocity_m_s], vec![glide.vertical_velocity_m_s]);
            panel = panel.layer(point.label("this glide"));
        }
        Figure::new("polar", x).panel(panel).caption(
            "Vertical against horizontal speed through the water, descents below zero (downwards positive) and ascents above.",
        )
    }

    fn against_pitch(&self, parameters: &Parameters<f64>) -> Figure {
        let panel = |y: Axis, of: fn(&Glide) -> f64| {
            self.all.iter().fold(Panel::new(y), |panel, polar| {
                panel.layers(legs(polar).map(|leg| {
                    let (xs, ys) = columns(leg, |g| (g.pitch_rad.to_degrees(), of(g)));
                    Layer::line(xs, ys).label(&polar.label)
                }))
            })
        };
        let reach = [parameters.moving_mass_min_m, parameters.moving_mass_max_m].map(|r| Layer::at_y(r * 1e3));
        Figure::new("against-pitch", Axis::new("Pitch", "θ", "deg"))
            .panel(panel(Axis::new("Glide path angle", "ξ", "deg"), |g| g.glide_angle_rad.to_degrees()))
            .panel(panel(Axis::new("Angle of attack", "α", "deg"), |g| g.angle_of_attack_rad.to_degrees()))
            .panel(panel(Axis::new("Speed", "V", "m/s"), |g| g.speed_m_s))
            .panel(
                panel(Axis::new("Moving mass", "r_{p1}", "mm"), |g| g.moving_mass_m * 1e3)
                    .layers(reach),
            )
            .caption("Path, angle of attack, speed and the place of the moving mass that balances the pitching moment. Horizontal lines: how far the moving mass reaches.")
    }
}

/// Net masses of one leg on the slider.
const MASSES: usize = 12;

/// Steepest pitch on the slider \[deg\].
const STEEPEST_DEG: usize = 70;

fn by_hand(parameters: &Parameters<f64>, water: &Surroundings<f64>) -> Section {
    let section = Section::new("By net mass and pitch");
    match explorer(parameters, water) {
        explorer if explorer.curve.values.is_empty() => {
            section.text("The buoyancy engine makes the glider neither heavy nor light.")
        }
        explorer => section.block(Block::Explorer(Box::new(explorer))),
    }
}

/// The polar at any net mass that the buoyancy engine gives, and the glide at any pitch.
fn explorer(parameters: &Parameters<f64>, water: &Surroundings<f64>) -> Explorer {
    let heaviest = parameters.net_mass_kg(parameters.ballast_min_m3, water);
    let lightest = parameters.net_mass_kg(parameters.ballast_max_m3, water);
    let share = |most: f64| (1..=MASSES).map(move |i| (most * i as f64 / MASSES as f64 * 1e4).round() / 1e4);
    let mut masses: Vec<f64> = share(lightest).rev().filter(|mass| *mass < 0.0).collect();
    let heavy_from = masses.len();
    masses.extend(share(heaviest).filter(|mass| *mass > 0.0));
    let begins_at = (heavy_from + MASSES / 2).min(masses.len().saturating_sub(1));
    let pitches: Vec<f64> = (1..=STEEPEST_DEG).map(|pitch| pitch as f64).collect();
    let glide = |mass: f64, pitch: f64| {
        let pitch_rad = -mass.signum() * pitch.to_radians();
        at_pitch(parameters, water, Attitude { pitch_rad, net_mass_kg: mass }).ok().filter(is_within)
    };
    let all: Vec<Vec<Option<Glide>>> =
        masses.iter().map(|&mass| pitches.iter().map(|&pitch| glide(mass, pitch)).collect()).collect();
    let quantity = |axis: Axis, of: fn(&Glide) -> f64| {
        let value = |glide: &Option<Glide>| glide.as_ref().map_or(f64::NAN, of);
        Quantity { axis, values: all.iter().map(|glides| glides.iter().map(value).collect()).collect() }
    };
    let most = |of: fn(&Glide) -> f64| all.iter().flatten().flatten().map(of).fold(0.0, f64::max);
    let (along, down) = (most(|g| g.horizontal_velocity_m_s), most(|g| g.vertical_velocity_m_s));
    let up = most(|g| -g.vertical_velocity_m_s);
    let x = Axis::new("Horizontal speed", "V_x", "m/s").range(0.0, 1.04 * along);
    let y = Axis::new("Vertical speed, downwards", "V_z", "m/s").range(-1.04 * up, 1.04 * down).reversed();
    Explorer {
        caption: "The polar at one net mass, and the glide at one pitch. A glider is heavy on descents, with its nose down, and light \
                  on ascents, with its nose up."
            .to_owned(),
        curve: Slider { label: "Net mass".to_owned(), unit: "kg".to_owned(), values: masses, begins_at },
        point: Slider {
            label: "Pitch, down or up".to_owned(),
            unit: "deg".to_owned(),
            begins_at: 25.min(pitches.len() - 1),
            values: pitches,
        },
        x: quantity(x, |g| g.horizontal_velocity_m_s),
        y: quantity(y, |g| g.vertical_velocity_m_s),
        further: vec![
            quantity(Axis::new("Speed along the path", "V", "m/s"), |g| g.speed_m_s),
            quantity(Axis::new("Glide path", "ξ", "deg"), |g| g.glide_angle_rad.to_degrees()),
            quantity(Axis::new("Angle of attack", "α", "deg"), |g| g.angle_of_attack_rad.to_degrees()),
            quantity(Axis::new("Glide ratio", "", ""), |g| {
                (g.horizontal_velocity_m_s / g.vertical_velocity_m_s).abs()
            }),
            quantity(Axis::new("Moving mass, forward", "r_{p1}", "mm"), |g| g.moving_mass_m * 1e3),
        ],
    }
}

fn is_within(glide: &Glide) -> bool {
    glide.angle_of_attack_rad.to_degrees().abs() <= WIDEST_ANGLE_OF_ATTACK_DEG
}

/// Every half degree of pitch at which this net mass glides.
fn leg(parameters: &Parameters<f64>, water: &Surroundings<f64>, net_mass_kg: f64) -> Vec<Glide> {
    let nose = -net_mass_kg.signum();
    let glide = |halves: i32| {
        let pitch_rad = nose * (0.5 * f64::from(halves)).to_radians();
        at_pitch(parameters, water, Attitude { pitch_rad, net_mass_kg }).ok()
    };
    (1..=140).filter_map(glide).filter(is_within).collect()
}

/// Descents and ascents apart, so that no line joins them.
fn legs(polar: &Polar) -> impl Iterator<Item = &[Glide]> {
    polar.glides.chunk_by(|a, b| a.net_mass_kg.signum() == b.net_mass_kg.signum())
}

fn columns(glides: &[Glide], of: impl Fn(&Glide) -> (f64, f64)) -> (Vec<f64>, Vec<f64>) {
    glides.iter().map(of).unzip()
}

/// Lift and drag over the angles of attack of glides and somewhat beyond.
fn coefficients(parameters: &Parameters<f64>, water: &Surroundings<f64>, polars: &Polars) -> Figure {
    let flown = polars.all.iter().flat_map(|p| &p.glides);
    let angles: Vec<f64> = flown.clone().map(|g| g.angle_of_attack_rad.to_degrees()).collect();
    let widest = angles.iter().fold(4.0, |most: f64, angle| most.max(angle.abs()));
    let speed = polars.all.first().and_then(|p| p.glides.first()).map_or(0.3, |g| g.speed_m_s);
    let flow = |sink_m_s: f64| Flow {
        v1_m_s: speed,
        v3_m_s: 0.0,
        pitch_rate_rad_s: 0.0,
        sink_m_s,
        density_kg_m3: water.density_kg_m3,
        time_s: water.time_s,
        roll_rad: 0.0,
        rudder_rad: 0.0,
        empirical: parameters.empirical(water),
    };
    let pressure = 0.5 * water.density_kg_m3 * speed * speed;
    let at = |angle_deg: f64| {
        // A glider descends at positive angles of attack.
        let sink = if angle_deg > 0.0 { speed } else { -speed };
        parameters.coefficients(angle_deg.to_radians(), pressure, &flow(sink))
    };
    let panel = |label: &str, symbol: &str| Panel::new(Axis::new(label, symbol, "")).layer(Layer::at_x(0.0));
    // Apart, since the legs may have different coefficients.
    let both = |panel: Panel, of: &dyn Fn(f64) -> f64| {
        let edge = 1e-9;
        let down = Layer::curve(edge, widest, of).label("descents");
        panel.layer(down).layer(Layer::curve(-widest, -edge, of).label("ascents"))
    };
    Figure::new("coefficients", Axis::new("Angle of attack", "α", "deg").range(-widest, widest))
        .panel(both(panel("Lift coefficient", "C_L"), &|angle| at(angle).lift))
        .panel(both(panel("Drag coefficient", "C_D"), &|angle| at(angle).drag))
        .caption("Lift and drag on the frontal area, every mechanism of the vehicle included.")
}

fn table(glides: &[Glide]) -> Table {
    let columns = [
        "Pitch [deg]",
        "Path [deg]",
        "Angle of attack [deg]",
        "Speed [m/s]",
        "Horizontal [m/s]",
        "Down [m/s]",
        "Net mass [kg]",
        "Ballast [cc]",
        "Moving mass [mm]",
    ];
    let caption =
        "Steady glides. Ballast is the volume that gives the net mass, positive when it makes the glider more buoyant.";
    glides.iter().fold(Table::new(caption, columns), |table, g| {
        let cells = [
            (g.pitch_rad.to_degrees(), 1),
            (g.glide_angle_rad.to_degrees(), 2),
            (g.angle_of_attack_rad.to_degrees(), 2),
            (g.speed_m_s, 4),
            (g.horizontal_velocity_m_s, 4),
            (g.vertical_velocity_m_s, 4),
            (g.net_mass_kg, 4),
            (g.ballast_m3 * 1e6, 1),
            (g.moving_mass_m * 1e3, 2),
        ];
        table.row(cells.map(|(value, decimals)| Cell::fixed(value, decimals)))
    })
}
