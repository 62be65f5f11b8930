"""Report pages in a real browser: they ask nothing of anyone, fit a phone, can be read in the dark, and answer the mouse.

A page forbids scripts but its own, so it is measured from outside: a wrapper holds it in a frame and writes what it finds into its
own document, where it is read.
"""

import json
import re
import subprocess
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from browser import CHROMIUM, Browser
from conftest import counters, path_from, together

WIDTHS = {"desktop": 1100, "phone": 390}
SCHEMES = ["light", "dark"]

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium: apt-get install chromium")


# Commands that write a report, by the name of the report; each gets its folder as the last argument.
REPORTS = {
    "example": ("GLIDEPOLAR_REPORT_EXAMPLE",),
    "glide": ("GLIDEPOLAR_COMMAND", "glide", "slocum-049", "--quiet", "--out"),
    "mission": (
        "GLIDEPOLAR_COMMAND",
        "simulate",
        "slocum-049",
        "--mission",
        ROOT / "missions/rising-seabed.toml",
        "--quiet",
        "--out",
    ),
    "history": ("GLIDEPOLAR_COMMAND", "simulate", "slocum-graver", "--quiet", "--out"),
    "plan": (
        "GLIDEPOLAR_COMMAND", "plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "1000", "--sensor-W", "0.5",
        "--sensor-drag-m2", "0.001", "--quiet", "--out",
    ),  # fmt: skip
    "calibration": ("GLIDEPOLAR_COMMAND", "plan", "seaglider", "--moves", "MOVES", "--dives", "DIVES", "--quiet", "--out"),
    "track": (
        "GLIDEPOLAR_COMMAND", "track", "LOG", "--vehicle", "slocum-049", "--fixes", "FIXES", "--quiet", "--out",
    ),  # fmt: skip
    "identify": (
        "GLIDEPOLAR_COMMAND", "identify", "SEA_LOG", "--vehicle", "SEA_VEHICLE", "--quiet", "--out",
    ),  # fmt: skip
    "diagnose": (
        "GLIDEPOLAR_COMMAND", "diagnose", "SEA_LOG", "--vehicle", "SEA_VEHICLE", "--quiet", "--out",
    ),  # fmt: skip
    "diagnose-turning": (
        "GLIDEPOLAR_COMMAND", "diagnose", "TURNING_LOG", "--vehicle", "TURNING_VEHICLE", "--quiet", "--out",
    ),  # fmt: skip
    "campaign": ("GLIDEPOLAR_TANK_REDUCE", "CAMPAIGN", "--diagnose", "--quiet", "--out"),
    "points": (
        "GLIDEPOLAR_TANK_REDUCE",
        ROOT / "tank/data/suboff_roddy1990.csv",
        "--hull",
        ROOT / "tank/data/suboff.toml",
        "--quiet",
        "--out",
    ),
}


@pytest.fixture(scope="session")
def tables(tmp_path_factory) -> dict[str, Path]:
    """Input that stands in the commands by a word in capitals: a simulated glider's log with fixes beside it, the
    counters of one that pumps 0.03 J per dbar and cc, and 10 J per cc, and a log and a campaign with something to find."""
    folder = tmp_path_factory.mktemp("tables")
    found = {name: folder / f"{name.lower()}.csv" for name in ("LOG", "FIXES", "MOVES", "DIVES")}
    mission = ROOT / "missions/rising-seabed.toml"
    command = [path_from("GLIDEPOLAR_COMMAND"), "simulate", "slocum-049", "--mission", mission, "--quiet", "--log", found["LOG"]]
    subprocess.run(command, check=True)
    header, *rows = [line for line in found["LOG"].read_text().splitlines() if not line.startswith("#")]
    found["LOG"].write_text("\n".join([header, *rows]) + "\n")
    found["FIXES"].write_text(
        "time_s,lat_deg,lon_deg,dac_east_m_s,dac_north_m_s\n"
        "0,47.5,-52.5,0.05,0.02\n4000,47.508,-52.487,0.04,0.03\n11000,47.51,-52.46,0.02,0.05\n18000,47.5,-52.44,0,0\n"
    )
    moves, dives = counters()
    found["MOVES"].write_text(moves)
    found["DIVES"].write_text(dives)
    sea = [path_from("GLIDEPOLAR_VIRTUAL_SEA"), "--seed", "3", "--effect", "drag_growth", "--hours", "6", "--dives", "8"]
    subprocess.run([*sea, "--out", folder / "sea"], check=True)
    found["SEA_LOG"], found["SEA_VEHICLE"] = folder / "sea/log.csv", folder / "sea/vehicle.toml"
    bent = ["--seed", "7000", "--effect", "rudder_offset=0.0524", "--hull", "slocum200", "--lateral", "--hours", "6", "--dives", "8"]
    subprocess.run([sea[0], *bent, "--out", folder / "turning"], check=True)
    found["TURNING_LOG"], found["TURNING_VEHICLE"] = folder / "turning/log.csv", folder / "turning/vehicle.toml"
    found["CAMPAIGN"] = folder / "campaign"
    demo = [path_from("GLIDEPOLAR_TANK_REDUCE"), "demo", found["CAMPAIGN"], "--hull", "LDR8.5", "--effect", "crossflow"]
    subprocess.run([*demo, "--quiet"], check=True)
    return found


