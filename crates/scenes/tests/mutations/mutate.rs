//! Random changes to inputs: of bits, of bytes, of numbers in text and in binary, of whole pieces.

/// Random numbers [Steele, Lea, Flood 2014, "SplitMix"].
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `n`, or 0 if `n` is 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    pub(crate) fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// Numbers at which arithmetic goes wrong, in text.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "1e38",
    "-1e39",
    "1e400",
    "1e-45",
    "nan",
    "inf",
];

/// Bytes that mean something in text.
const MARKS: &[u8] = b"0123456789-+.eE/ \n\r\t<>\"'=$&;#,:{}[]\\\0\xFF\x80";

/// The longest input.
const LONGEST: usize = 1 << 14;

/// A changed copy of a seed.
pub(crate) fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut input = random.of(seeds).clone();
    // Mostly a few changes, so that much of the input is still read.
    let changes = 1 << random.below(5);
    for _ in 0..1 + random.below(changes) {
        change(&mut input, seeds, random);
    }
    input.truncate(LONGEST);
    input
}

fn change(input: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    let at = random.below(input.len());
    let length = input.len();
    let piece = |random: &mut Random, of: usize| {
        let start = random.below(of);
        let most = 1 << random.below(9);
        start..(start + 1 + random.below(most)).min(of)
    };
    match random.below(12) {
        0 if length > 0 => input[at] ^= 1 << random.below(8),
        1 if length > 0 => input[at] = random.next() as u8,
        2 if length > 0 => input[at] = *random.of(MARKS),
        3 => input.truncate(at),
        // A piece of this or of another seed, put in, in place of another, or taken out.
        4 => {
            let from = random.of(seeds);
            let piece = from[piece(random, from.len())].to_vec();
            input.splice(at..at, piece);
        }
        5 => {
            let from = random.of(seeds);
            let put = from[piece(random, from.len())].to_vec();
            let place = piece(random, length);
            input.splice(place, put);
        }
        6 => {
            input.drain(piece(random, length));
        }
        7 => {
            let again = input[piece(random, length)].to_vec();
            let times = 1 + random.below(8);
            input.splice(at..at, again.repeat(times));
        }
        // A number in binary.
        8 => {
            const VALUES: [u64; 12] =
                [0, 1, 2, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFF_FFFF, 0xFFFF_FFFF, 1 << 40, u64::MAX];
            let value = random.of(&VALUES).wrapping_add(4 * random.below(2) as u64);
            let width = *random.of(&[1, 2, 4, 8]);
            let mut bytes = value.to_le_bytes()[..width].to_vec();
            if random.below(2) == 1 {
                bytes.reverse();
            }
            for (i, byte) in bytes.into_iter().enumerate() {
                if let Some(place) = input.get_mut(at + i) {
                    *place = byte;
                }
            }
        }
        // A number in text.
        _ => {
            let is_digit = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'e');
            let Some(start) = input[at..].iter().position(u8::is_ascii_digit).map(|i| at + i) else { return };
            let end = input[start..].iter().position(|b| !is_digit(b)).map_or(length, |i| start + i);
            let number = random.of(&NUMBERS).bytes().collect::<Vec<u8>>();
            input.splice(start..end, number);
        }
    }
}
