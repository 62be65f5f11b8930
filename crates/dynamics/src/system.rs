//! A glider on its way: equations, parameters, modes and inputs in one hand, carried through time and over events.

use super::equations::{Outputs, derivative, next_bend_s, outputs};
use super::integrate::{Advance, IntegrationError, Integrator, Jet, System};
use super::limits::{self, N_EVENTS};
use super::parameters::Parameters;
use super::state::{Actuation, Inputs, Modes, State};
use glidepolar_number::Number;

/// Events in a row at one and the same time after which they are taken as over.
const MAX_EVENTS_AT_ONCE: usize = 100;

/// To where a glider is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    /// Where its state is wanted \[s\].
    pub end_s: f64,
    /// How long nothing changes that its motion depends on, not before `end_s` \[s\].
    pub horizon_s: f64,
}

/// A glider with everything that its motion depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glider {
    /// The numbers of the equations.
    pub parameters: Parameters<f64>,
    /// Who moves moving mass and ballast.
    pub actuation: Actuation,
    /// Where its limits stand; they change at events only.
    pub modes: Modes,
    /// What acts on it, at the time `inputs_at_s`.
    pub inputs: Inputs<f64>,
    /// How the inputs change with time, per second; `None` for inputs that stand still.
    pub input_rates: Option<Inputs<f64>>,
    /// Time at which `inputs` holds \[s\].
    pub inputs_at_s: f64,
}

impl Glider {
    /// A glider with free limits and inputs that stand still.
    pub fn new(parameters: Parameters<f64>, actuation: Actuation, inputs: Inputs<f64>) -> Self {
        Glider { parameters, actuation, modes: Modes::default(), inputs, input_rates: None, inputs_at_s: 0.0 }
    }

    /// The inputs at a time.
    pub fn inputs_at<T: Number>(&self, time_s: T) -> Inputs<T> {
        let inputs = self.inputs.map(T::constant);
        match &self.input_rates {
            None => inputs,
            Some(rates) => inputs.plus(&rates.map(T::constant), time_s - self.inputs_at_s),
        }
    }

    /// What is looked at.
    pub fn outputs(&self, time_s: f64, state: &State<f64>) -> Outputs<f64> {
        outputs(&self.parameters, time_s, state, &self.inputs_at(time_s))
    }

    /// Brings modes and state in line with each other, as after an event or a change of inputs.
    pub fn apply_limits(&mut self, time_s: f64, state: &mut State<f64>) {
        let inputs = self.inputs_at(time_s);
        (self.modes, *state) = limits::apply(&self.parameters, self.actuation, self.modes, time_s, state, &inputs);
    }

    /// Carries time and state to `end_s`, over every event on the way; `on_event` is called at each, after the limits have
    /// been applied, and may end the advance there by returning `false`.
    ///
    /// # Errors
    /// As [`Integrator::advance`]; time and state are then those of the last event.
    pub fn fly(
        &mut self,
        integrator: &mut Integrator,
        time_s: &mut f64,
        state: &mut State<f64>,
        end_s: f64,
        on_event: impl FnMut(f64, &State<f64>, [bool; N_EVENTS]) -> bool,
    ) -> Result<(), IntegrationError> {
        integrator.forget_ahead();
        self.follow(integrator, time_s, state, Ends { end_s, horizon_s: end_s }, on_event)
    }

    /// As [`Glider::fly`], by [`Integrator::follow`]: for a glider whose inputs and parameters go on as they are until the
    /// horizon. Where they were changed, [`Integrator::forget_ahead`] or [`Integrator::restart`] comes first.
    ///
    /// # Errors
    /// As [`Glider::fly`].
    pub fn follow(
        &mut self,
        integrator: &mut Integrator,
        time_s: &mut f64,
        state: &mut State<f64>,
        Ends { end_s, horizon_s }: Ends,
        mut on_event: impl FnMut(f64, &State<f64>, [bool; N_EVENTS]) -> bool,
    ) -> Result<(), IntegrationError> {
        let mut at_once = 0;
        while *time_s < end_s {
            let started_s = *time_s;
            match integrator.follow(self, time_s, state, end_s, horizon_s)? {
                Advance::Reached => return Ok(()),
                Advance::Event(which) => {
                    self.apply_limits(*time_s, state);
                    if which[limits::SURFACE] && self.derivative(*time_s, state).depth_m < 0.0 {
                        state.energy_J += self.parameters.surfacing_J;
                    }
                    at_once = if *time_s - started_s < 1e-6 { at_once + 1 } else { 0 };
                    if !on_event(*time_s, state, which) {
                        return Ok(());
                    }
                    if at_once > MAX_EVENTS_AT_ONCE {
                        // A limit that opens and closes without end: the step size has long been its smallest, going
                        // on costs time and changes nothing.
                        return Err(IntegrationError::StepTooSmall { time_s: *time_s });
                    }
                }
            }
        }
        Ok(())
    }
}

