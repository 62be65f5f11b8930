//! The page: what was read, what was found, how to repeat it, as one HTML file that asks nothing of any other.

use super::draw::{NARROW, WIDTH, document};
use super::explorer::Explorer;
use super::figure::Figure;
use super::labels::{heading, powers};
use super::mouse;
use super::table::{Cell, Table};
use crate::output::{OutputError, OutputFolder};
use glidepolar_input::memory::Table as InMemory;
use glidepolar_input::{InputError, turns};
use minijinja::{Environment, HtmlEscape, Value, context};
use sha2::{Digest, Sha256};
use std::cell::RefCell;
use std::collections::HashSet;
use std::io::Read;
use std::path::Path;

/// One report. Warnings come first on the page, then findings, sections, and how to repeat it.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// What was done: `Hull tests`, `Identification`.
    pub title: String,
    /// To what: the campaign, the vehicle, the log.
    pub subject: String,
    /// What the reader must know before believing anything below; a sentence each.
    pub warnings: Vec<String>,
    /// The results in a few sentences.
    pub findings: Vec<String>,
    /// The body.
    pub sections: Vec<Section>,
    /// Program and version.
    pub program: String,
    /// The command as the user would type it again.
    pub command: String,
    /// The files that were read.
    pub inputs: Vec<InputFile>,
}

/// A heading and what stands below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// A few words.
    pub heading: String,
    /// Whether the reader unfolds it: long lists of runs or glides. Its figures stay in the page only.
    pub folded: bool,
    /// The file, without its ending, in which the section stands, where that is not the page itself: what is long and seldom
    /// read. The page then links to it.
    pub own_page: Option<String>,
    /// In reading order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Points of a list.
    List(Vec<String>),
    /// A command, a file's text: kept as it is, in a fixed-width face.
    Code(String),
    /// A figure, numbered by its place in the report.
    Figure(Figure),
    /// A table, numbered likewise.
    Table(Table),
    /// A curve with sliders, on the screen only.
    Explorer(Box<Explorer>),
    /// Other pages: what is there, and the file, relative to this one.
    Links(Vec<(String, String)>),
}

/// A file that was read, so that a reader can tell whether theirs is the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// As the user named it.
    pub name: String,
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 of the content, in hexadecimal.
    pub sha256: String,
}

thread_local! {
    /// What stands for the arguments of this process, where a program does the work of a command itself.
    static COMMAND: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
}

/// Does some work whose pages show this command, and not the one that this process was started with.
pub fn as_command<T>(words: &[String], work: impl FnOnce() -> T) -> T {
    let before = COMMAND.replace(Some(words.to_vec()));
    let done = work();
    COMMAND.replace(before);
    done
}

impl InputFile {
    /// Reads a file for its size and checksum, in bounded memory.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, InputError> {
        let path = path.as_ref();
        if let Some(table) = InMemory::named(path) {
            return Ok(InputFile::of_table(&table));
        }
        let failed = |e: std::io::Error| InputError::io(path, &e);
        let mut file = std::fs::File::open(path).map_err(failed)?;
        let (mut sum, mut bytes, mut buffer) = (Sha256::new(), 0, vec![0; 1 << 16]);
        loop {
            let n = file.read(&mut buffer).map_err(failed)?;
            if n == 0 {
                break;
            }
            sum.update(&buffer[..n]);
            bytes += n as u64;
        }
        Ok(InputFile { name: path.to_string_lossy().into_owned(), bytes, sha256: hexadecimal(&sum.finalize()) })
    }

    /// Of a table that the calling program holds: its numbers, row by row.
    fn of_table(table: &InMemory) -> Self {
        let (columns, mut sum) = (table.names().len(), Sha256::new());
        for row in 0..table.rows() {
            (0..columns).for_each(|column| sum.update(table.at(row, column).to_le_bytes()));
        }
        let name = table.path().to_string_lossy().into_owned();
        InputFile { name, bytes: (table.rows() * columns * 8) as u64, sha256: hexadecimal(&sum.finalize()) }
    }

    /// Of content that is already in memory.
    pub fn new(name: impl Into<String>, content: &[u8]) -> Self {
        let sha256 = hexadecimal(&Sha256::digest(content));
        InputFile { name: name.into(), bytes: content.len() as u64, sha256 }
    }
}

