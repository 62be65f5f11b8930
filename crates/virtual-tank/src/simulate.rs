//! One run from rest to rest, as an experiment: mechanism -> motion through the water -> force of the water on hull and
//! strut -> inertia -> balance -> columns of the run's file.

use super::balance::Balance;
use super::decimal::push_fixed;
use super::effects::Hidden;
use super::hull::{Flow, Hull, Loads};
use super::motion::{Kind, Mechanism, Motion, Times};
use super::noise::{Disturbance, NoiseLevels};
use super::planned_run::PlannedRun;
use super::random::Stream;
use super::water::Water;

/// Columns of a run's file.
const HEADER: &[u8] = b"time_s,speed_m_s,yaw_deg,sway_m,AF_N,SF_N,YM_N_m\n";

/// At the start the forces are a tenth short; the flow develops within this many hull lengths of way.
const DEVELOPMENT_LENGTHS: f64 = 1.0;
/// Where the moment centre stands at the begin of a run, and the tank's length, m.
const START_M: f64 = 8.0;
const TANK_M: f64 = 90.0;
/// The rig rings after run-up and braking: frequency, decay, share of the mean inertial force.
const RING_HZ: f64 = 4.3;
const RING_DECAY_S: f64 = 0.5;
const RING_SHARE: f64 = 0.03;

/// Everything that runs have in common.
pub(super) struct Tank<'a> {
    pub hulls: &'a [Hull],
    pub balance: &'a Balance,
    pub levels: &'a NoiseLevels,
    pub hidden: &'a Hidden,
    /// Between samples: static runs, oscillating runs.
    pub intervals_s: (f64, f64),
}

impl Tank<'_> {
    /// Interval between the samples of a run.
    pub(super) fn interval_s(&self, kind: Kind) -> f64 {
        if matches!(kind, Kind::Sway | Kind::Yaw) { self.intervals_s.1 } else { self.intervals_s.0 }
    }

    /// What the balance still shows of the last steady load.
    fn kept_of_last_load(&self, run: &PlannedRun) -> [f64; 3] {
        let steady = |command: &super::motion::Command| matches!(command.kind, Kind::Static | Kind::Tare);
        let last = run.loaded_before.filter(|(_, command)| self.hidden.hysteresis_share != 0.0 && steady(command));
        let Some((hull, command)) = last else { return [0.0; 3] };
        let water = Water::fresh(run.temperature_c);
        let (sine, cosine) = command.yaw_deg.to_radians().sin_cos();
        let (u, v) = (command.speed_m_s * cosine, -command.speed_m_s * sine);
        let mut load = self.balance.strut.force_of_water(u, v, &water);
        if let Some(hull) = hull {
            let flow = Flow { u, v, development: 1.0, ..Flow::default() };
            load = load + self.hulls[hull].force_of_water(&flow, &water, self.hidden);
        }
        let shown = self.balance.reading(load, &[0.0; 3], self.hidden);
        shown.map(|value| self.hidden.hysteresis_share * value)
    }

    /// Writes the file of one run into `buffer`.
    pub(super) fn write_run(&self, run: &PlannedRun, stream: &mut Stream, buffer: &mut Vec<u8>) {
        buffer.clear();
        buffer.extend_from_slice(HEADER);
        let interval = self.interval_s(run.command.kind);
        let mut experiment = Experiment::new(self, run, interval, stream);
        let count = (experiment.times.end / interval).round() as usize;
        for i in 0..=count {
            let row = experiment.sample(i as f64 * interval, stream);
            push_fixed::<4>(buffer, row[0]);
            for value in [row[1], row[2]] {
                buffer.push(b',');
                push_fixed::<4>(buffer, value);
            }
            buffer.push(b',');
            push_fixed::<5>(buffer, row[3]);
            for value in [row[4], row[5]] {
                buffer.push(b',');
                push_fixed::<4>(buffer, value);
            }
            buffer.push(b',');
            push_fixed::<5>(buffer, row[6]);
            buffer.push(b'\n');
        }
    }
}

