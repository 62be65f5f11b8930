//! Every kind of figure and table on one page: `cargo run --example report -- FOLDER`.
//!
//! The balance readings are those of the DARPA SUBOFF bare hull (Roddy 1990, DTRC/SHD-1298-08, appendix B,
//! configuration 3), converted to frontal area; the rest is drawn from formulas, and says so.

use glidepolar::output::{OutputError, OutputFolder};
use glidepolar::report::{Axis, Block, Cell, Dash, Figure, InputFile, Layer, Panel, Report, Section, Table};

fn main() -> Result<(), OutputError> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "report_example".to_owned());
    report().write(OutputFolder::open(&folder, false)?)?;
    println!("{folder}/report.html");
    Ok(())
}

/// Drift angle [deg], CL, CD on the frontal area, CM on frontal area and length, about the centre of buoyancy.
const SUBOFF: [(f64, f64, f64, f64); 24] = [
    (-18.05, -0.6098, 0.2790, -0.2568),
    (-16.15, -0.4890, 0.2299, -0.2332),
    (-13.98, -0.3752, 0.1870, -0.2102),
    (-12.02, -0.2791, 0.1563, -0.1880),
    (-9.99, -0.1894, 0.1315, -0.1641),
    (-8.00, -0.1243, 0.1151, -0.1375),
    (-5.93, -0.0746, 0.1033, -0.1073),
    (-4.11, -0.0462, 0.0973, -0.0756),
    (-3.07, -0.0314, 0.0961, -0.0523),
    (-1.95, -0.0229, 0.0966, -0.0306),
    (-1.03, -0.0167, 0.0947, -0.0140),
    (0.12, -0.0075, 0.0941, 0.0061),
    (0.20, -0.0092, 0.0950, 0.0086),
    (1.06, 0.0001, 0.0951, 0.0303),
    (2.08, 0.0086, 0.0940, 0.0453),
    (3.00, 0.0238, 0.0960, 0.0675),
    (4.07, 0.0333, 0.0976, 0.0872),
    (6.03, 0.0690, 0.1027, 0.1213),
    (8.00, 0.1229, 0.1140, 0.1495),
    (10.05, 0.1997, 0.1308, 0.1757),
    (12.03, 0.2847, 0.1517, 0.1982),
    (13.94, 0.3790, 0.1784, 0.2196),
    (16.03, 0.4848, 0.2147, 0.2404),
    (18.11, 0.6075, 0.2618, 0.2610),
];

fn report() -> Report {
    let mut report = Report::new("Figures and tables", "SUBOFF bare hull and drawn examples")
        .warning("The histories, hulls and mechanisms below are drawn from formulas; only the SUBOFF points are measured.")
        .warning("Text from files cannot act on the page: <script>alert('x')</script> stays text.")
        .finding("The lift of the SUBOFF hull bends upwards: a crossflow term fits it within 0.0067, a straight line within 0.0703.")
        .finding("The fitted slope depends on the range by 70 %, which a straight line would not allow.")
        .input(InputFile::new("suboff.csv", b"drift_deg,CL,CD,CM\n"))
        .section(suboff())
        .section(hulls())
        .section(Section::new("Time histories").figure(sawtooth()).figure(run()))
        .section(Section::new("Glides").figure(polar()).figure(residuals()))
        .section(diagnosis())
        .section(Section::new("Every run").folded().text("Folded away, since there may be hundreds.").figure(run()));
    report.command = "glidepolar identify 'my log.csv' --vehicle seaglider".to_owned();
    report
}

