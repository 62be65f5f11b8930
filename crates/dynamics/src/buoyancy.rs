//! What the glider weighs in water: masses, displaced volume and the mechanisms that change them.
//!
//! ```text
//! m0 = m + offset + leak t + [t >= t_s] step - rho ( V0 (1 - eps P - eps_c Q + tau (T - T_ref)) + s V_b - V_l + V_air P0 / (P0 + P) )
//!      + V_c (r - rho / (1 + kappa P)) - rho V0 tau_l (T_l - T)
//! ```
//! What stands for the past follows by rates of its own: `Q' = (P - Q) / tau_c` the late part of the pressure on a viscoelastic
//! hull (standard linear solid), `r' = (rho / (1 + kappa P) - r) / tau_e` the density of carried water, brought to p = 0,
//! `T_l' = (T - T_l) / tau_t` the temperature of what is slow in the hull, and `V_l' = k` the ballast volume that leaks back, anew from
//! zero whenever the engine moves. Of the expansion `tau` the part `tau_l` comes late, so that it has no effect where the
//! temperature stays. The inertia of carried water belongs to the added masses.
//!
//! `m` mass in air with the ballast volume at zero, `V_b` the ballast volume that is read, `P` gauge pressure. With
//! every mechanism at its default and water of the reference density this is Leonard and Graver's excess mass
//! `m0 = m_h + m_b + mbar - m`. Knows nothing of motion.

use super::parameters::Parameters;
use glidepolar_number::Number;

/// Atmospheric pressure \[Pa\], the standard atmosphere.
pub const ATMOSPHERE_PA: f64 = 101_325.0;

/// Seconds in an hour.
const HOUR_S: f64 = 3600.0;

/// Relative compressibility of sea water \[1/Pa\], within a tenth over the ocean's upper kilometre (TEOS-10).
pub const WATER_COMPRESSIBILITY_PER_PA: f64 = 4.4e-10;

/// Shortest time constant of what follows \[s\]: a shorter one is at once.
const AT_ONCE_S: f64 = 1.0;

/// Time in which a moving engine takes up what has leaked back \[s\].
const TAKEN_UP_S: f64 = 10.0;

/// What the glider keeps of where it has been.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory<T> {
    /// Gauge pressure that the late part of the hull has followed so far \[Pa\].
    pub creep_pressure_Pa: T,
    /// Density of the carried water brought to p = 0, less the reference density \[kg/m3\].
    pub carried_density_kg_m3: T,
    /// Temperature of the part of the hull that follows late, less the reference temperature \[K\].
    pub late_temperature_K: T,
    /// Ballast volume that has leaked back \[m3\].
    pub leaked_back_m3: T,
}

/// The water at one place, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings<T> {
    /// In-situ density as it is read \[kg/m3\].
    pub density_kg_m3: T,
    /// Gauge pressure \[Pa\].
    pub pressure_Pa: T,
    /// Temperature \[degC\].
    pub temperature_C: T,
    /// Time since the start \[s\]: what a leak, fouling and what is lost or caught go by.
    pub time_s: T,
}

impl<T: Number> Parameters<T> {
    /// Mass in air with the ballast volume at zero, the error of the trim left out \[kg\].
    pub fn mass_kg(&self) -> T {
        self.hull_mass_kg + self.moving_mass_kg + self.ballast_nominal_kg
    }

    /// Mass of the water that is carried along, which has inertia and weighs nothing in water of its own density \[kg\].
    pub fn carried_mass_kg(&self) -> T {
        self.carried_water_m3 * self.reference_density_kg_m3
    }

    /// Density of the water, once the error of its reading is taken off \[kg/m3\].
    pub fn true_density_kg_m3(&self, density_kg_m3: T) -> T {
        density_kg_m3 + self.density_bias_kg_m3
    }

    /// Volume that the hull displaces, ballast and trapped air apart \[m3\].
    pub fn hull_volume_m3(&self, water: &Surroundings<T>) -> T {
        let strain = -self.hull_compressibility_per_Pa * water.pressure_Pa
            + self.hull_thermal_expansion_per_K * self.warmer_than_reference_K(water);
        self.displaced_mass_kg / self.reference_density_kg_m3 * (strain + 1.0)
    }

    /// Net mass, positive when the glider is heavy \[kg\]; the net weight W - B is this times gravity.
    pub fn net_mass_kg(&self, ballast_m3: T, water: &Surroundings<T>) -> T {
        let constant = self.mass_kg() + self.ballast_offset_kg + self.leak_kg_per_hour * water.time_s / HOUR_S;
        let mass = constant + self.lost_or_caught_kg(water.time_s);
        mass - self.displaced_kg(ballast_m3, water) + self.empirical(water).net_mass_kg
    }