/// One run under way.
struct Experiment<'a> {
    tank: &'a Tank<'a>,
    run: &'a PlannedRun,
    hull: Option<&'a Hull>,
    mechanism: Mechanism,
    times: Times,
    interval: f64,
    water: Water,
    disturbance: Disturbance<'a>,
    /// Zero at the begin of the run and its growth per second.
    zero: ([f64; 3], [f64; 3]),
    /// True yaw less what the mechanism shows, rad.
    yaw_offset: f64,
    /// True speed at full throttle, m/s.
    full_speed: f64,
    /// True over recorded speed.
    speed_scale: f64,
    /// Angle by which the strut is twisted, rad.
    twist: f64,
    way: f64,
    sideways: f64,
}

impl<'a> Experiment<'a> {
    fn new(tank: &'a Tank<'a>, run: &'a PlannedRun, interval: f64, stream: &mut Stream) -> Self {
        let (hidden, times) = (tank.hidden, run.command.times());
        let mut begin = tank.balance.zero(run.day, run.hours, hidden);
        let end = tank.balance.zero(run.day, run.hours + times.end / 3600.0, hidden);
        let growth = [0, 1, 2].map(|i| (end[i] - begin[i]) / times.end);
        let kept = tank.kept_of_last_load(run);
        (0..3).for_each(|i| begin[i] += kept[i]);
        let speed_scale = hidden.speed_scale * (1.0 + hidden.rig.speed_slip * run.speed_slip);
        let play = 0.5 * hidden.rig.backlash_deg * run.command.yaw_deg.signum();
        let play = if run.command.yaw_deg == 0.0 { 0.0 } else { play };
        Self {
            tank,
            run,
            hull: run.hull.map(|index| &tank.hulls[index]),
            mechanism: Mechanism::new(run.command),
            times,
            interval,
            water: Water::fresh(run.temperature_c),
            disturbance: Disturbance::new(tank.levels, interval, stream),
            zero: (begin, growth),
            yaw_offset: (run.yaw_error_deg + hidden.yaw_misalignment_deg - play).to_radians(),
            full_speed: run.command.speed_m_s * run.speed_ratio * speed_scale,
            speed_scale,
            twist: 0.0,
            way: 0.0,
            sideways: 0.0,
        }
    }

    /// The columns at `time`; called for one sample after the other.
    #[inline]
    fn sample(&mut self, time: f64, stream: &mut Stream) -> [f64; 7] {
        let hidden = self.tank.hidden;
        let (share, rate) = self.mechanism.throttle(time);
        let (uneven, uneven_rate) = self.disturbance.unevenness();
        let speed = self.full_speed * share * (1.0 + uneven);
        let speed_rate = self.full_speed * (rate * (1.0 + uneven) + share * uneven_rate);
        let mut motion = self.mechanism.at(time, speed, speed_rate);
        motion.heading += self.yaw_offset + self.twist;
        self.way += speed * self.interval;
        self.sideways += motion.velocity.1 * self.interval;

        let load = self.load(time, &motion);
        self.twist = hidden.rig.twist_rad_per_N_m * load.n;
        let load = hidden.rig.on_balance(load, speed, motion.heading, self.run.command.yaw_deg);
        let speed_share = speed / 2.0;
        let model_share = if self.hull.is_some() { 1.0 } else { self.tank.levels.strut_alone_share };
        let [af, sf, ym] = self.disturbance.forces(speed_share, model_share, stream);
        let load = load + Loads { x: -af, y: sf + self.rectified_vibration(&motion, speed_share), n: ym };

        let (begin, growth) = &self.zero;
        let mut zero = [0, 1, 2].map(|i| begin[i] + growth[i] * time);
        if self.hull.is_some() && speed > 0.0 {
            let under_way = (speed / 0.2).powi(2).tanh();
            (0..3).for_each(|i| zero[i] += under_way * hidden.shift_under_way[i]);
        }
        let mut reading = self.tank.balance.reading(load, &zero, hidden);
        for (reading, step) in reading.iter_mut().zip(self.tank.levels.resolution).filter(|(_, step)| *step > 0.0) {
            *reading = (*reading / step).round() * step;
        }
        (0..3).filter(|i| hidden.flipped[*i]).for_each(|i| reading[i] = -reading[i]);

        let sensors = &self.tank.levels.sensors;
        let sway = if self.run.command.kind == Kind::Arc { self.sideways } else { motion.shown.2 };
        [
            time,
            motion.shown.0 / self.speed_scale + sensors[0] * stream.normal(),
            motion.shown.1 + sensors[1] * stream.normal(),
            sway + sensors[2] * stream.normal(),
            reading[0],
            reading[1],
            reading[2],
        ]
    }

