//! The empirical table: what a log shows without a known cause, as the glider flies it.
//!
//! Where a diagnosis finds something that no mechanism explains and that still predicts, the extended vehicle carries it as five
//! points of drag, lift or net mass against pressure, time or temperature, straight between them and level beyond. It is
//! no physics: it holds in the range of the log it comes from. Knows parameters and the water.

use super::buoyancy::Surroundings;
use super::parameters::Parameters;
use glidepolar_number::Number;

/// The rows of the table of parameters that make it.
pub const PARAMETERS: [&str; 12] = [
    "empirical_acts_on",
    "empirical_against",
    "empirical_at_1",
    "empirical_at_2",
    "empirical_at_3",
    "empirical_at_4",
    "empirical_at_5",
    "empirical_value_1",
    "empirical_value_2",
    "empirical_value_3",
    "empirical_value_4",
    "empirical_value_5",
];

/// Points of the table.
pub const POINTS: usize = 5;

/// Pascal in a decibar, seconds in an hour.
const DBAR_PA: f64 = 1e4;
const HOUR_S: f64 = 3600.0;

/// What the table changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// The drag, by a share of it.
    Drag,
    /// The lift, by a share of it.
    Lift,
    /// The net mass \[kg\].
    NetMass,
}

impl ActsOn {
    /// All of them, in the order of their codes from 1 on.
    pub const ALL: [ActsOn; 3] = [ActsOn::Drag, ActsOn::Lift, ActsOn::NetMass];

    /// Its code among the parameters.
    #[inline]
    pub fn code(self) -> f64 {
        1.0 + f64::from(self as u8)
    }
}

/// What the table goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Against {
    /// Gauge pressure \[dbar\].
    Pressure,
    /// Time since the start \[h\].
    Time,
    /// Temperature of the water \[degC\].
    Temperature,
}

impl Against {
    /// All of them, in the order of their codes from 0 on.
    pub const ALL: [Against; 3] = [Against::Pressure, Against::Time, Against::Temperature];

    /// Its code among the parameters.
    #[inline]
    pub fn code(self) -> f64 {
        f64::from(self as u8)
    }

    /// Its value in this water, in the unit of the table.
    pub fn value<T: Number>(self, water: &Surroundings<T>) -> T {
        match self {
            Against::Pressure => water.pressure_Pa / DBAR_PA,
            Against::Time => water.time_s / HOUR_S,
            Against::Temperature => water.temperature_C,
        }
    }
}

/// Shares with which the values at the points enter at `x`: straight lines between neighbours, level beyond the ends. Points that
/// do not rise take no part.
pub fn shares<T: Number>(at: [T; POINTS], x: T) -> [T; POINTS] {
    let mut shares = [T::constant(0.0); POINTS];
    let mut low = 0;
    for next in 1..POINTS {
        if x.value() <= at[low].value() {
            break;
        }
        if at[next].value() <= at[low].value() {
            continue;
        }
        if x.value() < at[next].value() {
            let share = (x - at[low]) / (at[next] - at[low]);
            shares[low] = T::constant(1.0) - share;
            shares[next] = share;
            return shares;
        }
        low = next;
    }
    shares[low] = T::constant(1.0);
    shares
}

/// What the table adds in one water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Added<T> {
    /// To the drag, as a share of it.
    pub drag: T,
    /// To the lift, as a share of it.
    pub lift: T,
    /// To the net mass \[kg\].
    pub net_mass_kg: T,
}

impl<T: Number> Added<T> {
    /// Nothing.
    pub fn nothing() -> Self {
        let zero = T::constant(0.0);
        Added { drag: zero, lift: zero, net_mass_kg: zero }
    }
}

