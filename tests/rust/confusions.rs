//! The table of confusions of the diagnosis at sea, with floors that fail: every mechanism of the catalogue, pairs of them,
//! effects outside the catalogue, and nothing, hidden by the virtual sea with size and sign drawn from the seed.
//!
//! `cargo test -p glidepolar-tests --release --test confusions -- --ignored --nocapture` prints it over `BLIND_SEEDS`
//! seeds (20) from `BLIND_FIRST` (0) on; `BLIND_EFFECT` (parts of names, by commas) and `BLIND_SPEED` (`measured`, `none`)
//! choose; with `BLIND_WORLDS=drawn` every seed has a world of its own, as in `blind_worlds`. A log counts as relevant where
//! its misfit beside the polar alone, less that of the same flight with nothing hidden, exceeds the limit of relevance of any
//! quantity and is significant: what noise hides cannot be named, and what the water does is not hidden.

use std::collections::BTreeMap;

use glidepolar::diagnose::{Cause, Diagnosis, Left, Verdict};
use glidepolar_tests::diagnosed;
use glidepolar_virtual_sea::catalogue::Drawn;
use glidepolar_virtual_sea::{Options, catalogue, generate, worlds};
use rayon::prelude::*;

/// What the table must reach, with measured speed and on vertical velocity alone, as shares.
struct Floors {
    /// The true name stands first.
    first: f64,
    /// It is named, or stands in the group of what is named first.
    in_group: f64,
    /// The true size lies in its 95 % interval.
    covered: f64,
    /// Groups of more than four names, at most.
    large_groups: f64,
    /// A name for an effect outside the catalogue, at most.
    wrong: f64,
}

const MEASURED: Floors = Floors { first: 0.93, in_group: 0.98, covered: 0.92, large_groups: 0.10, wrong: 0.05 };
const VERTICAL_ALONE: Floors = Floors { first: 0.0, in_group: 0.92, covered: 0.92, large_groups: 0.10, wrong: 0.07 };

/// Probability below which a misfit is significant.
const SIGNIFICANT: f64 = 0.01;

/// Names that a group may have beside which it is of use.
const LARGEST_GROUP: usize = 4;

/// Stands in the group of another scale, and is named where nothing else stands: beside a fitted polar it predicts what a scale of the
/// pressure does. Counted in groups alone.
const ALWAYS_GROUPED: &str = "speed_scale";

/// Two at once; both must be named.
const PAIRS: [&str; 3] =
    ["ballast_offset,hull_compressibility", "pitch_offset,drag_growth", "thermal_expansion,vertical_current"];

/// Every mechanism that has a size, and the density at p = 0.
fn catalogued() -> Vec<&'static str> {
    let has_size = |mechanism: &&glidepolar::mechanisms::Mechanism| !mechanism.parameters.is_empty();
    let all = glidepolar::mechanisms::AT_SEA.iter().chain(glidepolar::mechanisms::LATERAL);
    all.filter(has_size).map(|mechanism| mechanism.name).chain(["density_at_zero_pressure"]).collect()
}

fn outside() -> Vec<&'static str> {
    catalogue::TABLE.iter().filter(|effect| !effect.is_catalogued()).map(|effect| effect.name).collect()
}

/// What is left of a quantity, and what it must exceed to be worth acting on.
struct Misfit {
    quantity: String,
    size: f64,
    relevant_above: f64,
    is_significant: bool,
}

/// What one log gave.
struct Answer {
    effect: &'static str,
    seed: u64,
    causes: Vec<(String, Vec<String>)>,
    /// The probability that the first name is the true one of its group, by their likelihoods.
    probability_of_first: f64,
    verdict: Verdict,
    /// Whether anything is wrong beside the polar alone.
    is_wrong: bool,
    /// What is left of each quantity.
    misfits: Vec<Misfit>,
    /// Whether what is hidden makes a relevant misfit.
    is_relevant: bool,
    /// For each true parameter whether its interval holds it, where the mechanism was named first.
    covered: Vec<bool>,
    said: String,
    /// What a wrong name rests on.
    evidence: String,
}

