//! Work split into runs of fixed length, on rayon's current thread pool with feature `parallel`, else on the caller's
//! thread.
//!
//! The runs do not depend on the number of threads, so neither does anything that is kept for the length of a run. Each can be
//! taken by another thread: left to itself, rayon makes few long tasks of them, and at the end of a pass one thread waits for
//! the last of another's.

use crate::statistics::render::RenderStatistics;
#[cfg(feature = "parallel")]
use rayon::prelude::*;
use std::ops::Range;

/// Calls `work` with every run of `run` items (the last may be shorter) and the index of its first item; returns what
/// the calls counted.
pub fn for_runs_of<T: Send>(
    items: &mut [T],
    run: usize,
    work: impl Fn(usize, &mut [T]) -> RenderStatistics + Sync,
) -> RenderStatistics {
    #[cfg(feature = "parallel")]
    return items
        .par_chunks_mut(run)
        .enumerate()
        .with_max_len(1)
        .map(|(i, items)| work(i * run, items))
        .reduce(RenderStatistics::default, merged);
    #[cfg(not(feature = "parallel"))]
    return items
        .chunks_mut(run)
        .enumerate()
        .map(|(i, items)| work(i * run, items))
        .fold(RenderStatistics::default(), merged);
}

/// Calls `work` with `0..count` cut into ranges of `run` numbers (the last may be shorter); returns what the calls
/// counted.
pub fn for_ranges(count: u32, run: u32, work: impl Fn(Range<u32>) -> RenderStatistics + Sync) -> RenderStatistics {
    let range = |i: u32| i * run..(i * run).saturating_add(run).min(count);
    #[cfg(feature = "parallel")]
    return (0..count.div_ceil(run))
        .into_par_iter()
        .with_max_len(1)
        .map(|i| work(range(i)))
        .reduce(RenderStatistics::default, merged);
    #[cfg(not(feature = "parallel"))]
    return (0..count.div_ceil(run)).map(|i| work(range(i))).fold(RenderStatistics::default(), merged);
}

/// Does two things, one beside the other where there are threads for it.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(feature = "parallel")]
    return rayon::join(a, b);
    #[cfg(not(feature = "parallel"))]
    return (a(), b());
}

/// Calls `work` with every item.
pub(crate) fn for_each<T: Send>(items: &mut [T], work: impl Fn(&mut T) + Sync) {
    #[cfg(feature = "parallel")]
    items.par_iter_mut().for_each(&work);
    #[cfg(not(feature = "parallel"))]
    items.iter_mut().for_each(work);
}

/// Whether `good` holds of every item.
pub(crate) fn all<T: Sync>(items: &[T], good: impl Fn(&T) -> bool + Sync) -> bool {
    // Within a run without branches, so that many are looked at at once.
    let run = |items: &[T]| items.iter().fold(true, |all, item| all & good(item));
    #[cfg(feature = "parallel")]
    return items.par_chunks(1 << 14).all(run);
    #[cfg(not(feature = "parallel"))]
    return items.chunks(1 << 14).all(run);
}

fn merged(mut a: RenderStatistics, b: RenderStatistics) -> RenderStatistics {
    a.merge(&b);
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn every_item_is_visited_once_whatever_the_run() {
        for count in [0_usize, 1, 7, 8, 9, 100] {
            for run in [1_usize, 8, 1000] {
                let mut items: Vec<u32> = vec![0; count];
                let statistics = for_runs_of(&mut items, run, |first, items| {
                    for (i, item) in items.iter_mut().enumerate() {
                        *item += (first + i) as u32 + 1;
                    }
                    let mut statistics = RenderStatistics::default();
                    statistics.rays.camera = items.len() as u64;
                    statistics
                });
                assert!(items.iter().enumerate().all(|(i, &item)| item == i as u32 + 1));
                assert_eq!(statistics.rays.camera, count as u64);

                let seen: Vec<AtomicU32> = (0..count).map(|_| AtomicU32::new(0)).collect();
                for_ranges(count as u32, run as u32, |range| {
                    range.for_each(|i| _ = seen[i as usize].fetch_add(1, Ordering::Relaxed));
                    RenderStatistics::default()
                });
                assert!(seen.iter().all(|s| s.load(Ordering::Relaxed) == 1));
            }
        }
    }

    #[test]
    fn all_sees_every_item() {
        let mut items = vec![1; 40_000];
        assert!(all(&items, |i| *i == 1) && all(&items[..0], |_| false));
        for wrong in [0, 1 << 14, 39_999] {
            items[wrong] = 2;
            assert!(!all(&items, |i| *i == 1));
            items[wrong] = 1;
        }
    }

    #[test]
    fn the_last_range_ends_at_the_largest_count() {
        let statistics = for_ranges(u32::MAX, 1 << 28, |range| {
            let mut statistics = RenderStatistics::default();
            statistics.rays.light = range.len() as u64;
            statistics
        });
        assert_eq!(statistics.rays.light, u64::from(u32::MAX));
    }
}