@pytest.fixture(scope="session", params=[pytest.param(name, marks=together(f"report-{name}")) for name in REPORTS])
def page(request, tables, tmp_path_factory) -> Path:
    """Each report in turn."""
    program, *arguments = REPORTS[request.param]
    arguments = [tables.get(argument, argument) for argument in arguments]
    folder = tmp_path_factory.mktemp("reports") / request.param
    subprocess.run([path_from(program), *arguments, folder], check=True, capture_output=True)
    return folder / "report.html"


@pytest.fixture(scope="session")
def browser(tmp_path_factory) -> Iterator[Browser]:
    """The browser for all pages. None of them has asked for anything, by the browser's own list of requests."""
    browser = Browser(tmp_path_factory.mktemp("browser"))
    yield browser
    assert browser.close() == []


MEASURE = """<!doctype html><meta charset="utf-8">
<style>body { margin: 0 } iframe { border: 0; width: %(width)dpx; height: 3000px }</style>
<iframe src="%(page)s"></iframe><pre id="found"></pre>
<script>
const frame = document.querySelector("iframe");
frame.addEventListener("load", async () => {
  const page = frame.contentDocument, look = frame.contentWindow.getComputedStyle;
  page.querySelectorAll("details").forEach(folded => folded.open = true);
  // Figures that were folded away are made for the mouse a little later.
  await new Promise(done => setTimeout(done, 1000));
  // What must be moved sideways to be seen, but for tables, whose edge has a shadow.
  const beyond = [...page.querySelectorAll(".drawing, pre, p, li, h1, h2, figcaption, dl")]
    .filter(e => e.scrollWidth > e.clientWidth + 1 && look(e).display !== "inline")
    .map(e => `${e.tagName} ${e.className}: ${e.scrollWidth} px in ${e.clientWidth}, ${e.textContent.trim().slice(0, 60)}`);
  // The drawings, as they are printed and shown without scripts.
  page.querySelectorAll(".live").forEach(figure => figure.classList.remove("live"));
  const rgb = text => text.match(/[\\d.]+/g).map(Number);
  const light = colour => {
    const [r, g, b] = rgb(colour).map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
  const paper = element => {
    for (let e = element; e; e = e.parentElement) {
      const colour = look(e).backgroundColor;
      if ((rgb(colour)[3] ?? 1) > 0) return colour;
    }
    return "rgb(255, 255, 255)";
  };
  const box = e => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]; };
  // A figure has another drawing for narrow screens, where none is made for the mouse.
  const shown = [...page.querySelectorAll("svg")].filter(svg => svg.getClientRects().length);
  const figures = shown.map(svg => ({
    box: box(svg),
    drawn: Number(svg.getAttribute("width")),
    background: look(svg.querySelector("rect")).fill,
    texts: [...svg.querySelectorAll("text")].map(t => ({ text: t.textContent.trim(), box: box(t), fill: look(t).fill })),
    strokes: [...new Set([...svg.querySelectorAll("polyline, line")].map(l => look(l).stroke))],
  }));
  figures.forEach(f => {
    f.texts.forEach(t => t.contrast = contrast(t.fill, f.background));
    f.strokes = f.strokes.map(s => ({ stroke: s, contrast: contrast(s, f.background) }));
  });
  const words = [...page.querySelectorAll("h1, h2, p, li, td, th, figcaption, code, a, summary")];
  const faint = words.map(w => ({ text: w.textContent.trim().slice(0, 40), contrast: contrast(look(w).color, paper(w)) }));
  document.getElementById("found").textContent = JSON.stringify({
    width: page.documentElement.scrollWidth,
    height: page.documentElement.scrollHeight,
    background: look(page.body).backgroundColor,
    beyond, figures, faint: faint.filter(w => w.text && w.contrast < 4.5),
  });
});
</script>"""


