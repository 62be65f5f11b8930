//! Campaigns that lack a kind of run, and manifests that state how sure their own figures are.

mod support;

use glidepolar_hull::hull_tests::{Estimate, Reduction};
use glidepolar_tank::Results;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use support::{Spoilt, campaign_with_noise, misses, reduce};

/// The same campaign without runs of some kinds.
fn without(spoilt: &Spoilt, kinds: &[&str]) -> Results {
    let is_kept = |line: &&str| !kinds.iter().any(|kind| line.contains(&format!(",{kind},")));
    spoilt.change_table(|text| text.lines().filter(is_kept).fold(String::new(), |all, line| all + line + "\n"));
    let results = reduce(&spoilt.folder);
    spoilt.restore_table();
    results
}

fn close(found: &Estimate, expected: &Estimate, what: &str) {
    let allowed = 4.0 * found.se.hypot(expected.se);
    assert!((found.value - expected.value).abs() < allowed, "{what}: {found:?}, {expected:?}");
}

#[test]
fn what_a_campaign_cannot_tell_is_left_out_and_said() {
    let spoilt = Spoilt::new(21);
    let whole = reduce(&spoilt.folder).reduction();
    let whole = whole.hulls[0].dynamic.as_ref().unwrap();
    let said = |results: &Results, words: &str| {
        assert!(results.warnings.iter().any(|w| w.contains(words)), "{words}: {:?}", results.warnings);
    };

    // Arcs only, beside the steady sweep: Yr and Nr, and nothing that goes with accelerations.
    let results = without(&spoilt, &["sway", "yaw"]);
    let arcs = results.reduction().hulls[0].dynamic.clone().expect("derivatives from turns");
    close(arcs.yr.as_ref().unwrap(), whole.yr.as_ref().unwrap(), "Yr of turns");
    close(arcs.nr.as_ref().unwrap(), whole.nr.as_ref().unwrap(), "Nr of turns");
    close(&arcs.nv, &whole.nv, "Nv of the sweep");
    assert!(arcs.yvdot.is_none() && arcs.nrdot.is_none());
    said(&results, "Yv and Nv are those of the steady sweep, and Yvdot, Nvdot, Yrdot, Nrdot are left out");
    // What is left out is null in the JSON.
    let json = serde_json::to_value(&arcs).unwrap();
    assert!(json["Nrdot"].is_null() && json["Yv"]["value"].is_number());

    // Yaw without sway: what goes with rdot cannot be moved to the centre of buoyancy.
    let results = without(&spoilt, &["sway", "arc"]);
    let yaw = results.reduction().hulls[0].dynamic.clone().expect("derivatives from yaw");
    close(yaw.nr.as_ref().unwrap(), whole.nr.as_ref().unwrap(), "Nr of yaw");
    assert!(yaw.nrdot.is_none());

    // Sway alone.
    let results = without(&spoilt, &["yaw", "arc"]);
    let sway = results.reduction().hulls[0].dynamic.clone().expect("derivatives from sway");
    close(sway.yvdot.as_ref().unwrap(), whole.yvdot.as_ref().unwrap(), "Yvdot of sway");
    assert!(sway.yr.is_none() && sway.nrdot.is_none());
    said(&results, "no usable yaw runs or turns: Yr, Nr, Yrdot, Nrdot are left out");

    // Sway and arcs.
    let results = without(&spoilt, &["yaw"]);
    let both = results.reduction().hulls[0].dynamic.clone().expect("derivatives from sway and turns");
    close(both.nr.as_ref().unwrap(), whole.nr.as_ref().unwrap(), "Nr of sway and turns");
    said(&results, "no usable yaw runs: Yrdot, Nrdot are left out");

    // Turns with neither sway nor sweep: v and r go together, nothing can be said.
    let results = without(&spoilt, &["sway", "yaw", "static"]);
    assert!(results.reduction().hulls[0].dynamic.is_none());
    said(&results, "no derivatives");

    // A sweep alone is a whole campaign, too.
    let results = without(&spoilt, &["sway", "yaw", "arc"]);
    assert!(results.reduction().hulls[0].dynamic.is_none() && results.reduction().hulls[0].fit.is_some());
}