impl<T: Number> Parameters<T> {
    /// What the empirical table adds in this water.
    pub fn empirical(&self, water: &Surroundings<T>) -> Added<T> {
        let nothing = Added::nothing();
        if self.empirical_acts_on.value() == 0.0 {
            return nothing;
        }
        let acts_on = self.empirical_acts_on.value().round();
        let Some(acts) = ActsOn::ALL.into_iter().find(|acts| acts.code() == acts_on) else { return nothing };
        let against = self.empirical_against.value().round();
        let Some(against) = Against::ALL.into_iter().find(|other| other.code() == against) else { return nothing };
        let at =
            [self.empirical_at_1, self.empirical_at_2, self.empirical_at_3, self.empirical_at_4, self.empirical_at_5];
        let values = [
            self.empirical_value_1,
            self.empirical_value_2,
            self.empirical_value_3,
            self.empirical_value_4,
            self.empirical_value_5,
        ];
        let shares = shares(at, against.value(water));
        let added = shares.into_iter().zip(values).fold(T::constant(0.0), |sum, (share, value)| sum + share * value);
        match acts {
            ActsOn::Drag => Added { drag: added, ..nothing },
            ActsOn::Lift => Added { lift: added, ..nothing },
            ActsOn::NetMass => Added { net_mass_kg: added, ..nothing },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_water(pressure_dbar: f64, time_h: f64, temperature_c: f64) -> Surroundings<f64> {
        Surroundings {
            density_kg_m3: 1027.0,
            pressure_Pa: DBAR_PA * pressure_dbar,
            temperature_C: temperature_c,
            time_s: HOUR_S * time_h,
        }
    }

    #[test]
    fn the_table_is_straight_between_its_points_and_level_beyond() {
        let at = [10.0, 20.0, 40.0, 80.0, 100.0];
        let value =
            |x: f64| -> f64 { shares(at, x).into_iter().zip([1.0, 3.0, -1.0, 0.0, 5.0]).map(|(s, v)| s * v).sum() };
        for (x, expected) in
            [(0.0, 1.0), (10.0, 1.0), (15.0, 2.0), (20.0, 3.0), (30.0, 1.0), (60.0, -0.5), (90.0, 2.5), (1e3, 5.0)]
        {
            assert!((value(x) - expected).abs() < 1e-12, "{x}: {}", value(x));
        }
        // A point that stands where the one before it does is passed over.
        let twice = shares([0.0, 0.0, 2.0, 2.0, 4.0], 1.0);
        assert!((twice.iter().sum::<f64>() - 1.0).abs() < 1e-12 && twice[2] == 0.5, "{twice:?}");
    }

    #[test]
    fn codes_count_on_in_the_order_of_the_lists() {
        assert_eq!(ActsOn::ALL.map(ActsOn::code), [1.0, 2.0, 3.0]);
        assert_eq!(Against::ALL.map(Against::code), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn it_acts_on_one_quantity_and_not_at_all_by_default() {
        let plain = Parameters::<f64>::default();
        assert_eq!(plain.empirical(&in_water(50.0, 3.0, 7.0)), Added::nothing());
        let mut p = Parameters { empirical_against: 1.0, empirical_value_4: 0.2, empirical_acts_on: 3.0, ..plain };
        let water = in_water(50.0, 3.0, 7.0);
        assert!((p.net_mass_kg(0.0, &water) - plain.net_mass_kg(0.0, &water) - 0.2).abs() < 1e-12);
        p.empirical_acts_on = 1.0;
        assert_eq!(p.net_mass_kg(0.0, &water), plain.net_mass_kg(0.0, &water));
        let glide = |p: &Parameters<f64>| {
            let attitude = crate::glide::Attitude { pitch_rad: -0.4, net_mass_kg: 0.2 };
            crate::glide::at_pitch(p, &water, attitude).expect("a glide").speed_m_s
        };
        // Of 1.2 times the drag at nearly the same angle: V ~ D^-1/2.
        let ratio = glide(&p) / glide(&plain);
        assert!((ratio - 1.2f64.powf(-0.5)).abs() < 0.02, "{ratio}");
    }
}