fn suboff() -> Section {
    let column = |f: fn(&(f64, f64, f64, f64)) -> f64| SUBOFF.iter().map(f).collect::<Vec<f64>>();
    let angle = column(|p| p.0);
    let x = Axis::new("Angle of attack", "α", "deg").range(-20.0, 20.0);
    let panel = |label, symbol, data: Vec<f64>, error: fn(f64) -> f64| {
        let bars = data.iter().map(|v| error(*v)).collect();
        let y = Axis::new(label, symbol, "");
        Panel::new(y)
            .layer(Layer::shaded_x(-10.0, 10.0).label("range of the straight fit"))
            .layer(Layer::at_y(0.0))
            .layer(Layer::points(angle.clone(), data).y_error(bars).label("measured, ±4 % of the reading"))
    };
    let curve =
        |f: fn(f64) -> f64| Layer::curve(-20.0, 20.0, move |deg| f(deg.to_radians())).label("with crossflow").slot(1);
    let straight = |f: fn(f64) -> f64| {
        Layer::curve(-10.0, 10.0, move |deg| f(deg.to_radians())).label("small-angle form").slot(2).dash(Dash::Dashed)
    };
    let lift = panel("Lift coefficient", "C_L", column(|p| p.1), |v| 0.04 * v.abs() + 0.002)
        .layer(curve(|a| -0.0026 + 0.128 * a + 5.726 * a * a.abs()))
        .layer(straight(|a| 0.905 * a));
    let drag = panel("Drag coefficient", "C_D", column(|p| p.2), |v| 0.04 * v.abs())
        .layer(curve(|a| 0.0941 + 0.505 * a * a + 4.012 * a.abs().powi(3)))
        .layer(straight(|a| 0.0930 + 1.177 * a * a));
    let moment = panel("Moment coefficient", "C_M", column(|p| p.3), |v| 0.04 * v.abs() + 0.002)
        .layer(curve(|a| 0.0055 + 1.185 * a - 1.194 * a * a.abs()))
        .layer(straight(|a| 1.028 * a));
    let one = Figure::new("suboff-lift", x.clone()).panel(lift.clone()).caption(
        "Lift of the SUBOFF bare hull (Roddy 1990) on the frontal area, with the small-angle form and with crossflow.",
    );
    let all = Figure::new("suboff-all", x)
        .panel(lift)
        .panel(drag)
        .panel(moment)
        .caption("Lift, drag and moment about the centre of buoyancy, stacked over one axis.");
    let table = Table::new(
        "Fits over ±18 degrees, leave-one-out. Intervals are 95 %.",
        ["Coefficient", "Form", "First term", "95 % interval", "Leave-one-out rms"],
    )
    .row([
        "CL".into(),
        "a α".into(),
        Cell::estimate(1.543, 0.061),
        Cell::interval((1.42, 1.67)),
        Cell::number(0.0703, 3),
    ])
    .row([
        "CL".into(),
        "x + x|x|".into(),
        Cell::estimate(0.128, 0.013),
        Cell::interval((0.101, 0.155)),
        Cell::number(0.0067, 3),
    ])
    .row([
        "CD".into(),
        "b + c α²".into(),
        Cell::estimate(0.0879, 0.0021),
        Cell::interval((0.0835, 0.0923)),
        Cell::number(0.00882, 3),
    ]);
    Section::new("Hull tests")
        .text("Points are measured; lines are fits of the published table.")
        .figure(one)
        .figure(all)
        .table(table)
}

fn hulls() -> Section {
    let ratios = [8.5, 9.5, 10.5, 11.5, 12.5];
    let mut panel =
        Panel::new(Axis::new("Drag coefficient", "C_D", "")).layer(Layer::shaded_x(-10.0, 10.0).label("fitted range"));
    for (i, ratio) in ratios.iter().enumerate() {
        let b = 0.09 + 0.009 * (ratio - 8.5);
        let drag = move |deg: f64| b + (1.6 + 0.12 * ratio) * deg.to_radians().powi(2);
        let angles: Vec<f64> = (-10..=10).map(|k| f64::from(k) * 2.0).collect();
        let noise = |k: usize| 0.006 * ((k * 7919 + i * 104_729) % 101) as f64 / 50.0 - 0.006;
        let points = angles.iter().enumerate().map(|(k, a)| drag(*a) + noise(k)).collect();
        let label = format!("LDR {ratio}");
        panel = panel
            .layer(Layer::points(angles, points).y_error(vec![0.007; 21]).label(&label))
            .layer(Layer::curve(-10.0, 10.0, drag).label(&label));
    }
    let all = Figure::new("five-hulls", Axis::new("Angle of attack", "α", "deg").range(-21.0, 21.0))
        .panel(panel)
        .caption("Five hulls of one family; bars are 95 % intervals. Drawn from a formula.");
    let slope = |r: f64| 0.9 + 0.11 * (r - 8.5);
    let trend = Figure::new("trend", Axis::new("Length-to-diameter ratio", "L/d", ""))
        .panel(
            Panel::new(Axis::new("Lift slope", "a", "1/rad"))
                .layer(
                    Layer::band(
                        ratios.to_vec(),
                        ratios.iter().map(|r| slope(*r) - 0.05 - 0.02 * (r - 10.5).powi(2)).collect(),
                        ratios.iter().map(|r| slope(*r) + 0.05 + 0.02 * (r - 10.5).powi(2)).collect(),
                    )
                    .label("trend"),
                )
                .layer(Layer::line(ratios.to_vec(), ratios.map(slope).to_vec()).label("trend"))
                .layer(
                    Layer::points(ratios.to_vec(), vec![0.93, 0.98, 1.14, 1.21, 1.36])
                        .y_error(vec![0.06; 5])
                        .label("hulls"),
                )
                .layer(Layer::curve(8.5, 12.5, |r| 0.7 + 0.09 * (r - 8.5)).dash(Dash::Dotted).label("Allen-Perkins")),
        )
        .caption("The lift slope against length. Band: 95 % interval of the trend.");
    Section::new("Trend over the hulls").figure(all).figure(trend)
}

