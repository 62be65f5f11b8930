//! Model Exchange, driven by a small importer of the test's own: the same trajectory as Co-Simulation, events included.

mod support;

use glidepolar_fmu::fmi3::*;
use support::*;

const N: usize = STATES.len();

struct Importer {
    glider: Glider3,
    time: f64,
    next_time_event: Option<f64>,
    events: Vec<f64>,
}

impl Importer {
    fn new(starts: &[(&str, f64)], actuation: i32) -> Self {
        let glider = Glider3::model_exchange();
        glider.set_actuation(actuation);
        glider.set(starts);
        glider.begin(None);
        let mut importer = Importer { glider, time: 0.0, next_time_event: None, events: Vec::new() };
        importer.update();
        importer
    }

    fn update(&mut self) {
        let mut found = self.glider.update_discrete_states();
        while found.flags[0] != 0 {
            found = self.glider.update_discrete_states();
        }
        self.next_time_event = found.next_s;
        // SAFETY: a live instance.
        self.glider.ok(unsafe { fmi3EnterContinuousTimeMode(self.glider.instance) });
    }

    fn event(&mut self) {
        self.events.push(self.time);
        // SAFETY: a live instance.
        self.glider.ok(unsafe { fmi3EnterEventMode(self.glider.instance) });
        self.update();
    }

    fn states(&self) -> [f64; N] {
        let mut x = [f64::NAN; N];
        // SAFETY: a live instance and room for all.
        self.glider.ok(unsafe { fmi3GetContinuousStates(self.glider.instance, x.as_mut_ptr(), N) });
        x
    }

    fn rates(&self, time: f64, x: &[f64; N]) -> [f64; N] {
        let mut rates = [f64::NAN; N];
        // SAFETY: as above.
        unsafe {
            self.glider.ok(fmi3SetTime(self.glider.instance, time));
            self.glider.ok(fmi3SetContinuousStates(self.glider.instance, x.as_ptr(), N));
            self.glider.ok(fmi3GetContinuousStateDerivatives(self.glider.instance, rates.as_mut_ptr(), N));
        }
        rates
    }

    fn indicators(&self, time: f64, x: &[f64; N]) -> [f64; 6] {
        self.rates(time, x);
        let mut z = [f64::NAN; 6];
        // SAFETY: as above.
        self.glider.ok(unsafe { fmi3GetEventIndicators(self.glider.instance, z.as_mut_ptr(), 6) });
        z
    }

