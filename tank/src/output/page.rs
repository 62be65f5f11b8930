//! The page: what was found, how sure it is, every step that led there.

use glidepolar_hull::hull_tests::Estimate;
use glidepolar_report::{Cell, InputFile, Report, Section, Table};

use super::{figures, particulars};
use crate::derivatives::{self, Comparison, Derivatives};
use crate::fits::SweepFit;
use crate::results::{HullResults, Results};
use crate::sweep::NAMES;
use crate::trend::COEFFICIENTS;

/// Runs of one hull that are drawn at most, those with notices apart: a page that a browser can still show.
const MOST_DRAWN: usize = 200;

/// Makes the page of a reduction. `inputs` are the files that describe it; the runs' own files are many and stay unlisted.
pub fn report(results: &Results, inputs: Vec<InputFile>) -> Report {
    let mut report = Report::new("Hull tests", &results.name);
    report.program = concat!("tank-reduce ", env!("CARGO_PKG_VERSION")).to_owned();
    report.warnings = results.warnings.clone();
    report.findings = findings(results);
    for input in inputs {
        report = report.input(input);
    }
    if let Some(section) = super::diagnosis::section(results) {
        report = report.section(section);
    }
    report = report.section(coefficients(results)).section(particulars::uncertainty(results));
    if results.hulls.iter().any(|h| h.dynamic.is_some()) {
        report = report.section(derivatives(results));
    }
    report = report.section(particulars::particulars(results));
    report = report.section(theory(results)).section(adequacy(results)).section(steps(results));
    for hull in results.hulls.iter().filter(|hull| !hull.sweep.points.is_empty()) {
        report = report.section(points(hull));
    }
    for hull in (0..results.hulls.len()).map(Some).chain([None]) {
        report = runs(results, hull).into_iter().fold(report, Report::section);
    }
    report
}

/// Every reduced steady run of a hull.
fn points(hull: &HullResults) -> Section {
    let mut table = Table::new(
        "Steady runs about the centre of buoyancy, with standard errors from within each run.",
        ["Run", "yaw [deg]", "speed [m/s]", "Re / 10⁶", "CL", "CD", "CM", "in the fit"],
    );
    let rows = hull.fit.as_ref().map(|fit| fit.rows.as_slice()).unwrap_or_default();
    for (i, point) in hull.sweep.points.iter().enumerate() {
        let optional = |value: Option<f64>, digits| value.map_or(Cell::from("-"), |value| Cell::number(value, digits));
        let coefficient = |k: usize| match point.se[k] > 0.0 {
            true => Cell::estimate(point.coefficients[k], point.se[k]),
            false => Cell::number(point.coefficients[k], 4),
        };
        table.push([
            Cell::from(point.run_id.as_str()),
            Cell::fixed(point.yaw_deg, 2),
            optional(point.speed_m_s, 4),
            optional(point.reynolds.map(|re| re / 1e6), 3),
            coefficient(0),
            coefficient(1),
            coefficient(2),
            Cell::from(if rows.contains(&i) { "yes" } else { "" }),
        ]);
    }
    Section::new(format!("Steady runs of {}", hull.hull.id)).folded().table(table)
}

/// The histories of the runs of one hull, or of the strut alone, on a page of their own. Of very many runs those with
/// notices and some of the rest are drawn.
fn runs(results: &Results, hull: Option<usize>) -> Option<Section> {
    let of_hull: Vec<_> = results.runs.iter().filter(|run| run.run.hull == hull).collect();
    let name = hull.and_then(|hull| results.hulls.get(hull)).map_or("the strut alone", |hull| hull.hull.id.as_str());
    let every = of_hull.len().div_ceil(MOST_DRAWN);
    let section = Section::new(format!("Windows of the runs of {name}")).on_its_own_page(format!("runs-{name}"));
    let mut section = section.text("Each run's history; the part that was used is shaded.");
    if every > 1 {
        section = section.text(format!(
            "Of {} runs those with notices and one in {every} of the others are drawn; steps.csv has the windows of all steady ones.",
            of_hull.len()
        ));
    }
    for (i, run) in of_hull.iter().enumerate() {
        if i % every == 0 || !run.notices.is_empty() {
            section = section.figure(figures::run(run));
        }
    }
    (!of_hull.is_empty()).then_some(section)
}

