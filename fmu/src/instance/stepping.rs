//! Co-Simulation: communication steps carried out by the library's integrator, with inputs that may move inside a step.

use std::cell::Cell;

use glidepolar_number::Number;

use super::access::{check_value, not_finite};
use super::refusal::{Outcome, Refusal};
use super::{Core, Instance};
use crate::model::flight::{Ends, InputsAt, Moving};
use crate::model::tangent::Tangent;
use crate::model::values::MOST_INPUTS;
use crate::model::{Causality, Kind, Slot, Variable};

/// Highest derivative of an input that can be given.
pub const MAX_INPUT_ORDER: usize = 3;

/// Longest communication step \[s\], a hundred days: whoever asks for more has lost a number.
const LONGEST_STEP_S: f64 = 1e7;

/// Right-hand sides that one communication step may cost: a glider needs 2 to 20 a second in a turn and less than one on
/// a leg; one with a parameter that has no physical meaning may need millions, and an importer that waits for it seems to
/// hang. The largest number is some seconds of work.
fn most_evaluations(size_s: f64) -> u64 {
    const EVALUATIONS: f64 = 50_000.0;
    const EVALUATIONS_PER_S: f64 = 100.0;
    const MOST: f64 = 6e6;
    (EVALUATIONS + EVALUATIONS_PER_S * size_s).min(MOST) as u64
}

/// Events at one place after which the step is given up.
const MAX_EVENTS_AT_ONCE: usize = 100;

/// How the inputs move after the communication point at which they were set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputSlopes {
    /// Derivatives of order 1, 2, 3.
    pub(super) derivatives: [[f64; MOST_INPUTS]; MAX_INPUT_ORDER],
    /// Whether any of them is there.
    pub(super) any: bool,
    /// How fast each input moved where the last step ended, until it is set.
    pub(super) at_end: [f64; MOST_INPUTS],
}

impl Default for InputSlopes {
    fn default() -> Self {
        InputSlopes { derivatives: [[0.0; MOST_INPUTS]; MAX_INPUT_ORDER], any: false, at_end: [0.0; MOST_INPUTS] }
    }
}

impl InputSlopes {
    /// An input that is set stands still from there on, unless its derivatives are given after it.
    pub(super) fn forget(&mut self, input: usize) {
        self.at_end[input] = 0.0;
        if self.any {
            self.derivatives.iter_mut().for_each(|order| order[input] = 0.0);
        }
    }

    /// The inputs this long after they were set.
    fn inputs<T: Number>(&self, base: &[f64; MOST_INPUTS], duration_s: T) -> [T; MOST_INPUTS] {
        let mut values = base.map(T::constant);
        if !self.any {
            return values;
        }
        let (mut power, mut factorial) = (T::constant(1.0), 1.0);
        for (order, derivatives) in self.derivatives.iter().enumerate() {
            power *= duration_s;
            factorial *= (order + 1) as f64;
            values.iter_mut().zip(derivatives).for_each(|(value, d)| *value += power * *d / factorial);
        }
        values
    }

    /// Their rates of change at a communication point: those that were given for the next step, or else those with
    /// which the last one ended.
    fn rates_here(&self) -> [f64; MOST_INPUTS] {
        let next = self.rates(0.0);
        std::array::from_fn(|i| next[i] + self.at_end[i])
    }

    /// Their rates of change this long after they were set.
    fn rates(&self, duration_s: f64) -> [f64; MOST_INPUTS] {
        let [d1, d2, d3] = &self.derivatives;
        std::array::from_fn(|i| d1[i] + duration_s * (d2[i] + 0.5 * duration_s * d3[i]))
    }
}

/// How far a part of a step came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// To the time that was asked for.
    Reached,
    /// To a state event, or to the time of an event, before it or on it.
    Event,
}

/// A communication step under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Where it ends \[s\].
    pub target_s: f64,
    begun_s: f64,
    inputs: [f64; MOST_INPUTS],
    evaluations_left: u64,
}

impl Instance {
    /// Checks a communication step and begins it.
    pub fn begin_step(&mut self, current_s: f64, size_s: f64) -> Outcome<Step> {
        let time = self.time_s();
        if !(size_s > 0.0 && size_s <= LONGEST_STEP_S) {
            return Err(Refusal::error(format!(
                "the step size is {size_s:?} s, expected a number above zero and not above {LONGEST_STEP_S:?}"
            )));
        }
        if !current_s.is_finite() || (current_s - time).abs() > 1e-9 * time.abs().max(1.0) {
            return Err(Refusal::error(format!(
                "the communication point is {current_s:?} s, but the instance stands at {time} s; to go back, restore a saved state"
            )));
        }
        let target_s = current_s + size_s;
        if target_s <= time {
            return Err(Refusal::error(format!("the step of {size_s:?} s does not move the time {time} s")));
        }
        if let Some(stop) = self.core.stop_time_s
            && target_s > stop + 1e-9 * stop.abs().max(1.0)
        {
            return Err(Refusal::error(format!("the step would end at {target_s} s, after the stop time {stop} s")));
        }
        // The next step may do: whoever set one limit sets the other.
        self.check_limits().map_err(|refusal| Refusal::discard(refusal.message))?;
        self.check_moving_inputs(size_s)?;
        if self.core.unsettled {
            self.handle_event();
        }
        Ok(Step {
            target_s,
            begun_s: time,
            inputs: self.core.glider.values.inputs,
            evaluations_left: most_evaluations(size_s),
        })
    }

