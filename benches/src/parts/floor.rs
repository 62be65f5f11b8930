//! The floor under the right-hand side: the arithmetic that it consists of, counted by a number that counts, times what
//! each operation costs on this core when nothing waits for anything.
//!
//! A real right-hand side is above it: an operation waits for the one whose result it needs, and numbers must be fetched.

mod counting;

use std::hint::black_box;
use std::time::Instant;

use glidepolar::Number;
use glidepolar::dynamics::{Actuation, Modes, Parameters, derivative};
use glidepolar::glide::start;
use glidepolar::number::functions;

pub use counting::{Counted, KINDS, Kind, Tally};

use crate::contest::Samples;
use crate::report::{Unit, figures, quantity};

/// Parameters with every mechanism away from neutral, so that nothing is skipped.
pub fn every_mechanism() -> Parameters<f64> {
    Parameters {
        CL0: 0.001,
        CM0: 0.001,
        ascent_a_ratio: 1.05,
        ascent_b_ratio: 1.05,
        ascent_c_ratio: 1.05,
        ascent_d_ratio: 1.05,
        pitch_damping_CMq: -0.5,
        offset_mass_kg: 1.0,
        offset_mass_forward_m: 0.01,
        offset_mass_below_m: 0.01,
        ballast_forward_m: 0.1,
        ballast_below_m: 0.01,
        hotel_W: 1.0,
        pump_J_per_m3: 1e6,
        pump_J_per_Pa_m3: 2.0,
        ballast_offset_kg: 0.01,
        hull_compressibility_per_Pa: 4e-10,
        hull_thermal_expansion_per_K: 7e-5,
        ballast_scale: 1.01,
        trapped_air_cc: 1.0,
        leak_kg_per_hour: 1e-4,
        drag_growth_per_day: 1e-3,
        drag_step: 0.01,
        net_mass_step_kg: 1e-4,
        drag_exponent: -0.2,
        nonlinear_lift_per_rad2: 1.0,
        climb_dive_drag_ratio: 1.02,
        roll_drag_per_rad2: 0.1,
        rudder_drag_per_rad2: 0.1,
        vertical_current_m_s: 0.001,
        density_bias_kg_m3: 0.01,
        ..Parameters::default()
    }
}

/// Operations of one right-hand side in the glide that it starts in.
pub fn count(parameters: &Parameters<f64>) -> Tally {
    let begin = start(parameters);
    let counting = parameters.map(Counted::constant);
    let (state, inputs) = (begin.state.map(Counted::constant), begin.inputs.map(Counted::constant));
    let time = Counted::constant(1.0);
    let before = Tally::now();
    let rates = derivative(&counting, Actuation::Servo, Modes::default(), time, &state, &inputs);
    let counted = Tally::now().since(&before);
    assert!(rates.as_array().iter().all(|rate| rate.value().is_finite()), "the glide must be a glide");
    counted
}

/// Seconds of one operation of each kind, by rounds.
pub type Costs = [Samples; KINDS.len()];

/// Measures what each operation costs when it waits for nothing and nothing disturbs it.
pub fn costs() -> Costs {
    const ROUNDS: usize = 25;
    let mut costs: Costs = std::array::from_fn(|_| Samples::default());
    for round in 0..=ROUNDS {
        for (kind, samples) in KINDS.iter().zip(&mut costs) {
            let seconds = cost(*kind);
            if round > 0 {
                samples.push(seconds);
            }
        }
    }
    costs
}

/// The floor: operations times their cost.
pub fn seconds(counted: &Tally, costs: &Costs) -> Samples {
    Samples::one(KINDS.iter().zip(costs).map(|(kind, cost)| counted.count(*kind) as f64 * cost.least()).sum())
}

/// How many of what, in words.
pub fn words(counted: &Tally) -> String {
    let parts: Vec<String> = KINDS
        .iter()
        .filter(|kind| counted.count(**kind) > 0)
        .map(|kind| format!("{} {}", counted.count(*kind), kind.words()))
        .collect();
    parts.join(", ")
}

/// What each costs, in words.
pub fn cost_words(costs: &Costs) -> Vec<String> {
    KINDS
        .iter()
        .zip(costs)
        .map(|(kind, cost)| match *kind {
            Kind::Add | Kind::Multiply => {
                format!("{} {} a nanosecond", figures(1e-9 / cost.least()), kind.words())
            }
            _ => format!("{} for one of its {}", quantity(Unit::Seconds, cost.least()), kind.words()),
        })
        .collect()
}

/// Independent operations in one pass: enough that no result is waited for.
const LANES: usize = 16;
const PASSES: usize = 2_000;

fn cost(kind: Kind) -> f64 {
    let begin = Instant::now();
    match kind {
        Kind::Add => arithmetic::add(PASSES),
        Kind::Multiply => arithmetic::multiply(PASSES),
        Kind::Divide => arithmetic::divide(PASSES),
        Kind::SquareRoot => arithmetic::square_root(PASSES),
        Kind::SineCosine => each(|x| {
            let (sin, cos) = functions::sin_cos(x);
            sin + cos
        }),
        Kind::ArcTangent => each(|x| functions::atan2(0.01 * x, x)),
        Kind::Exponential => each(functions::exp),
        Kind::Logarithm => each(functions::ln),
        Kind::Other => each(functions::tan),
    }
    begin.elapsed().as_secs_f64() / (PASSES * LANES) as f64
}