@pytest.fixture(scope="session")
def measure(browser, tmp_path_factory) -> Callable[[Path, int, str], dict]:
    """Measures a page, once for all that is asked of it."""
    wrapper = tmp_path_factory.mktemp("measured") / "wrapper.html"

    @cache
    def measure(page: Path, width: int, scheme: str) -> dict:
        wrapper.write_text(MEASURE % {"width": width, "page": page.as_uri()}, encoding="utf-8")
        return found_by(browser, wrapper, max(width, 600), scheme)

    return measure


def found_by(browser: Browser, wrapper: Path, width: int, scheme: str = "light"):
    """What a wrapper has written into its own document."""
    found = []
    tab = browser.show(
        wrapper, width, scheme, 10_000, lambda tab: found.append(tab.value("document.getElementById('found').textContent"))
    )
    assert found[0], f"the page could not be measured: {tab.console}"
    return json.loads(found[0])


def test_the_browser_reports_what_a_bad_page_does(tmp_path):
    """The checks below can fail: a page with a foreign image, style and a broken script is seen through."""
    bad = tmp_path / "bad.html"
    bad.write_text(
        '<!doctype html><style>@import url("http://styles.invalid/a.css");</style>'
        '<img src="http://images.invalid/a.png"><script>undefinedFunction()</script>',
        encoding="utf-8",
    )
    browser = Browser(tmp_path)
    try:
        tab = browser.show(bad, 1100, "light")
    finally:
        listed = browser.close()
    asked = {"http://styles.invalid/a.css", "http://images.invalid/a.png"}
    assert asked <= set(tab.requests) and asked <= set(listed)
    assert any("undefinedFunction" in line for line in tab.console)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
def test_a_page_asks_nothing_and_reports_no_error(browser, page, tmp_path, width, scheme):
    picture = tmp_path / f"{page.parent.name}-{width}-{scheme}.png"
    tab = browser.show(page, WIDTHS[width], scheme, look=lambda tab: tab.picture(picture))
    assert tab.requests == []
    assert tab.console == []
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
def test_a_page_fits_and_can_be_read(measure, page, width, scheme):
    found = measure(page, WIDTHS[width], scheme)
    assert found["width"] <= WIDTHS[width], "the page scrolls sideways"
    # Commands are broken on a phone only.
    assert [moved for moved in found["beyond"] if width == "phone" or not moved.startswith("PRE")] == []
    dark = all(int(v) < 60 for v in re.findall(r"\d+", found["background"])[:3])
    assert dark == (scheme == "dark")
    assert found["faint"] == []
    assert len(found["figures"]) == len(re.findall(r"<div class=\"drawing[^>]*data-figure=", page.read_text(encoding="utf-8")))
    for figure in found["figures"]:
        for text in figure["texts"]:
            assert text["contrast"] >= 4.5, text
        # Only grid lines are meant to be faint.
        assert sum(stroke["contrast"] < 2.0 for stroke in figure["strokes"]) <= 1, figure["strokes"]


