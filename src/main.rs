//! The command `glidepolar`; what it does is in [`glidepolar::cli`].

fn main() -> std::process::ExitCode {
    glidepolar::cli::main()
}