    /// Refuses a step in which an input would move out of its bounds: it could not be set there either.
    fn check_moving_inputs(&self, size_s: f64) -> Outcome {
        /// A cubic may come back by the end.
        const LOOKS: u32 = 16;
        let slopes = &self.core.slopes;
        if !slopes.any {
            return Ok(());
        }
        let moves = |input: usize| slopes.derivatives.iter().any(|order| order[input] != 0.0);
        for look in 1..=LOOKS {
            let after_s = size_s * f64::from(look) / f64::from(LOOKS);
            let values = slopes.inputs(&self.core.glider.values.inputs, after_s);
            for (input, value) in values.into_iter().enumerate().filter(|(input, _)| moves(*input)) {
                check_value(self.table().variable_of(Slot::Input(input)), value).map_err(|refusal| {
                    Refusal::discard(format!(
                        "its derivatives carry an input out of its bounds {after_s} s into the step: {}; give other derivatives or a shorter step",
                        refusal.message
                    ))
                })?;
            }
        }
        Ok(())
    }

    /// Everything as it is, to go back to when a step fails.
    pub fn checkpoint(&self) -> Core {
        self.core.clone()
    }

    /// Back to where a failed step began.
    pub fn roll_back(&mut self, checkpoint: Core) {
        self.core = checkpoint;
    }

    /// A whole communication step; when it fails, everything is as before it.
    pub fn whole_step(&mut self, current_s: f64, size_s: f64) -> Outcome {
        let before = self.checkpoint();
        let mut steps = || {
            let mut step = self.begin_step(current_s, size_s)?;
            let end_s = step.target_s;
            self.advance_over_events(&mut step, end_s)?;
            self.end_step(&step);
            Ok(())
        };
        let result = steps();
        if result.is_err() {
            self.roll_back(before);
        }
        result
    }

    /// The step that the integrator would take next \[s\].
    pub fn integrator_step_s(&self) -> f64 {
        self.core.integrator.step_s()
    }

    /// Carries the step on, to `until_s` or to the first event before it.
    pub fn advance(&mut self, step: &mut Step, until_s: f64) -> Outcome<Progress> {
        let until_s = until_s.min(step.target_s);
        let time_event = self.core.glider.next_time_event_s().filter(|event| *event <= until_s);
        let end_s = time_event.unwrap_or(until_s).max(self.time_s());
        let core = &mut self.core;
        let mut time = core.glider.values.time_s;
        let mut state = core.glider.values.state;
        let inputs = MovingInputs { slopes: &core.slopes, inputs: &step.inputs, begun_s: step.begun_s };
        let moving = Moving {
            rules: core.glider.rules(),
            parameters: &core.glider.values.parameters,
            inputs,
            evaluations_left: Cell::new(step.evaluations_left),
            furthest_s: Cell::new(time),
        };
        let mut integrator = core.integrator;
        // With inputs unchanged, communication points are interpolated. So is the stop time, beyond which the equations hold as
        // well: a run that stops, is saved and goes on with another stop time is the run that did not stop.
        let is_free = !(core.is_steered || core.slopes.any);
        let horizon_s = is_free.then(|| core.glider.next_time_event_s().unwrap_or(f64::INFINITY));
        let advance = integrator.advance(&moving, &mut time, &mut state, Ends { end_s, horizon_s });
        step.evaluations_left = moving.evaluations_left.get();
        let inputs = moving.inputs.inputs_at(time);
        let is_reached = match advance {
            Ok(is_reached) => is_reached,
            Err(_) if step.evaluations_left == 0 => {
                return Err(Refusal::discard(format!(
                    "the step to {} s needs too many internal steps: it came to {:.3} s and was taken back; ask for smaller steps, or check the parameters for values without physical meaning",
                    step.target_s,
                    moving.furthest_s.get()
                )));
            }
            Err(error) => return Err(Refusal::discard(error.to_string())),
        };
        let model = core.glider.model;
        check_in_the_sea(time, model.table().variable_of(Slot::State(model.depth())), state[model.depth()])?;
        core.glider.values.time_s = time;
        core.glider.values.state = state;
        core.glider.values.inputs = inputs;
        core.integrator = integrator;
        match (is_reached, time_event) {
            (true, None) => Ok(Progress::Reached),
            _ => {
                core.unsettled = true;
                Ok(Progress::Event)
            }
        }
    }

