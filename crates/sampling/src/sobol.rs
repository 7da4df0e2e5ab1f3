//! Sobol points with Owen scrambling.

use crate::permutation::scaled;
use etendue_core::{digest::mix, independent::unit};
use glam::Vec2;

/// The first `count` points of an Owen-scrambled (0,2)-sequence in base 2, in the order of the sequence.
///
/// Every `2^k` points from a multiple of `2^k` on have one point in each of the `2^k` boxes of size `2^-a` by `2^-b`,
/// `a + b = k`. At powers of two the variance on a smooth integrand falls as `N^-3` up to a logarithm [Owen 1997].
/// `f32` has room for `2^24` points on an axis, and the sequence for `2^32` in all.
pub fn sobol(count: u32, seed: u64) -> Vec<Vec2> {
    let sequence = Sequence::new(seed);
    (0..count).map(|index| sequence.point(index)).collect()
}

/// An Owen-scrambled (0,2)-sequence, whose points are computed from their number in a few nanoseconds.
///
/// ```
/// use etendue_sampling::sobol::Sequence;
/// let sequence = Sequence::new(7);
/// let quarters: Vec<u32> = (0..4).map(|i| (sequence.point(i).x * 4.0) as u32).collect();
/// assert!((0..4).all(|quarter| quarters.contains(&quarter)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    x: Scramble,
    y: Scramble,
}

impl Sequence {
    /// The sequence of a seed. Seeds need not be random: those of neighbours have nothing in common.
    pub fn new(seed: u64) -> Sequence {
        Sequence::of_key(mix(seed ^ 0x5b0a_1e57_90d3_c7a1))
    }

    /// The sequence of 64 random bits.
    #[inline]
    fn of_key(key: u64) -> Sequence {
        Sequence { x: Scramble::new(key), y: Scramble::new(second(key)) }
    }

    /// A point in `[0, 1)^2`.
    #[inline]
    pub fn point(self, index: u32) -> Vec2 {
        Vec2::from(self.bits(index, pascal(index)).map(unit))
    }

    /// The point's coordinates times `2^32`.
    #[inline]
    fn bits(self, x: u32, y: u32) -> [u32; 2] {
        // Both are reversed at once; the halves change places.
        let bits = (u64::from(self.x.apply(x)) << 32 | u64::from(self.y.apply(y))).reverse_bits();
        [bits as u32, (bits >> 32) as u32]
    }
}