/// A function of the mathematical library at independent places.
fn each(function: impl Fn(f64) -> f64) {
    let places: [f64; LANES] = std::array::from_fn(|i| 0.3 + 0.01 * i as f64);
    for _ in 0..PASSES {
        let places = black_box(&places);
        black_box(std::array::from_fn::<f64, LANES, _>(|i| function(places[i])));
    }
}

/// Scalar instructions one by one, sixteen chains side by side: the compiler must neither leave them out nor join them
/// into wider ones, which the equations, where each operation is another one, could not use.
#[cfg(target_arch = "x86_64")]
mod arithmetic {
    use std::arch::asm;

    macro_rules! scalar {
        ($name:ident, $instruction:literal) => {
            pub fn $name(passes: usize) {
                let operand = 1.000_000_1_f64;
                for _ in 0..passes {
                    // SAFETY: reads one register, writes registers that are declared clobbered.
                    unsafe {
                        asm!(
                            concat!($instruction, " xmm1, xmm0"), concat!($instruction, " xmm2, xmm0"),
                            concat!($instruction, " xmm3, xmm0"), concat!($instruction, " xmm4, xmm0"),
                            concat!($instruction, " xmm5, xmm0"), concat!($instruction, " xmm6, xmm0"),
                            concat!($instruction, " xmm7, xmm0"), concat!($instruction, " xmm8, xmm0"),
                            concat!($instruction, " xmm9, xmm0"), concat!($instruction, " xmm10, xmm0"),
                            concat!($instruction, " xmm11, xmm0"), concat!($instruction, " xmm12, xmm0"),
                            concat!($instruction, " xmm13, xmm0"), concat!($instruction, " xmm14, xmm0"),
                            concat!($instruction, " xmm15, xmm0"), concat!($instruction, " xmm1, xmm0"),
                            in("xmm0") operand,
                            inout("xmm1") operand => _, inout("xmm2") operand => _, inout("xmm3") operand => _,
                            inout("xmm4") operand => _, inout("xmm5") operand => _, inout("xmm6") operand => _,
                            inout("xmm7") operand => _, inout("xmm8") operand => _, inout("xmm9") operand => _,
                            inout("xmm10") operand => _, inout("xmm11") operand => _, inout("xmm12") operand => _,
                            inout("xmm13") operand => _, inout("xmm14") operand => _, inout("xmm15") operand => _,
                            options(nomem, nostack),
                        );
                    }
                }
            }
        };
    }

    scalar!(add, "addsd");
    scalar!(multiply, "mulsd");
    scalar!(divide, "divsd");
    scalar!(square_root, "sqrtsd");
}

/// Elsewhere the compiler may join operations; the floor is then a little low.
#[cfg(not(target_arch = "x86_64"))]
mod arithmetic {
    use std::hint::black_box;

    fn chains(passes: usize, operation: impl Fn(f64) -> f64) {
        let mut lanes = black_box([1.000_000_1_f64; super::LANES]);
        for _ in 0..passes {
            lanes.iter_mut().for_each(|lane| *lane = operation(*lane));
        }
        black_box(lanes);
    }

    pub fn add(passes: usize) {
        chains(passes, |x| x + 1e-9);
    }
    pub fn multiply(passes: usize) {
        chains(passes, |x| x * 1.000_000_1);
    }
    pub fn divide(passes: usize) {
        chains(passes, |x| x / 1.000_000_1);
    }
    pub fn square_root(passes: usize) {
        chains(passes, f64::sqrt);
    }
}

#[cfg(test)]
mod tests {
    use num_dual::DualNum;
    use num_traits::Signed;

    use super::*;

    #[test]
    fn every_operation_is_counted_once() {
        let (a, b) = (Counted::constant(2.0), Counted::constant(3.0));
        let before = Tally::now();
        let mut c = a * b + 1.0 - a / b;
        c += a * 2.0;
        let root = DualNum::sqrt(&b);
        c = -c.abs();
        let counted = Tally::now().since(&before);
        let of = |kind| counted.count(kind);
        // Changes of sign are bit masks and cost next to nothing.
        assert_eq!((of(Kind::Multiply), of(Kind::Add), of(Kind::Divide), of(Kind::SquareRoot)), (2, 3, 1, 1));
        assert!((c.value() + 6.0 + 1.0 - 2.0 / 3.0 + 4.0).abs() < 1e-14 && root.value() == 3f64.sqrt());
    }

    #[test]
    fn counting_does_not_change_the_result() {
        for parameters in [Parameters::default(), every_mechanism()] {
            let begin = start(&parameters);
            let plain = derivative(&parameters, Actuation::Servo, Modes::default(), 1.0, &begin.state, &begin.inputs);
            let counted = derivative(
                &parameters.map(Counted::constant),
                Actuation::Servo,
                Modes::default(),
                Counted::constant(1.0),
                &begin.state.map(Counted::constant),
                &begin.inputs.map(Counted::constant),
            );
            assert_eq!(counted.as_array().map(Number::value), plain.as_array());
        }
        let (few, many) = (count(&Parameters::default()), count(&every_mechanism()));
        assert!(few.count(Kind::Multiply) > 50 && few.count(Kind::ArcTangent) == 1 && few.count(Kind::SineCosine) == 1);
        assert!(many.count(Kind::Exponential) == 1 && many.count(Kind::Logarithm) == 1);
    }

    #[test]
    fn operations_take_time() {
        for cost in costs() {
            assert!(cost.least() > 0.0 && cost.least().is_finite());
        }
    }
}