impl Answer {
    /// `None` where the log holds too little steady glide for an answer.
    fn diagnose(effect: &'static str, seed: u64, speed: bool, drawn: bool) -> Option<Answer> {
        let effects = catalogue::parse_requests(effect).expect("an effect of the virtual sea");
        let (log, vehicle_toml, truth, world) = if drawn {
            let world = worlds::generate_with(seed, speed, &effects);
            (world.log, world.vehicle_toml, world.effects, world.drawn)
        } else {
            let sea = generate(&Options { effects, speed, ..Options::seeded(seed) });
            (sea.log, sea.vehicle_toml, sea.truth.effects, String::new())
        };
        let found = diagnosed(&log.to_csv(), &vehicle_toml)?;
        let mechanism = glidepolar::mechanisms::at_sea(effect);
        let parameters = mechanism.iter().flat_map(|mechanism| mechanism.parameters);
        let first = found.causes.first().filter(|cause| cause.cause == effect);
        let covered = parameters
            .filter_map(|parameter| Some((true_size(&truth, parameter)?, first?.parameters.get(*parameter)?)))
            // A time constant is one of a few, of which each stands for a range.
            .map(|(size, estimate)| estimate.ci95[0] <= size && size <= estimate.ci95[1])
            .collect();
        let causes: Vec<(String, Vec<String>)> =
            found.causes.iter().map(|cause| (cause.cause.clone(), cause.indistinguishable_from.clone())).collect();
        let of_rivals = |cause: &Cause| cause.log_likelihood_ratio.values().map(|ratio| ratio.exp()).sum::<f64>();
        let probability_of_first = found.causes.first().map_or(0.0, |cause| 1.0 / (1.0 + of_rivals(cause)));
        let is_wrong = !found.wrong.is_empty() || !causes.is_empty();
        let of = |left: &Left| Misfit {
            quantity: left.quantity.clone(),
            size: left.size,
            relevant_above: left.relevant_above,
            is_significant: left.p_value < SIGNIFICANT,
        };
        let misfits = found.left.iter().map(of).collect();
        let said = match (causes.is_empty(), found.verdict) {
            (true, Verdict::None) => "none".to_owned(),
            (true, _) => "unexplained".to_owned(),
            _ => causes.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join("+"),
        };
        let evidence = format!("{}; {world}", evidence(&truth, &found));
        Some(Answer {
            evidence,
            effect,
            seed,
            causes,
            probability_of_first,
            verdict: found.verdict,
            is_wrong,
            misfits,
            is_relevant: is_wrong,
            covered,
            said,
        })
    }

    /// What is left is relevant where it exceeds what the same flight leaves with nothing hidden, the squares of independent
    /// misfits adding up.
    fn beside(mut self, nothing: Option<&Answer>) -> Answer {
        let of_water = |quantity: &str| {
            let misfits = nothing.iter().flat_map(|nothing| &nothing.misfits);
            misfits.filter(|misfit| misfit.quantity == quantity).map(|misfit| misfit.size.powi(2)).sum::<f64>()
        };
        let is_of_hidden = |misfit: &Misfit| {
            let hidden = misfit.size.powi(2) - of_water(&misfit.quantity);
            misfit.is_significant && hidden > misfit.relevant_above.powi(2)
        };
        let is_of_water = nothing.is_some_and(|nothing| nothing.is_wrong);
        self.is_relevant = self.is_wrong && !is_of_water || self.misfits.iter().any(is_of_hidden);
        self
    }

    fn wanted(&self) -> Vec<&'static str> {
        self.effect.split(',').filter(|name| *name != "none" && !name.starts_with("uncatalogued")).collect()
    }

    /// The true names and no others stand among the causes, the strongest first where there is one.
    fn is_right(&self) -> bool {
        let wanted = self.wanted();
        match wanted.as_slice() {
            [] => self.causes.is_empty(),
            [one] => self.causes.first().is_some_and(|(name, _)| name == one),
            several => {
                several.len() == self.causes.len()
                    && several.iter().all(|one| self.causes.iter().any(|(name, _)| name == one))
            }
        }
    }

    /// Every true name is named or stands in a group.
    fn is_in_group(&self) -> bool {
        let has =
            |one: &str| self.causes.iter().any(|(name, group)| name == one || group.iter().any(|other| other == one));
        self.is_right() || (!self.wanted().is_empty() && self.wanted().iter().all(|one| has(one)))
    }

    /// A cause that is neither true nor grouped with what is.
    fn wrong_names(&self) -> usize {
        let wanted = self.wanted();
        let is_true = |(name, group): &&(String, Vec<String>)| {
            wanted.iter().any(|one| name == one || group.iter().any(|other| other == one))
        };
        self.causes.iter().filter(|cause| !is_true(cause)).count()
    }

    fn has_large_group(&self) -> bool {
        self.causes.iter().any(|(_, group)| group.len() + 1 > LARGEST_GROUP)
    }
}

