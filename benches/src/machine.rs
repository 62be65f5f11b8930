//! What the measurements were made on and with.

use std::path::Path;
use std::process::Command;

/// Lines for the head of the page.
pub struct Machine {
    pub lines: Vec<String>,
}

/// Python's packages that take part.
const PACKAGES: [&str; 8] = ["fmpy", "pythonfmu3", "gliderflight", "numpy", "scipy", "pandas", "dask", "gsw"];

impl Machine {
    pub fn look(python: Option<&Path>) -> Self {
        let mut lines = vec![processor()];
        lines.extend(output("uname", &["-sr"]));
        lines.extend(output("cc", &["--version"]));
        lines.extend(output("rustc", &["--version"]));
        lines.push(format!("glidepolar {}", env!("CARGO_PKG_VERSION")));
        let profile = if cfg!(debug_assertions) { "a build for tests: no figure counts" } else { "release build" };
        lines.push(profile.to_owned());
        if let Some(python) = python {
            let script = format!(
                "import platform, importlib.metadata as m\nprint('Python', platform.python_version() + ':', \
                 ', '.join(f'{{n}} {{m.version(n)}}' for n in {PACKAGES:?}))"
            );
            lines.extend(output(python, &["-c", &script]));
        }
        lines.push(format!("load average at the start: {}", load()));
        Machine { lines }
    }
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |key: &str| text.lines().find(|line| line.starts_with(key)).and_then(|line| line.split(": ").nth(1));
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let memory = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let kib = memory.split_whitespace().nth(1).and_then(|kib| kib.parse::<f64>().ok());
    let gib = kib.map_or_else(String::new, |kib| format!(", {:.0} GiB of memory", kib / 1_048_576.0));
    let name = field("model name").unwrap_or("unknown processor");
    let cache = field("cache size").map_or_else(String::new, |cache| format!(", {cache} cache"));
    format!(
        "{cores} cores of {name} (family {}, model {}{cache}){gib}",
        field("cpu family").unwrap_or("?"),
        field("model\t").unwrap_or("?")
    )
}

fn load() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split_whitespace().next().unwrap_or("unknown").to_owned()
}

/// The first line that a program prints.
fn output(program: impl AsRef<std::ffi::OsStr>, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok().filter(|output| output.status.success())?;
    String::from_utf8_lossy(&output.stdout).lines().next().map(str::to_owned)
}