    /// Carries the step to its end, over every event on the way.
    pub fn advance_over_events(&mut self, step: &mut Step, until_s: f64) -> Outcome {
        let mut at_once = 0;
        loop {
            let before = self.time_s();
            match self.advance(step, until_s)? {
                Progress::Reached => return Ok(()),
                Progress::Event => {
                    self.handle_event();
                    at_once = if self.time_s() - before < 1e-6 { at_once + 1 } else { 0 };
                    if at_once > MAX_EVENTS_AT_ONCE {
                        return Err(Refusal::discard(format!(
                            "events follow each other without end at {} s; check limits and commands",
                            self.time_s()
                        )));
                    }
                    if self.time_s() >= until_s.min(step.target_s) {
                        return Ok(());
                    }
                }
            }
        }
    }

    /// The importer set inputs inside the step: it goes on from there with them standing still.
    pub fn take_inputs_inside(&mut self, step: &mut Step) {
        if self.core.glider.values.inputs != step.inputs {
            step.inputs = self.core.glider.values.inputs;
            step.begun_s = self.time_s();
            self.core.slopes = InputSlopes::default();
        }
    }

    /// The step is over: inputs stand still in the next one unless they are given derivatives again.
    pub fn end_step(&mut self, step: &Step) {
        let at_end = self.core.slopes.rates(self.time_s() - step.begun_s);
        self.core.slopes = InputSlopes { at_end, ..InputSlopes::default() };
        self.core.is_steered = false;
    }

    /// Sets derivatives of inputs at this communication point, all or none. They hold for one step.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Outcome {
        let all = || references.iter().zip(orders.iter().zip(values));
        for (&reference, (&order, &value)) in all() {
            self.checked_slope(reference, order, value)?;
        }
        for (&reference, (&order, &value)) in all() {
            let (input, order) = self.checked_slope(reference, order, value)?;
            self.core.slopes.at_end[input] = 0.0;
            self.core.slopes.derivatives[order - 1][input] = value;
            self.core.slopes.any = true;
            self.core.steer();
        }
        Ok(())
    }

    /// The input and the order of a derivative of it.
    fn checked_slope(&self, reference: u32, order: i32, value: f64) -> Outcome<(usize, usize)> {
        let variable = self.of_kind(reference, Kind::Real)?;
        let Slot::Input(input) = variable.slot else {
            return Err(Refusal::error(format!("{} is not an input", variable.name)));
        };
        let order = check_order(order, MAX_INPUT_ORDER)?;
        if !value.is_finite() {
            return Err(Refusal::error(format!(
                "a derivative of {} is {value}, expected a finite number",
                variable.name
            )));
        }
        Ok((input, order))
    }

    /// Time derivatives of outputs, exact.
    pub fn output_derivatives(&self, references: &[u32], orders: &[i32], values: &mut [f64]) -> Outcome {
        let glider = self.now();
        let tangent = Tangent::in_time(&glider, self.core.slopes.rates_here());
        for ((&reference, &order), value) in references.iter().zip(orders).zip(values) {
            let variable = self.of_kind(reference, Kind::Real)?;
            check_order(order, 1)?;
            let derivative = if variable.causality == Causality::Output { tangent.of(variable.slot) } else { None };
            *value = derivative.ok_or_else(|| Refusal::error(format!("{} is not an output", variable.name)))?;
            if !value.is_finite() {
                return Err(not_finite(variable, *value));
            }
        }
        Ok(())
    }
}

/// Refuses to go on with a glider that has left the sea: one without weight floats away, and no number of it means anything.
fn check_in_the_sea(time_s: f64, depth: &Variable, depth_m: f64) -> Outcome {
    check_value(depth, depth_m).map_err(|refusal| {
        Refusal::discard(format!(
            "at {time_s} s {}; look for masses, offsets or leaks without physical meaning",
            refusal.message
        ))
    })
}

fn check_order(order: i32, max: usize) -> Outcome<usize> {
    match usize::try_from(order) {
        Ok(order) if (1..=max).contains(&order) => Ok(order),
        _ => Err(Refusal::error(format!("derivative of order {order}, expected 1 to {max}"))),
    }
}

/// The inputs of a step.
struct MovingInputs<'a> {
    slopes: &'a InputSlopes,
    inputs: &'a [f64; MOST_INPUTS],
    begun_s: f64,
}

impl InputsAt for MovingInputs<'_> {
    fn inputs_at<T: Number>(&self, time_s: T) -> [T; MOST_INPUTS] {
        self.slopes.inputs(self.inputs, time_s - self.begun_s)
    }
}