impl Section {
    /// An empty section.
    pub fn new(heading: impl Into<String>) -> Self {
        Section { heading: heading.into(), folded: false, own_page: None, blocks: Vec::new() }
    }

    /// Folded: the reader opens it.
    pub fn folded(self) -> Self {
        Section { folded: true, ..self }
    }

    /// In a file of its own beside the page, of this name (letters, digits and `-`; all else becomes `-`).
    pub fn on_its_own_page(self, stem: impl AsRef<str>) -> Self {
        let safe = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        Section { own_page: Some(stem.as_ref().chars().map(safe).collect()), ..self }
    }

    /// With one more block.
    pub fn block(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// With one more paragraph.
    pub fn text(self, text: impl Into<String>) -> Self {
        self.block(Block::Text(text.into()))
    }

    /// With one more figure.
    pub fn figure(self, figure: Figure) -> Self {
        self.block(Block::Figure(figure))
    }

    /// With one more table.
    pub fn table(self, table: Table) -> Self {
        self.block(Block::Table(table))
    }
}

impl Report {
    /// An empty report of this program's version and the command line it was started with.
    pub fn new(title: impl Into<String>, subject: impl Into<String>) -> Self {
        Report {
            title: title.into(),
            subject: subject.into(),
            warnings: Vec::new(),
            findings: Vec::new(),
            sections: Vec::new(),
            program: concat!("glidepolar ", env!("CARGO_PKG_VERSION")).to_owned(),
            command: COMMAND.with_borrow(|command| {
                command.clone().map_or_else(|| command_line(std::env::args()), |words| command_line(words.into_iter()))
            }),
            inputs: Vec::new(),
        }
    }

    /// With one more warning.
    pub fn warning(mut self, warning: impl Into<String>) -> Self {
        self.warnings.push(warning.into());
        self
    }

    /// With one more sentence among the findings.
    pub fn finding(mut self, finding: impl Into<String>) -> Self {
        self.findings.push(finding.into());
        self
    }

    /// With one more section.
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// With one more file among those read.
    pub fn input(mut self, input: InputFile) -> Self {
        self.inputs.push(input);
        self
    }

    /// The page. Every text is escaped; figures stand inline; no request to anywhere, and no script but the one that shows
    /// figures under the mouse. Without it the drawings stay.
    pub fn html(&self) -> String {
        Self::render(self.values())
    }

    /// The files beside the page: those of sections on pages of their own, by name.
    fn own_pages(&self) -> Vec<(String, String)> {
        let mut taken = HashSet::new();
        let apart = self.sections.iter().filter_map(|section| Some((section.own_page.as_ref()?, section)));
        apart
            .map(|(stem, section)| {
                let section = Section { own_page: None, folded: false, ..section.clone() };
                let page = Report {
                    title: section.heading.clone(),
                    subject: self.subject.clone(),
                    program: self.program.clone(),
                    command: self.command.clone(),
                    warnings: Vec::new(),
                    findings: Vec::new(),
                    inputs: Vec::new(),
                    sections: vec![section],
                };
                (format!("{}.html", free_name(stem.clone(), &mut taken)), page.html())
            })
            .collect()
    }

    fn render(values: Value) -> String {
        let mut pages = Environment::new();
        if let Ok(syntax) = pages.syntax().to_builder().trim_blocks(true).lstrip_blocks(true).build() {
            pages.set_syntax(syntax);
        }
        pages.add_filter("with_code", with_code);
        // Template and values are the program's own, so neither step fails for any user's data; tests render them all.
        let _ = pages.add_template("report.html", include_str!("page.html"));
        let rendered = pages.get_template("report.html").and_then(|t| t.render(values));
        rendered.unwrap_or_else(|e| {
            format!("<!doctype html><title>report</title><p>The report could not be made: {:?}", e.kind())
        })
    }