/// The truth and the causes with their sizes, groups, halves, and what is left, in a line.
fn evidence(truth: &[Drawn], found: &Diagnosis) -> String {
    let mut text = format!("true {:?}", truth.iter().map(|drawn| &drawn.parameters).collect::<Vec<_>>());
    for cause in &found.causes {
        let sizes = cause.parameters.iter().map(|(name, e)| format!("{name} {:.3e} +- {:.1e}", e.value, e.se));
        let halves: Vec<String> =
            cause.stability.iter().map(|half| format!("{:.3e}+-{:.1e}", half.value, half.se)).collect();
        // With the logarithm of the ratio of its likelihood to that of the one named.
        let group: Vec<String> =
            cause.log_likelihood_ratio.iter().map(|(name, ratio)| format!("{name} {ratio:.1}")).collect();
        text += &format!(
            "; {} {} bic {:.0} {} {:.2}>{:.2} mm/s halves {} group {}",
            cause.cause,
            sizes.collect::<Vec<_>>().join(" "),
            cause.delta_bic,
            cause.quantity,
            cause.holdout_rms_before * 1e3,
            cause.holdout_rms_after * 1e3,
            halves.join(" "),
            group.join(",")
        );
    }
    for left in &found.left {
        text += &format!(
            "; left {} {} {:.2} of {:.2} mm/s p {:.1e}",
            left.quantity,
            left.depends_on,
            left.size * 1e3,
            left.relevant_above * 1e3,
            left.p_value
        );
    }
    for wrong in found.wrong.iter().take(2) {
        text += &format!("; wrong {} {} {:.2} mm/s", wrong.quantity, wrong.regime, wrong.size * 1e3);
    }
    let rejected = found.rejected.iter().filter(|one| truth.iter().any(|drawn| drawn.effect.name == one.cause));
    for one in rejected {
        text += &format!("; true one refused: {:?}, p {:.0e}", one.why, one.p_value.unwrap_or(f64::NAN));
    }
    if let Some(table) = &found.empirical {
        text += &format!(
            "; table {} {} {:.2}>{:.2} mm/s",
            table.acts_on,
            table.against,
            table.gain.holdout_rms_before * 1e3,
            table.gain.holdout_rms_after * 1e3
        );
    }
    text
}

/// True value of a parameter that is hidden in the log.
fn true_size(truth: &[Drawn], name: &str) -> Option<f64> {
    let parameters = truth.iter().flat_map(|drawn| &drawn.parameters);
    parameters.into_iter().find(|(parameter, _)| *parameter == name).map(|(_, value)| *value)
}

/// Counts over logs.
#[derive(Default)]
struct Tally {
    logs: usize,
    relevant: usize,
    /// Of these, with an effect that has a name of its own.
    to_name: usize,
    right: usize,
    in_group: usize,
    wrong: usize,
    large: usize,
    named: usize,
    sized: usize,
    covered: usize,
    partly: usize,
    said: BTreeMap<String, usize>,
}

impl Tally {
    fn count<'a>(answers: impl Iterator<Item = &'a Answer>) -> Tally {
        let mut sum = Tally::default();
        for answer in answers {
            sum.logs += 1;
            sum.relevant += usize::from(answer.is_relevant);
            let is_to_name = answer.is_relevant && answer.effect != ALWAYS_GROUPED;
            sum.to_name += usize::from(is_to_name);
            sum.right += usize::from(answer.is_right() && is_to_name);
            sum.in_group += usize::from(answer.is_in_group() && answer.is_relevant);
            sum.wrong += usize::from(answer.wrong_names() > 0);
            sum.named += usize::from(!answer.causes.is_empty());
            sum.large += usize::from(answer.has_large_group());
            sum.sized += answer.covered.len();
            sum.covered += answer.covered.iter().filter(|covered| **covered).count();
            sum.partly += usize::from(answer.verdict == Verdict::PartlyExplained);
            *sum.said.entry(answer.said.clone()).or_insert(0) += 1;
        }
        sum
    }

    fn row(&self, name: &str) {
        let said: Vec<String> = self.said.iter().map(|(name, n)| format!("{name} {n}")).collect();
        println!(
            "{name:<38} logs {:>3} relevant {:>3} to name {:>3} first {:>3} group {:>3} wrong {:>3} large {:>2} partly {:>2} size {:>3} of {:<3} {}",
            self.logs,
            self.relevant,
            self.to_name,
            self.right,
            self.in_group,
            self.wrong,
            self.large,
            self.partly,
            self.covered,
            self.sized,
            said.join(", ")
        );
    }
}

