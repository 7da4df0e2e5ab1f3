//! Time and memory: what a render costs.

use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};
use std::{ops::AddAssign, time::Instant};

/// Time on the wall clock, and processor time summed over threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Wall clock, seconds.
    pub seconds: f64,
    /// Processor time of the whole process, seconds.
    pub cpu_seconds: f64,
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Cost) {
        self.seconds += other.seconds;
        self.cpu_seconds += other.cpu_seconds;
    }
}

/// Runs something and says what it cost.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, Cost) {
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    let result = run();
    let cost = Cost { seconds: wall.elapsed().as_secs_f64(), cpu_seconds: cpu.elapsed().as_secs_f64() };
    (result, cost)
}

/// Starts a new measurement of the peak memory, where the system can (Linux).
pub fn reset_peak_memory() {
    // 5 resets the high-water mark of the resident set [proc(5), /proc/pid/clear_refs]. Without the right to, the
    // peak is that of the process so far, which is still an upper bound.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The most memory that the process has held since the last reset, bytes; none where the system does not say.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kb| kb * 1024)
}

/// The processor's name, where the system says it.
pub fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split_once(':'));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, n)| n.trim().to_owned())
}

/// Threads that are used unless told otherwise: one for each processor.
pub fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Seconds as people read them: `350 ms`, `1.50 s`, `2 min 5 s`, `3 h 20 min`.
pub fn human_seconds(seconds: f64) -> String {
    let days = seconds / 86_400.0;
    match seconds {
        s if !s.is_finite() => "never".into(),
        s if s < 0.0095 => format!("{:.1} ms", s * 1e3),
        s if s < 0.9995 => format!("{:.0} ms", s * 1e3),
        s if s < 9.995 => format!("{s:.2} s"),
        s if s < 99.95 => format!("{s:.1} s"),
        s if s < 3599.5 => format!("{} min {} s", s.round() as u64 / 60, s.round() as u64 % 60),
        s if s < 86_400.0 => format!("{} h {} min", s as u64 / 3600, s as u64 % 3600 / 60),
        _ if days < 1000.0 => format!("{days:.1} days"),
        _ => format!("{:.2e} years", days / 365.25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_read_well() {
        for (s, text) in [
            (0.0012, "1.2 ms"),
            (0.35, "350 ms"),
            (0.9999, "1.00 s"),
            (42.0, "42.0 s"),
            (125.2, "2 min 5 s"),
            (12_000.0, "3 h 20 min"),
            (200_000.0, "2.3 days"),
            (f64::INFINITY, "never"),
        ] {
            assert_eq!(human_seconds(s), text);
        }
    }

    #[test]
    fn memory_is_seen() {
        reset_peak_memory();
        let block = vec![1u8; 64 << 20];
        assert!(block.iter().map(|&b| u64::from(b)).sum::<u64>() == 64 << 20);
        if let Some(bytes) = peak_memory() {
            assert!(bytes > 64 << 20);
        }
    }
}