    /// Writes `report.html`, each figure that is not folded away as `figures/NAME.svg` and `.png`, and what the folder
    /// was given before.
    pub fn write(&self, mut folder: OutputFolder) -> Result<(), OutputError> {
        let shown = self.sections.iter().filter(|s| !s.folded && s.own_page.is_none()).flat_map(|s| &s.blocks);
        let mut taken = HashSet::new();
        for block in shown {
            if let Block::Figure(figure) = block {
                let stem = free_name(figure.stem(), &mut taken);
                folder.add(format!("figures/{stem}.svg"), figure.svg())?;
                folder.add(format!("figures/{stem}.png"), figure.png())?;
            }
        }
        for (name, page) in self.own_pages() {
            folder.add(name, page)?;
        }
        folder.add("report.html", self.html())?;
        folder.write()
    }

    fn values(&self) -> Value {
        let mut count = Count::default();
        let mut taken = HashSet::new();
        let mut link =
            |s: &Section| s.own_page.as_ref().map(|stem| format!("{}.html", free_name(stem.clone(), &mut taken)));
        let sections: Vec<Value> = self.sections.iter().map(|s| section(s, link(s), &mut count)).collect();
        let inputs: Vec<Value> = self
            .inputs
            .iter()
            .map(|i| context! { name => visible(&i.name), bytes => grouped(i.bytes), sha256 => i.sha256.as_str() })
            .collect();
        let (numbers, explorers) = (json_of(&count.numbers), json_of(&count.explorers));
        let script = if numbers.is_empty() && explorers.is_empty() { String::new() } else { mouse::script() };
        let style = if script.is_empty() { "" } else { mouse::STYLE };
        context! {
            style => Value::from_safe_string(format!("{style}\n{}", include_str!("page.css"))),
            allowance => Value::from_safe_string(mouse::allowance(&script)),
            script => Value::from_safe_string(script),
            numbers => Value::from_safe_string(numbers),
            explorers => Value::from_safe_string(explorers),
            title => visible(&self.title),
            subject => visible(&self.subject),
            warnings => all_visible(&self.warnings),
            // One more than these is shown as well: a fold for a single line hides nothing.
            shown_warnings => if self.warnings.len() == SHOWN_WARNINGS + 1 { SHOWN_WARNINGS + 1 } else { SHOWN_WARNINGS },
            findings => all_visible(&self.findings),
            sections,
            program => visible(&self.program),
            command => visible(&self.command),
            inputs,
        }
    }
}

/// Warnings before the fold: what was found has to be on the first page, too.
const SHOWN_WARNINGS: usize = 8;

/// The name itself, or with the first free number where it is taken.
fn free_name(name: String, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}-{n}"));
    let free = std::iter::once(name.clone()).chain(numbered).find(|n| !taken.contains(n)).unwrap_or_default();
    taken.insert(free.clone());
    free
}

#[derive(Default)]
struct Count {
    figures: usize,
    tables: usize,
    /// Of each figure that a mouse can explore: its number on the page and what it shows, as JSON.
    numbers: Vec<String>,
    /// Likewise of each curve with sliders.
    explorers: Vec<String>,
}

/// Entries of an object as JSON for a block of the page; empty without any.
fn json_of(entries: &[String]) -> String {
    if entries.is_empty() {
        return String::new();
    }
    // A `<` in a text must not end the block.
    format!("{{{}}}", entries.join(",")).replace('<', "\\u003c")
}

fn section(section: &Section, link: Option<String>, count: &mut Count) -> Value {
    let here = if link.is_some() { &[][..] } else { &section.blocks };
    let blocks: Vec<Value> = here.iter().map(|b| block(b, count)).collect();
    context! { heading => visible(&section.heading), folded => section.folded, link, blocks }
}