@pytest.mark.parametrize("width", WIDTHS)
def test_no_text_in_a_figure_is_cut_off_or_covered_by_another(measure, page, width):
    """With the fonts of this machine, which are not those that the layout was measured with."""
    for number, figure in enumerate(measure(page, WIDTHS[width], "light")["figures"], start=1):
        left, top, right, bottom = figure["box"]
        assert right - left > 200 and bottom - top > 60, f"figure {number} is too small"
        # The smallest letters are 12 px of a drawing's own width.
        assert (right - left) * 12 / figure["drawn"] >= 10, f"letters of figure {number} cannot be read"
        assert figure["texts"], f"figure {number} has no text"
        assert list(cut_or_covered(figure)) == [], f"figure {number}"


def test_cut_and_covered_text_is_noticed(measure, tmp_path):
    bad = tmp_path / "bad.html"
    bad.write_text(
        '<!doctype html><svg width="300" height="100"><rect fill="white"/><text x="10" y="20">one</text>'
        '<text x="12" y="22">two</text><text x="290" y="80">cut off</text><text x="100" y="80">free</text></svg>',
        encoding="utf-8",
    )
    (figure,) = measure(bad, 390, "light")["figures"]
    assert list(cut_or_covered(figure)) == ["two on one", "cut off is cut"]


POINT = """<!doctype html><meta charset="utf-8">
<style>body { margin: 0 } iframe { border: 0; width: %(width)dpx; height: 3000px }</style>
<iframe src="%(page)s"></iframe><pre id="found"></pre>
<script>
const frame = document.querySelector("iframe");
frame.addEventListener("load", () => setTimeout(() => {
  const page = frame.contentDocument, plots = [...page.querySelectorAll(".plot")].map(holder => holder.plot);
  const hand = plot => {
    const over = plot.over, { left, top, width, height } = over.getBoundingClientRect();
    return (type, x, more) => over.dispatchEvent(new frame.contentWindow.MouseEvent(type,
      { bubbles: true, clientX: left + x * width, clientY: top + height / 2, button: 0, ...more }));
  };
  const found = plots.map(plot => {
    const mouse = hand(plot);
    mouse("mouseenter", 0.5); mouse("mousemove", 0.5);
    const index = plot.cursor.idx;
    return {
      values: [...plot.root.querySelectorAll(".u-legend .u-value")].map(cell => cell.textContent),
      data: plot.data.map(column => index == null ? null : column[index]), width: plot.root.offsetWidth,
      names: [...plot.root.querySelectorAll(".u-legend .u-series")].filter(row => row.offsetWidth > 0)
        .map(row => row.querySelector(".u-label").textContent),
      room: (plot.ctx.font = "13px system-ui, sans-serif",
        plot.over.offsetHeight + 16 - plot.ctx.measureText(plot.axes[1].label).width),
    };
  });
  const range = () => plots.slice(0, 1).map(plot => plot.scales.x.max - plot.scales.x.min);
  const before = range();
  plots.slice(0, 1).map(hand).forEach(mouse => {
    mouse("mousedown", 0.4); mouse("mousemove", 0.6, { movementX: 100, movementY: 0 }); mouse("mouseup", 0.6);
  });
  setTimeout(() => document.getElementById("found").textContent = JSON.stringify({
    found, before, after: range(),
    drawings: [...page.querySelectorAll(".live > svg")].map(svg => svg.getBoundingClientRect().width),
  }), 300);
}, 300));
</script>"""


def test_ticks_of_small_values_have_labels_of_their_own(browser, page, tmp_path):
    """uPlot's labels have three decimals: ticks at -5e-4, 0 and 5e-4 would all read 0."""
    text = page.read_text(encoding="utf-8")
    if 'id="figures"' not in text:
        return
    ask = "document.getElementById('found').textContent = JSON.stringify(glidepolarPage.ticked(null, [-5e-4, 0, 5e-4, 1e-3, 0.0015, 2500, null]))"
    copy = tmp_path / "copy.html"
    # The page allows its own scripts alone; the question is another one.
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text)
    copy.write_text(text.replace("</body>", f'<pre id="found"></pre><script>{ask}</script></body>'), encoding="utf-8")
    assert found_by(browser, copy, 1000) == ["-5e-4", "0", "5e-4", "0.001", "0.0015", "2500", ""]


