//! What must hold for every figure and page: well-formed, self-contained, harmless, deterministic, bounded.

use super::*;
use resvg::usvg::roxmltree;

fn axis() -> Axis {
    Axis::new("Angle of attack", "α", "deg")
}

/// Every kind of layer, in two panels.
fn everything() -> Figure {
    let xs = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
    Figure::new("every kind", axis())
        .title("Every kind")
        .panel(
            Panel::new(Axis::new("Lift coefficient", "C_L", ""))
                .title("First")
                .layer(Layer::shaded_x(-1.0, 1.0).label("range"))
                .layer(Layer::band(xs.clone(), vec![-1.0; 5], vec![1.0; 5]).label("band"))
                .layer(
                    Layer::points(xs.clone(), xs.clone()).y_error(vec![0.2; 5]).x_error(vec![0.1; 5]).label("points"),
                )
                .layer(Layer::line(xs.clone(), xs.clone()).dash(Dash::Dashed).label("points"))
                .layer(Layer::line(xs.clone(), vec![0.5; 5]).dash(Dash::Dotted)),
        )
        .panel(
            Panel::new(Axis::of_names("Cause", ["leak", "trapped_air"]))
                .layer(Layer::at_x(0.0).label("baseline"))
                .layer(Layer::at_y(0.5))
                .layer(Layer::points(vec![0.3, -0.7], vec![0.0, 1.0])),
        )
        .caption("All of it.")
}

fn parse(svg: &str) -> roxmltree::Document<'_> {
    roxmltree::Document::parse(svg).unwrap_or_else(|e| panic!("{e}\n{svg}"))
}

#[test]
fn a_figure_is_well_formed_and_labelled() {
    let svg = everything().svg();
    let document = parse(&svg);
    let texts: Vec<String> = document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .map(|n| {
            n.descendants()
                .filter_map(|d| if d.is_text() { d.text() } else { None })
                .collect::<String>()
                .trim()
                .to_owned()
        })
        .collect();
    for wanted in
        ["Every kind", "First", "Angle of attack\u{A0} α [deg]", "Lift coefficient\u{A0} CL", "band", "leak", "−1"]
    {
        assert!(texts.iter().any(|t| t == wanted), "{wanted} not in {texts:?}");
    }
    assert_eq!(texts.iter().filter(|t| *t == "points").count(), 1, "one entry for the layers of one label");
}

#[test]
fn figures_are_deterministic() {
    assert_eq!(everything().svg(), everything().svg());
    assert_eq!(everything().png(), everything().png());
}

#[test]
fn a_png_has_ink_where_text_stands() {
    // Text without a font would leave the strip below the axis blank.
    let png = everything().png();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let pixels = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
    assert_eq!(pixels.width(), 1800);
    let bottom = pixels.height() - 60..pixels.height() - 10;
    let dark =
        bottom.flat_map(|y| (0..1800).map(move |x| (x, y))).filter(|&(x, y)| pixels.pixel(x, y).unwrap().red() < 128);
    assert!(dark.count() > 500);
}

#[test]
fn no_data_no_panic() {
    let nasty = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, 1e308, -1e308, 5e-324, 1.0];
    let empty = Figure::new("", axis());
    parse(&empty.svg());
    let mut figures = vec![empty.clone().panel(Panel::new(axis()))];
    for a in nasty {
        for b in nasty {
            let range = Axis::new("", "", "").range(a, b);
            figures.push(
                Figure::new("x", range.clone())
                    .panel(
                        Panel::new(range)
                            .layer(Layer::points(vec![a, b, 1.0], vec![b, a]).y_error(vec![a]).x_interval(vec![(a, b)]))
                            .layer(Layer::line(vec![a, b, a, 0.0], vec![b, 2.0, a, b]).dash(Dash::Dotted))
                            .layer(Layer::shaded_x(a, b))
                            .layer(Layer::at_x(a))
                            .layer(Layer::at_y(b)),
                    )
                    .panel(
                        Panel::new(axis())
                            .layer(Layer::band(vec![a, b, 3.0], vec![a, 1.0], vec![b]))
                            .layer(Layer::line(vec![a, b, a, 0.0], vec![b, 2.0, a, b])),
                    ),
            );
        }
    }
    for figure in figures {
        parse(&figure.svg());
    }
    assert!(empty.panel(Panel::new(axis())).svg().contains("no data"));
}

#[test]
fn a_million_samples_make_a_small_figure() {
    let n = 1_000_000;
    let xs: Vec<f64> = (0..n).map(f64::from).collect();
    let ys: Vec<f64> = xs.iter().map(|x| (x * 0.7).sin() + (x * 1e-5).cos()).collect();
    let panel = || Panel::new(Axis::new("y", "", ""));
    let line = Figure::new("line", axis()).panel(panel().layer(Layer::line(xs.clone(), ys.clone()))).svg();
    assert!(line.len() < 60_000, "{}", line.len());
    let dots = Figure::new("dots", axis())
        .panel(panel().layer(Layer::points(xs.clone(), ys.clone()).y_error(vec![0.1; n as usize])))
        .svg();
    assert!(dots.len() < 2_500_000, "{}", dots.len());
    let phase = Figure::new("phase", axis())
        .panel(panel().layer(Layer::line(ys.clone(), xs.iter().map(|x| (x * 0.3).cos()).collect())))
        .svg();
    assert!(phase.len() < 400_000, "{}", phase.len());
    let dashed = Figure::new("dashed", axis()).panel(panel().layer(Layer::line(xs, ys).dash(Dash::Dotted))).svg();
    assert!(dashed.len() < 300_000, "{}", dashed.len());
}