    /// What was lost or caught by this time adds to the net mass \[kg\].
    fn lost_or_caught_kg(&self, time_s: T) -> T {
        let is_behind = time_s.value() >= self.net_mass_step_time_s.value();
        if is_behind { self.net_mass_step_kg } else { T::constant(0.0) }
    }

    /// Mass of the water that hull, ballast and trapped air displace \[kg\].
    pub fn displaced_kg(&self, ballast_m3: T, water: &Surroundings<T>) -> T {
        let trapped_air_m3 =
            self.trapped_air_cc * 1e-6 * ATMOSPHERE_PA / (water.pressure_Pa.at_least(0.0) + ATMOSPHERE_PA);
        let volume = self.hull_volume_m3(water) + self.ballast_scale * ballast_m3 + trapped_air_m3;
        self.true_density_kg_m3(water.density_kg_m3) * volume
    }

    /// Density of the water here brought to p = 0, less the reference density \[kg/m3\]: what carried water comes to.
    pub fn carried_from_kg_m3(&self, water: &Surroundings<T>) -> T {
        let compressed = water.pressure_Pa.at_least(0.0) * WATER_COMPRESSIBILITY_PER_PA + 1.0;
        self.true_density_kg_m3(water.density_kg_m3) / compressed - self.reference_density_kg_m3
    }

    /// Temperature of the water less the reference temperature \[K\]: what the late part of the hull comes to.
    pub fn warmer_than_reference_K(&self, water: &Surroundings<T>) -> T {
        water.temperature_C - self.reference_temperature_C
    }

    /// What the past adds to the net mass \[kg\].
    pub fn kept_mass_kg(&self, memory: &Memory<T>, water: &Surroundings<T>) -> T {
        let density = self.true_density_kg_m3(water.density_kg_m3);
        let volume = self.displaced_mass_kg / self.reference_density_kg_m3;
        let late_strain = self.hull_creep_per_Pa * memory.creep_pressure_Pa
            - self.late_expansion_per_K * (memory.late_temperature_K - self.warmer_than_reference_K(water));
        density * (late_strain * volume + memory.leaked_back_m3)
            + self.carried_water_m3 * (memory.carried_density_kg_m3 - self.carried_from_kg_m3(water))
    }

    /// How the memory changes; `pumping` is the rate of the ballast volume over its largest. What no mechanism needs rests.
    pub fn memory_rates(&self, memory: &Memory<T>, water: &Surroundings<T>, pumping: T) -> Memory<T> {
        let rest = T::constant(0.0);
        let follow = |size: T, late: T, goal: T, time_s: T| {
            if size.value() == 0.0 { rest } else { (goal - late) / time_s.at_least(AT_ONCE_S) }
        };
        let leakback_m3_s = self.pump_leakback_cc_per_hour * (1e-6 / HOUR_S);
        Memory {
            creep_pressure_Pa: follow(
                self.hull_creep_per_Pa,
                memory.creep_pressure_Pa,
                water.pressure_Pa,
                self.creep_time_s,
            ),
            carried_density_kg_m3: follow(
                self.carried_water_m3,
                memory.carried_density_kg_m3,
                self.carried_from_kg_m3(water),
                self.exchange_time_s,
            ),
            late_temperature_K: follow(
                self.late_expansion_per_K,
                memory.late_temperature_K,
                self.warmer_than_reference_K(water),
                self.expansion_time_s,
            ),
            leaked_back_m3: if leakback_m3_s.value() == 0.0 {
                rest
            } else {
                leakback_m3_s - memory.leaked_back_m3 * pumping.abs() / TAKEN_UP_S
            },
        }
    }

    /// Ballast mass that stands for a ballast volume, by the reference density \[kg\].
    pub fn ballast_mass_kg(&self, ballast_m3: T) -> T {
        self.ballast_nominal_kg - self.reference_density_kg_m3 * ballast_m3
    }

