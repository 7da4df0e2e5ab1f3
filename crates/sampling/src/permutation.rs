//! Random permutations that are computed, not stored.

use etendue_core::digest::mix;

/// Where the permutation of `0..count` that `key` stands for takes `index`; `index < count`.
///
/// Few things are shuffled [Durstenfeld 1964]. For more there are rounds of operations that are bijections of the numbers
/// below a power of two, repeated until the number is one of `0..count` ("cycle walking") [Black and Rogaway 2002;
/// Kensler 2013, sec. 3]: at most two turns on average. Keys need not be random.
///
/// ```
/// use etendue_sampling::permutation::permute;
/// let mut places: Vec<u32> = (0..10).map(|i| permute(i, 10, 7)).collect();
/// places.sort();
/// assert!(places.into_iter().eq(0..10));
/// ```
#[inline]
pub fn permute(index: u32, count: u32, key: u64) -> u32 {
    permute_by(index, count, mix(key.wrapping_add(0x2545_f491_4f6c_dd1d)))
}

/// As [`permute`], for a key of random bits.
#[inline]
pub(crate) fn permute_by(index: u32, count: u32, key: u64) -> u32 {
    if count <= FEW { shuffle(index, count, key) } else { walk(index, count, key) }
}

/// Up to here shuffling is the faster way. It is also the better one: every order is as likely as any other.
const FEW: u32 = 16;

/// Follows one of `count` things through a shuffle that starts with one and adds the others in turn, each of which takes
/// the place of one that moves to the end.
#[inline]
fn shuffle(index: u32, count: u32, key: u64) -> u32 {
    let (mut random, mut place) = (key, 0);
    for added in 0..count {
        // A linear congruential generator, of which the upper bits are good [Knuth 1997, sec. 3.3.4, table 1].
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let taken = scaled((random >> 32) as u32, added + 1);
        if added == index {
            place = taken;
        } else if added > index && place == taken {
            place = added;
        }
    }
    place
}

#[inline]
fn walk(index: u32, count: u32, key: u64) -> u32 {
    let bits = 32 - (count - 1).leading_zeros();
    let (mask, half) = (u32::MAX >> (32 - bits), bits.div_ceil(2));
    let low = (1 << half) - 1;
    let more = (key ^ key >> 31).wrapping_mul(0xd1b5_4a32_d192_ed03);
    let round = |x: u32, key: u64| {
        // A product takes information up; a function of the upper half, by a product as well, takes it down.
        let x = x.wrapping_mul(key as u32 | 1).wrapping_add((key >> 24) as u32) & mask;
        x ^ ((u64::from(x >> half) * 2 + 1).wrapping_mul(key) >> 40) as u32 & low
    };
    let mut x = index;
    loop {
        x = round(x, key);
        x = round(x, more);
        x = round(x, key.rotate_left(32));
        x = round(x, more.rotate_left(32));
        if x < count {
            break;
        }
    }
    // Turned by a random number, so that every place is as likely as any other whatever the rounds do.
    let turned = u64::from(x) + u64::from(scaled((key ^ more >> 32) as u32, count));
    (if turned >= u64::from(count) { turned - u64::from(count) } else { turned }) as u32
}

/// A random number below `count`.
#[inline]
pub(crate) fn scaled(random: u32, count: u32) -> u32 {
    ((u64::from(random) * u64::from(count)) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::statistics::chi_square::{sidak, test};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_place_is_taken_once(count in 0..2000_u32, key: u64) {
            let mut places: Vec<u32> = (0..count).map(|i| permute(i, count, key)).collect();
            places.sort_unstable();
            prop_assert!(places.into_iter().eq(0..count));
        }

        #[test]
        fn large_counts_stay_in_range(count in 1_u32.., key: u64) {
            prop_assert!(permute(count - 1, count, key) < count);
        }
    }

    /// Permutations of few things: each as often as any other.
    #[test]
    fn small_permutations_are_equally_likely() {
        for count in 2..=5_u32 {
            let keys = 120_000;
            let mut seen = std::collections::BTreeMap::new();
            for key in 0..keys {
                let order: Vec<u32> = (0..count).map(|i| permute(i, count, key)).collect();
                *seen.entry(order).or_insert(0) += 1;
            }
            let all: usize = (1..=count as usize).product();
            let counts: Vec<u64> = seen.into_values().collect();
            assert_eq!(counts.len(), all);
            let p = test(&counts, &vec![keys as f64 / all as f64; all], 5.0).p_value;
            assert!(p > 1e-4, "{count}: {p:e}");
        }
    }

    /// Where two numbers go together: any two places are as likely as any other two.
    #[test]
    fn pairs_are_equally_likely() {
        let counts = [6, 8, 16, 17, 18, 25, 31, 32, 33, 48, 64, 100];
        let mut p_values = Vec::new();
        for count in counts {
            for (a, b) in [(0, 1), (0, count - 1), (count / 2, count / 2 + 1), (1, 1 + count / 2), (2, 4)] {
                let pairs = (count * (count - 1)) as usize;
                let keys = 40 * pairs as u64;
                let mut observed = vec![0_u64; pairs];
                for key in 0..keys {
                    let (x, y) = (permute(a, count, key), permute(b, count, key));
                    observed[(x * (count - 1) + y - u32::from(y > x)) as usize] += 1;
                }
                p_values.push(test(&observed, &vec![40.0; pairs], 5.0).p_value);
            }
        }
        let worst = p_values.iter().copied().fold(1.0, f64::min);
        assert!(worst > sidak(1e-4, p_values.len()), "{worst:e}: {p_values:?}");
    }
}