/// More bits from random ones.
#[inline]
pub(crate) fn second(key: u64) -> u64 {
    (key ^ key >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
}

/// Owen scrambling of a number whose first binary digit is its lowest bit: flips every bit by a random function of the
/// bits below it [Owen 1995].
///
/// Operations whose bits depend on lower bits alone do that without a tree of random bits [Laine and Karras 2011,
/// sec. 3.1; Burley 2020, sec. 3]. Here they are `x -> factor * x + offset` with a random odd factor and a random
/// offset. Two numbers that first differ in bit `b` then get a difference whose lowest bit is `b` and whose higher bits
/// are uniform, whatever the first number becomes; and that is uniform as well. So every *pair* of points is distributed
/// exactly as by a tree of random bits, and with it the variance of every estimate, which is a sum over pairs. Fixed
/// bijections of the same kind before and after change nothing for pairs, and break the regularity of larger groups: the
/// error's higher moments come near those of a tree as well.
#[derive(Clone, Copy, Debug)]
struct Scramble {
    factor: u32,
    offset: u32,
}

impl Scramble {
    #[inline]
    fn new(key: u64) -> Scramble {
        Scramble { factor: key as u32 | 1, offset: (key >> 32) as u32 }
    }

    #[inline]
    fn apply(self, x: u32) -> u32 {
        let x = x ^ x.wrapping_mul(0x3d20_adea);
        let x = x.wrapping_mul(self.factor).wrapping_add(self.offset);
        x ^ x.wrapping_mul(0x6c50_b47c)
    }
}

/// The second coordinate of the sequence, first binary digit in the lowest bit: bit `i` is the sum over `j` of
/// `C(j, i)` times bit `j` of the index, modulo 2 [Sobol 1967; Joe and Kuo 2008, the polynomial x + 1].
///
/// Pascal's triangle modulo 2 is the fivefold Kronecker product of `[1 1; 0 1]` with itself, so its product with a
/// vector takes five steps.
#[inline]
const fn pascal(mut x: u32) -> u32 {
    x ^= x >> 16;
    x ^= x >> 8 & 0x00ff_00ff;
    x ^= x >> 4 & 0x0f0f_0f0f;
    x ^= x >> 2 & 0x3333_3333;
    x ^ x >> 1 & 0x5555_5555
}

/// A number of a sample, prepared for [`padded_1d`](Index::padded_1d) and [`padded_2d`](Index::padded_2d): points of
/// sequences of different keys, each of which is gone through in an order of its own.
///
/// In every order, `2^k` samples from a multiple of `2^k` on are `2^k` points from a multiple of `2^k` on. So pairs of
/// dimensions from such sequences may be put together ("padding") [Burley 2020, sec. 4]. If at least 16 samples are
/// planned, that holds for `k >= 4` only, and each 16 of them come in any order.
///
/// For if it holds for `k = 1`, samples `2 i` and `2 i + 1` have their numbers in opposite halves in *every* dimension.
/// Where an integrand is a product of odd functions of two dimensions, the two values then have the same sign, and the
/// variance is 1.57 times that of independent samples. Of any order of 16, it is 1.07 times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Index {
    reversed: u32,
    /// The upper 16 bits, in place, and what they add to [`pascal`].
    high: u32,
    pascal_high: u32,
    /// All ones if each 16 samples come in any order, else 0.
    any_order: u32,
}

impl Index {
    #[inline]
    pub(crate) fn new(index: u32, planned: u32) -> Index {
        let high = index & 0xffff_0000;
        let any_order = if planned == 0 || planned >= 16 { u32::MAX } else { 0 };
        Index { reversed: index.reverse_bits(), high, pascal_high: pascal(high), any_order }
    }

    /// A point in `[0, 1)^2` of the sequence of a key of random bits.
    #[inline]
    pub(crate) fn padded_2d(self, key: u64) -> Vec2 {
        Vec2::from(self.padded_bits(key).map(unit))
    }

    /// The same times `2^32`.
    #[inline]
    pub(crate) fn padded_bits(self, key: u64) -> [u32; 2] {
        let low = self.shuffle(key);
        Sequence::of_key(key).bits(low & 0xffff | self.high, low >> 16 ^ self.pascal_high)
    }

    /// The radical inverse in base 2, scrambled by a key of random bits.
    #[inline]
    pub(crate) fn scrambled(index: u32, key: u64) -> f32 {
        unit(Scramble::new(key).apply(index).reverse_bits())
    }

    /// As [`padded_2d`](Index::padded_2d) in one dimension.
    #[inline]
    pub(crate) fn padded_1d(self, key: u64) -> f32 {
        Index::scrambled(self.shuffled(key), key)
    }

    /// The shuffled index: that of [`padded_2d`](Index::padded_2d).
    #[inline]
    pub(crate) fn shuffled(self, key: u64) -> u32 {
        self.shuffle(key) & 0xffff | self.high
    }

    /// The lower 16 bits of the shuffled index and, above them, what they add to [`pascal`].
    ///
    /// The shuffling is a [`Scramble`] of the reversed index. It leaves the upper 16 bits as they are. The lowest four are
    /// then multiplied by a random element of the field of 16 elements, which isn't 0: with what the scramble has added,
    /// any two of them go to any other two, all equally likely.
    #[inline]
    fn shuffle(self, key: u64) -> u32 {
        // The factor's lower half and the offset's upper half are what counts for indices below 2^16.
        let product = key.wrapping_mul(0x94d0_49bb_1331_11eb);
        let key = (product >> 32) as u32;
        let reversed = self.reversed.wrapping_mul(key | 1).wrapping_add(key);
        let factor = scaled(product as u32 & self.any_order, 15);
        PRODUCTS[factor as usize][(reversed >> 28) as usize]
            ^ FOURS[(reversed >> 24 & 15) as usize]
            ^ EIGHTS[(reversed >> 16 & 255) as usize]
    }
}