fn block(block: &Block, count: &mut Count) -> Value {
    match block {
        Block::Text(text) => context! { kind => "text", text => visible(text) },
        Block::List(points) => context! { kind => "list", points => all_visible(points) },
        Block::Code(text) => context! { kind => "code", text => visible(text) },
        Block::Links(links) => {
            let links: Vec<Value> =
                links.iter().map(|(text, file)| context! { text => visible(text), file => visible(file) }).collect();
            context! { kind => "links", links }
        }
        Block::Explorer(explorer) => {
            let number = count.explorers.len() + 1;
            count.explorers.push(format!("\"{number}\":{}", explorer.numbers()));
            context! { kind => "explorer", number, caption => visible(&explorer.caption) }
        }
        Block::Figure(figure) => {
            count.figures += 1;
            let numbers = mouse::numbers(figure);
            // What the mouse reads is drawn anew as wide as the screen; anything else has a drawing for narrow ones.
            let narrow = match &numbers {
                Some(_) => String::new(),
                None => document(figure, &format!("figure-{}-narrow", count.figures), NARROW, false),
            };
            if let Some(numbers) = numbers {
                count.numbers.push(format!("\"{}\":{numbers}", count.figures));
            }
            let svg = document(figure, &format!("figure-{}", count.figures), WIDTH, false);
            context! {
                kind => "figure",
                number => count.figures,
                svg => Value::from_safe_string(svg),
                narrow => Value::from_safe_string(narrow),
                caption => visible(&figure.caption),
            }
        }
        Block::Table(table) => {
            count.tables += 1;
            let width = table.columns.len();
            let numeric: Vec<bool> =
                (0..width).map(|i| table.rows.iter().filter_map(|r| r.get(i)).any(|c| c.is_number())).collect();
            let cell = |i: usize, text: String| {
                // Short words stay on one line, so that a narrow screen scrolls the table instead of breaking them up.
                let class =
                    [if numeric[i] { "number" } else { "" }, if text.chars().count() <= 24 { "short" } else { "" }];
                context! { text => visible(&text), class => class.join(" ").trim() }
            };
            let columns: Vec<Value> = table.columns.iter().enumerate().map(|(i, c)| cell(i, heading(c))).collect();
            let text = |r: &Vec<Cell>, i: usize| {
                let text = r.get(i).map(ToString::to_string).unwrap_or_default();
                if table.columns[i] == "Unit" { powers(&text) } else { text }
            };
            let row = |r: &Vec<Cell>| -> Vec<Value> { (0..width).map(|i| cell(i, text(r, i))).collect() };
            let rows: Vec<Vec<Value>> = table.rows.iter().map(row).collect();
            context! { kind => "table", number => count.tables, caption => visible(&table.caption), columns, rows }
        }
    }
}

/// Without the control characters that HTML forbids, and the ones that turn the direction of text round.
fn visible(text: &str) -> String {
    let forbidden = |c: &char| (c.is_control() && !matches!(c, '\n' | '\t')) || turns(*c);
    text.chars().map(|c| if forbidden(&c) { '\u{FFFD}' } else { c }).collect()
}

/// Sets what stands between two backticks as code, the rest as text with HTML's own characters escaped. A backtick
/// without a second one stays as it is.
fn with_code(text: &str) -> Value {
    let plain = |text: &str| HtmlEscape(&text.replace("+-", "\u{b1}")).to_string();
    let mut parts = text.split('`');
    let mut html = plain(parts.next().unwrap_or(""));
    while let Some(code) = parts.next() {
        html += &match parts.next() {
            Some(after) => format!("<code>{}</code>{}", HtmlEscape(code), plain(after)),
            None => format!("`{}", HtmlEscape(code)),
        };
    }
    Value::from_safe_string(html)
}

fn all_visible(texts: &[String]) -> Vec<String> {
    texts.iter().map(|t| visible(t)).collect()
}

/// The program by its name, the arguments quoted where a shell needs it.
fn command_line(arguments: impl Iterator<Item = String>) -> String {
    let safe = |c: char| c.is_alphanumeric() || "-_./,:=+@%^*".contains(c);
    let quoted = |(i, a): (usize, String)| {
        let a =
            if i == 0 { Path::new(&a).file_stem().map_or(a.clone(), |s| s.to_string_lossy().into_owned()) } else { a };
        if !a.is_empty() && a.chars().all(safe) { a } else { format!("'{}'", a.replace('\'', "'\\''")) }
    };
    arguments.enumerate().map(quoted).collect::<Vec<_>>().join(" ")
}

/// With a thin space between groups of three digits.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|g| std::str::from_utf8(g).ok()).collect();
    groups.join("\u{202F}")
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