impl System for Glider {
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64> {
        derivative(&self.parameters, self.actuation, self.modes, time_s, state, &self.inputs_at(time_s))
    }

    fn linearised(&self, time_s: Jet, state: &State<Jet>) -> State<Jet> {
        let parameters = self.parameters.map(Jet::constant);
        derivative(&parameters, self.actuation, self.modes, time_s, state, &self.inputs_at(time_s))
    }

    fn event_indicators(&self, time_s: f64, state: &State<f64>) -> [f64; N_EVENTS] {
        limits::event_indicators(&self.parameters, self.actuation, self.modes, time_s, state, &self.inputs_at(time_s))
    }

    fn next_jump_s(&self, time_s: f64) -> Option<f64> {
        self.parameters.next_step_s(time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &State<f64>) -> Option<f64> {
        next_bend_s(&self.parameters, self.actuation, time_s, state, &self.inputs_at(time_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glide::start;

    fn gliding() -> (Glider, State<f64>) {
        let parameters = Parameters::default();
        let start = start(&parameters);
        (Glider::new(parameters, Actuation::Servo, start.inputs), start.state)
    }

    /// Down, round and up again: the commands change at 200 s.
    fn dive(tolerance: f64, communication_step_s: f64) -> State<f64> {
        let (mut glider, mut state) = gliding();
        let mut integrator = Integrator::new(tolerance);
        let mut time = 0.0;
        while time < 600.0 {
            if time == 200.0 {
                glider.inputs.ballast_command_m3 *= -1.0;
                glider.inputs.moving_mass_command_m *= -1.0;
            }
            let end = time + communication_step_s;
            glider.fly(&mut integrator, &mut time, &mut state, end, |_, _, _| true).unwrap();
            assert_eq!(time, end);
        }
        state
    }

    /// The same flight, looked at in passing.
    fn followed(tolerance: f64, communication_step_s: f64) -> State<f64> {
        let (mut glider, mut state) = gliding();
        let mut integrator = Integrator::new(tolerance);
        let mut time = 0.0;
        for (turn_s, sign) in [(200.0, -1.0), (600.0, 1.0)] {
            while time < turn_s {
                let ends_s = Ends { end_s: time + communication_step_s, horizon_s: turn_s };
                glider.follow(&mut integrator, &mut time, &mut state, ends_s, |_, _, _| true).unwrap();
                assert_eq!(time, ends_s.end_s);
            }
            glider.inputs.ballast_command_m3 *= sign;
            glider.inputs.moving_mass_command_m *= sign;
            integrator.forget_ahead();
        }
        state
    }

    fn distance(a: &State<f64>, b: &State<f64>) -> f64 {
        let nominal = State::NOMINALS;
        let scaled = a.as_array().into_iter().zip(b.as_array()).zip(nominal);
        scaled.map(|((a, b), n)| (a - b).abs() / n).fold(0.0, f64::max)
    }

    #[test]
    fn the_result_depends_on_tolerance_and_not_on_the_communication_step() {
        let reference = dive(1e-12, 200.0);
        // The explicit method alone, the default, a usual one.
        for tolerance in [1e-10, 1e-8, 1e-7] {
            for step in [200.0, 50.0, 1.0, 0.25] {
                let distances = [dive, followed].map(|fly| distance(&fly(tolerance, step), &reference));
                assert!(distances.iter().all(|d| *d < 20.0 * tolerance), "{step} s, {tolerance}: {distances:?}");
            }
        }
        assert!(distance(&dive(1e-5, 200.0), &reference) < 1e-3);
        assert!(distance(&dive(1e-5, 200.0), &reference) > distance(&dive(1e-9, 200.0), &reference));
    }

    #[test]
    fn a_saved_run_goes_on_bit_for_bit() {
        for tolerance in [1e-10, 1e-8, 1e-6] {
            save_and_go_on(tolerance);
        }
    }

    fn save_and_go_on(tolerance: f64) {
        let (mut glider, mut state) = gliding();
        glider.inputs.moving_mass_command_m = -0.01;
        let mut integrator = Integrator::new(tolerance);
        let mut time = 0.0;
        glider.fly(&mut integrator, &mut time, &mut state, 17.3, |_, _, _| true).unwrap();
        let saved = (time, state, integrator.step_s());
        glider.fly(&mut integrator, &mut time, &mut state, 91.0, |_, _, _| true).unwrap();
        let (mut time_2, mut state_2, step) = saved;
        let mut restored = Integrator::new(tolerance).with_step_s(step);
        glider.fly(&mut restored, &mut time_2, &mut state_2, 91.0, |_, _, _| true).unwrap();
        assert_eq!((time_2, state_2, restored.step_s()), (time, state, integrator.step_s()));
    }

    #[test]
    fn a_run_saved_inside_a_step_goes_on_bit_for_bit() {
        for tolerance in [1e-10, 1e-8, 1e-6] {
            let (mut glider, mut state) = gliding();
            glider.inputs.moving_mass_command_m = -0.01;
            let (mut integrator, mut time, mut kept) = (Integrator::new(tolerance), 0.0, Vec::new());
            let mut go_on = |integrator: &mut Integrator, time: &mut f64, state: &mut State<f64>| {
                let ends_s = Ends { end_s: *time + 0.7, horizon_s: 1000.0 };
                glider.follow(integrator, time, state, ends_s, |_, _, _| true).unwrap();
            };
            for _ in 0..200 {
                kept.push((integrator.numbers(), time, state));
                go_on(&mut integrator, &mut time, &mut state);
            }
            for k in [1, 20, 60, 150] {
                let (numbers, mut time, mut state) = kept[k].clone();
                let mut restored = Integrator::from_numbers(&numbers).expect("it wrote them itself");
                kept[k + 1..].iter().for_each(|next| {
                    go_on(&mut restored, &mut time, &mut state);
                    assert_eq!((restored.numbers(), time, state), *next);
                });
            }
        }
    }

    #[test]
    fn the_seabed_is_met_when_and_where_the_steady_glide_says() {
        let (mut glider, mut state) = gliding();
        glider.inputs.seabed_depth_m = 60.0;
        let sink = 0.30 * 25f64.to_radians().sin();
        let expected = (60.0 - state.depth_m) / sink;
        let mut met = None;
        let (mut time, mut integrator) = (0.0, Integrator::new(1e-8));
        glider
            .fly(&mut integrator, &mut time, &mut state, 1000.0, |t, s, which| {
                met = Some((t, s.depth_m, which));
                false
            })
            .unwrap();
        let (t, depth, which) = met.expect("the seabed");
        assert!((t - expected).abs() < 1e-6, "{t} against {expected}");
        assert!((depth - 60.0).abs() < 1e-6);
        assert_eq!(which, [false, true, false, false, false, false]);
        assert_eq!(time, t);
    }

    #[test]
    fn a_jump_of_drag_is_met_exactly() {
        // After the jump the same ballast drives the glider at a lower speed: the new steady glide, by the balance of
        // forces. Before it nothing may have changed.
        let (mut glider, start) = gliding();
        glider.parameters.drag_step = 0.5;
        glider.parameters.step_time_s = 100.0;
        let (mut time, mut state, mut integrator) = (0.0, start, Integrator::new(1e-9));
        glider.fly(&mut integrator, &mut time, &mut state, 100.0, |_, _, _| true).unwrap();
        assert!((state.v1_m_s - start.v1_m_s).abs() < 1e-9);
        glider.fly(&mut integrator, &mut time, &mut state, 101.0, |_, _, _| true).unwrap();
        assert!(state.v1_m_s < start.v1_m_s - 1e-4, "{} after {}", state.v1_m_s, start.v1_m_s);
    }

    #[test]
    fn a_step_of_the_net_mass_is_met_exactly_beside_one_of_the_drag() {
        // Heavier, the glider sinks faster; with more drag it slows down again. Before either step nothing may have changed.
        let (mut glider, start) = gliding();
        let p = &mut glider.parameters;
        (p.net_mass_step_kg, p.net_mass_step_time_s) = (0.05, 100.0);
        (p.drag_step, p.step_time_s) = (0.5, 130.0);
        let (mut time, mut state, mut integrator) = (0.0, start, Integrator::new(1e-9));
        let mut fly = |state: &mut State<f64>, end_s: f64| {
            glider.fly(&mut integrator, &mut time, state, end_s, |_, _, _| true).unwrap();
        };
        fly(&mut state, 100.0);
        assert!((state.v1_m_s - start.v1_m_s).abs() < 1e-9);
        fly(&mut state, 130.0);
        let heavier = state.v1_m_s;
        assert!(heavier > start.v1_m_s + 1e-3, "{heavier} after {}", start.v1_m_s);
        fly(&mut state, 131.0);
        assert!(state.v1_m_s < heavier - 1e-4, "{} after {heavier}", state.v1_m_s);
    }

    #[test]
    fn what_is_not_finite_is_an_error_and_changes_nothing() {
        let (mut glider, start) = gliding();
        glider.inputs.water_density_kg_m3 = f64::NAN;
        let (mut time, mut state, mut integrator) = (5.0, start, Integrator::new(1e-8));
        let error = glider.fly(&mut integrator, &mut time, &mut state, 10.0, |_, _, _| true).unwrap_err();
        assert_eq!(error, IntegrationError::NotFinite { time_s: 5.0 });
        assert_eq!((time, state), (5.0, start));
    }

    #[test]
    fn raw_ballast_runs_to_its_limit_and_stays_there() {
        let (mut glider, mut state) = gliding();
        glider.actuation = Actuation::RawAlongAxis1;
        glider.parameters.moving_mass_min_m = -0.05;
        glider.parameters.moving_mass_max_m = 0.05;
        glider.inputs.u4_kg_s = 0.025;
        let (mut time, mut integrator, mut events) = (0.0, Integrator::new(1e-8), Vec::new());
        glider
            .fly(&mut integrator, &mut time, &mut state, 60.0, |t, _, which| {
                events.push((t, which));
                true
            })
            .unwrap();
        let lowest = glider.parameters.ballast_mass_kg(glider.parameters.ballast_min_m3);
        assert_eq!(state.ballast_mass_kg, lowest);
        let (t, _) = events.iter().find(|(_, which)| which[2]).expect("the limit of the ballast");
        let expected = (lowest - start(&glider.parameters).state.ballast_mass_kg) / 0.025;
        assert!((t - expected).abs() < 1e-6, "{t} against {expected}");
        // A force that stays constant cannot hold the moving mass: it runs to its stops and never beyond.
        assert!(events.iter().any(|(_, which)| which[4] || which[5]), "{events:?}");
        assert!(state.moving_mass_1_m.abs() < 0.05 + 1e-6, "moving mass at {}", state.moving_mass_1_m);
    }

    #[test]
    fn what_is_only_counted_is_felt_by_nothing() {
        // What lets the Jacobian leave their columns out.
        let p = Parameters::default();
        let start = start(&p);
        for state in [start.state, State { depth_m: -0.05, ..start.state }, State { depth_m: 6001.0, ..start.state }] {
            let richer =
                State { energy_J: state.energy_J + 1e6, x_m: state.x_m + 1e5, creep_pressure_Pa: 1e6, ..state };
            for actuation in [Actuation::Servo, Actuation::Raw] {
                let glider = Glider::new(p, actuation, start.inputs);
                assert_eq!(glider.derivative(7.0, &state), glider.derivative(7.0, &richer));
            }
        }
    }
}
