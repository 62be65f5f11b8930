//! What a steady run reads when a hull with these coefficients is towed by a rig with these faults, in duals: the fit's
//! slopes come from the very equations. The reduction's own map then takes the reading to CL, CD, CM, as it took the
//! measured one. Knows one run; no campaign, no statistics.

use glidepolar_hull::coefficients::BalanceForce;
use glidepolar_number::Number;
use nalgebra::{Const, Matrix3, U1};
use num_dual::{Derivative, DualSVec64};

/// How many numbers a run's reading depends on.
pub const TERMS: usize = 26;

type Dual = DualSVec64<TERMS>;

/// Crossflow is shared out between two stations this far ahead and aft of the centre of buoyancy, in lengths: neither
/// share is negative, so the whole acts between them. Planforms have their centre within a tenth of the length of it, a
/// separated stern moves SUBOFF's aft by a fifth.
pub const STATION: f64 = 0.35;

/// The main hump of wave drag lies near a Froude number of 0.5, where the hull is half a wavelength and a bit more, and is a
/// fifth of that wide (Havelock 1931, Proc. Roy. Soc. A 131, 275-285, for a submerged spheroid).
pub const WAVE_TOP: f64 = 0.5;
/// See [`WAVE_TOP`].
pub const WAVE_WIDTH: f64 = 0.1;

/// A number that a run's reading depends on, by its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Term {
    /// Lift slope \[1/rad\].
    A,
    /// Drag at zero angle and the reference Reynolds number.
    B,
    /// Growth of drag \[1/rad2\].
    C,
    /// Moment slope \[1/rad\].
    D,
    /// How far the moment centre lies aft of where it is said to lie \[m\].
    MomentCentre,
    /// True less recorded yaw angle \[deg\].
    Misalignment,
    /// Shift of a channel's reading under way \[N, N, N m\].
    Zero(usize),
    /// Share of SF that AF shows.
    AxialFromSide,
    /// Slopes to starboard over those to port.
    Asymmetry,
    /// Normal force per sin|sin| that acts [`STATION`] ahead of the centre of buoyancy.
    CrossflowFore,
    /// The same aft of it.
    CrossflowAft,
    /// Share of the crossflow's drag that suction on the nose gives back.
    CrossflowSuction,
    /// Exponent of the dynamic pressure in b.
    DragExponent,
    /// Recorded less true temperature \[degC\].
    Temperature,
    /// Axial force of the strut over the dynamic pressure \[m2\].
    StrutAxial,
    /// Side force of the strut over dynamic pressure and sine of the angle \[m2\].
    StrutSide,
    /// Relative rise of the dynamic pressure per sine of the angle, whichever side, for a hull of the median length.
    BlockageLinear,
    /// The same per its square.
    BlockageSquare,
    /// Height of a bump of drag in the Froude number on the length.
    WaveDrag,
    /// Froude number at its top.
    WaveTop,
    /// Its width: half the distance between the points of 1/e.
    WaveWidth,
    /// Side force of the walls as a coefficient, alike at all angles.
    WallSide,
    /// Their moment about the centre of buoyancy as a coefficient.
    WallMoment,
    /// Side force of the strut's wake on the hull at the moment centre, per sin|sin|.
    StrutInterference,
    /// Enters elsewhere.
    None,
}

impl Term {
    /// Its place among the directions of a dual.
    pub fn place(self) -> usize {
        match self {
            Term::A => 0,
            Term::B => 1,
            Term::C => 2,
            Term::D => 3,
            Term::MomentCentre => 4,
            Term::Misalignment => 5,
            Term::Zero(channel) => 6 + channel,
            Term::AxialFromSide => 9,
            Term::Asymmetry => 10,
            Term::CrossflowFore => 11,
            Term::CrossflowAft => 12,
            Term::DragExponent => 13,
            Term::Temperature => 14,
            Term::StrutAxial => 15,
            Term::StrutSide => 16,
            Term::CrossflowSuction => 17,
            Term::BlockageLinear => 18,
            Term::BlockageSquare => 19,
            Term::WaveDrag => 20,
            Term::WaveTop => 21,
            Term::WaveWidth => 22,
            Term::WallSide => 23,
            Term::WallMoment => 24,
            Term::StrutInterference => 25,
            Term::None => usize::MAX,
        }
    }
}

/// The values of all terms for one run.
pub type Values = [f64; TERMS];

/// Values at which nothing is wrong; the coefficients are zero.
pub fn neutral() -> Values {
    let mut values = [0.0; TERMS];
    values[Term::Asymmetry.place()] = 1.0;
    values[Term::WaveTop.place()] = WAVE_TOP;
    values[Term::WaveWidth.place()] = WAVE_WIDTH;
    values
}