fn findings(results: &Results) -> Vec<String> {
    let mut findings = Vec::new();
    if !results.source.is_empty() {
        findings.push(format!("Source: {}.", results.source));
    }
    for hull in &results.hulls {
        let Ok(fit) = &hull.fit else { continue };
        let e = &fit.estimates;
        findings.push(format!(
            "{}: CL = {} α, CD = {} + {} α², CM = {} α within {} deg (α in radians; 95 % intervals in the table).",
            hull.hull.id,
            shown(&e.a),
            shown(&e.b),
            shown(&e.c),
            shown(&e.d),
            results.range_deg
        ));
    }
    if let Some(overall) = results.diagnoses.as_ref().and_then(|diagnoses| diagnoses.overall()) {
        findings.push(super::diagnosis::in_a_sentence(overall));
    }
    if !results.rejected.is_empty() {
        findings.push(format!("{} runs could not be used; the warnings say why.", results.rejected.len()));
    }
    findings
}

fn shown(q: &Estimate) -> String {
    glidepolar_report::estimate(q.value, q.se)
}

fn pair_of_thousandths(q: &Estimate) -> [Cell; 2] {
    [Cell::estimate(1e3 * q.value, 1e3 * q.se), Cell::interval((1e3 * q.ci95[0], 1e3 * q.ci95[1]))]
}

fn pair(q: &Estimate) -> [Cell; 2] {
    [Cell::estimate(q.value, q.se), Cell::interval((q.ci95[0], q.ci95[1]))]
}

fn coefficients(results: &Results) -> Section {
    let mut fits = Table::new(
        "Fits about the centre of buoyancy with standard errors.",
        ["Hull", "runs", "points", "a [1/rad]", "b", "c [1/rad²]", "d [1/rad]"],
    );
    let mut intervals = Table::new("Their 95 % intervals.", ["Hull", "a [1/rad]", "b", "c [1/rad²]", "d [1/rad]"]);
    for hull in &results.hulls {
        let name = || Cell::from(hull.hull.id.as_str());
        let mut row = vec![name(), Cell::Count(hull.n_runs as i64)];
        if let Ok(fit) = &hull.fit {
            let e = &fit.estimates;
            let pairs = [&e.a, &e.b, &e.c, &e.d].map(pair);
            row.push(Cell::Count(fit.rows.len() as i64));
            row.extend(pairs.iter().map(|[value, _]| value.clone()));
            intervals.push(std::iter::once(name()).chain(pairs.into_iter().map(|[_, interval]| interval)));
        }
        fits.push(row);
    }
    let mut section = Section::new("Lift, drag and moment").table(fits).table(intervals).table(sway_slopes(results));
    for figure in figures::coefficients(results) {
        section = section.figure(figure);
    }
    section = section.figure(figures::residuals(results));
    if let Some(figure) = figures::trend(results) {
        section = section.figure(figure);
    }
    if let Some(lines) = &results.trend {
        let mut table = Table::new(
            "Change per unit of length to diameter ratio; the probability is that of so much scatter about a straight line.",
            ["Coefficient", "slope", "95 %", "probability"],
        );
        for (line, (name, ..)) in lines.0.iter().zip(COEFFICIENTS) {
            let [value, interval] = pair(&line.slope);
            table.push([Cell::from(name), value, interval, Cell::number(line.p_value, 2)]);
        }
        section = section.table(table);
    }
    section
}

/// The same slopes as a manoeuvring engineer has them.
fn sway_slopes(results: &Results) -> Table {
    let mut table = Table::new(
        "The slopes at zero drift as SNAME primes on the overall length about the centre of buoyancy: Yv' = -(a₀ + b) A/L², Nv' = -d₀ A/L², from all points to 20 deg, by an odd series in v/V to the fifth order (less where points are too few: then the orders stand behind the hull).",
        ["Hull", "10³ Yv'", "95 %", "10³ Nv'", "95 %"],
    );
    for hull in &results.hulls {
        let Ok(fit) = &hull.fit else { continue };
        let [yv, nv] = derivatives::from_sweep(&hull.hull, fit);
        let name = match fit.zero_drift.each_ref().map(|slope| slope.order) {
            [5, 5] => hull.hull.id.clone(),
            [lift, moment] => format!("{} (orders {lift}, {moment})", hull.hull.id),
        };
        let mut row = vec![Cell::from(name)];
        row.extend([&yv, &nv].into_iter().flat_map(pair_of_thousandths));
        table.push(row);
    }
    table
}