/// For each factor less 1 and each four bits: what reversing them and the product give and, 16 bits further up,
/// [`pascal`] of that.
static PRODUCTS: [[u32; 16]; 15] = {
    let mut table = [[0; 16]; 15];
    let mut i = 0;
    while i < 15 * 16 {
        let bits = (i as u32 % 16).reverse_bits() >> 28;
        table[i / 16][i % 16] = with_pascal(field_product(i as u32 / 16 + 1, bits));
        i += 1;
    }
    table
};

/// The same for the four bits that come to lie above those, without a product.
static FOURS: [u32; 16] = {
    let mut table = [0; 16];
    let mut i = 0;
    while i < 16 {
        table[i] = with_pascal((i as u32).reverse_bits() >> 28 << 4);
        i += 1;
    }
    table
};

/// The same for the eight bits that come to lie above those.
static EIGHTS: [u32; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        table[i] = with_pascal((i as u32).reverse_bits() >> 24 << 8);
        i += 1;
    }
    table
};

const fn with_pascal(x: u32) -> u32 {
    x | pascal(x) << 16
}

/// Product of polynomials over two elements of degree below 4, modulo `x^4 + x + 1`.
const fn field_product(a: u32, b: u32) -> u32 {
    let mut product = 0;
    let mut bit = 4;
    while bit > 0 {
        bit -= 1;
        product <<= 1;
        product ^= product >> 4 & 1 | (product >> 4 & 1) << 1 | (product >> 4 & 1) << 4;
        product ^= a * (b >> bit & 1);
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stratified::jitter;
    use proptest::prelude::*;

    /// Whether `2^k` points have one in each of the boxes of area `2^-k`, of every shape.
    fn is_net(points: &[Vec2]) -> bool {
        let k = points.len().ilog2();
        assert_eq!(points.len(), 1 << k);
        (0..=k).all(|a| {
            let (columns, rows) = ((1 << a) as f32, (1 << (k - a)) as f32);
            let mut seen = vec![false; points.len()];
            points.iter().for_each(|p| seen[(p.x * columns) as usize * rows as usize + (p.y * rows) as usize] = true);
            seen.into_iter().all(|s| s)
        })
    }

    proptest! {
        #[test]
        fn aligned_points_are_nets(k in 0..12_u32, block: u32, seed: u64) {
            let sequence = Sequence::new(seed);
            let start = block >> k << k;
            let points: Vec<Vec2> = (start..=start + ((1 << k) - 1)).map(|i| sequence.point(i)).collect();
            prop_assert!(is_net(&points));
        }

        #[test]
        fn aligned_padded_points_are_nets(k in 0..11_u32, block: u32, planned in 0..33_u32, key: u64) {
            let k = if planned == 0 || planned >= 16 { k.max(4) } else { k };
            let start = block >> k << k;
            let samples = || (start..=start + ((1 << k) - 1)).map(|i| Index::new(i, planned));
            let points: Vec<Vec2> = samples().map(|i| i.padded_2d(key)).collect();
            prop_assert!(is_net(&points));
            let mut seen = vec![false; points.len()];
            samples().for_each(|i| seen[(i.padded_1d(key) * points.len() as f32) as usize] = true);
            prop_assert!(seen.into_iter().all(|s| s));
        }

        #[test]
        fn padded_points_are_those_of_the_shuffled_index(index: u32, planned in 0..33_u32, key: u64) {
            let prepared = Index::new(index, planned);
            let shuffled = prepared.shuffled(key);
            prop_assert_eq!(prepared.padded_2d(key), Sequence::of_key(key).point(shuffled));
            prop_assert_eq!(prepared.padded_1d(key), prepared.padded_2d(key).x);
        }
    }

    #[test]
    fn the_unscrambled_sequence_is_that_of_sobol() {
        // The first points of dimensions 1 and 2 in sixteenths, from the direction numbers of Joe and Kuo.
        let y = [0, 8, 12, 4, 10, 2, 6, 14, 15, 7, 3, 11, 5, 13, 9, 1];
        assert!((0..16).map(|i| pascal(i).reverse_bits() >> 28).eq(y));
        let bit = |i: u32, j: u32| u32::from(i & j == i);
        for j in 0..32 {
            // C(j, i) is odd where the bits of i are among those of j [Lucas 1878].
            assert_eq!(pascal(1 << j), (0..32).map(|i| bit(i, j) << i).sum());
        }
    }

    #[test]
    fn the_field_has_inverses() {
        for a in 1..16 {
            let products: std::collections::BTreeSet<u32> = (1..16).map(|b| field_product(a, b)).collect();
            assert!(products.into_iter().eq(1..16));
            assert_eq!(field_product(a, 1), a);
            assert_eq!(field_product(1, a), a);
        }
        assert_eq!(field_product(field_product(7, 9), 13), field_product(7, field_product(9, 13)));
    }

    /// Owen's scrambling by the letter: a random bit for each node of the tree.
    fn by_the_tree(x: u32, key: u64) -> u32 {
        (0..32_u32).fold(0, |y, bit| {
            let node = jitter(key ^ u64::from(bit), x & !(u32::MAX << bit));
            y | (x ^ (node[0] >> 31) << bit) & 1 << bit
        })
    }

    /// Mean and mean square of the squared error of `2^k` points.
    fn errors(k: u32, integrand: fn(Vec2) -> f32, place: impl Fn(u64, u32) -> Vec2) -> (f64, f64) {
        let runs = 4000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for seed in 0..runs {
            let error: f64 = (0..1 << k).map(|i| f64::from(integrand(place(seed, i)))).sum();
            let square = (error / f64::from(1 << k)).powi(2);
            sum += square;
            squares += square * square;
        }
        (sum / runs as f64, squares / runs as f64)
    }

    /// Integrands of mean 0: smooth in one dimension, in both, and with an edge.
    const INTEGRANDS: [fn(Vec2) -> f32; 4] = [
        |p| p.x - 0.5,
        |p| p.x * p.x * p.y - 1.0 / 6.0,
        |p| (p.x * 7.0).sin() * (p.y * 3.0 + 1.0).cos() + 0.018_730_2,
        |p| if p.x + 2.0 * p.y < 1.3 { 0.6 } else { -0.4 },
    ];

    #[test]
    fn the_variance_is_that_of_owens_scrambling() {
        for (i, integrand) in INTEGRANDS.into_iter().enumerate() {
            for k in [3, 5, 7] {
                let ours = errors(k, integrand, |seed, i| Sequence::new(seed).point(i));
                let tree = errors(k, integrand, |seed, i| {
                    let (x, y) = (by_the_tree(i, mix(seed)), by_the_tree(pascal(i), mix(!seed)));
                    Vec2::new(unit(x.reverse_bits()), unit(y.reverse_bits()))
                });
                let variance = (ours.1 - ours.0 * ours.0 + tree.1 - tree.0 * tree.0) / 4000.0;
                let z = (ours.0 - tree.0) / variance.sqrt();
                assert!(z.abs() < 4.0, "integrand {i}, {k}: {ours:?} {tree:?}, z = {z}");
                // Very large errors are not much more frequent either: of the affine functions alone, this would be
                // 28 and 3 for the first integrand at 128 points.
                let [ours, tree] = [ours, tree].map(|e| e.1 / (e.0 * e.0));
                assert!(ours < 1.3 * tree, "integrand {i}, {k}: kurtosis {ours}, {tree}");
            }
        }
    }
}
