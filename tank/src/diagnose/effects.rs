//! What a point of the fit does to each run: the terms of its reading, and what zeros and loads before it add to its coefficients.
//! Knows runs one by one; neither noise nor the choice of a cause.

use glidepolar_inference::Point;
use nalgebra::{DMatrix, Matrix3, Vector3};

use super::data::ZeroTimes;
use super::drift::Drift;
use super::model::{self, Term, Values};
use super::problem::{Shape, TankProblem};

/// A run is not its own predecessor \[s\].
const SAME_TIME_S: f64 = 0.5;

impl TankProblem<'_> {
    /// The values of all terms for a run at a point.
    pub fn values(&self, run: usize, point: &Point) -> Values {
        let mut values = model::neutral();
        let hull = self.data.runs[run].hull;
        values[..4].copy_from_slice(&point.baseline[4 * hull..4 * hull + 4]);
        let common = 4 * self.data.hulls.len();
        values[Term::MomentCentre.place()] = point.baseline[common];
        for (i, term) in self.strut.iter().enumerate() {
            values[term.place()] = point.baseline[common + 1 + i];
        }
        for (shape, sizes) in self.shapes.iter().zip(&point.candidates) {
            for (i, parameter) in shape.mechanism().parameters.iter().enumerate() {
                let Some(place) = self.place_of(shape, i, run) else { continue };
                if parameter.term != Term::None && sizes[place] != parameter.neutral {
                    values[parameter.term.place()] = sizes[place];
                }
            }
        }
        values
    }

    /// Where a candidate keeps the size that acts on a run; none where it does not.
    pub(super) fn place_of(&self, shape: &Shape, parameter: usize, run: usize) -> Option<usize> {
        match shape {
            Shape::All(_) => Some(parameter),
            Shape::EachHull(m) => Some(m.parameters.len() * self.data.runs[run].hull + parameter),
            Shape::Day(_, day) => (self.days.of_run(run) == Some(*day)).then_some(parameter),
            Shape::Drift(..) | Shape::Before(_) | Shape::WithTare(..) => None,
        }
    }

    /// What drifting zeros add to the coefficients of a run beside the model.
    pub(super) fn added(&self, run: usize, point: &Point) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (shape, sizes) in self.shapes.iter().zip(&point.candidates) {
            if let Shape::Drift(_, channel) = shape
                && sizes[0] != 0.0
            {
                let (net, _) = self.drift(run, *channel, sizes[1]);
                sum += net * sizes[0];
            }
            if let Shape::Before(_) = shape {
                sum += self.before[run] * sizes[0];
            }
            if let Shape::WithTare(_, channel) = shape {
                sum += self.with_tare(run, *channel) * sizes[0];
            }
        }
        sum
    }

    /// Effect of a zero that runs away at unit rate on a run's coefficients, and its slope against the time constant.
    pub(super) fn drift(&self, run: usize, channel: usize, time_constant_h: f64) -> (Vector3<f64>, Vector3<f64>) {
        let data = &self.data.runs[run];
        let drift = Drift { time_constant_h };
        let reading = self.days.net(&drift, &data.zeros);
        // Through the interaction, less what the tare took along.
        let of_tare: Vec<(f64, f64)> =
            self.data.tare_zeros.iter().map(|zeros: &ZeroTimes| self.days.net(&drift, zeros)).collect();
        let force = [0, 1, 2].map(|to| {
            let share = data.interaction[(to, channel)];
            let tare = data.tare_weights[to].iter().zip(&of_tare);
            let (by_rate, by_time) = tare.fold((0.0, 0.0), |sum, (w, t)| (sum.0 + w * t.0, sum.1 + w * t.1));
            (share * (reading.0 - by_rate), share * (reading.1 - by_time))
        });
        let map = self.map(run);
        (map * Vector3::from(force.map(|f| f.0)), map * Vector3::from(force.map(|f| f.1)))
    }

    /// Effect on a run's coefficients of a unit shift of a channel's reading in this run and in every run of the strut alone.
    pub(super) fn with_tare(&self, run: usize, channel: usize) -> Vector3<f64> {
        let data = &self.data.runs[run];
        let force = [0, 1, 2].map(|to| data.interaction[(to, channel)] * (1.0 - data.tare_weights[to].sum()));
        self.map(run) * Vector3::from(force)
    }

    /// What the balance would show of the last load if it kept it whole, less what the zeros of the run took along, as CL, CD,
    /// CM. Loads of other than steady runs are not known; a zero run leaves what was there.
    pub(super) fn loads_before(&self) -> Vec<Vector3<f64>> {
        let readings: Vec<(f64, Vector3<f64>)> = self
            .order
            .iter()
            .map(|run| {
                // The balance carried the strut as well.
                let force = self.force(*run) + self.data.runs[*run].strut;
                let to_reading = self.data.runs[*run].interaction.try_inverse().unwrap_or_else(Matrix3::identity);
                (self.data.runs[*run].zeros.time_s, to_reading * force)
            })
            .collect();
        let last = |time_s: f64| {
            // Over night a balance recovers.
            let day = self.days.day_at(time_s);
            let loaded = |at: f64| at < time_s - SAME_TIME_S && self.days.day_at(at) == day;
            readings.iter().rev().find(|(at, _)| loaded(*at)).map_or(Vector3::zeros(), |(_, load)| *load)
        };
        (0..self.data.runs.len())
            .map(|run| {
                let data = &self.data.runs[run];
                let of_zeros: Vector3<f64> =
                    data.zeros.zeros.iter().map(|(time_s, weight)| last(*time_s) * *weight).sum();
                self.map(run) * data.interaction * (last(data.zeros.time_s) - of_zeros)
            })
            .collect()
    }

    /// Force about the moment centre: AF, SF, YM.
    pub(super) fn force(&self, run: usize) -> Vector3<f64> {
        let c = Vector3::from(self.data.runs[run].point.coefficients);
        self.map(run).try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * c)
    }

    /// AF, SF, YM about the moment centre to CL, CD, CM.
    pub(super) fn map(&self, run: usize) -> Matrix3<f64> {
        let s = &self.settings[run];
        let column = |axial_N: f64, side_N: f64, yaw_N_m: f64| {
            let c = glidepolar_hull::coefficients::BalanceForce { axial_N, side_N, yaw_N_m }
                .moved(s.mc_m, s.cb_m)
                .in_wind_axes(s.yaw_rad)
                .coefficients(s.pressure_Pa, s.area_m2, s.length_m);
            Vector3::new(c.lift, c.drag, c.moment)
        };
        Matrix3::from_columns(&[column(1.0, 0.0, 0.0), column(0.0, 1.0, 0.0), column(0.0, 0.0, 1.0)])
    }

    /// Largest magnitude of a channel's force about the moment centre.
    pub(super) fn largest(&self, channel: usize) -> f64 {
        (0..self.data.runs.len()).map(|run| self.force(run)[channel].abs()).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Puts the slopes of a run's row against the baseline's parameters in their places.
    pub(super) fn put_baseline(
        &self,
        columns: &mut DMatrix<f64>,
        row: usize,
        run: usize,
        slopes: &[f64; model::TERMS],
    ) {
        let common = 4 * self.data.hulls.len();
        for j in 0..4 {
            columns[(row, 4 * self.data.runs[run].hull + j)] = slopes[j];
        }
        columns[(row, common)] = slopes[Term::MomentCentre.place()];
        for (j, term) in self.strut.iter().enumerate() {
            columns[(row, common + 1 + j)] = slopes[term.place()];
        }
    }
}