/// A small share of the table, always: nothing outside the catalogue gets a name.
#[test]
fn an_effect_outside_the_catalogue_gets_no_name() {
    let wrong: Vec<String> = ["uncatalogued-compass-pitch", "uncatalogued-layer", "uncatalogued-tide"]
        .into_iter()
        .map(|effect| Answer::diagnose(effect, 31, true, false).expect("a diagnosis"))
        .filter(|answer| !answer.causes.is_empty())
        .map(|answer| format!("{} was called {}", answer.effect, answer.said))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("; "));
}

/// A layer of 57 m that sinks at 29 mm/s, in dives to 529 m: the smooth curves pass it by, and a pitch offset was named.
#[test]
fn water_that_moves_in_a_layer_gets_no_name() {
    let answer = Answer::diagnose("uncatalogued-layer", 54_702, false, true).expect("a diagnosis");
    assert!(answer.causes.is_empty() && answer.verdict == Verdict::Unexplained, "{}", answer.said);
}

/// Foam that is crushed in the first metres. Trapped air explains the readings that are fitted, and leaves more of held-out vertical velocity.
#[test]
fn what_makes_held_out_vertical_velocity_worse_gets_no_name() {
    let answer = Answer::diagnose("uncatalogued-foam-crush", 80_200, true, true).expect("a diagnosis");
    assert!(answer.causes.is_empty() && answer.verdict == Verdict::Unexplained, "{}", answer.said);
}

/// A glider that hangs above a thermocline on each ascent for three hours, its pitch hunting: a clock offset was named.
#[test]
fn a_glider_that_hangs_near_neutral_follows_its_pitch_as_late_as_it_is_fast() {
    for speed in [false, true] {
        let answer = Answer::diagnose("none", 84_205, speed, true).expect("a diagnosis");
        assert!(answer.causes.is_empty() && answer.verdict == Verdict::None, "{}", answer.said);
    }
}

/// In dives to 614 m a scale of the speed and one of the pressure are distinguishable: the latter changes the pressure that compresses the hull.
#[test]
fn a_scale_of_the_speed_is_named_in_deep_water() {
    let answer = Answer::diagnose("speed_scale", 54_606, true, true).expect("a diagnosis");
    assert_eq!(answer.said, "speed_scale", "{}", answer.evidence);
}

/// Logs in which the slopes at another law hide the true one:
///
/// - carried water, before which a ballast scale of 0.74 stood, though its sum of squares was larger by 23;
/// - a scale of the pressure. Without it the polar runs away, and slopes count 19 of the 62 by which the sum of squares falls;
/// - carried water behind a creep and an expansion that fit together, neither with a size that nature has;
/// - a ballast scale behind a drag exponent that explains as much and changes too little to act on;
/// - clocks that are late by a fifth of a leg of 25 to 42 m, behind a curve and between two minima; one leg alone shows them.
#[test]
fn what_the_slopes_at_another_law_hide_is_found() {
    let hidden = [
        ("carried_water", 81_000),
        ("pressure_scale", 81_202),
        ("carried_water", 81_307),
        ("ballast_scale", 81_700),
        ("clock_offset", 81_104),
        ("clock_offset", 81_105),
        ("clock_offset", 81_807),
    ];
    for (effect, seed) in hidden {
        let answer = Answer::diagnose(effect, seed, true, true).expect("a diagnosis");
        assert!(answer.is_in_group() && answer.wrong_names() == 0, "{seed}: {}", answer.evidence);
        assert!(effect == "pressure_scale" || answer.is_right(), "{seed}: {}", answer.evidence);
    }
}

