//! Long logs in bounded memory.

use super::preparing::saw_tooth;
use super::*;

fn observations(yos: usize) -> Vec<Observation> {
    let mut preparation = Preparation::new(Settings::default());
    let mut out = Vec::new();
    preparation.push(saw_tooth(yos), &mut out);
    preparation.finish(&mut out);
    out
}

fn condensed(how: Shorten, most: usize, batch: usize) -> (Vec<Observation>, Option<String>) {
    let all = observations(20);
    let mut condenser = Condenser::new(how, most);
    for some in all.chunks(batch) {
        condenser.take(&mut some.to_vec());
    }
    condenser.finish()
}

#[test]
fn a_short_log_passes_as_it_is() {
    let (found, said) = condensed(Shorten::Means, 1_000_000, 777);
    assert_eq!(found, observations(20));
    assert_eq!(said, None);
}

#[test]
fn means_keep_what_is_constant_on_a_leg_and_the_mean_of_what_is_not() {
    for most in [2000, 500, 150] {
        let (found, said) = condensed(Shorten::Means, most, 777);
        assert!(found.len() <= most && found.len() > most / 4, "{} of {most}", found.len());
        assert!(said.is_some());
        assert!(found.windows(2).all(|pair| pair[1].time_s > pair[0].time_s));
        let all = observations(20);
        let steady: Vec<&Observation> = all.iter().filter(|o| o.steady).collect();
        for o in &found {
            assert_eq!(o.ballast_m3, if o.pitch_rad < 0.0 { -200e-6 } else { 200e-6 });
        }
        // The middle of every leg stays where it was, up to what waits at its end.
        let middle = |of: &[Observation], leg: u32| {
            let times: Vec<f64> = of.iter().filter(|o| o.leg == leg).map(|o| o.time_s).collect();
            times.iter().sum::<f64>() / times.len() as f64
        };
        let steady: Vec<Observation> = steady.into_iter().copied().collect();
        for leg in [0, 17, 39] {
            assert!((middle(&found, leg) - middle(&steady, leg)).abs() < 60.0, "leg {leg}");
        }
    }
}

#[test]
fn the_size_of_the_batches_changes_nothing() {
    assert_eq!(condensed(Shorten::Means, 700, 13), condensed(Shorten::Means, 700, 5000));
    assert_eq!(condensed(Shorten::Dives, 3000, 13), condensed(Shorten::Dives, 3000, 5000));
}

#[test]
fn dives_are_kept_whole() {
    let (found, said) = condensed(Shorten::Dives, 3000, 777);
    let all = observations(20);
    assert!(found.len() <= 3000 && said.unwrap().contains("one dive in 8"));
    for dive in [0, 8, 16] {
        let of = |list: &[Observation]| list.iter().filter(|o| o.dive == dive).count();
        assert_eq!(of(&found), of(&all), "dive {dive}");
    }
}
