//! The table on the console and the page in the docs.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use crate::arguments::Run;
use crate::machine::Machine;
use crate::report::Part;

const HEAD: [&str; 7] = ["what", "glidepolar", "beside", "its figure", "ratio", "goal", "met"];

/// The hand-written explanations, included as they are.
const NOTES: &str = "benches/notes.md";

/// A part's table for a terminal.
pub fn console(part: &Part) -> String {
    let rows: Vec<[String; 7]> = part.rows.iter().map(|row| row.cells()).collect();
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.chain([HEAD[column].len()]).max().unwrap_or(0).min(60)
    };
    let widths: [usize; 7] = std::array::from_fn(width);
    let line = |cells: &[String; 7]| {
        let padded: Vec<String> = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        padded.join("  ").trim_end().to_owned()
    };
    let mut text = format!("\n{} ({:.0} s)\n{}\n", part.heading, part.seconds, line(&HEAD.map(str::to_owned)));
    for row in &rows {
        let _ = writeln!(text, "{}", line(row));
    }
    for remark in &part.remarks {
        let _ = writeln!(text, "  {remark}");
    }
    text
}

/// Writes the page and its figures: into docs/ when everything was measured, beside what was made on the way otherwise.
pub fn write(run: &Run, machine: &Machine, parts: &[Part]) -> Result<()> {
    let whole = run.choice.is_whole();
    let docs = if whole { run.root.join("docs") } else { run.work.clone() };
    let figures = docs.join("figures");
    std::fs::create_dir_all(&figures).with_context(|| format!("cannot make {}", figures.display()))?;
    for figure in parts.iter().flat_map(|part| &part.figures) {
        place(&figures.join(format!("{}.svg", figure.name)), &figure.svg())?;
    }
    let notes = std::fs::read_to_string(run.root.join(NOTES)).unwrap_or_default();
    let evidence = docs.join("evidence");
    std::fs::create_dir_all(&evidence).with_context(|| format!("cannot make {}", evidence.display()))?;
    let page = evidence.join("benchmarks.md");
    place(&page, &markdown(machine, parts, &notes, run.choice.full))?;
    println!("\n{}", page.display());
    if !whole {
        println!("(docs/evidence/benchmarks.md is written by a whole run only)");
    }
    Ok(())
}

/// Written beside its place and renamed: whole or not at all.
fn place(file: &Path, text: &str) -> Result<()> {
    let beside: PathBuf = file.with_extension("partial");
    std::fs::write(&beside, text)
        .and_then(|()| std::fs::rename(&beside, file))
        .with_context(|| format!("cannot write {}", file.display()))
}

fn markdown(machine: &Machine, parts: &[Part], notes: &str, full: bool) -> String {
    let command = if full { "cargo xtask bench --full" } else { "cargo xtask bench" };
    let mut text = format!(
        "# Evidence: speed, cost and scale\n\n\
         Written by `{command}`; the notes at the end stand in `{NOTES}`. All that is compared runs on the same machine, \
         taking turns in rounds, each round begun by another one, after one round that does not count. A figure is the \
         median over the rounds with its quartiles; a ratio is the other's figure over glidepolar's in the same round, \
         above 1 where glidepolar is better. Absolute times hold for this machine alone.\n\n"
    );
    for line in &machine.lines {
        let _ = writeln!(text, "- {line}");
    }
    let met =
        |wanted: bool| parts.iter().flat_map(|part| &part.rows).filter(|row| row.is_met() == Some(wanted)).count();
    let open = parts.iter().flat_map(|part| &part.rows).filter(|row| row.goal.is_some() && row.is_met().is_none());
    let _ = writeln!(text, "\nGoals met: {}; not met: {}; not measured: {}.", met(true), met(false), open.count());
    for part in parts {
        let _ = write!(text, "\n## {}\n\n{}\n\n", part.heading, part.text);
        let _ = writeln!(text, "| {} |\n|{}", HEAD.join(" | "), "---|".repeat(HEAD.len()));
        for row in &part.rows {
            let _ = writeln!(text, "| {} |", row.cells().join(" | "));
        }
        text.push('\n');
        for remark in &part.remarks {
            let _ = writeln!(text, "- {remark}");
        }
        for figure in &part.figures {
            let _ = writeln!(text, "\n![{}](../figures/{}.svg)", figure.caption, figure.name);
        }
        let _ = writeln!(text, "\nThis part took {:.0} s.", part.seconds);
    }
    if !notes.trim().is_empty() {
        let _ = write!(text, "\n{}\n", notes.trim());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contest::Samples;
    use crate::report::{Goal, Row, Unit};

    #[test]
    fn the_page_says_what_was_measured_what_was_not_and_what_is_met() {
        let mut part = Part::new("The FMU", "Calls.");
        let samples = |value| Ok(Samples::one(value));
        part.row(
            Row::new("step", Unit::Seconds, samples(1e-6)).against("peer", samples(1e-3)).goal(Goal::Quicker(100.0)),
        );
        part.row(Row::new("voyage", Unit::Seconds, samples(2.0)).goal(Goal::AtMost(1.0)));
        part.row(Row::new("fit", Unit::Seconds, Err(anyhow::anyhow!("no | data"))).goal(Goal::AtMost(1.0)));
        let machine = Machine { lines: vec!["a machine".to_owned()] };
        let page = markdown(&machine, &[part], "## Notes\n\nWhy.\n", false);
        assert!(page.contains("Goals met: 1; not met: 1; not measured: 1."));
        assert!(page.contains("| step | 1.00 µs | peer | 1.00 ms | 1000 | ≥ 100 times better | yes |"), "{page}");
        assert!(page.contains("not measured: no   data") && page.contains("- a machine") && page.ends_with("Why.\n"));
    }
}