/// Dives to 26 to 113 m with a pressure that is late by 33 to 40 s: for minutes after a turn it reads the other leg.
#[test]
fn a_pressure_that_is_late_after_a_turn_has_its_size() {
    for seed in [81_201, 81_706, 81_801] {
        let answer = Answer::diagnose("pressure_lag", seed, true, true).expect("a diagnosis");
        assert!(answer.is_right() && answer.covered == [true], "{seed}: {}", answer.evidence);
    }
}

/// Air of 93 to 100 cm3, compressed within the first bins of each leg, and a ballast volume of 33 cm3/h that leaks back while its reading
/// has noise of half a cubic centimetre: two sizes that stayed where a quick fit ended, one that stayed at 11 cm3 in a curved valley beside
/// a drag at large angles of attack, and one that began anew in mid-leg.
#[test]
fn what_changes_most_near_a_turn_has_its_size() {
    let hidden = [("trapped_air", 82_400), ("trapped_air", 82_602), ("trapped_air", 82_604), ("pump_leakback", 82_604)];
    for (effect, seed) in hidden {
        let answer = Answer::diagnose(effect, seed, true, true).expect("a diagnosis");
        assert!(answer.is_right() && answer.covered == [true], "{seed}: {}", answer.evidence);
    }
}

/// Two at once. Beside an offset and a compressibility two spurious mechanisms fitted as well, and spoilt what the four predict of glides held
/// out: all were dropped. A current is not known well enough beside an expansion: a drag exponent stood in the place of both, and left 15 mm/s.
#[test]
fn what_is_spurious_takes_nothing_true_along() {
    let answer = Answer::diagnose("ballast_offset,hull_compressibility", 82_407, true, true).expect("a diagnosis");
    assert!(answer.is_right(), "{}", answer.evidence);
    let answer = Answer::diagnose("thermal_expansion,vertical_current", 82_405, true, true).expect("a diagnosis");
    assert!(answer.causes[0].0 == "vertical_current" && answer.wrong_names() == 0, "{}", answer.evidence);
}

/// A glider with inertia whose pressure reads 7 % too much: without inertia the baseline alone predicts better, and nothing explains that.
#[test]
fn what_has_inertia_is_not_taken_without_for_want_of_a_cause() {
    let answer = Answer::diagnose("pressure_scale", 83_702, true, true).expect("a diagnosis");
    assert!(answer.is_right() && answer.covered == [true], "{}", answer.evidence);
}

/// Slopes at a drag that grows by a third in a day show it by five standard errors, since lift and drag can follow it there; as far as no
/// growth they cannot, and the sum of squares rises threefold. A thermistor that is early, the same, on one of the legs.
#[test]
fn a_leg_that_hardly_shows_a_law_by_slopes_does_not_refuse_it() {
    for (effect, seed, speed) in [("drag_growth", 83_803, false), ("thermal_lag", 83_902, true)] {
        let answer = Answer::diagnose(effect, seed, speed, true).expect("a diagnosis");
        assert!(answer.is_right() && answer.covered == [true], "{seed}: {}", answer.evidence);
    }
}

/// A creep that the speed shows to 2 mm/s: without it the first eighth of the log is missed most, in which it does not act yet. Held-out
/// vertical velocities are missed by 3 um/s more with it, which no name may do. So a leak that is less likely has the name, and the creep
/// stands beside it. In other logs the creep has it, with its size.
#[test]
fn what_grows_from_nothing_is_relevant_for_what_is_missed_before() {
    let answer = Answer::diagnose("hull_creep", 84_002, true, true).expect("a diagnosis");
    assert!(answer.is_in_group(), "{}", answer.evidence);
    for seed in [84_020, 84_021] {
        let answer = Answer::diagnose("hull_creep", seed, true, true).expect("a diagnosis");
        assert!(answer.is_right() && answer.covered.iter().all(|covered| *covered), "{seed}: {}", answer.evidence);
    }
}

/// Descents and ascents whose drag differs. The baseline ends far from them and nothing stands beside it; with a scale of the speed among
/// the candidates the search goes another way, and names the difference without that scale.
#[test]
fn what_is_found_beside_a_scale_of_the_speed_stands_without_one() {
    let answer = Answer::diagnose("climb_dive_asymmetry", 83_901, true, true).expect("a diagnosis");
    assert!(answer.is_right() && answer.covered == [true], "{}", answer.evidence);
}

