//! Steps of one method about one origin: to a bend, to an event, to where they are to end.

use super::ahead::Ahead;
use super::crossing::{EVENT_WIDTH_S, first_change, locate, sign_changes};
use super::method::{Method, Stretch, Trial};
use super::{Advance, FIRST_STEP_S, IntegrationError, LONGEST_STEP_S, System};

/// Rejections in a row after which the step is given up.
const MAX_REJECTIONS: usize = 100;

/// So near to a bend a step is at it: what is left on the other side no error shows \[s\].
const AT_A_BEND_S: f64 = 1e-5;

/// How far past the place of the dense output an event is looked for at most \[s\].
const LANDING_S: f64 = 1e-2;

/// Where a run stands.
#[derive(Debug, Clone, Copy)]
pub struct Place<const N: usize> {
    /// Time \[s\].
    pub time_s: f64,
    /// State.
    pub state: [f64; N],
    /// The step that is next \[s\].
    pub step_s: f64,
    /// Explicit steps still to go before the implicit method is tried again.
    pub explicit_steps: usize,
    /// The step that went beyond time and state, if it did.
    pub ahead: Option<Ahead<N>>,
}

/// Where steps lead.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    /// The time whose state is wanted \[s\].
    pub wanted_s: f64,
    /// The time that no step may pass, not before it \[s\].
    pub target_s: f64,
}

/// When a stretch ends before its aim.
#[derive(Debug, Clone, Copy)]
pub struct Until {
    /// After so many accepted steps.
    pub steps: usize,
    /// With a rejected step after which the next is to be shorter than this \[s\].
    pub shorter_than_s: f64,
}

impl Until {
    /// After so many accepted steps.
    pub fn steps(steps: usize) -> Self {
        Until { steps, shorter_than_s: 0.0 }
    }
}