    /// One step of the classical Runge-Kutta method.
    fn stepped(&self, x: &[f64; N], h: f64) -> [f64; N] {
        let at = |k: &[f64; N], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
        let k1 = self.rates(self.time, x);
        let k2 = self.rates(self.time + h / 2.0, &at(&k1, h / 2.0));
        let k3 = self.rates(self.time + h / 2.0, &at(&k2, h / 2.0));
        let k4 = self.rates(self.time + h, &at(&k3, h));
        std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Integrates to `end` with events found by bisection on the step size.
    fn run(&mut self, end: f64, step: f64) {
        while self.time < end - 1e-9 {
            let x = self.states();
            let z = self.indicators(self.time, &x);
            let limit = self.next_time_event.map_or(end, |event| event.min(end));
            let mut h = step.min(limit - self.time);
            let changes = |importer: &Self, h: f64| {
                let after = importer.indicators(importer.time + h, &importer.stepped(&x, h));
                z.iter().zip(after).any(|(a, b)| (*a > 0.0) != (b > 0.0))
            };
            let state_event = changes(self, h);
            if state_event {
                let (mut low, mut high) = (0.0, h);
                while high - low > 1e-10 {
                    let middle = 0.5 * (low + high);
                    if changes(self, middle) { high = middle } else { low = middle }
                }
                h = high;
            }
            let after = self.stepped(&x, h);
            self.time += h;
            self.rates(self.time, &after);
            let (mut enter, mut terminate) = (9, 9);
            // SAFETY: as above.
            unsafe {
                let instance = self.glider.instance;
                self.glider.ok(fmi3CompletedIntegratorStep(instance, 1, &mut enter, &mut terminate));
            }
            assert_eq!((enter, terminate), (0, 0));
            if state_event || self.next_time_event.is_some_and(|event| self.time >= event - 1e-9) {
                self.event();
            }
        }
    }
}

fn co_simulated(starts: &[(&str, f64)], actuation: i32, end: f64) -> Glider3 {
    let glider = Glider3::co_simulation(Options::default());
    glider.set_actuation(actuation);
    glider.set(starts);
    glider.begin(Some(1e-10));
    assert_eq!(glider.step(0.0, end).status, OK);
    glider
}

fn same(importer: &Importer, co_simulation: &Glider3, tolerance: f64) {
    for ((name, found), expected) in STATES.iter().zip(importer.states()).zip(co_simulation.states()) {
        let scale = expected.abs().max(0.1);
        assert!((found - expected).abs() < tolerance * scale, "{name}: {found} against {expected}");
    }
}

#[test]
fn a_turn_is_the_same_as_in_co_simulation() {
    let starts = [("ballast_command_m3", 1e-4), ("moving_mass_command_m", -0.02)];
    let mut importer = Importer::new(&starts, 0);
    importer.run(60.0, 0.02);
    same(&importer, &co_simulated(&starts, 0, 60.0), 1e-6);
    // The servos' corners, and nothing else: the mass runs 0.04 m at 0.02 m/s to 1 s short of its set-point, the ballast at its rate.
    assert_eq!(importer.events.len(), 2, "{:?}", importer.events);
}

#[test]
fn the_jump_of_drag_is_a_time_event() {
    let starts = [("drag_step", 0.5), ("step_time_s", 10.25)];
    let mut importer = Importer::new(&starts, 0);
    assert_eq!(importer.next_time_event, Some(10.25));
    importer.run(30.0, 0.02);
    assert_eq!(importer.events.len(), 1);
    assert!((importer.events[0] - 10.25).abs() < 1e-9);
    assert_eq!(importer.next_time_event, None);
    same(&importer, &co_simulated(&starts, 0, 30.0), 1e-7);
}

#[test]
fn two_steps_at_different_times_are_two_time_events() {
    let starts =
        [("drag_step", 0.5), ("step_time_s", 20.5), ("net_mass_step_kg", 0.03), ("net_mass_step_time_s", 10.25)];
    let mut importer = Importer::new(&starts, 0);
    assert_eq!(importer.next_time_event, Some(10.25));
    importer.run(15.0, 0.02);
    assert_eq!(importer.next_time_event, Some(20.5));
    same(&importer, &co_simulated(&starts, 0, 15.0), 1e-7);
    let mut importer = Importer::new(&starts, 0);
    importer.run(30.0, 0.02);
    assert_eq!(importer.events.len(), 2, "{:?}", importer.events);
    assert!(importer.events.iter().zip([10.25, 20.5]).all(|(at, expected)| (at - expected).abs() < 1e-9));
    assert_eq!(importer.next_time_event, None);
    same(&importer, &co_simulated(&starts, 0, 30.0), 1e-7);
    // Each does something.
    for without in ["drag_step", "net_mass_step_kg"] {
        let others: Vec<(&str, f64)> = starts.into_iter().filter(|(name, _)| *name != without).collect();
        let other = co_simulated(&others, 0, 30.0).get("speed_m_s");
        assert!((importer.glider.get("speed_m_s") - other).abs() > 1e-3, "{without}");
    }
}

#[test]
fn the_moving_mass_runs_into_its_stop_at_an_event_and_hands_over_its_momentum() {
    let starts = [("moving_mass_max_m", 0.05), ("u1_N", 1.0)];
    let mut importer = Importer::new(&starts, 2);
    importer.run(1.0, 0.002);
    assert_eq!(importer.events.len(), 1, "{:?}", importer.events);
    assert_eq!(importer.glider.integer("moving_mass_stop"), 1);
    let co_simulation = co_simulated(&starts, 2, 1.0);
    assert_eq!(co_simulation.integer("moving_mass_stop"), 1);
    same(&importer, &co_simulation, 1e-6);
}

#[test]
fn what_is_no_number_is_discarded_by_its_name() {
    let importer = Importer::new(&[], 0);
    let glider = &importer.glider;
    for (state, size, name, unknown) in
        [("v1_m_s", 1e160, "lift_N", "lift_N"), ("pitch_rate_rad_s", 1e300, "der(v1_m_s)", "der(")]
    {
        let mut x = importer.states();
        x[STATES.iter().position(|known| *known == state).unwrap()] = size;
        let (mut rates, mut value) = ([0.0; N], 0.0);
        // SAFETY: a live instance and room for all.
        unsafe {
            let before = importer.states();
            glider.ok(fmi3SetContinuousStates(glider.instance, x.as_ptr(), N));
            assert_eq!(fmi3GetContinuousStateDerivatives(glider.instance, rates.as_mut_ptr(), N), DISCARD);
            assert_eq!(fmi3GetFloat64(glider.instance, &vr(name), 1, &mut value, 1), DISCARD);
            let messages = glider.environment.messages.take();
            assert!(
                messages.len() == 2 && messages[0].1.contains("der(") && messages[1].1.contains(unknown),
                "{messages:?}"
            );
            // What is a number is read, and back in range all is well.
            assert_eq!(glider.get(state), size);
            glider.ok(fmi3SetContinuousStates(glider.instance, before.as_ptr(), N));
            glider.ok(fmi3GetContinuousStateDerivatives(glider.instance, rates.as_mut_ptr(), N));
        }
    }
}

#[test]
fn limits_the_wrong_way_round_keep_an_instance_at_its_event() {
    let importer = Importer::new(&[], 2);
    let glider = &importer.glider;
    let before = importer.states();
    // SAFETY: a live instance.
    unsafe {
        glider.ok(fmi3EnterEventMode(glider.instance));
        glider.set(&[("moving_mass_max_m", -0.3)]);
        let (mut a, mut b, mut c, mut d, mut e, mut t) = (0, 0, 0, 0, 0, 0.0);
        glider.ok(fmi3UpdateDiscreteStates(glider.instance, &mut a, &mut b, &mut c, &mut d, &mut e, &mut t));
        assert_eq!(fmi3EnterContinuousTimeMode(glider.instance), ERROR);
        let messages = glider.environment.messages.take();
        assert!(messages[0].1.contains("moving_mass_max_m = -0.3 lies below moving_mass_min_m = -0.2"), "{messages:?}");
        glider.set(&[("moving_mass_max_m", 0.3)]);
        glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
    }
    assert_eq!(importer.states(), before);
}

#[test]
fn what_cannot_be_set_between_events_is_told_with_what_can() {
    let importer = Importer::new(&[], 0);
    let glider = &importer.glider;
    for (name, expected) in [("b", "only inputs and states move; enter Event Mode first"), ("hull_mass_kg", "fixed")] {
        // SAFETY: a live instance.
        assert_eq!(unsafe { fmi3SetFloat64(glider.instance, &vr(name), 1, &0.2, 1) }, ERROR);
        let messages = glider.environment.messages.take();
        assert!(messages[0].1.contains(expected), "{messages:?}");
    }
    glider.set(&[("current_x_m_s", 0.1), ("pitch_rad", -0.3)]);
}

#[test]
fn right_after_an_event_every_indicator_has_the_sign_of_its_side() {
    let signs = |importer: &Importer| {
        let z = importer.indicators(importer.time, &importer.states());
        assert!(z.iter().all(|z| *z != 0.0), "{z:?}");
        z.map(|z| z > 0.0)
    };
    let all = [true; 6];
    let without = |i: usize| std::array::from_fn(|k| k != i);
    // Exactly at a boundary the glider has not met it yet; well behind, it has.
    for (depth, seabed, expected) in
        [(0.0, 50.0, all), (50.0, 50.0, all), (-0.01, 50.0, without(0)), (50.01, 50.0, without(1))]
    {
        let importer = Importer::new(&[("depth_m", depth), ("seabed_depth_m", seabed)], 0);
        assert_eq!(signs(&importer), expected, "{depth} m above a seabed at {seabed} m");
    }
    for (volume, flow, stop) in [("ballast_min_m3", 0.01, -1), ("ballast_max_m3", -0.01, 1)] {
        let glider = Glider3::model_exchange();
        let mass = 1.0 - 1027.0 * glider.get(volume);
        let mut importer = Importer::new(&[("ballast_mass_kg", mass), ("u4_kg_s", flow)], 2);
        let index = if stop < 0 { 2 } else { 3 };
        assert_eq!((importer.glider.integer("ballast_stop"), signs(&importer)), (stop, without(index)));
        importer.glider.set(&[("u4_kg_s", -flow)]);
        importer.event();
        assert_eq!((importer.glider.integer("ballast_stop"), signs(&importer)), (0, all));
    }
    for (position, force, stop) in [(-0.2, -20.0, -1), (0.2, 20.0, 1)] {
        let starts = [("moving_mass_position_m", position), ("u1_N", force), ("depth_m", 500.0)];
        let mut importer = Importer::new(&starts, 2);
        let index = if stop < 0 { 4 } else { 5 };
        assert_eq!((importer.glider.integer("moving_mass_stop"), signs(&importer)), (stop, without(index)));
        importer.glider.set(&[("u1_N", -force)]);
        importer.event();
        assert_eq!((importer.glider.integer("moving_mass_stop"), signs(&importer)), (0, all));
    }
}

#[test]
fn nominals_are_positive_and_counts_are_right() {
    let glider = Glider3::model_exchange();
    let (mut states, mut events) = (0, 0);
    let mut nominals = [0.0; N];
    // SAFETY: a live instance.
    unsafe {
        glider.ok(fmi3GetNumberOfContinuousStates(glider.instance, &mut states));
        glider.ok(fmi3GetNumberOfEventIndicators(glider.instance, &mut events));
        glider.ok(fmi3GetNominalsOfContinuousStates(glider.instance, nominals.as_mut_ptr(), N));
        assert_eq!(fmi3GetNominalsOfContinuousStates(glider.instance, nominals.as_mut_ptr(), N - 1), ERROR);
    }
    assert_eq!((states, events), (N, 6));
    assert!(nominals.iter().all(|nominal| *nominal > 0.0));
}