@pytest.mark.parametrize("width", WIDTHS)
def test_a_figure_answers_the_mouse(browser, page, tmp_path, width):
    """Pointing at a figure shows the numbers there, dragging zooms; the drawing makes room for it on the screen."""
    text = page.read_text(encoding="utf-8")
    wrapper = tmp_path / "wrapper.html"
    wrapper.write_text(POINT % {"width": WIDTHS[width], "page": page.as_uri()}, encoding="utf-8")
    read = found_by(browser, wrapper, max(WIDTHS[width], 600))
    if 'id="figures"' not in text:
        assert read["found"] == []
        return
    assert read["found"] and set(read["drawings"]) == {0}, "drawings are hidden where plots stand"
    for plot in read["found"]:
        assert plot["width"] <= WIDTHS[width]
        assert len(set(plot["names"])) == len(plot["names"]) and not {"", "Value"} & set(plot["names"]), plot["names"]
        assert plot["room"] >= 0, "the name of the axis is cut off"
        shown = [float(value) for value in plot["values"] if value not in ("–", "--", "")]
        data = [value for value in plot["data"] if value is not None]
        assert shown == pytest.approx(data, rel=1e-3, abs=1e-9) and shown, plot
    assert read["after"] == pytest.approx([0.2 * read["before"][0]], rel=0.1), "dragging over a fifth zooms to it"


SLIDE = """<!doctype html><meta charset="utf-8">
<style>body { margin: 0 } iframe { border: 0; width: %(width)dpx; height: 3000px }</style>
<iframe src="%(page)s"></iframe><pre id="found"></pre>
<script>
const frame = document.querySelector("iframe");
frame.addEventListener("load", () => setTimeout(() => {
  const page = frame.contentDocument, place = page.querySelector(".explorer");
  const [mass, pitch] = place.querySelectorAll("input");
  const read = () => ({
    width: place.scrollWidth, room: place.clientWidth,
    sliders: [...place.querySelectorAll("output")].map(cell => cell.textContent),
    values: Object.fromEntries([...place.querySelectorAll("dt")].map(name => [name.textContent, name.nextSibling.textContent])),
  });
  const move = (slider, to) => {
    slider.value = to;
    slider.dispatchEvent(new frame.contentWindow.Event("input", { bubbles: true }));
  };
  const found = [read()];
  for (const [i, j] of [[0, 40], [Number(mass.max), 19], [5, 59]]) { move(mass, i); move(pitch, j); found.push(read()); }
  document.getElementById("found").textContent = JSON.stringify(found);
}, 300));
</script>"""


@pytest.mark.parametrize("width", WIDTHS)
def test_sliders_of_the_polar_show_the_glide_that_the_command_computes(browser, tmp_path, width):
    program = path_from("GLIDEPOLAR_COMMAND")
    subprocess.run([program, "glide", "slocum-049", "--quiet", "--out", tmp_path / "polar"], check=True)
    wrapper = tmp_path / "wrapper.html"
    wrapper.write_text(SLIDE % {"width": WIDTHS[width], "page": (tmp_path / "polar/report.html").as_uri()}, encoding="utf-8")
    read = found_by(browser, wrapper, max(WIDTHS[width], 600))
    assert len(read) == 4 and len({tuple(state["sliders"]) for state in read}) == 4
    for state in read:
        assert state["width"] <= state["room"]
        mass, pitch = (float(text.split()[0]) for text in state["sliders"])
        pitch *= -1 if mass > 0 else 1
        asked = ["--net-mass-kg", f"{mass}", f"--pitch-deg={pitch}"]
        glide = json.loads(subprocess.check_output([program, "glide", "slocum-049", *asked, "--json", "-"], text=True))["glide"]
        shown = {name.split()[0]: float(value) for name, value in state["values"].items() if name.split()[0] in ("Horizontal", "Vertical", "Speed")}
        expected = {"Horizontal": "horizontal_velocity_m_s", "Vertical": "vertical_velocity_m_s", "Speed": "speed_m_s"}
        assert shown == {name: pytest.approx(glide[key], rel=1e-3) for name, key in expected.items()}