#[test]
fn points_beyond_a_given_range_are_counted() {
    let figure = |top: f64| {
        Figure::new("x", axis())
            .panel(
                Panel::new(Axis::new("y", "", "").range(0.0, top))
                    .layer(Layer::points(vec![1.0, 2.0, 3.0], vec![1.0, 5.0, 9.0])),
            )
            .svg()
    };
    assert!(figure(4.0).contains("2 points outside the axes"));
    assert!(!figure(10.0).contains("outside the axes"));
}

const HOSTILE: &str = "`</title></svg><script>alert(1)</script><img src=http://evil/x onerror=alert(1)>\" ' & {{ 7*7 }} \u{0}\u{1b}[31m\u{202e}";

fn hostile() -> Report {
    let t = HOSTILE;
    let figure = Figure::new(t, Axis::new(t, t, t))
        .title(t)
        .caption(t)
        .panel(
            Panel::new(Axis::of_names(t, [t, t]))
                .title(t)
                .layer(Layer::points(vec![0.0, 1.0], vec![0.0, 1.0]).label(t)),
        )
        .panel(Panel::new(Axis::new(t, t, t)).layer(Layer::shaded_x(0.0, 1.0).label(t)));
    let table = Table::new(t, [t, t]).row([t.into(), 1.0.into()]);
    let mut report = Report::new(t, t).warning(t).finding(t).input(InputFile::new(t, b"x"));
    (report.program, report.command) = (t.to_owned(), t.to_owned());
    let blocks = [Block::Text(t.into()), Block::List(vec![t.into()]), Block::Code(t.into())];
    let section = blocks.into_iter().fold(Section::new(t).figure(figure).table(table), Section::block);
    report.section(section.clone()).section(section.clone().folded()).section(section)
}

#[test]
fn names_between_backticks_are_set_as_code() {
    let page = Report::new("t", "s").warning("`a < b` is held, `c` & one ` alone").html();
    assert!(page.contains("<code>a &lt; b</code> is held, <code>c</code> &amp; one ` alone"), "{page}");
}

#[test]
fn hostile_text_stays_text() {
    let page = hostile().html();
    assert!(!page.contains("<script") && !page.contains("<img"), "markup from text");
    assert!(!page.contains('\u{0}') && !page.contains('\u{1b}') && !page.contains('\u{202e}'));
    assert!(page.contains("{{ 7*7 }}") && !page.contains("49 }}"));
    for figure in hostile().sections.iter().flat_map(|s| &s.blocks) {
        if let Block::Figure(figure) = figure {
            let svg = figure.svg();
            let document = parse(&svg);
            assert!(document.descendants().all(|n| !n.has_tag_name("script") && !n.has_tag_name("img")));
            assert!(figure.stem().chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_'));
        }
    }
}

/// A page without its own two scripts, the numbers of the figures and what shows them.
fn without_scripts(page: &str) -> String {
    let mut parts = page.split("<script");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| kept + part.split_once("</script>").expect("a script has an end").1)
}

#[test]
fn a_label_cannot_leave_the_numbers_of_a_figure() {
    let panel =
        Panel::new(Axis::new(HOSTILE, "", "")).layer(Layer::line(vec![0.0, 1.0], vec![0.0, 1.0]).label(HOSTILE));
    let page = Report::new("t", "s")
        .section(Section::new("one").figure(Figure::new("one", Axis::new(HOSTILE, "", "")).panel(panel)))
        .html();
    assert_eq!(page.matches("<script").count(), 2, "the page's own");
    assert_eq!(page.matches("</script").count(), 2);
    let (_, numbers) = page.split_once("id=\"figures\">").expect("numbers of the figure");
    let numbers: serde_json::Value = serde_json::from_str(numbers.split_once("</script>").unwrap().0).expect("JSON");
    assert_eq!(numbers["1"]["panels"][0]["layers"][0]["label"], HOSTILE);
    // Only the script with this checksum may run.
    let allowed = page.split_once("script-src 'sha256-").expect("a checksum").1;
    assert_eq!(allowed.find('\''), Some(44));
}