/// What is known of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Recorded yaw angle \[rad\].
    pub yaw_rad: f64,
    /// Dynamic pressure by the recorded speed and temperature \[Pa\].
    pub pressure_Pa: f64,
    /// Reynolds number on the length by the same.
    pub reynolds: f64,
    /// Froude number on the length; none where the speed is not known.
    pub froude: Option<f64>,
    /// Reynolds number at which b is stated.
    pub reference_reynolds: f64,
    /// Relative change of the density per degree \[1/K\].
    pub density_per_K: f64,
    /// Relative change of the viscosity per degree \[1/K\].
    pub viscosity_per_K: f64,
    /// Frontal area \[m2\].
    pub area_m2: f64,
    /// Overall length \[m\].
    pub length_m: f64,
    /// The same over the median of the hulls.
    pub length_ratio: f64,
    /// Moment centre and centre of buoyancy aft of the nose \[m\].
    pub mc_m: f64,
    /// Centre of buoyancy aft of the nose \[m\].
    pub cb_m: f64,
    /// `force = interaction * reading`, AF, SF, YM.
    pub interaction: Matrix3<f64>,
}

/// CL, CD, CM as they are reduced, each with its slopes.
pub fn reduced(setting: &Setting, values: &Values) -> [(f64, [f64; TERMS]); 3] {
    let p: [Dual; TERMS] = std::array::from_fn(|i| Dual::new(values[i], Derivative::derivative_generic(Const, U1, i)));
    coefficients(setting, &p).map(|c| {
        let slopes = c.eps.0.map_or([0.0; TERMS], |eps| std::array::from_fn(|i| eps[i]));
        (c.re, slopes)
    })
}

fn coefficients<T: Number>(setting: &Setting, p: &[T; TERMS]) -> [T; 3] {
    let at = |term: Term| p[term.place()];
    let number = T::constant;
    let alpha = at(Term::Misalignment) * 1f64.to_radians() + setting.yaw_rad;
    let (sine, cosine) = alpha.sin_cos();

    // The hull, about its centre of buoyancy, on frontal area and length.
    let excess = (at(Term::Asymmetry) - 1.0) / (at(Term::Asymmetry) + 1.0);
    let side = excess * alpha.value().signum() + 1.0;
    let true_reynolds = (at(Term::Temperature) * setting.viscosity_per_K + 1.0) * setting.reynolds;
    let b = at(Term::B) * friction_ratio(true_reynolds, setting.reference_reynolds, at(Term::DragExponent));
    let lift = at(Term::A) * side * alpha;
    let drag = b + at(Term::C) * alpha * alpha + wave_drag(setting, p);
    let across = sine * sine.abs();
    let (fore, aft) = (at(Term::CrossflowFore), at(Term::CrossflowAft));
    let normal = lift * cosine + drag * sine + (fore + aft) * across + at(Term::WallSide);
    let axial = drag * cosine - lift * sine - at(Term::CrossflowSuction) * (fore + aft) * across * sine;
    let moment = at(Term::D) * side * alpha + (fore - aft) * across * STATION + at(Term::WallMoment);

    // The rig. A temperature entered too high makes the water too light on paper.
    let pressure = (at(Term::Temperature) * (-setting.density_per_K) + 1.0) * setting.pressure_Pa;
    // A longer hull takes up more of the tank's section, in proportion.
    let taken = sine.abs() * setting.length_ratio;
    let blockage = (at(Term::BlockageSquare) * taken + at(Term::BlockageLinear)) * taken + 1.0;
    let scale = pressure * blockage * setting.area_m2;
    let side_N = scale * normal + pressure * at(Term::StrutSide) * sine;
    let axial_N = scale * axial + pressure * at(Term::StrutAxial) * cosine;
    let hull = BalanceForce { axial_N, side_N, yaw_N_m: scale * moment * setting.length_m };
    let about_mc = hull.moved(number(setting.cb_m), number(setting.mc_m));
    let interference_N = pressure * at(Term::StrutInterference) * across * setting.area_m2;
    let zero = |channel: usize| {
        (0..3).map(|j| at(Term::Zero(j)) * setting.interaction[(channel, j)]).fold(number(0.0), |sum, x| sum + x)
    };
    let shown = BalanceForce {
        axial_N: axial_N + at(Term::AxialFromSide) * side_N + zero(0),
        side_N: side_N + interference_N + zero(1),
        yaw_N_m: about_mc.yaw_N_m + at(Term::MomentCentre) * side_N + zero(2),
    };

    // The reduction, by the recorded angle, speed and temperature.
    let c = shown.moved(number(setting.mc_m), number(setting.cb_m)).in_wind_axes(number(setting.yaw_rad)).coefficients(
        number(setting.pressure_Pa),
        number(setting.area_m2),
        number(setting.length_m),
    );
    [c.lift, c.drag, c.moment]
}