impl<S, const N: usize> Stretch<'_, S, N> {
    /// Steps to what is wanted, an event, or the end of the stretch. Returns how many were accepted, and the event.
    pub fn walk<M: Method<S, N, F, E>, const F: usize, const E: usize>(
        &self,
        tolerance: f64,
        place: &mut Place<N>,
        aim: Aim,
        until: Until,
    ) -> Result<(usize, Option<Advance<E>>), IntegrationError>
    where
        S: System<N, F, E>,
    {
        let mut method = M::begin(self, tolerance, place.time_s, place.step_s.min(LONGEST_STEP_S))?;
        let mut before = self.system.event_indicators(place.time_s, &place.state);
        let (mut accepted, mut rejected) = (0, 0);
        let mut stop_s = self.next_stop_s(place, aim.target_s);
        while place.time_s < aim.wanted_s && accepted < until.steps {
            let remaining = stop_s - method.time_s();
            let unclipped = method.next_step_s();
            if unclipped <= 1e-13 * place.time_s.abs().max(1e-3) && unclipped < remaining {
                return Err(self.too_small(place));
            }
            let clipped = unclipped >= remaining * (1.0 - 1e-10);
            if clipped {
                method.set_next_step_s(remaining);
            }
            match method.step(self) {
                Trial::Failed => return Err(self.too_small(place)),
                Trial::Rejected if method.next_step_s() < until.shorter_than_s => {
                    place.step_s = method.next_step_s();
                    return Ok((accepted, None));
                }
                Trial::Rejected if rejected >= MAX_REJECTIONS => return Err(self.too_small(place)),
                Trial::Rejected => {
                    rejected += 1;
                    continue;
                }
                Trial::Accepted => (accepted, rejected) = (accepted + 1, 0),
            }
            if !method.place().iter().all(|value| value.is_finite()) {
                return Err(IntegrationError::NotFinite { time_s: place.time_s });
            }
            let reached_s = if clipped { stop_s } else { method.time_s() };
            let after = self.indicators(reached_s, method.place());
            let mut known_to_s = reached_s;
            if let Some(ends) = first_change(self, &mut method, (place.time_s, reached_s), (&before, &after)) {
                let (event_s, event) = locate(self, &mut method, ends, &before);
                if event_s <= aim.wanted_s {
                    let passed = self.land::<M, F, E>(tolerance, place, (event_s, event, &before), aim.wanted_s)?;
                    return Ok((accepted, passed));
                }
                known_to_s = (event_s - LANDING_S).max(aim.wanted_s);
            }
            // A step that was cut to end at a stop says nothing against the one before it.
            place.step_s = if clipped { unclipped.max(method.next_step_s()) } else { method.next_step_s() };
            if reached_s > aim.wanted_s {
                let span = (place.time_s, reached_s, known_to_s);
                let inside = |time_s| method.inside(time_s).map(|scaled| self.state(&scaled));
                let ahead = Ahead::new(span, place.state, &S::NOMINALS, inside).ok_or_else(|| self.too_small(place))?;
                let wanted = ahead.at(aim.wanted_s);
                let changed = sign_changes(&before, &self.system.event_indicators(aim.wanted_s, &wanted));
                if changed.contains(&true) {
                    // An event so near that rounding decides: the method's own state there says whether it has happened.
                    let passed =
                        self.land::<M, F, E>(tolerance, place, (aim.wanted_s, changed, &before), aim.wanted_s)?;
                    return Ok((accepted, passed));
                }
                (place.time_s, place.state, place.ahead) = (aim.wanted_s, wanted, Some(ahead));
                return Ok((accepted, None));
            }
            (place.time_s, place.state, before) = (reached_s, self.state(method.place()), after);
            method.set_next_step_s(place.step_s);
            stop_s = self.next_stop_s(place, aim.target_s);
        }
        Ok((accepted, None))
    }

    /// Goes to the event by steps of its own, so that the state there has the order of the method, not of the dense
    /// output that found it. The two differ by the tolerance, and a slow crossing may not have happened yet where the
    /// dense output has it: then a little further, or the same event would be found again without end.
    fn land<M: Method<S, N, F, E>, const F: usize, const E: usize>(
        &self,
        tolerance: f64,
        place: &mut Place<N>,
        (mut event_s, changed, before): (f64, [bool; E], &[f64; E]),
        target_s: f64,
    ) -> Result<Option<Advance<E>>, IntegrationError>
    where
        S: System<N, F, E>,
    {
        let stretch = &Stretch { origin: place.state, ..*self };
        let first_step_s = (event_s - place.time_s).min(place.step_s).clamp(EVENT_WIDTH_S, LONGEST_STEP_S);
        let mut method = M::begin(stretch, tolerance, place.time_s, first_step_s)?;
        let (mut rejected, mut further_s) = (0, EVENT_WIDTH_S);
        loop {
            let remaining = event_s - method.time_s();
            if remaining <= 4.0 * f64::EPSILON * event_s.abs() {
                let landed = stretch.state(method.place());
                let crossed = sign_changes(before, &stretch.system.event_indicators(event_s, &landed));
                let is_behind = crossed.contains(&true);
                if is_behind || further_s > LANDING_S || event_s >= target_s {
                    (place.time_s, place.state) = (event_s, landed);
                    place.step_s = place.step_s.min(FIRST_STEP_S);
                    // Not yet there at the target: the next advance will find it.
                    let is_left = !is_behind && event_s >= target_s;
                    return Ok((!is_left).then_some(Advance::Event(if is_behind { crossed } else { changed })));
                }
                event_s = (event_s + further_s).min(target_s);
                further_s *= 2.0;
                continue;
            }
            if method.next_step_s() >= remaining * (1.0 - 1e-10) {
                method.set_next_step_s(remaining);
            }
            let trial = method.step(stretch);
            rejected = if trial == Trial::Rejected { rejected + 1 } else { 0 };
            if trial == Trial::Failed || rejected > MAX_REJECTIONS {
                return Err(IntegrationError::StepTooSmall { time_s: place.time_s });
            }
        }
    }

    /// Where a step from here must end at the latest: at a bend of the rates, or at the target.
    fn next_stop_s<const F: usize, const E: usize>(&self, place: &Place<N>, target_s: f64) -> f64
    where
        S: System<N, F, E>,
    {
        let is_ahead = |bend_s: &f64| *bend_s > place.time_s + AT_A_BEND_S && *bend_s < target_s - AT_A_BEND_S;
        self.system.next_bend_s(place.time_s, &place.state).filter(is_ahead).unwrap_or(target_s)
    }

    /// Why there is no way on: rates that are no numbers reject every step, however small.
    fn too_small<const F: usize, const E: usize>(&self, place: &Place<N>) -> IntegrationError
    where
        S: System<N, F, E>,
    {
        let time_s = place.time_s;
        let rates = self.system.derivative(time_s.min(self.last_s), &place.state);
        if rates.iter().all(|rate| rate.is_finite()) {
            IntegrationError::StepTooSmall { time_s }
        } else {
            IntegrationError::NotFinite { time_s }
        }
    }
}