fn sawtooth() -> Figure {
    let n = 1_000_000;
    let hours: Vec<f64> = (0..n).map(|i| f64::from(i) * 38.0 / f64::from(n)).collect();
    let phase = |t: f64| (t / 0.27).fract();
    let depth = |t: f64| 180.0 * (1.0 - (2.0 * phase(t) - 1.0).abs());
    let pitch = |t: f64| if phase(t) < 0.5 { -26.0 } else { 25.0 } + (t * 997.0).sin() + 0.7 * (t * 3571.0).sin();
    Figure::new("saw-tooth", Axis::new("Time", "t", "h"))
        .panel(
            Panel::new(Axis::new("Depth", "z", "m").reversed())
                .layer(Layer::line(hours.clone(), hours.iter().map(|t| depth(*t)).collect())),
        )
        .panel(
            Panel::new(Axis::new("Pitch", "θ", "deg"))
                .layer(Layer::line(hours.clone(), hours.iter().map(|t| pitch(*t)).collect())),
        )
        .panel(Panel::new(Axis::new("Net mass", "m_0", "kg")).layer(Layer::at_y(0.0)).layer(Layer::line(
            hours.clone(),
            hours.iter().map(|t| if phase(*t) < 0.5 { 0.26 } else { -0.24 }).collect(),
        )))
        .caption("A voyage of 38 hours, a million samples: depth, pitch and net mass.")
}

fn run() -> Figure {
    let seconds: Vec<f64> = (0..4000).map(|i| f64::from(i) / 100.0).collect();
    let speed = |t: f64| (2.0 * ((t - 4.0) / 5.0).clamp(0.0, 1.0)).min(2.0 * ((36.0 - t) / 3.0).clamp(0.0, 1.0));
    let noise = |t: f64, k: f64| (t * 41.3 * k).sin() + 0.6 * (t * 17.9 * k).sin() + 0.4 * (t * 93.1).sin();
    let channel = |f: &dyn Fn(f64) -> f64| Layer::line(seconds.clone(), seconds.iter().map(|t| f(*t)).collect());
    let window = || Layer::shaded_x(12.0, 31.5).label("window used");
    Figure::new("run-017", Axis::new("Time", "t", "s"))
        .panel(
            Panel::new(Axis::new("Speed", "U", "m/s"))
                .layer(window())
                .layer(channel(&|t| speed(t) + 0.004 * noise(t, 1.0))),
        )
        .panel(
            Panel::new(Axis::new("Axial force", "F_A", "N"))
                .layer(window())
                .layer(channel(&|t| 2.1 * speed(t).powi(2) + 0.7 * noise(t, 2.0))),
        )
        .panel(
            Panel::new(Axis::new("Side force", "F_S", "N"))
                .layer(window())
                .layer(channel(&|t| 5.3 * speed(t).powi(2) + 1.1 * noise(t, 1.7))),
        )
        .panel(
            Panel::new(Axis::new("Yaw moment", "M_Y", "N m"))
                .layer(window())
                .layer(channel(&|t| 1.9 * speed(t).powi(2) + 0.5 * noise(t, 0.6))),
        )
        .caption("Run 17, static, yaw 8 degrees: the window found by the stationarity test is shaded.")
}