/// Every coefficient and derivative: name, value, standard error.
fn figures(reduction: &Reduction, truth: &glidepolar_tank::virtual_tank::Truth) -> Vec<(String, f64, f64)> {
    misses(reduction, truth).into_iter().map(|miss| (miss.name, miss.value, miss.se)).collect()
}

/// Manifests that are off by errors of the stated size give results that scatter as the intervals grow.
fn scatter_is_what_is_stated(state: &dyn Fn(&str) -> String, err: &mut dyn FnMut(&str) -> String, feels: &[&str]) {
    let (holder, plain, truth) = campaign_with_noise(22, &["LDR10.5"], &[], 0.3);
    let folder = holder.path().join("runs");
    let file = folder.join("campaign.toml");
    let manifest = std::fs::read_to_string(&file).unwrap();
    let without = figures(&plain.reduction(), &truth);
    std::fs::write(&file, state(&manifest)).unwrap();
    let with = figures(&reduce(&folder).reduction(), &truth);
    let repeats = 16;
    let mut squares = vec![0.0; with.len()];
    for _ in 0..repeats {
        std::fs::write(&file, err(&manifest)).unwrap();
        for (i, (_, value, _)) in figures(&reduce(&folder).reduction(), &truth).into_iter().enumerate() {
            squares[i] += (value - without[i].1).powi(2) / f64::from(repeats);
        }
    }
    for (i, (name, _, se)) in with.iter().enumerate() {
        if !feels.contains(&name.as_str()) {
            continue;
        }
        let stated = se * se - without[i].2 * without[i].2;
        let ratio = (squares[i] / stated).sqrt();
        // A standard deviation from sixteen draws is good to 18 %.
        assert!((0.45..1.65).contains(&ratio), "{name}: scatters by {ratio} of what is stated");
    }
}

const ALL: [&str; 12] = ["a", "b", "c", "d", "Yv", "Nv", "Yr", "Nr", "Yvdot", "Nvdot", "Yrdot", "Nrdot"];

#[test]
fn an_uncertain_interaction_matrix_widens_the_intervals() {
    let mut rng = rand::rngs::StdRng::seed_from_u64(1);
    let matrix = |text: &str| -> [[f64; 3]; 3] {
        let line = text.lines().find(|line| line.starts_with("interaction")).unwrap();
        let table: toml::Table = line.parse().unwrap();
        table["interaction"].clone().try_into().unwrap()
    };
    let replace = |text: &str, matrix: &[[f64; 3]; 3], more: &str| {
        let line = text.lines().find(|line| line.starts_with("interaction")).unwrap();
        text.replace(line, &format!("interaction = {matrix:?}\n{more}"))
    };
    let stated = "interaction_uncertainty = [[0.01, 0.01, 0.01], [0.01, 0.01, 0.01], [0.01, 0.01, 0.01]]\n";
    scatter_is_what_is_stated(
        &|text| replace(text, &matrix(text), stated),
        &mut |text| {
            let off = matrix(text).map(|row| row.map(|x| x + 0.01 * rng.sample::<f64, _>(StandardNormal)));
            replace(text, &off, "")
        },
        &ALL,
    );
}

#[test]
fn uncertain_centres_widen_the_intervals() {
    let mut rng = rand::rngs::StdRng::seed_from_u64(2);
    for (key, feels) in [
        ("cb_m", &["d", "Nv", "Yr", "Nr", "Nvdot", "Yrdot", "Nrdot"]),
        ("mc_m", &["d", "Nv", "Yr", "Nr", "Nvdot", "Yrdot", "Nrdot"]),
    ] {
        let value = |text: &str| -> f64 {
            let line = text.lines().find(|line| line.starts_with(&format!("{key} ="))).unwrap();
            line.split('=').nth(1).unwrap().trim().parse().unwrap()
        };
        let replace = |text: &str, value: f64, more: &str| {
            let line = text.lines().find(|line| line.starts_with(&format!("{key} ="))).unwrap();
            text.replace(line, &format!("{key} = {value}\n{more}"))
        };
        scatter_is_what_is_stated(
            &|text| replace(text, value(text), &format!("{} = 0.003\n", key.replace("_m", "_uncertainty_m"))),
            &mut |text| replace(text, value(text) + 0.003 * rng.sample::<f64, _>(StandardNormal), ""),
            feels,
        );
    }
}
