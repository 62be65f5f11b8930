//! Long logs in bounded memory.

use super::preparing::saw_tooth;
use super::*;

pub(super) fn observations(yos: usize) -> Vec<Observation> {
    let mut preparation = Preparation::new(PreparationSettings::default());
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
    // As text, in which a missing value is like another.
    assert_eq!(format!("{found:?}"), format!("{:?}", observations(20)));
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
        for o in &found {
            assert!((o.ballast_m3 - if o.pitch_rad < 0.0 { -200e-6 } else { 200e-6 }).abs() < 1e-15);
        }
        // Every leg is still there, and each mean lies on its leg.
        for leg in 0..40 {
            let of = |list: &[Observation]| -> Vec<f64> {
                list.iter().filter(|o| o.steady && o.leg == leg).map(|o| o.time_s).collect()
            };
            let (means, samples) = (of(&found), of(&all));
            assert!(!means.is_empty(), "leg {leg}");
            assert!(means[0] >= samples[0] && means[means.len() - 1] <= samples[samples.len() - 1], "leg {leg}");
        }
    }
}

#[test]
fn the_size_of_the_batches_changes_nothing() {
    for (how, most) in [(Shorten::Means, 700), (Shorten::Dives, 3000)] {
        assert_eq!(format!("{:?}", condensed(how, most, 13)), format!("{:?}", condensed(how, most, 5000)));
    }
}

#[test]
fn dives_are_kept_whole() {
    let (found, said) = condensed(Shorten::Dives, 3000, 777);
    let all = observations(20);
    assert!(found.len() <= 3000 && said.unwrap().contains("one dive in"));
    for dive in [0, 8, 16] {
        let of = |list: &[Observation]| list.iter().filter(|o| o.dive == dive).count();
        assert_eq!(of(&found), of(&all), "dive {dive}");
    }
}