    /// Ballast volume that a ballast mass stands for, the inverse of [`Parameters::ballast_mass_kg`] \[m3\].
    pub fn ballast_m3(&self, ballast_mass_kg: T) -> T {
        (self.ballast_nominal_kg - ballast_mass_kg) / self.reference_density_kg_m3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(depth_pressure_Pa: f64) -> Surroundings<f64> {
        Surroundings { density_kg_m3: 1027.0, pressure_Pa: depth_pressure_Pa, temperature_C: 15.0, time_s: 0.0 }
    }

    #[test]
    fn without_mechanisms_it_is_the_excess_mass_of_the_papers() {
        let p = Parameters::default();
        for ballast_mass in [0.5, 1.0, 1.047_349] {
            let excess = p.hull_mass_kg + ballast_mass + p.moving_mass_kg - p.displaced_mass_kg;
            let net = p.net_mass_kg(p.ballast_m3(ballast_mass), &at(1e6));
            assert!((net - excess).abs() < 1e-12, "{net} against {excess}");
        }
    }

    #[test]
    fn what_is_kept_of_the_past_weighs_what_a_hand_computation_says() {
        let nothing = Memory {
            creep_pressure_Pa: 3e6,
            carried_density_kg_m3: -2.0,
            late_temperature_K: 4.0,
            leaked_back_m3: 0.0,
        };
        let p = Parameters::<f64>::default();
        assert_eq!(p.kept_mass_kg(&nothing, &at(5e6)), 0.0);
        let resting =
            Memory { creep_pressure_Pa: 0.0, carried_density_kg_m3: 0.0, late_temperature_K: 0.0, leaked_back_m3: 0.0 };
        assert_eq!(p.memory_rates(&nothing, &at(5e6), 1.0), resting);

        let creeping = Parameters { hull_creep_per_Pa: 2e-10, creep_time_s: 7200.0, ..p };
        assert!((creeping.kept_mass_kg(&nothing, &at(5e6)) - 50.0 * 2e-10 * 3e6).abs() < 1e-12);
        assert!((creeping.memory_rates(&nothing, &at(5e6), 0.0).creep_pressure_Pa - 2e6 / 7200.0).abs() < 1e-9);

        // Ten litres from water that is lighter by 2 kg/m3 than that of the reference, at p = 0.
        let carrying = Parameters { carried_water_m3: 0.01, exchange_time_s: 600.0, ..p };
        let around = 1027.0 / (1.0 + 4.4e-10 * 5e6) - 1027.0;
        assert!((carrying.kept_mass_kg(&nothing, &at(5e6)) - 0.01 * (-2.0 - around)).abs() < 1e-12);
        let rate = carrying.memory_rates(&nothing, &at(5e6), 0.0).carried_density_kg_m3;
        assert!((rate - (around + 2.0) / 600.0).abs() < 1e-12, "{rate}");

        // Water of 15 degC around a hull that is still 4 K above the reference: too large by 5e-5/K times the difference.
        let slow = Parameters { late_expansion_per_K: 5e-5, expansion_time_s: 800.0, ..p };
        let behind = p.reference_temperature_C + 4.0 - 15.0;
        assert!((slow.kept_mass_kg(&nothing, &at(5e6)) + 50.0 * 5e-5 * behind).abs() < 1e-12);
        let rate = slow.memory_rates(&nothing, &at(5e6), 0.0).late_temperature_K;
        assert!((rate + behind / 800.0).abs() < 1e-12, "{rate}");

        let leaking = Parameters { pump_leakback_cc_per_hour: 36.0, ..p };
        let leaked = Memory { leaked_back_m3: 2e-5, ..resting };
        assert!((leaking.kept_mass_kg(&leaked, &at(5e6)) - 1027.0 * 2e-5).abs() < 1e-12);
        assert!((leaking.memory_rates(&leaked, &at(5e6), 0.0).leaked_back_m3 - 1e-8).abs() < 1e-20);
        // While the engine runs it is taken up.
        assert!((leaking.memory_rates(&leaked, &at(5e6), -1.0).leaked_back_m3 - (1e-8 - 2e-6)).abs() < 1e-18);
    }

    #[test]
    fn each_mechanism_weighs_what_a_hand_computation_says() {
        let weigh = |change: fn(&mut Parameters<f64>), water: Surroundings<f64>| {
            let mut p = Parameters::default();
            let before = p.net_mass_kg(2e-4, &water);
            change(&mut p);
            p.net_mass_kg(2e-4, &water) - before
        };
        let volume = 50.0 / 1027.0;
        let mut late = at(5e6);
        late.time_s = 7200.0;
        late.temperature_C = 5.0;
        let cases = [
            (weigh(|p| p.ballast_offset_kg = 0.1, late), 0.1),
            (weigh(|p| p.hull_compressibility_per_Pa = 4e-10, late), 1027.0 * volume * 4e-10 * 5e6),
            (weigh(|p| p.hull_thermal_expansion_per_K = 7e-5, late), 1027.0 * volume * 7e-5 * 10.0),
            (weigh(|p| p.ballast_scale = 1.05, late), -1027.0 * 0.05 * 2e-4),
            (weigh(|p| p.leak_kg_per_hour = 0.01, late), 0.02),
            (weigh(|p| (p.net_mass_step_kg, p.net_mass_step_time_s) = (-0.04, 7200.0), late), -0.04),
            (weigh(|p| (p.net_mass_step_kg, p.net_mass_step_time_s) = (-0.04, 7201.0), late), 0.0),
            (weigh(|p| p.trapped_air_cc = 20.0, late), -1027.0 * 20e-6 * 101_325.0 / 5_101_325.0),
            (weigh(|p| p.density_bias_kg_m3 = 0.5, late), -0.5 * (volume + 2e-4)),
        ];
        for (i, (found, expected)) in cases.into_iter().enumerate() {
            assert!((found - expected).abs() < 1e-12, "case {i}: {found} against {expected}");
        }
    }
}
