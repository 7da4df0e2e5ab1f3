//! `cargo xtask`: one match.

use clap::Parser;
use std::process::ExitCode;
use xtask::cli::{Cli, Command};

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Study(args) => xtask::study::run(&args),
        Command::Render(args) => xtask::render::run(&args),
        Command::Pyramid(args) => xtask::pyramid::run(&args),
        Command::Merge(args) => xtask::merge::run(&args),
        Command::Compare(args) => xtask::compare::run(&args),
        Command::Reference(args) => xtask::reference::run(&args),
        Command::Sampling(args) => xtask::sampling::run(&args),
        Command::Scene(args) => xtask::scene::run(&args),
        Command::Scenes(args) => xtask::listing::scenes(&args),
        Command::Techniques(args) => xtask::listing::techniques(&args),
        Command::Check(args) => xtask::check::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