/// Ten legs through water that moves by 3.3 mm/s in 36 minutes. With all candidates set aside it seems to move by 1.3 mm/s in 6 minutes,
/// and a curve along five headings hid what is there.
#[test]
fn water_that_ten_legs_hardly_tell_from_candidates_is_noise() {
    for effect in ["hull_creep", "pressure_scale", "pitch_offset", "conductivity_drift"] {
        let answer = Answer::diagnose(effect, 84_115, true, true).expect("a diagnosis");
        assert!(answer.is_right() && answer.covered.iter().all(|covered| *covered), "{effect}: {}", answer.evidence);
    }
}

/// Legs of one stretch of glide each, all at one depth on one heading: by the readings' own rate the column of a shear had all of their
/// noise, and 0.04 mm/s were left of 5.5.
#[test]
fn a_column_that_goes_by_the_rate_of_a_leg_does_not_hold_its_noise() {
    let answer = Answer::diagnose("none", 66_629, false, true).expect("a diagnosis");
    assert_eq!(answer.said, "none", "{}", answer.evidence);
}

/// Beside the polar that bends to a late clock its minimum is narrower than its prior: from none, and from one prior standard deviation,
/// fits end elsewhere. Beside the bent polar of the last there is no minimum at all; beside the vehicle's there is.
#[test]
fn a_late_clock_is_found_from_sizes_on_either_side_of_none() {
    for (seed, speed) in [(84_113, true), (84_005, true), (83_804, false), (84_507, true)] {
        let answer = Answer::diagnose("clock_offset", seed, speed, true).expect("a diagnosis");
        assert!(answer.is_right(), "{seed}: {}", answer.evidence);
    }
}

/// A clock of -39 s resembled a pressure that is late by 16 s, and a pressure that is late by 29 s a scale of it: the slopes at the one say
/// nothing of the other.
#[test]
fn what_is_late_is_fitted_from_its_own_sizes_in_the_place_of_what_resembles_it() {
    for (effect, seed) in [("clock_offset", 84_502), ("pressure_lag", 84_501)] {
        let answer = Answer::diagnose(effect, seed, true, true).expect("a diagnosis");
        assert!(answer.is_right(), "{seed}: {}", answer.evidence);
    }
}

/// A current of 18 mm/s is most of what a noise that lasts explains too, and a curve along the pitch explains more of the rest.
#[test]
fn no_curve_takes_the_place_of_a_current_that_does_nearly_all() {
    let answer = Answer::diagnose("vertical_current", 82_206, true, true).expect("a diagnosis");
    assert!(answer.is_right() && answer.covered == [true], "{}", answer.evidence);
}

/// Air that leaves in dives to 28 m looks like a hull that is four times as soft as sea water.
#[test]
fn a_hull_much_softer_than_water_gets_no_name() {
    let answer = Answer::diagnose("uncatalogued-burped-air", 81_800, true, true).expect("a diagnosis");
    assert_eq!(answer.said, "unexplained", "{}", answer.evidence);
}

/// Dives to 41 m of one bin a leg, through 0.22 m/s of shear in 11 m: with one mode of the shear a misfit along the heading hid the current.
#[test]
fn a_shear_that_one_bin_on_each_leg_meets_does_not_hide_a_vertical_current() {
    let answer = Answer::diagnose("vertical_current", 81_105, true, true).expect("a diagnosis");
    assert_eq!(answer.said, "vertical_current", "{}", answer.evidence);
}