fn derivatives(results: &Results) -> Section {
    let mut section = Section::new("Derivatives from oscillations and turns").text(
        "SNAME primes on the overall length about the centre of buoyancy, all sway, yaw and turning runs of a hull in one regression of first and third harmonics.",
    );
    let names = ["Yv'", "Nv'", "Yr'", "Nr'", "Yvdot'", "Nvdot'", "Yrdot'", "Nrdot'"];
    let header = || std::iter::once("10³ times").chain(dynamic(results).map(|(hull, _)| hull.hull.id.as_str()));
    let mut values = Table::new("Derivatives with standard errors, times 1000.", header());
    let mut intervals = Table::new("Their 95 % intervals.", header());
    for (i, name) in names.into_iter().enumerate() {
        let all = dynamic(results).map(|(_, d)| {
            let e = &d.estimates;
            let others = [&e.yr, &e.nr, &e.yvdot, &e.nvdot, &e.yrdot, &e.nrdot];
            [Some(&e.yv), Some(&e.nv)].into_iter().chain(others.map(Option::as_ref)).nth(i).flatten()
        });
        let cells = |q: Option<&Estimate>| match q {
            Some(q) => pair_of_thousandths(q),
            None => [Cell::from("-"), Cell::from("-")],
        };
        let columns: Vec<[Cell; 2]> = all.map(cells).collect();
        let row = |which: usize| std::iter::once(Cell::from(name)).chain(columns.iter().map(move |c| c[which].clone()));
        values.push(row(0));
        intervals.push(row(1));
    }
    section = section.table(values).table(intervals);
    for (hull, d) in dynamic(results) {
        if let Some((low, high)) = d.reduced_frequencies {
            section = section.text(format!("{}: reduced frequencies ωL/U {low:.2} to {high:.2}.", hull.hull.id));
        }
    }
    section = section.text(agreement(results));
    let mut table = Table::new(
        "The same derivative from two kinds of run, and how many standard errors they are apart.",
        ["Hull", "derivative", "from", "value", "from", "value", "apart"],
    );
    let mut nonlinear = Table::new("Nonlinear terms.", ["Hull", "term", "value", "95 %"]);
    for (hull, d) in dynamic(results) {
        for c in hull.comparisons.iter().chain(&d.turns) {
            table.push([
                Cell::from(hull.hull.id.as_str()),
                Cell::from(format!("{}'", c.name)),
                Cell::from(c.first_from),
                Cell::estimate(c.first.value, c.first.se),
                Cell::from(c.second_from),
                Cell::estimate(c.second.value, c.second.se),
                Cell::number(c.apart(), 2),
            ]);
        }
        for (name, q) in &d.nonlinear {
            let [value, interval] = pair(q);
            nonlinear.push([Cell::from(hull.hull.id.as_str()), Cell::from(format!("{name}'")), value, interval]);
        }
    }
    section
        .table(table)
        .table(nonlinear)
        .text("derivatives.csv has what each oscillation alone says, for amplitude and frequency to be compared.")
}

/// Whether kinds of run agree, in a sentence.
fn agreement(results: &Results) -> String {
    let all = || dynamic(results).flat_map(|(hull, d)| hull.comparisons.iter().chain(&d.turns).map(move |c| (hull, c)));
    let apart = |c: &Comparison| c.apart().abs();
    let Some((hull, worst)) = all().max_by(|a, b| apart(a.1).total_cmp(&apart(b.1))) else {
        return "No derivative is identified by two kinds of run.".to_owned();
    };
    let disagree = all().filter(|(_, c)| c.disagrees()).count();
    let verdict = match disagree {
        0 => "agree within what chance allows".to_owned(),
        n => format!("disagree in {n} of {} cases", all().count()),
    };
    format!(
        "Steady sweep and oscillation, and turns and yaw oscillation, {verdict}; furthest apart is {}' of {}, {:.1} standard errors between {} and {}.",
        worst.name,
        hull.hull.id,
        apart(worst),
        worst.first_from,
        worst.second_from
    )
}

fn dynamic(results: &Results) -> impl Iterator<Item = (&HullResults, &Derivatives)> {
    results.hulls.iter().filter_map(|hull| Some((hull, hull.dynamic.as_ref()?)))
}

fn theory(results: &Results) -> Section {
    let mut table = Table::new(
        "Theory beside measurement. An asterisk marks figures that rest on an assumed outline: SUBOFF's bow and stern with a parallel middle body.",
        ["Hull", "quantity", "theory", "predicted", "measured", "measured/predicted"],
    );
    for hull in &results.hulls {
        for t in &hull.theory {
            table.push([
                Cell::from(hull.hull.id.as_str()),
                Cell::from(t.quantity),
                Cell::from(format!("{}{}", t.method, if t.assumes_outline { " *" } else { "" })),
                Cell::number(t.predicted, 4),
                t.measured.map_or(Cell::from("-"), |(value, se)| Cell::estimate(value, se)),
                t.ratio().map_or(Cell::from("-"), |ratio| Cell::number(ratio, 3)),
            ]);
        }
    }
    Section::new("Theory beside measurement").table(table)
}

