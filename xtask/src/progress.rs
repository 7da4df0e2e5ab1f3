//! Progress on standard error, and only if somebody looks: indicatif draws nothing unless it is a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A bar that shows how much of a budget is used.
pub struct Progress(ProgressBar);

/// Steps of a bar, which is given shares.
const STEPS: u64 = 1000;

impl Progress {
    /// An empty bar.
    pub fn new(label: &str) -> Progress {
        let bar = ProgressBar::new(STEPS);
        let style = ProgressStyle::with_template("{prefix:.bold} [{bar:32}] {percent:>3} %  {msg}");
        bar.set_style(style.expect("the template is valid").progress_chars("=> "));
        bar.set_prefix(label.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Progress(bar)
    }

    /// Shows a share in [0, 1] of the work as done, and a text.
    pub fn show(&self, share: f64, text: String) {
        self.0.set_position((share.clamp(0.0, 1.0) * STEPS as f64) as u64);
        self.0.set_message(text);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