#[test]
#[ignore = "some 2500 logs over 20 seeds, an hour; BLIND_EFFECT and BLIND_SPEED choose among them"]
fn the_table_of_confusions() {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default);
    let (first, seeds): (u64, u64) = (number("BLIND_FIRST", 0), number("BLIND_SEEDS", 20));
    let only = std::env::var("BLIND_EFFECT").unwrap_or_default();
    let is_chosen = |effect: &&str| only.split(',').any(|part| effect.contains(part));
    let speeds = match std::env::var("BLIND_SPEED").as_deref() {
        Ok("measured") => vec![true],
        Ok("none") => vec![false],
        _ => vec![true, false],
    };
    let drawn = std::env::var("BLIND_WORLDS").is_ok_and(|worlds| worlds == "drawn");
    let mut failed: Vec<String> = Vec::new();
    for speed in speeds {
        println!("measured speed: {speed}");
        let parts =
            [("catalogue", catalogued()), ("pairs", PAIRS.to_vec()), ("outside", outside()), ("none", vec!["none"])];
        for (part, effects) in parts {
            let effects: Vec<&str> = effects.into_iter().filter(is_chosen).collect();
            if effects.is_empty() {
                continue;
            }
            let answers = answers(&effects, first..first + seeds, speed, drawn);
            for effect in &effects {
                Tally::count(answers.iter().filter(|answer| answer.effect == *effect)).row(effect);
            }
            let all = Tally::count(answers.iter());
            all.row(&format!("all of {part}"));
            if part == "catalogue" {
                first_by_likelihood(&answers);
                missed(&answers);
            }
            for answer in answers.iter().filter(|answer| {
                answer.wrong_names() > 0 || !answer.is_right() && answer.is_relevant || answer.covered.contains(&false)
            }) {
                println!("  {} seed {} was called {}: {}", answer.effect, answer.seed, answer.said, answer.evidence);
            }
            let floors = if speed { &MEASURED } else { &VERTICAL_ALONE };
            failed.extend(below(part, &all, floors).into_iter().map(|line| format!("measured speed {speed}: {line}")));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Prints how many first names are right, beside how many the likelihoods of the groups promise: among laws that these data hardly
/// separate no rule does better.
fn first_by_likelihood(answers: &[Answer]) {
    let is_to_name = |answer: &&Answer| answer.is_relevant && answer.effect != ALWAYS_GROUPED;
    let named: Vec<&Answer> = answers.iter().filter(is_to_name).filter(|answer| !answer.causes.is_empty()).collect();
    let right = named.iter().filter(|answer| answer.is_right()).count();
    let promised: f64 = named.iter().map(|answer| answer.probability_of_first).sum();
    println!("first of those that have a name: {right} of {}, by the likelihoods {promised:.1}", named.len());
}

/// Prints the verdicts on relevant effects that are neither named nor in the group. The verdict is `none` where the misfit is not
/// significant at the level of the diagnosis, 1e-4.
fn missed(answers: &[Answer]) {
    let missed: Vec<&Answer> = answers.iter().filter(|answer| answer.is_relevant && !answer.is_in_group()).collect();
    let said = |what: &str| missed.iter().filter(|answer| answer.said == what).count();
    let (none, unexplained) = (said("none"), said("unexplained"));
    let other = missed.len() - none - unexplained;
    println!("not in name or group: none {none}, unexplained {unexplained}, another name {other}");
}

/// What is below its floor.
fn below(part: &str, sum: &Tally, floors: &Floors) -> Vec<String> {
    let mut failed = Vec::new();
    let mut at_least = |what: &str, n: usize, of: usize, floor: f64| {
        if of > 0 && (n as f64) < floor * of as f64 {
            failed.push(format!("{part}: {what} {n} of {of}, at least {floor}"));
        }
    };
    match part {
        "catalogue" => {
            at_least("true name first", sum.right, sum.to_name, floors.first);
            at_least("name or group", sum.in_group, sum.relevant, floors.in_group);
            at_least("size in its interval", sum.covered, sum.sized, floors.covered);
            at_least("groups of at most four names", sum.named - sum.large, sum.named, 1.0 - floors.large_groups);
        }
        "outside" | "none" => at_least("no wrong name", sum.logs - sum.wrong, sum.logs, 1.0 - floors.wrong),
        _ => at_least("both in name or group", sum.in_group, sum.relevant, floors.in_group),
    }
    failed
}

/// Diagnoses every effect under every seed, on all cores.
fn answers(effects: &[&'static str], seeds: std::ops::Range<u64>, speed: bool, drawn: bool) -> Vec<Answer> {
    let tasks: Vec<(&'static str, u64)> =
        effects.iter().flat_map(|effect| seeds.clone().map(|seed| (*effect, seed))).collect();
    let answer = |(effect, seed)| Answer::diagnose(effect, seed, speed, drawn);
    let nothing: BTreeMap<u64, Answer> =
        seeds.clone().into_par_iter().filter_map(|seed| Some((seed, answer(("none", seed))?))).collect();
    let mut found: Vec<Answer> =
        tasks.into_par_iter().filter_map(|task| Some(answer(task)?.beside(nothing.get(&task.1)))).collect();
    found.sort_by_key(|answer| (answer.effect, answer.seed));
    found
}