#[test]
fn a_page_is_well_formed_and_asks_nothing_of_anyone() {
    for report in
        [hostile(), Report::new("t", "s").section(Section::new("one").figure(everything()).figure(everything()))]
    {
        let page = report.html();
        // The page is written so that it is XML, too, but for scripts and the elements that HTML leaves open.
        let xml = without_scripts(&page.replacen("<!doctype html>", "", 1));
        let mut closed = String::new();
        for part in xml.split_inclusive('>') {
            let void = ["<meta", "<link"].iter().any(|tag| part.trim_start().starts_with(tag));
            closed += &if void { part.replace('>', "/>") } else { part.to_owned() };
        }
        let document = parse(&closed);
        let mut ids = std::collections::HashSet::new();
        for node in document.descendants().filter(|n| n.is_element()) {
            assert!(
                !["script", "img", "iframe", "object", "image", "use", "base", "form"]
                    .contains(&node.tag_name().name())
            );
            for attribute in node.attributes() {
                let (name, value) = (attribute.name(), attribute.value());
                assert!(!name.starts_with("on") && name != "src" && name != "style", "{name}={value}");
                if name == "href" {
                    assert!(value.starts_with('#') || value == "data:,", "{value}");
                }
                if name == "id" {
                    assert!(ids.insert(value.to_owned()), "two elements with the identifier {value}");
                }
            }
        }
        let style = document.descendants().find(|n| n.has_tag_name("style")).and_then(|n| n.text()).unwrap();
        assert!(!style.contains("url(") && !style.contains("@import"));
    }
}

#[test]
fn colours_are_known_to_the_dark_page() {
    let svg = (0..6).fold(everything(), |f, slot| {
        f.panel(Panel::new(axis()).layer(Layer::line(vec![0.0, 1.0], vec![0.0, 1.0]).slot(slot)))
    });
    let style = include_str!("page.css");
    for (i, _) in svg.svg().clone().match_indices("=\"#") {
        let svg = svg.svg();
        let (start, end) = (svg[..i].rfind(' ').unwrap() + 1, i + 10);
        let attribute = &svg[start..end];
        assert!(style.contains(&format!("[{attribute}]")), "{attribute} has no dark counterpart");
    }
}

#[test]
fn powers_in_units_are_raised() {
    let label = |unit: &str| Figure::new("x", Axis::new("c", "", unit)).panel(Panel::new(axis())).svg();
    assert!(label("1/rad^2").contains("[1/rad²]"));
    assert!(label("m s^-1").contains("[m s⁻¹]"));
    assert!(label("a^b^").contains("[a^b^]"));
    assert!(label("J/(dbar.cm3)").contains("[J/(dbar.cm³)]"));
    assert!(label("TEOS-10").contains("[TEOS-10]") && label("H2O").contains("[H2O]"));
}

/// A table's heads and its column of units write powers as axes do; names and values stay as they are.
#[test]
fn powers_in_tables_are_raised() {
    let table = Table::new("Of r2d2.", ["c [1/rad2]", "Name", "Unit"]).row([
        Cell::fixed(1.5, 1),
        Cell::from("c_per_rad2"),
        Cell::from("cm3"),
    ]);
    let page = Report::new("t", "s").section(Section::new("x").table(table)).html();
    let page = page.replace("&#x2f;", "/");
    for expected in ["c [1/rad²]", ">c_per_rad2<", ">cm³<", "Of r2d2."] {
        assert!(page.contains(expected), "{expected} is not in the page");
    }
}

#[test]
fn warnings_come_first() {
    let page = Report::new("t", "s").finding("found").warning("careful").html();
    assert!(page.find("careful").unwrap() < page.find("found").unwrap());
}

#[test]
fn many_warnings_are_folded_and_none_is_lost() {
    let page = |n: usize| (0..n).fold(Report::new("t", "s"), |page, i| page.warning(format!("careful {i};"))).html();
    assert!(!page(9).contains("<details>") && page(9).contains("careful 8;"));
    let many = page(20);
    assert!(many.contains("12 more") && many.contains("20 warnings"));
    let (fold, last) = (many.find("<details>").unwrap(), many.find("careful 19;").unwrap());
    assert!(many.find("careful 7;").unwrap() < fold && fold < many.find("careful 8;").unwrap() && fold < last);
}

#[test]
fn files_are_written_once_and_again() {
    let dir = tempfile::tempdir().unwrap();
    let report = Report::new("t", "s").section(Section::new("one").figure(everything()).figure(everything()));
    for _ in 0..2 {
        let folder = crate::output::OutputFolder::open(dir.path(), false).unwrap();
        report.write(folder).unwrap();
    }
    for name in ["report.html", "figures/every-kind.svg", "figures/every-kind.png", "figures/every-kind-2.svg"] {
        assert!(dir.path().join(name).metadata().unwrap().len() > 1000, "{name}");
    }
}

#[test]
fn a_file_is_known_by_its_checksum() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("abc"), b"abc").unwrap();
    let read = InputFile::read(dir.path().join("abc")).unwrap();
    // FIPS 180-2, appendix B.1.
    assert_eq!(read.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    assert_eq!((read.bytes, &read.sha256), (3, &InputFile::new("abc", b"abc").sha256));
    assert!(InputFile::read(dir.path().join("missing")).is_err());
}
