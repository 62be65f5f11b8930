//! What can be wrong in a virtual tank: one table of effects, from which the command line's help, the drawn sizes, the
//! checks and the stated truth follow. How each one acts on the water, the rig or the paperwork stands with the part
//! that it acts on; nothing here is a term that a reduction could fit.

use std::fmt::Write as _;

use super::effects::{
    Bubble, CHANNELS, Gyre, RectifiedVibration, Seiche, TornStrip, Touching, Transition, Wall, WarmUp, Weed,
    WrongTemperature,
};
use super::entry::{Draw, Entry};

/// The catalogue as text for a terminal: one effect per paragraph.
pub fn catalogue_text() -> String {
    let mut text = String::from("Effects (none hides nothing):\n");
    for entry in CATALOGUE {
        let unit = if entry.unit.is_empty() { String::new() } else { format!(" [{}]", entry.unit) };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {}: {}{unit}\n      {}", entry.name, entry.parameter, entry.meaning);
    }
    text
}

/// Every effect by name. `none` is accepted too and hides nothing.
pub const CATALOGUE: &[Entry] = &[
    Entry {
        name: "crossflow",
        parameter: "crossflow_per_rad2",
        unit: "1/rad^2",
        meaning: "viscous crossflow drag of the hull's strips; size is the normal-force coefficient per sin(alpha)|sin(alpha)| on frontal area",
        bounds: (0.0, 20.0),
        draw: Draw::Between(2.5, 6.0),
        act: |hidden, size, _| put(&mut hidden.crossflow_per_rad2, size),
    },
    Entry {
        name: "yaw_misalignment",
        parameter: "yaw_misalignment_deg",
        unit: "deg",
        meaning: "true yaw angle = recorded yaw angle + this, every run",
        bounds: (-10.0, 10.0),
        draw: Draw::EitherSign(0.3, 1.0),
        act: |hidden, size, _| put(&mut hidden.yaw_misalignment_deg, size),
    },
    Entry {
        name: "side_force_zero",
        parameter: "side_force_zero_N",
        unit: "N",
        meaning: "the SF reading shifts by this as soon as a model is under way, after its zero was taken at rest",
        bounds: (-50.0, 50.0),
        draw: Draw::EitherSign(0.4, 1.5),
        act: |hidden, size, _| put(&mut hidden.shift_under_way[1], size),
    },
    Entry {
        name: "axial_force_zero",
        parameter: "axial_force_zero_N",
        unit: "N",
        meaning: "the AF reading shifts by this as soon as a model is under way, after its zero was taken at rest",
        bounds: (-50.0, 50.0),
        draw: Draw::EitherSign(0.2, 0.6),
        act: |hidden, size, _| put(&mut hidden.shift_under_way[0], size),
    },
    Entry {
        name: "yaw_moment_zero",
        parameter: "yaw_moment_zero_N_m",
        unit: "N m",
        meaning: "the YM reading shifts by this as soon as a model is under way, after its zero was taken at rest",
        bounds: (-50.0, 50.0),
        draw: Draw::EitherSign(0.3, 1.0),
        act: |hidden, size, _| put(&mut hidden.shift_under_way[2], size),
    },
    Entry {
        name: "interaction",
        parameter: "af_from_sf",
        unit: "",
        meaning: "AF shows this fraction of SF beyond what the stated interaction matrix removes",
        bounds: (-0.5, 0.5),
        draw: Draw::EitherSign(0.01, 0.04),
        act: |hidden, size, _| put(&mut hidden.af_from_sf, size),
    },
    Entry {
        name: "moment_centre_error",
        parameter: "moment_centre_error_m",
        unit: "m",
        meaning: "the balance's moment centre lies this far aft of where the manifest says",
        bounds: (-0.5, 0.5),
        draw: Draw::EitherSign(0.01, 0.05),
        act: |hidden, size, _| put(&mut hidden.moment_centre_error_m, size),
    },
    Entry {
        name: "speed_scale",
        parameter: "speed_scale",
        unit: "",
        meaning: "true speed = recorded speed x this, every run",
        bounds: (0.5, 2.0),
        draw: Draw::AboutOne(0.01, 0.04),
        act: |hidden, size, _| put(&mut hidden.speed_scale, size),
    },
    Entry {
        name: "zero_drift",
        parameter: "zero_drift_N_per_hour",
        unit: "N/h",
        meaning: "rate at which one channel's zero starts to run away at the morning's switching-on, beside its even drift; settles exponentially",
        bounds: (-50.0, 50.0),
        draw: Draw::EitherSign(2.0, 5.0),
        act: |hidden, size, stream| {
            let warm_up =
                WarmUp { channel: stream.index(2), rate_per_hour: size, time_constant_h: stream.between(0.5, 0.9) };
            hidden.warm_up = Some(warm_up);
            format!("channel {}, time constant {:.4} h", CHANNELS[warm_up.channel], warm_up.time_constant_h)
        },
    },
    Entry {
        name: "strut_tare",
        parameter: "strut_tare_N",
        unit: "N",
        meaning: "no tare runs are made; size is the strut's axial force at 2 m/s and zero yaw",
        bounds: (0.0, 20.0),
        draw: Draw::Between(1.0, 2.5),
        act: |hidden, size, _| put(&mut hidden.untared_strut_n, Some(size)),
    },
    Entry {
        name: "reynolds_drag",
        parameter: "drag_exponent",
        unit: "",
        meaning: "b follows a friction line; size is its local exponent of dynamic pressure at 2 m/s (b is stated for 2 m/s)",
        bounds: (-0.5, 0.5),
        draw: Draw::Between(-0.22, -0.08),
        act: |hidden, size, _| put(&mut hidden.drag_exponent, size),
    },
    Entry {
        name: "water_temperature",
        parameter: "water_temperature_error_c",
        unit: "C",
        meaning: "recorded temperature = true temperature + this, for one day's runs",
        bounds: (-15.0, 20.0),
        draw: Draw::EitherSign(5.0, 9.0),
        act: |hidden, size, stream| {
            hidden.wrong_temperature = Some(WrongTemperature { error_c: size, day_fraction: stream.between(0.0, 1.0) });
            String::new()
        },
    },
    Entry {
        name: "port_starboard_asymmetry",
        parameter: "asymmetry_ratio",
        unit: "",
        meaning: "lift and moment at positive angles over those at the same negative angles; a and d are stated for the mean of both sides",
        bounds: (0.3, 3.0),
        draw: Draw::AboutOne(0.05, 0.15),
        act: |hidden, size, _| put(&mut hidden.asymmetry_ratio, size),
    },
    Entry {
        name: "free_surface",
        parameter: "wave_drag_cd",
        unit: "",
        meaning: "wave-making drag of a hull too close to the surface, humps at Froude numbers 0.34 and 0.50; size is the greater hump in CD",
        bounds: (0.0, 0.2),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, _| put(&mut hidden.wave_hump_cd, size),
    },
    Entry {
        name: "uncatalogued-gyre",
        parameter: "gyre_current_m_s",
        unit: "m/s",
        meaning: "slow circulation of the tank's water: a transverse current that swings with the time of day and along the tank",
        bounds: (0.0, 0.2),
        draw: Draw::Between(0.01, 0.025),
        act: |hidden, size, stream| {
            let gyre = Gyre {
                current_m_s: size,
                period_s: stream.between(2100.0, 3600.0),
                phase_rad: stream.between(0.0, std::f64::consts::TAU),
            };
            hidden.gyre = Some(gyre);
            format!("period {:.0} s", gyre.period_s)
        },
    },
    Entry {
        name: "uncatalogued-separation-bubble",
        parameter: "lift_loss",
        unit: "",
        meaning: "CL lost, within a degree, beyond one angle on one side, where a laminar bubble bursts; CD gains a fifth of it",
        bounds: (-0.5, 0.5),
        draw: Draw::Between(0.05, 0.12),
        act: |hidden, size, stream| {
            let bubble =
                Bubble { lift_loss: size, onset_rad: stream.between(5.0, 9.0).to_radians(), side: stream.sign() };
            hidden.bubble = Some(bubble);
            let side = if bubble.side > 0.0 { "starboard" } else { "port" };
            format!("bow to {side} beyond {:.2} deg", bubble.onset_rad.to_degrees())
        },
    },
    Entry {
        name: "uncatalogued-residual-current",
        parameter: "residual_current_ratio",
        unit: "",
        meaning: "the water still follows the run before: current after it as a fraction of its speed, dying out over six minutes of waiting",
        bounds: (0.0, 0.3),
        draw: Draw::Between(0.04, 0.10),
        act: |hidden, size, _| put(&mut hidden.residual_current, size),
    },
    Entry {
        name: "uncatalogued-weed",
        parameter: "weed_cd",
        unit: "",
        meaning: "something caught on the model from one run on until the hull is changed, added to CD",
        bounds: (0.0, 0.2),
        draw: Draw::Between(0.008, 0.02),
        act: |hidden, size, stream| {
            hidden.weed = Some(Weed {
                drag_coefficient: size,
                hull_fraction: stream.between(0.0, 1.0),
                run_fraction: stream.between(0.3, 0.7),
            });
            String::new()
        },
    },
    Entry {
        name: "uncatalogued-vibration",
        parameter: "vibration_side_force_N",
        unit: "N",
        meaning: "carriage vibration that the balance turns into a mean side force at 2 m/s; it varies with the yaw angle",
        bounds: (0.0, 10.0),
        draw: Draw::Between(0.3, 0.8),
        act: |hidden, size, stream| {
            let vibration = RectifiedVibration {
                side_force_n: size,
                period_rad: stream.between(3.0, 6.0).to_radians(),
                phase_rad: stream.between(0.0, std::f64::consts::TAU),
            };
            hidden.vibration = Some(vibration);
            format!("once in {:.2} deg", vibration.period_rad.to_degrees())
        },
    },
    Entry {
        name: "blockage",
        parameter: "blockage_section_ratio",
        unit: "",
        meaning: "the water must pass the model within the tank's section: size is the frontal area over that section; across the tank the model takes up more",
        bounds: (0.0, 0.05),
        draw: Draw::Between(0.005, 0.015),
        act: |hidden, size, _| put(&mut hidden.blockage_section_ratio, size),
    },
    Entry {
        name: "uncatalogued-transition",
        parameter: "transition_cd",
        unit: "",
        meaning: "CD saved below one speed, where the boundary layer stays laminar further aft",
        bounds: (0.0, 0.1),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, stream| {
            let transition = Transition { drag_saved: size, speed_m_s: stream.between(1.15, 2.85) };
            hidden.transition = Some(transition);
            format!("at {:.2} m/s", transition.speed_m_s)
        },
    },
    Entry {
        name: "wrong-sign",
        parameter: "channel_sign",
        unit: "",
        meaning: "the SF or the YM column is recorded with the opposite sign, zeros included",
        bounds: (-1.0, -1.0),
        draw: Draw::Between(-1.0, -1.0),
        act: |hidden, _, stream| {
            let channel = 1 + stream.index(2);
            hidden.flipped[channel] = true;
            format!("channel {}", CHANNELS[channel])
        },
    },
    Entry {
        name: "wrong-sign-sf",
        parameter: "channel_sign",
        unit: "",
        meaning: "the SF column is recorded with the opposite sign, zeros included",
        bounds: (-1.0, -1.0),
        draw: Draw::Between(-1.0, -1.0),
        act: |hidden, _, _| {
            hidden.flipped[1] = true;
            "channel SF".to_owned()
        },
    },
    Entry {
        name: "wrong-sign-ym",
        parameter: "channel_sign",
        unit: "",
        meaning: "the YM column is recorded with the opposite sign, zeros included",
        bounds: (-1.0, -1.0),
        draw: Draw::Between(-1.0, -1.0),
        act: |hidden, _, _| {
            hidden.flipped[2] = true;
            "channel YM".to_owned()
        },
    },
    Entry {
        name: "wall_interference",
        parameter: "wall_side_force",
        unit: "",
        meaning: "a wall nearer on one side draws the model: side force coefficient on frontal area, acting an arm ahead of the centre of buoyancy",
        bounds: (-0.3, 0.3),
        draw: Draw::EitherSign(0.008, 0.03),
        act: |hidden, size, stream| {
            let arm_lengths = stream.sign() * stream.between(0.1, 0.5);
            hidden.wall = Some(Wall { side_force: size, arm_lengths });
            format!("{arm_lengths:.3} lengths ahead")
        },
    },
    Entry {
        name: "strut_interference",
        parameter: "strut_interference_per_rad2",
        unit: "1/rad^2",
        meaning: "the strut's wake pushes the hull where it is held: normal-force coefficient per sin(alpha)|sin(alpha)| on frontal area, at the moment centre",
        bounds: (-20.0, 20.0),
        draw: Draw::EitherSign(0.5, 1.5),
        act: |hidden, size, _| put(&mut hidden.strut_interference_per_rad2, size),
    },
    Entry {
        name: "balance_hysteresis",
        parameter: "hysteresis_share",
        unit: "",
        meaning: "share of the last run's steady load that the balance still shows, until the next load or the next day",
        bounds: (-0.2, 0.2),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, _| put(&mut hidden.hysteresis_share, size),
    },
    Entry {
        name: "uncatalogued-soft-balance",
        parameter: "softening_per_N",
        unit: "1/N",
        meaning: "SF reads less than in proportion: reading = force / (1 + this |force|)",
        bounds: (0.0, 0.05),
        draw: Draw::Between(0.002, 0.006),
        act: |hidden, size, _| put(&mut hidden.softening_per_n, size),
    },
    Entry {
        name: "uncatalogued-strut-lock-in",
        parameter: "lock_in_cd",
        unit: "",
        meaning: "the strut with a model below it rings with its vortices about one speed: CD gains this there, alike at all angles, at one speed whatever the hull",
        bounds: (0.0, 0.2),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, stream| {
            let transition = Transition { drag_saved: size, speed_m_s: stream.between(1.4, 2.6) };
            hidden.lock_in = Some(transition);
            format!("at {:.2} m/s", transition.speed_m_s)
        },
    },
    Entry {
        name: "uncatalogued-stall",
        parameter: "stall_lift_loss",
        unit: "",
        meaning: "CL lost beyond one angle on both sides, where the flow leaves the tail; CM loses a third of it",
        bounds: (0.0, 0.5),
        draw: Draw::Between(0.03, 0.08),
        act: |hidden, size, stream| {
            let onset_rad = stream.between(7.0, 11.0).to_radians();
            hidden.stall = Some(Bubble { lift_loss: size, onset_rad, side: 1.0 });
            format!("beyond {:.2} deg", onset_rad.to_degrees())
        },
    },
    Entry {
        name: "uncatalogued-speed-slip",
        parameter: "speed_slip",
        unit: "",
        meaning: "the carriage's measuring wheel slips: relative error of the recorded speed, a standard deviation from run to run",
        bounds: (0.0, 0.1),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, _| put(&mut hidden.rig.speed_slip, size),
    },
    Entry {
        name: "uncatalogued-sting-resonance",
        parameter: "resonance_share",
        unit: "",
        meaning: "the sting rings about one speed and the balance shows a larger moment there: share of YM",
        bounds: (-0.5, 0.5),
        draw: Draw::EitherSign(0.04, 0.12),
        act: |hidden, size, stream| {
            let speed_m_s = stream.between(1.2, 2.8);
            hidden.rig.resonance = Some((size, speed_m_s));
            format!("at {speed_m_s:.2} m/s")
        },
    },
    Entry {
        name: "uncatalogued-torn-strip",
        parameter: "strip_cd",
        unit: "",
        meaning: "the transition strip is partly torn off one hull: CD saved there below one speed, more on one side",
        bounds: (0.0, 0.1),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, stream| {
            let strip = TornStrip {
                drag_saved: size,
                speed_m_s: stream.between(1.3, 2.7),
                hull_fraction: stream.between(0.0, 1.0),
                side: stream.sign(),
            };
            hidden.rig.torn_strip = Some(strip);
            format!("below {:.2} m/s", strip.speed_m_s)
        },
    },
    Entry {
        name: "uncatalogued-dead-water",
        parameter: "dead_water_cd",
        unit: "",
        meaning: "the water settles in layers during the day: CD gained about 1 m/s, in proportion to the hours",
        bounds: (0.0, 0.2),
        draw: Draw::Between(0.02, 0.05),
        act: |hidden, size, _| put(&mut hidden.rig.dead_water_cd, size),
    },
    Entry {
        name: "uncatalogued-flipped-block",
        parameter: "flipped_runs",
        unit: "",
        meaning: "so many runs in a row of every hull are written down with the other sign of yaw",
        bounds: (1.0, 20.0),
        draw: Draw::Between(3.0, 6.0),
        act: |hidden, size, stream| {
            hidden.rig.flipped_block = Some((stream.between(0.2, 0.7), size.round() as usize));
            String::new()
        },
    },
    Entry {
        name: "uncatalogued-seiche",
        parameter: "seiche_ratio",
        unit: "",
        meaning: "a standing wave of the tank that the run before started: current over that run's speed, with the phase that the waiting time leaves it",
        bounds: (0.0, 0.3),
        draw: Draw::Between(0.04, 0.1),
        act: |hidden, size, stream| {
            let seiche =
                Seiche { ratio: size, period_s: stream.between(30.0, 90.0), decay_s: stream.between(300.0, 900.0) };
            hidden.rig.seiche = Some(seiche);
            format!("period {:.0} s", seiche.period_s)
        },
    },
    Entry {
        name: "uncatalogued-cable",
        parameter: "cable_N_m_per_deg",
        unit: "N m/deg",
        meaning: "a cable that the yaw table twists pulls the balance: moment per degree at any speed, at rest too; zeros are taken straight ahead",
        bounds: (-1.0, 1.0),
        draw: Draw::EitherSign(0.02, 0.08),
        act: |hidden, size, stream| {
            hidden.rig.cable_per_deg = (size, size * stream.between(-2.0, 2.0));
            format!("side force {:.3} N/deg", hidden.rig.cable_per_deg.1)
        },
    },
    Entry {
        name: "uncatalogued-yaw-slip",
        parameter: "yaw_slip_deg",
        unit: "deg",
        meaning: "the yaw table slips at one run of one hull and stays so until the hull is changed",
        bounds: (-5.0, 5.0),
        draw: Draw::EitherSign(0.3, 1.0),
        act: |hidden, size, stream| {
            hidden.rig.yaw_slip = Some((size, stream.between(0.0, 1.0), stream.between(0.25, 0.75)));
            String::new()
        },
    },
    Entry {
        name: "uncatalogued-touching",
        parameter: "touching_share",
        unit: "",
        meaning: "the model touches the fairing beyond one angle on one side: the share of its load that the balance misses there",
        bounds: (0.0, 0.5),
        draw: Draw::Between(0.03, 0.1),
        act: |hidden, size, stream| {
            let touching =
                Touching { share: size, onset_rad: stream.between(3.0, 9.0).to_radians(), side: stream.sign() };
            hidden.rig.touching = Some(touching);
            format!("beyond {:.2} deg", touching.side * touching.onset_rad.to_degrees())
        },
    },
    Entry {
        name: "uncatalogued-backlash",
        parameter: "backlash_deg",
        unit: "deg",
        meaning: "the yaw table has play: the true angle is smaller than the recorded one by half of this, on either side",
        bounds: (0.0, 3.0),
        draw: Draw::Between(0.3, 0.9),
        act: |hidden, size, _| put(&mut hidden.rig.backlash_deg, size),
    },
    Entry {
        name: "uncatalogued-elastic-strut",
        parameter: "twist_deg_per_N_m",
        unit: "deg/(N m)",
        meaning: "the strut twists under the yaw moment: the true angle exceeds the recorded one by this times the moment",
        bounds: (-0.1, 0.1),
        draw: Draw::Between(0.01, 0.03),
        act: |hidden, size, _| {
            hidden.rig.twist_rad_per_N_m = size.to_radians();
            String::new()
        },
    },
    Entry {
        name: "uncatalogued-air-bubbles",
        parameter: "air_cd",
        unit: "",
        meaning: "air on the hull at the begin of every day, which leaves it in the course of an hour or two: CD gained",
        bounds: (0.0, 0.2),
        draw: Draw::Between(0.015, 0.04),
        act: |hidden, size, stream| {
            hidden.rig.air = Some((size, stream.between(0.7, 2.0)));
            String::new()
        },
    },
];

/// Sets a parameter of the virtual tank to the size of its effect; the effect draws no further figures to be stated.
fn put<T>(hidden: &mut T, size: T) -> String {
    *hidden = size;
    String::new()
}