fn adequacy(results: &Results) -> Section {
    let fitted = || results.hulls.iter().filter_map(|h| Some((h.hull.id.as_str(), h.fit.as_ref().ok()?)));
    let mut forms = Table::new(
        "Other forms on the same points, x the angle in radians: root mean square error of predicting a point that was left out, over that of the model used.",
        ["Hull", "coefficient", "form", "rms", "over the model's", "parameters"],
    );
    let mut lack = Table::new(
        "Repeats against the model: ratio of mean squares; a small probability means that the model misses by more than repeats scatter.",
        [
            "Hull",
            "coefficient",
            "F",
            "degrees of freedom",
            "probability",
            "scatter between runs",
            "as a setting error [deg]",
        ],
    );
    let mut ranges = Table::new(
        "The coefficients against the range of angles.",
        ["Hull", "range [deg]", "points", "a [1/rad]", "b", "c [1/rad²]", "d [1/rad]"],
    );
    for (id, fit) in fitted() {
        add_forms(&mut forms, id, fit);
        for (i, name) in NAMES.into_iter().enumerate() {
            let l = fit.lack_of_fit[i];
            lack.push([
                Cell::from(id),
                Cell::from(name),
                l.map_or(Cell::from("no repeats"), |l| Cell::number(l.f, 3)),
                l.map_or(Cell::from("-"), |l| Cell::from(format!("{} and {}", l.misfit_dof, l.repeat_dof))),
                l.map_or(Cell::from("-"), |l| Cell::number(l.p_value, 2)),
                Cell::number(fit.fits[i].between_runs, 2),
                if i == 2 { Cell::number(fit.setting_rad.to_degrees(), 2) } else { Cell::from("") },
            ]);
        }
        for r in &fit.ranges {
            let mut row = vec![Cell::from(id), Cell::number(r.range_deg, 4), Cell::Count(r.points as i64)];
            row.extend([&r.fit.a, &r.fit.b, &r.fit.c, &r.fit.d].map(|q| Cell::estimate(q.value, q.se)));
            ranges.push(row);
        }
    }
    Section::new("Is the model adequate?").table(ranges).table(lack).table(forms)
}

fn add_forms(table: &mut Table, id: &str, fit: &SweepFit) {
    for (i, candidates) in fit.adequacy.iter().enumerate() {
        let own = candidates.first().map_or(f64::NAN, |c| c.left_out_rms);
        for c in candidates {
            let parameters: Vec<String> =
                c.parameters.iter().map(|(value, se)| glidepolar_report::estimate(*value, *se)).collect();
            table.push([
                Cell::from(id),
                Cell::from(NAMES[i]),
                Cell::from(c.form),
                Cell::number(c.left_out_rms, 3),
                Cell::number(c.left_out_rms / own, 3),
                Cell::from(parameters.join(", ")),
            ]);
        }
    }
}

fn steps(results: &Results) -> Section {
    let mut section = Section::new("From readings to forces");
    if let Some(balance) = &results.balance {
        let rows = balance.interaction.map(|row| row.map(|x| format!("{x:.5}")).join(" "));
        section = section.text(format!(
            "Zeros: {} zero runs, interpolated in {}; largest change between two of the same hull: AF {:.3} N, SF {:.3} N, YM {:.4} N m. Interaction matrix, row by row: {}. Tare: {} runs of the strut alone.",
            balance.zeros,
            if balance.in_time { "time" } else { "run order" },
            balance.largest_drift[0],
            balance.largest_drift[1],
            balance.largest_drift[2],
            rows.join("; "),
            balance.tare_runs
        ));
        if let Some([straight, askew]) = balance.tare_at_2_m_s {
            section = section.text(format!(
                "The strut at 2 m/s in water of 1000 kg/m³: AF {:.3} N straight ahead; AF {:.3} N, SF {:.3} N, YM {:.4} N m at 10 deg.",
                straight[0], askew[0], askew[1], askew[2]
            ));
        }
    }
    for hull in &results.hulls {
        if let Some(share) = hull.blockage {
            section = section.text(format!(
                "{}: frontal area over the tank's cross-section {:.3} %: not corrected for.",
                hull.hull.id,
                100.0 * share
            ));
        }
    }
    if results.runs.is_empty() {
        return section
            .text("The points came reduced: moment moved to the centre of buoyancy, forces turned into wind axes.");
    }
    section.text("steps.csv has every steady run step by step: reading, zero, force after interaction, strut, inertia, force of the water.")
}
