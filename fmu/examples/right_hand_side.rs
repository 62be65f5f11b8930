//! Times the right-hand side of both models through the table of variables, as a get of the derivatives costs it, the fastest
//! of many runs: `cargo run --release -p glidepolar-fmu --example right_hand_side`.

use std::hint::black_box;
use std::time::Instant;

use glidepolar_fmu::model::Model;
use glidepolar_fmu::model::vehicle::Vehicle;

fn main() {
    let times = Model::ALL.map(|model| {
        let glider = Vehicle::built_in(model).glider;
        let fastest_ns = (0..200)
            .map(|_| {
                let begun = Instant::now();
                for _ in 0..1000 {
                    black_box(black_box(&glider).derivative());
                }
                begun.elapsed().as_secs_f64() * 1e6
            })
            .fold(f64::INFINITY, f64::min);
        println!("{}: {fastest_ns:.0} ns", model.name());
        fastest_ns
    });
    println!("ratio {:.2}", times[1] / times[0]);
}
