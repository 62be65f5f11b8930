//! Errors that runs share: those of the tare, the zeros, the interaction matrix, the calibration, the carriage's speed. Each kind is taken apart
//! into independent parts of one standard error each, and a run carries only the parts that it feels: a long campaign has
//! thousands of zeros, and every run rests on two of them.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::campaign::Balance;
use crate::influence::Influence;
use crate::steady_run::SteadyRun;
use crate::tare::Tare;
use crate::zeros::Zeros;

/// Standard uncertainty of the carriage's speed, which all runs share, as a share of it: speed shall be measured to within 0.1 %, or 3 mm/s
/// where that is more (ITTC 7.5-02-02-01, Resistance Test): of 0.1 % a rectangular distribution of that half-width. The force coefficients move by twice as much.
const SPEED_UNCERTAINTY: f64 = 1e-3 / 1.732_050_8;

/// What all runs of a campaign have in common.
#[derive(Debug, Clone)]
pub struct Common<'a> {
    /// The balance.
    pub balance: &'a Balance,
    /// The zeros.
    pub zeros: &'a Zeros,
    /// The strut, where it was towed alone.
    pub tare: Option<&'a Tare>,
}

/// An error that runs share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SharedKind {
    /// The strut's force in one channel.
    Tare(usize),
    /// The zero runs.
    Zeros,
    /// The elements of the interaction matrix.
    Interaction,
    /// The calibration of the balance.
    Calibration,
    /// The speed of the carriage.
    Speed,
}

impl SharedKind {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            SharedKind::Tare(0) => "tare AF",
            SharedKind::Tare(1) => "tare SF",
            SharedKind::Tare(_) => "tare YM",
            SharedKind::Zeros => "zeros",
            SharedKind::Interaction => "interaction",
            SharedKind::Calibration => "calibration",
            SharedKind::Speed => "speed",
        }
    }
}

impl Common<'_> {
    /// The errors that a campaign's runs share: the tare channel by channel, the zeros, the calibration, the speed.
    pub fn shared(&self) -> Vec<SharedKind> {
        let mut kinds = Vec::new();
        if self.tare.is_some() {
            kinds.extend((0..3).map(SharedKind::Tare));
        }
        if !self.zeros.zeros.is_empty() {
            kinds.push(SharedKind::Zeros);
        }
        if self.balance.interaction_uncertainty.is_some() {
            kinds.push(SharedKind::Interaction);
        }
        if self.balance.uncertainty.is_some() {
            kinds.push(SharedKind::Calibration);
        }
        kinds.push(SharedKind::Speed);
        kinds
    }

    /// Degrees of freedom with which the size of an error is known.
    pub fn shared_dof(&self, kind: SharedKind) -> f64 {
        match (kind, self.tare) {
            (SharedKind::Tare(channel), Some(tare)) => tare.dof(channel),
            (SharedKind::Zeros, _) => self.zeros.dof,
            _ => f64::INFINITY,
        }
    }

    /// Influence of one kind of error on the force of a steady run: AF, SF, YM.
    pub fn influence(&self, kind: SharedKind, run: &SteadyRun) -> Influence {
        match (kind, self.tare) {
            (SharedKind::Tare(channel), Some(tare)) => {
                let of_terms = tare.gradient(channel, &run.motion, run.run.water.density_kg_m3);
                self.tare_influence(channel, &-of_terms).on_channel(channel)
            }
            (SharedKind::Zeros, _) => self.zero_influence(run),
            // Run and tare went through the same matrix.
            (SharedKind::Interaction, _) => self.interaction_influence(run.steps.force - run.steps.tare),
            // A calibration may be off in proportion to the load: alike on one side, opposite on the other.
            (SharedKind::Calibration, _) => {
                let side = run.steps.water()[1].signum();
                self.calibration_influence(Vector3::new(1.0, side, side))
            }
            // Forces go with the square of the speed: a speed that is high by a share is a force that is low by two.
            (SharedKind::Speed, _) => {
                let force = -2.0 * SPEED_UNCERTAINTY * run.steps.water();
                Influence::of_all(DMatrix::from_column_slice(3, 1, force.as_slice()))
            }
            (SharedKind::Tare(_), None) => Influence::none(3),
        }
    }

    /// Of the tare of one channel on a number that changes so with the terms of the tare.
    pub fn tare_influence(&self, channel: usize, of_terms: &DVector<f64>) -> Influence {
        match self.tare {
            Some(tare) => {
                let parts = tare.root(channel).tr_mul(of_terms);
                Influence::of_all(DMatrix::from_row_slice(1, parts.len(), parts.as_slice()))
            }
            None => Influence::none(1),
        }
    }

    /// Of the elements of the interaction matrix on a force that came through it.
    pub fn interaction_influence(&self, force: Vector3<f64>) -> Influence {
        let reading = self.balance.interaction.try_inverse().unwrap_or_else(Matrix3::identity) * force;
        let uncertainty = self.balance.interaction_uncertainty.unwrap_or_default();
        let of = |channel: usize, part: usize| match part / 3 == channel {
            true => uncertainty[(channel, part % 3)] * reading[part % 3],
            false => 0.0,
        };
        Influence::of_all(DMatrix::from_fn(3, 9, of))
    }

    /// Of the calibration on a force of this direction in each channel.
    pub fn calibration_influence(&self, side: Vector3<f64>) -> Influence {
        let uncertainty = Vector3::from(self.balance.uncertainty.unwrap_or_default());
        Influence::of_all(DMatrix::from_diagonal(&DVector::from_column_slice(
            side.component_mul(&uncertainty).as_slice(),
        )))
    }

    fn zero_influence(&self, run: &SteadyRun) -> Influence {
        let root = self.balance.interaction * self.zeros.root;
        let mut parts = run.zero.parts.clone();
        parts.sort_by_key(|(zero, _)| *zero);
        let bridge = run.zero.bridge.filter(|_| self.zeros.walk.amax() > 0.0);
        let mut on = DMatrix::zeros(3, 3 * (parts.len() + usize::from(bridge.is_some())));
        for (place, (_, weight)) in parts.iter().enumerate() {
            on.fixed_view_mut::<3, 3>(0, 3 * place).copy_from(&(-*weight * root));
        }
        let mut felt: Vec<usize> = parts.iter().flat_map(|(zero, _)| (0..3).map(move |k| 3 * zero + k)).collect();
        if let Some((gap, sd)) = bridge {
            let walk = self.balance.interaction * Matrix3::from_diagonal(&self.zeros.walk.map(|rate| sd * rate.sqrt()));
            on.fixed_view_mut::<3, 3>(0, 3 * parts.len()).copy_from(&(-walk));
            felt.extend((0..3).map(|k| 3 * (self.zeros.zeros.len() + gap) + k));
        }
        Influence { parts: felt, on }
    }
}