fn polar() -> Figure {
    let scatter = |i: usize| ((i * 7919) % 97) as f64 / 97.0 - 0.5;
    let glides = |sign: f64| -> (Vec<f64>, Vec<f64>) {
        (0..50)
            .map(|i| {
                let pitch = 20.0 + 10.0 * i as f64 / 49.0;
                (sign * pitch, sign * (pitch * 0.62 + 16.5 + 1.2 * scatter(i + 3)))
            })
            .unzip()
    };
    let (down, down_glide) = glides(-1.0);
    let (up, up_glide) = glides(1.0);
    Figure::new("glide-angle", Axis::new("Pitch", "θ", "deg"))
        .panel(
            Panel::new(Axis::new("Glide path angle", "ξ", "deg"))
                .layer(Layer::at_y(0.0))
                .layer(Layer::at_x(0.0))
                .layer(Layer::points(down, down_glide).label("descents"))
                .layer(Layer::points(up, up_glide).label("ascents")),
        )
        .caption("Glide path angle against pitch for fifty descents and fifty ascents. Drawn from a formula.")
}

fn residuals() -> Figure {
    let n = 13_140;
    let noise = |i: usize, k: usize| ((i * k) % 10_007) as f64 / 10_007.0 - 0.5;
    let depth: Vec<f64> = (0..n).map(|i| 95.0 * (0.5 - noise(i, 6151)).powi(1)).collect();
    let error: Vec<f64> = (0..n)
        .map(|i| 0.012 * (noise(i, 7919) + noise(i, 3571) + noise(i, 104_729)) + 4e-5 * (depth[i] - 45.0))
        .collect();
    let bins: Vec<f64> = (0..9).map(|k| 5.0 + 10.0 * f64::from(k)).collect();
    Figure::new("residuals", Axis::new("Depth", "z", "m"))
        .panel(
            Panel::new(Axis::new("Vertical velocity, measured minus modelled", "Δw", "m/s").range(-0.015, 0.015))
                .layer(Layer::points(depth, error).label("samples"))
                .layer(Layer::at_y(0.0))
                .layer(Layer::points(bins.clone(), bins.iter().map(|z| 4e-5 * (z - 45.0)).collect()).y_error(vec![0.0006; 9]).label("mean per 10 m, 95 % interval")),
        )
        .caption("Residuals of vertical velocity against depth: a trend that the baseline does not explain. Drawn from a formula.")
}

fn diagnosis() -> Section {
    let names = ["hull_compressibility", "ballast_offset", "thermal_expansion", "pitch_offset", "vertical_current"];
    let places: Vec<f64> = (0..5).map(f64::from).collect();
    let rms = [5.9, 7.4, 7.9, 8.2, 8.3];
    let ends = rms.iter().map(|r| (r - 0.35, r + 0.4)).collect();
    let figure = Figure::new("mechanisms", Axis::new("Held-out rms of vertical velocity", "", "mm/s"))
        .panel(
            Panel::new(Axis::of_names("", names))
                .layer(Layer::at_x(8.3).label("baseline"))
                .layer(Layer::points(rms.to_vec(), places).x_interval(ends).label("with the mechanism, 95 % interval")),
        )
        .caption("What each mechanism gains on data that the fit did not see.");
    let histories = Figure::new("mission", Axis::of_names("Leg", (1..=24).map(|i| format!("dive {i} down"))))
        .panel(Panel::new(Axis::new("Charge per dive", "Q", "A h")).layer(Layer::points(
            (0..24).map(f64::from).collect(),
            (0..24).map(|i| 0.31 + 0.002 * f64::from(i % 7)).collect(),
        )))
        .caption("Names along x turn upwards where they do not fit.");
    Section::new("Diagnosis")
        .text(
            "The baseline misses vertical velocity by more than the measurement explains. Compressibility explains it.",
        )
        .figure(figure)
        .figure(histories)
        .block(Block::Code("glidepolar diagnose p5420*.nc --vehicle seaglider --extended sg542.toml".to_owned()))
        .block(Block::List(vec![
            "The extended vehicle runs in the FMU as it is.".to_owned(),
            "The gain was measured on dives left out.".to_owned(),
        ]))
}
