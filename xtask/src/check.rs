//! `check`: what must pass before a change is taken.

use crate::{cli::CheckArgs, error::Error, files};
use std::process::Command;

/// A step: its command, and variables of its environment.
struct Step {
    arguments: &'static [&'static str],
    environment: &'static [(&'static str, &'static str)],
}

/// The quick ones first.
const STEPS: &[Step] = &[
    Step { arguments: &["fmt", "--all", "--check"], environment: &[] },
    Step { arguments: &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"], environment: &[] },
    Step { arguments: &["check", "--workspace", "--no-default-features"], environment: &[] },
    Step { arguments: &["doc", "--workspace", "--no-deps"], environment: &[("RUSTDOCFLAGS", "-D warnings")] },
    Step { arguments: &["test", "--workspace"], environment: &[] },
];

impl Step {
    fn text(&self) -> String {
        let variables = self.environment.iter().map(|(name, value)| format!("{name}=\"{value}\" "));
        format!("{}cargo {}", variables.collect::<String>(), self.arguments.join(" "))
    }
}

/// The command.
pub fn run(args: &CheckArgs) -> Result<(), Error> {
    if args.list {
        return files::print(&STEPS.iter().map(Step::text).collect::<Vec<_>>().join("\n"));
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    for step in STEPS {
        eprintln!("$ {}", step.text());
        let mut command = Command::new(&cargo);
        command.args(step.arguments).envs(step.environment.iter().copied()).current_dir(files::workspace_root());
        let status = command.status().map_err(|e| Error::Input(format!("cargo cannot be run: {e}")))?;
        if !status.success() {
            return Err(Error::Failed(format!("failed: {}", step.text())));
        }
    }
    files::print("all checks passed")
}