def test_pages_say_what_matters_first_and_in_words(page):
    text = page.read_text(encoding="utf-8")
    body = re.sub(r"(?s)<script.*?</script>|<style.*?</style>|<pre>.*?</pre>|<!--.*?-->", "", text)
    words = re.sub(r"<[^>]+>", " ", body)
    assert "`" not in words
    assert not re.search(r"p [<=] 1\.?0?e-?(0|[1-9]\d\d)", words), "a probability that nobody can mean"
    warnings = re.search(r'(?s)<section class="warnings".*?</section>', text)
    for housekeeping in ("in the record, the legs cut there", "left out", "has no position"):
        assert not (warnings and housekeeping in warnings[0]), housekeeping
    if page.parent.name == "diagnose":
        (notes,) = [fold for fold in re.findall(r"(?s)<details>.*?</details>", text) if "Reading of the log" in fold]
        assert "in the record, the legs cut there" in notes


def test_the_second_best_mechanism_is_seen_beside_the_best(tables, tmp_path):
    """On the scale of evidence the second is more than a tenth of the way to the first, though it is a hundredth of it."""
    program = path_from("GLIDEPOLAR_COMMAND")
    command = [program, "diagnose", tables["SEA_LOG"], "--vehicle", tables["SEA_VEHICLE"], "--quiet", "--out", tmp_path / "page"]
    subprocess.run([str(word) for word in command], check=True, capture_output=True)
    figure = (tmp_path / "page/figures/cause.svg").read_text(encoding="utf-8")
    bars = [[float(value) for value in re.findall(r"[-\d.]+", points)] for points in re.findall(r'<polyline[^>]*points="([^"]+)"', figure)]
    lengths = sorted((abs(bar[2] - bar[0]) for bar in bars if len(bar) == 4 and bar[1] == bar[3]), reverse=True)
    assert len(lengths) >= 3 and lengths[1] > 0.1 * lengths[0], lengths


def test_causes_of_turning_are_seen_in_the_turn_rate(page):
    """Of a bent rudder, one mark for each leg and series; the model with it lies nearer to the measured stretches."""
    figure = page.parent / "figures/turning.svg"
    is_of_turning = page.parent.name == "diagnose-turning"
    assert figure.exists() == is_of_turning
    if not is_of_turning:
        return
    drawn = figure.read_text(encoding="utf-8")
    for text in ["Turn rate", "Roll, to starboard", "Without the causes of turning", "With the causes of turning"]:
        assert text in drawn, text
    for text in [f"{leg}, {series}" for leg in ["descents", "ascents"] for series in ["measured", "modelled"]]:
        assert drawn.count(text) == 1, text
    figures = json.loads(re.search(r'(?s)id="figures">(.*?)</script>', page.read_text(encoding="utf-8"))[1])
    (panels,) = [f["panels"] for f in figures.values() if f["panels"][0]["title"] == "Without the causes of turning"]
    errors = []
    for panel in panels:
        rates = [layer["y"] for layer in panel["layers"] if layer.get("label")]
        pairs = [pair for leg in [0, 1] for pair in zip(rates[leg], rates[leg + 2], strict=True)]
        errors.append(sum((modelled - measured) ** 2 for measured, modelled in pairs))
    assert errors[1] < 0.3 * errors[0], errors


def cut_or_covered(figure: dict):
    """Says which texts leave the figure or lie on one another."""
    left, top, right, bottom = figure["box"]
    texts = [text for text in figure["texts"] if text["text"]]
    for i, one in enumerate(texts):
        a, b, c, d = one["box"]
        if a < left - 1 or b < top - 1 or c > right + 1 or d > bottom + 1:
            yield f"{one['text']} is cut"
        for other in texts[:i]:
            # Boxes are those of lines, with room around the letters: a fifth either way may overlap.
            wide = min(c, other["box"][2]) - max(a, other["box"][0])
            high = min(d, other["box"][3]) - max(b, other["box"][1])
            height = min(d - b, other["box"][3] - other["box"][1])
            width = min(c - a, other["box"][2] - other["box"][0])
            if wide > 0.2 * width and high > 0.2 * height:
                yield f"{one['text']} on {other['text']}"
