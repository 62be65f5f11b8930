//! The classical Runge-Kutta method of fourth order as a solver for `fmi-rs`, whose own is the forward Euler method:
//! too coarse to compare trajectories with. State events are located by bisection of the step.

use fmi_rs::sim::SimulationError;
use fmi_rs::sim::solver::{Dae, Ode, Solver, SolverFactory};

/// Derivatives at the end of a step are taken this much earlier, s: there `fmi-rs` sets the inputs as they are after a
/// jump, which belongs to the next step.
const BEFORE_JUMP_S: f64 = 1e-6;

/// How narrowly an event is located, relative to the step.
const EVENT_WIDTH: f64 = 1e-10;

pub struct RungeKuttaFactory {
    /// The longest step, s.
    pub step: f64,
}

impl SolverFactory for RungeKuttaFactory {
    fn create<'a, O: Ode + 'a, D: Dae + 'a>(
        &self,
        start_time: f64,
        _relative_tolerance: f64,
        ode: O,
        _dae: Option<D>,
    ) -> Result<Box<dyn Solver + 'a>, SimulationError> {
        let (states, indicators) = (ode.nx(), ode.nz());
        let mut solver = RungeKutta {
            time: start_time,
            step: self.step,
            x: vec![0.0; states],
            trial: vec![0.0; states],
            stage: vec![0.0; states],
            slopes: [(); 4].map(|()| vec![0.0; states]),
            z: vec![0.0; indicators],
            trial_z: vec![0.0; indicators],
            ode,
        };
        solver.reset(start_time)?;
        Ok(Box::new(solver))
    }
}

struct RungeKutta<O> {
    time: f64,
    step: f64,
    x: Vec<f64>,
    /// The states at the end of the step that is tried.
    trial: Vec<f64>,
    stage: Vec<f64>,
    slopes: [Vec<f64>; 4],
    /// The event indicators now, and at the end of the step that is tried.
    z: Vec<f64>,
    trial_z: Vec<f64>,
    ode: O,
}

impl<O: Ode> RungeKutta<O> {
    /// Tries a step: `trial` and `trial_z` are what would be after it.
    fn try_step(&mut self, h: f64) -> Result<(), SimulationError> {
        // Where the derivative is taken: how far into the step, along which of the slopes before.
        const STAGES: [(f64, Option<usize>); 4] = [(0.0, None), (0.5, Some(0)), (0.5, Some(1)), (1.0, Some(2))];
        for (index, (part, along)) in STAGES.into_iter().enumerate() {
            self.stage.copy_from_slice(&self.x);
            if let Some(along) = along {
                for (stage, slope) in self.stage.iter_mut().zip(&self.slopes[along]) {
                    *stage += part * h * slope;
                }
            }
            let time = (self.time + part * h).min(self.time + h - BEFORE_JUMP_S).max(self.time);
            self.ode.f(time, &self.stage, &mut self.slopes[index])?;
        }
        let [k1, k2, k3, k4] = &self.slopes;
        for (index, trial) in self.trial.iter_mut().enumerate() {
            *trial = self.x[index] + h / 6.0 * (k1[index] + 2.0 * k2[index] + 2.0 * k3[index] + k4[index]);
        }
        self.ode.g(self.time + h, &self.trial, &mut self.trial_z)
    }

    fn crosses(&self) -> bool {
        self.z.iter().zip(&self.trial_z).any(|(before, after)| (*before > 0.0) != (*after > 0.0))
    }

    fn accept(&mut self, time: f64) {
        self.time = time;
        std::mem::swap(&mut self.x, &mut self.trial);
        std::mem::swap(&mut self.z, &mut self.trial_z);
    }
}

impl<O: Ode> Solver for RungeKutta<O> {
    fn reset(&mut self, time: f64) -> Result<(), SimulationError> {
        self.time = time;
        // The nominal values are not needed; the trial's place takes them.
        self.ode.init(&mut self.x, &mut self.trial)?;
        self.ode.g(time, &self.x, &mut self.z)
    }

    fn step(&mut self, next_time: f64) -> Result<(f64, &[f64], bool), SimulationError> {
        // Equal steps that end exactly at the time asked for.
        let count = ((next_time - self.time) / self.step).ceil().max(1.0);
        let (start, whole) = (self.time, next_time - self.time);
        for index in 1..=count as u64 {
            let end = if index as f64 == count { next_time } else { start + whole * index as f64 / count };
            let h = end - self.time;
            self.try_step(h)?;
            if self.crosses() {
                let (mut before, mut after) = (0.0, h);
                while after - before > EVENT_WIDTH * h {
                    let middle = 0.5 * (before + after);
                    self.try_step(middle)?;
                    if self.crosses() { after = middle } else { before = middle }
                }
                self.try_step(after)?;
                self.accept(if after == h { end } else { self.time + after });
                return Ok((self.time, &self.x, true));
            }
            self.accept(end);
        }
        Ok((self.time, &self.x, false))
    }
}