/// Drag of waves: a bump in the Froude number.
fn wave_drag<T: Number>(setting: &Setting, p: &[T; TERMS]) -> T {
    let at = |term: Term| p[term.place()];
    match setting.froude {
        Some(froude) => {
            let off = (T::constant(froude) - at(Term::WaveTop)) / at(Term::WaveWidth);
            at(Term::WaveDrag) * (-(off * off)).exp()
        }
        None => T::constant(0.0),
    }
}

/// b at a Reynolds number over b at the reference: the ITTC-57 line `0.075/(lg Re - 2)^2`, raised to the power that makes
/// this its exponent of the dynamic pressure there.
fn friction_ratio<T: Number>(reynolds: T, reference: f64, exponent: T) -> T {
    let above = |lg: f64| lg - 2.0;
    let at_reference = above(reference.log10());
    let here = reynolds.ln() * std::f64::consts::LN_10.recip() - 2.0;
    // d ln Cf/d ln q of the line is -1/(ln 10 (lg Re - 2)): half of that against Re.
    let power = exponent * (-2.0 * std::f64::consts::LN_10 * at_reference);
    (power * ((T::constant(at_reference) / here).ln())).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setting(yaw_deg: f64) -> Setting {
        Setting {
            yaw_rad: yaw_deg.to_radians(),
            pressure_Pa: 1998.0,
            reynolds: 3.0e6,
            froude: Some(0.42),
            reference_reynolds: 3.0e6,
            density_per_K: -1.5e-4,
            viscosity_per_K: -0.025,
            area_m2: 0.0324,
            length_m: 1.724,
            length_ratio: 1.0,
            mc_m: 0.736,
            cb_m: 0.815,
            interaction: Matrix3::identity(),
        }
    }

    fn hull() -> Values {
        let mut values = neutral();
        for (term, value) in [(Term::A, 1.1), (Term::B, 0.13), (Term::C, 1.6), (Term::D, 1.2)] {
            values[term.place()] = value;
        }
        values
    }

    #[test]
    fn without_faults_the_reduction_gives_the_hull_back() {
        for degrees in [-20.0f64, -3.0, 0.0, 12.0] {
            let alpha = degrees.to_radians();
            let [lift, drag, moment] = reduced(&setting(degrees), &hull()).map(|c| c.0);
            assert!((lift - 1.1 * alpha).abs() < 1e-14);
            assert!((drag - 0.13 - 1.6 * alpha * alpha).abs() < 1e-14);
            assert!((moment - 1.2 * alpha).abs() < 1e-14);
        }
    }

    /// Slopes by dual numbers against differences.
    #[test]
    fn slopes_are_those_of_the_model() {
        let mut values = hull();
        values[Term::Misalignment.place()] = 0.4;
        values[Term::CrossflowAft.place()] = 3.0;
        values[Term::CrossflowSuction.place()] = 0.3;
        values[Term::DragExponent.place()] = -0.1;
        values[Term::Temperature.place()] = 2.0;
        values[Term::Asymmetry.place()] = 1.1;
        values[Term::BlockageLinear.place()] = 0.2;
        values[Term::BlockageSquare.place()] = 0.5;
        values[Term::WaveDrag.place()] = 0.02;
        values[Term::WallSide.place()] = 0.01;
        values[Term::WallMoment.place()] = -0.02;
        values[Term::StrutInterference.place()] = 0.7;
        let setting = Setting { reynolds: 1.6e6, ..setting(-9.0) };
        let exact = reduced(&setting, &values);
        for term in 0..TERMS {
            let h = 1e-5;
            let moved = |by: f64| {
                let mut v = values;
                v[term] += by;
                reduced(&setting, &v)
            };
            let (plus, minus) = (moved(h), moved(-h));
            for k in 0..3 {
                let difference = (plus[k].0 - minus[k].0) / (2.0 * h);
                assert!((difference - exact[k].1[term]).abs() < 1e-7 * (1.0 + difference.abs()), "term {term}, {k}");
            }
        }
    }

    #[test]
    fn friction_has_the_stated_exponent_at_the_reference() {
        let ratio = |re: f64| friction_ratio(re, 3.0e6, -0.15f64).ln();
        // The dynamic pressure goes with the square of the Reynolds number.
        let exponent = (ratio(3.0e6 * 1.001) - ratio(3.0e6 / 1.001)) / (4.0 * 1.001f64.ln());
        assert!((exponent + 0.15).abs() < 1e-6, "{exponent}");
    }
}
