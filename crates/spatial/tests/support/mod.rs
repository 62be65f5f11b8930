//! Bodies that the tests share.
#![allow(non_snake_case, reason = "coefficients are named as in the literature")]
#![allow(dead_code, reason = "each test takes what it needs")]

use glidepolar_dynamics::Parameters;
use glidepolar_spatial::{Body, Lateral, RateLaw};

/// Seawing from the K's of Zhang et al. 2013, on a frontal area of 0.04 m2.
pub fn seawing() -> Body<f64> {
    let (rho, area, length) = (1025.0, 0.04, 1.99);
    let (force, moment) = (2.0 / (rho * area), 2.0 / (rho * area * length));
    let (mf1, mf2, mf3) = (1.48, 49.58, 65.92);
    let plane = Parameters {
        reference_density_kg_m3: rho,
        frontal_area_m2: area,
        length_m: length,
        a_per_rad: 440.99 * force,
        b: 7.19 * force,
        c_per_rad2: 386.29 * force,
        CL0: -0.36 * force,
        CM0: 0.28 * moment,
        d_per_rad: (-65.84 + mf3 - mf1) * moment,
        pitch_damping_N_m_s: 0.0,
        pitch_damping_quadratic_N_m_s2: 0.0,
        pitch_damping_V2_kg_s: -205.64,
        hull_mass_kg: 54.28,
        moving_mass_kg: 11.0,
        ballast_nominal_kg: 0.0,
        displaced_mass_kg: 65.28,
        added_mass_1_kg: mf1,
        added_mass_3_kg: mf3,
        pitch_inertia_kg_m2: 7.88 + 15.27 + 10.16,
        added_Z_qdot_kg_m: 3.61,
        moving_mass_height_m: 0.014,
        offset_mass_kg: 54.28,
        offset_mass_forward_m: -0.0814,
        offset_mass_below_m: 0.0032,
        moving_mass_min_m: 0.3,
        moving_mass_max_m: 0.5,
        ..Parameters::default()
    };
    let (CY, Cl, CN) = (-115.65 * force, -58.27 * moment, (34.10 + mf1 - mf2) * moment);
    let (Cl_p, CN_r) = (-19.83 * moment, -389.30 * moment);
    let lateral = Lateral {
        CY_beta_per_rad: CY,
        ascent_CY_beta_per_rad: CY,
        Cl_beta_per_rad: Cl,
        ascent_Cl_beta_per_rad: Cl,
        CN_beta_per_rad: CN,
        ascent_CN_beta_per_rad: CN,
        Cl_p,
        ascent_Cl_p: Cl_p,
        CN_r,
        ascent_CN_r: CN_r,
        added_mass_2_kg: mf2,
        roll_inertia_kg_m2: 0.53 + 0.60,
        yaw_inertia_kg_m2: 10.18 + 15.32,
        added_Y_rdot_kg_m: 2.57,
        moving_inertia_1_kg_m2: 0.02,
        moving_inertia_2_kg_m2: 10.16,
        moving_inertia_3_kg_m2: 0.17,
        roll_mass_kg: 11.0,
        roll_mass_radius_m: 0.014,
        roll_mass_min_rad: -1.6,
        roll_mass_max_rad: 1.6,
        ..Lateral::default()
    };
    Body { plane, lateral, rate_law: RateLaw::SpeedSquared }
}
