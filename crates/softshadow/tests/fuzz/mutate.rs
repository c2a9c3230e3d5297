//! Random changes to texts and bytes. They know neither format nor reader: words, numbers and parts of other inputs are put where such
//! things stand.

/// SplitMix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// Below `count`; 0 where that is 0.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }

    fn choose<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }
}

/// Counts, sizes and coordinates at which something changes.
const NUMBERS: [&str; 30] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "63",
    "64",
    "65",
    "127",
    "128",
    "255",
    "256",
    "1024",
    "32768",
    "65535",
    "65536",
    "2147483647",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "1e-320",
    "1e-30",
    "3e38",
    "1e154",
    "1.7e308",
    "1e999",
];
const WORDS_32: [u32; 10] = [0, 1, 3, 0x7f, 0xffff, 0x7fff_ffff, 0x8000_0000, u32::MAX, 0x7f80_0000, 0x7fc0_0000];

/// A changed copy of `input`, at most `longest` bytes. `others` are inputs, and `words` what the format is made of.
pub(crate) fn mutated(
    random: &mut Random,
    input: &[u8],
    others: &[Vec<u8>],
    words: &[&str],
    longest: usize,
) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..1 + random.below(6) {
        change(random, &mut bytes, others, words);
    }
    bytes.truncate(longest);
    bytes
}

fn change(random: &mut Random, bytes: &mut Vec<u8>, others: &[Vec<u8>], words: &[&str]) {
    let at = random.below(bytes.len() + 1);
    let end = at + random.below(bytes.len() - at + 1).min(1 << random.below(10));
    match random.below(12) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => {
            let part = bytes[at..end].to_vec();
            let place = random.below(bytes.len() + 1);
            bytes.splice(place..place, part);
        }
        3 => {
            let other = &others[random.below(others.len())];
            let from = random.below(other.len() + 1);
            let to = from + random.below(other.len() - from + 1).min(1 << random.below(12));
            bytes.splice(at..end, other[from..to].iter().copied());
        }
        4 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(8)),
        5 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte = random.below(256) as u8),
        6 => {
            let word = WORDS_32[random.below(WORDS_32.len())];
            let word = if random.below(2) == 0 { word.to_le_bytes() } else { word.to_be_bytes() };
            bytes.iter_mut().skip(at).zip(word).for_each(|(byte, new)| *byte = new);
        }
        7 => {
            let word = random.choose(words);
            bytes.splice(at..at, word.bytes());
        }
        8 => {
            // Nested, or long.
            let part = bytes[at..end.min(at + 16)].repeat(1 << random.below(9));
            bytes.splice(at..at, part);
        }
        kind => {
            let token = token(bytes, at);
            let word = if kind == 9 { random.choose(words) } else { random.choose(&NUMBERS) };
            bytes.splice(token, word.bytes());
        }
    }
}

/// The word or number next behind a place.
fn token(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let is_inside = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-._".contains(byte);
    let start = at + bytes[at..].iter().position(is_inside).unwrap_or(bytes.len() - at);
    start..start + bytes[start..].iter().position(|byte| !is_inside(byte)).unwrap_or(bytes.len() - start)
}

#[test]
fn changes_are_many_and_the_same_for_the_same_seed() {
    let others = [b"solid a\nfacet".to_vec(), b"v 1 2 3".to_vec()];
    let run = |seed| {
        let mut random = Random::new(seed);
        (0..200).map(|_| mutated(&mut random, &others[0], &others, &["vertex"], 64)).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
    let seen: std::collections::BTreeSet<_> = run(3).into_iter().collect();
    assert!(seen.len() > 150 && seen.iter().all(|bytes| bytes.len() <= 64), "{} of 200", seen.len());
    assert!(seen.iter().any(|bytes| String::from_utf8_lossy(bytes).contains("vertex")));
    assert_eq!([token(b"  12.5e3 x", 0), token(b"a", 1), token(b"", 0)], [2..8, 1..1, 0..0]);
}