    /// Force of the water plus inertia on everything below the balance, about the stated moment centre, body axes.
    #[inline]
    fn load(&self, time: f64, motion: &Motion) -> Loads {
        let (sine, cosine) = motion.heading.sin_cos();
        let along = |(x, y): (f64, f64)| (x * cosine + y * sine, y * cosine - x * sine);
        let current = self.current();
        let (u, v) = along((motion.velocity.0 - current.0, motion.velocity.1 - current.1));
        let (ax, ay) = along(motion.acceleration);
        let r = motion.r;
        let mut load = self.tank.balance.strut.force_of_water(u, v, &self.water);

        let Some(hull) = self.hull else {
            let mass = self.tank.balance.strut.mass_kg;
            return load + Loads { x: -mass * ax, y: -mass * ay, n: 0.0 };
        };
        let flow = Flow {
            u,
            v,
            r,
            // Rates of the components along turning axes.
            udot: ax + r * v,
            vdot: ay - r * u,
            rdot: motion.rdot,
            development: 1.0 - 0.1 * (-self.way / (DEVELOPMENT_LENGTHS * hull.row.loa_m)).exp(),
            extra_cd: self.run.extra_cd,
        };
        load = load + hull.force_of_water(&flow, &self.water, self.tank.hidden);

        // The centre of mass lies ahead of the moment centre by this much; inertia acts there against its acceleration.
        let live = &hull.live;
        let ahead = hull.row.mc_m - live.xg_m;
        let (gx, gy) = (ax - ahead * r * r, ay + ahead * motion.rdot);
        let inertia = Loads {
            x: -live.live_mass_kg * gx,
            y: -live.live_mass_kg * gy,
            n: -live.izz_kg_m2 * motion.rdot - live.live_mass_kg * ahead * ay,
        };
        load + inertia + Loads { x: self.ringing(time, live.live_mass_kg), y: 0.0, n: 0.0 }
    }

    /// Velocity of the tank's water, tank axes.
    #[inline]
    fn current(&self) -> (f64, f64) {
        let hidden = self.tank.hidden;
        let mut current = (0.0, 0.0);
        if hidden.residual_current != 0.0 {
            current.0 = hidden.residual_current * self.run.speed_before_m_s * (-self.run.wait_s / 360.0).exp();
        }
        if let Some(seiche) = hidden.rig.seiche {
            let phase = std::f64::consts::TAU * self.run.wait_s / seiche.period_s;
            let left = (-self.run.wait_s / seiche.decay_s).exp();
            current.0 += seiche.ratio * self.run.speed_before_m_s * left * phase.cos();
        }
        if let Some(gyre) = hidden.gyre {
            let swing = (self.run.start_time_s() * std::f64::consts::TAU / gyre.period_s + gyre.phase_rad).sin();
            current.1 = gyre.current_m_s * swing * (std::f64::consts::PI * (START_M + self.way) / TANK_M).cos();
        }
        current
    }

    /// Mean side force that the balance makes of the carriage's vibration.
    #[inline]
    fn rectified_vibration(&self, motion: &Motion, speed_share: f64) -> f64 {
        self.tank.hidden.vibration.map_or(0.0, |vibration| {
            let turns = motion.heading / vibration.period_rad * std::f64::consts::TAU;
            vibration.side_force_n * speed_share * speed_share * (turns + vibration.phase_rad).sin()
        })
    }

    /// The rig rings when the carriage stops gaining or losing speed.
    #[inline]
    fn ringing(&self, time: f64, mass: f64) -> f64 {
        let since = if time > self.times.stopped { time - self.times.stopped } else { time - self.times.up_to_speed };
        if !(0.0..12.0 * RING_DECAY_S).contains(&since) {
            return 0.0;
        }
        let mean_force = mass * self.full_speed / (self.times.up_to_speed - self.times.start);
        RING_SHARE * mean_force * (-since / RING_DECAY_S).exp() * (std::f64::consts::TAU * RING_HZ * since).sin()
    }
}
