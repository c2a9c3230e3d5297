//! Digits counted in simulation: in words and in channels, in every order of changes.

use softshadow_plan::Host;

use super::*;

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }
}

/// A change of so much for every sample in the mask.
#[derive(Clone, Copy)]
struct Event {
    change: i64,
    mask: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Order {
    Mixed,
    OuterFirst,
    InnerFirst,
}

/// Changes of one pixel: each hits half of the samples, and no count leaves `0 ..= most` at the end. The published method begins with a
/// wedge's outer half and ends with its inner one: as many add as take away.
fn events(random: &mut Random, count: usize, fields: u32, initial: i64, most: i64) -> Vec<Event> {
    loop {
        let events: Vec<Event> = (0..count)
            .map(|k| Event { change: if k % 2 == 0 { 1 } else { -1 }, mask: random.below(1 << fields) })
            .collect();
        if (0..fields).all(|field| (0..=most).contains(&final_count(&events, field, initial))) {
            return events;
        }
    }
}

fn final_count(events: &[Event], field: u32, initial: i64) -> i64 {
    initial + events.iter().filter(|e| e.mask >> field & 1 == 1).map(|e| e.change).sum::<i64>()
}

fn ordered(random: &mut Random, mut events: Vec<Event>, order: Order) -> Vec<Event> {
    for at in (1..events.len()).rev() {
        events.swap(at, random.below(at as u64 + 1) as usize);
    }
    match order {
        Order::Mixed => {}
        Order::OuterFirst => events.sort_by_key(|e| -e.change),
        Order::InnerFirst => events.sort_by_key(|e| e.change),
    }
    events
}

/// One channel or word as the device adds it up, decoded; `begun` puts the initial count in first, as published, instead of last.
fn counted(digits: Digits, events: &[Event], initial: i64, begun: bool) -> Vec<i64> {
    let places =
        |mask: u64| (0..digits.fields).filter(|f| mask >> f & 1 == 1).map(|f| 1u64 << (f * digits.bits)).sum::<u64>();
    let ones = places(u64::MAX);
    let start = if begun { initial * ones as i64 } else { 0 };
    let sum = match digits.counters {
        Counters::Float => {
            let add = |sum: f32, e: &Event| sum + (e.change * places(e.mask) as i64) as f32;
            events.iter().fold(start as f32, add) as i64 as u32
        }
        Counters::Words => {
            let add = |sum: u32, e: &Event| sum.wrapping_add((e.change as u32).wrapping_mul(places(e.mask) as u32));
            events.iter().fold(start as u32, add)
        }
    };
    let rest = i64::from(digits.bias) + if begun { 0 } else { initial };
    let sum = sum.wrapping_add((rest as u32).wrapping_mul(ones as u32));
    let largest = u32::MAX >> (32 - digits.bits);
    (0..digits.fields).map(|f| i64::from(sum >> (f * digits.bits) & largest) - i64::from(digits.bias)).collect()
}

fn is_wrong(digits: Digits, events: &[Event], initial: i64, begun: bool) -> bool {
    let expected: Vec<i64> = (0..digits.fields).map(|f| final_count(events, f, initial)).collect();
    counted(digits, events, initial, begun) != expected
}

/// What the first stage finds out about a pixel.
fn largest(events: &[Event], initial: i64) -> Largest {
    let sum = |sign: i64| events.iter().map(|e| (e.change * sign).max(0)).sum::<i64>() as u32;
    Largest { count: initial as u32 + sum(1), fall: sum(-1), initial: initial as u32, astray: 0 }
}

#[test]
fn outer_before_inner_loses_counts_that_a_mixed_order_keeps() {
    // Base 64, chosen by the largest initial count as published: 63 layers fit, and the counts of every pixel end within them.
    let paper = Digits { bias: 0, ..CHANNELS[2] };
    let mut random = Random(1);
    let mut share = |count: usize, order: Order| {
        let pixels = 400;
        let wrong = (0..pixels)
            .filter(|_| {
                let initial = 24 + random.below(8) as i64;
                let events = events(&mut random, count, paper.fields, initial, 63);
                let events = ordered(&mut random, events, order);
                is_wrong(paper, &events, initial, true)
            })
            .count();
        f64::from(wrong as u32) / f64::from(pixels)
    };
    let orders = [Order::Mixed, Order::OuterFirst, Order::InnerFirst];
    let table = [32, 128, 256].map(|count| (count, orders.map(|order| share(count, order))));
    for (count, [mixed, ..]) in table {
        assert_eq!(mixed, 0.0, "{count} events");
    }
    let outer_first = table.map(|(_, shares)| shares[1]);
    // The page of the technique cites these.
    assert_eq!(outer_first.map(|share| (share * 100.0_f64).round()), [0.0, 16.0, 94.0]);
}

#[test]
fn digits_that_hold_the_bounds_are_never_wrong() {
    let mut random = Random(2);
    for round in 0..2000 {
        let initial = random.below([1, 2, 8, 60, 300][round % 5]) as i64;
        let count = random.below([3, 8, 40, 300, 900][round / 5 % 5]) as usize;
        for counters in [Counters::Words, Counters::Float] {
            let events = events(&mut random, count, 8, initial, i64::MAX);
            let digits = Digits::new(counters, 8, largest(&events, initial));
            assert!(digits.hold(largest(&events, initial)));
            for order in [Order::Mixed, Order::OuterFirst, Order::InnerFirst] {
                let events = ordered(&mut random, events.clone(), order);
                assert!(
                    !is_wrong(digits, &events, initial, false),
                    "{digits:?}, {count} events from {initial}, {order:?}"
                );
            }
        }
    }
}

#[test]
fn digits_too_narrow_are_wrong() {
    // One layer more than a digit holds: the bound is no idle precaution.
    for digits in WORDS.iter().take(4).chain(&CHANNELS[..4]) {
        let most = (1i64 << digits.bits) - 1 - i64::from(digits.bias);
        let up = Event { change: 1, mask: 1 };
        assert!(!is_wrong(*digits, &vec![up; most as usize], 0, false), "{digits:?}");
        assert!(is_wrong(*digits, &vec![up; most as usize + 1], 0, false), "{digits:?}");
        let full = largest(&vec![up; most as usize], 0);
        assert!(digits.hold(full) && !digits.hold(Largest { count: full.count + 1, ..full }), "{digits:?}");
    }
}

#[test]
fn counts_below_zero_borrow_nothing() {
    for digits in WORDS.iter().take(4).chain(&CHANNELS[..4]) {
        let down = Event { change: -1, mask: 0b01 };
        for below in 0..=digits.bias as usize {
            assert!(!is_wrong(*digits, &vec![down; below], 0, false), "{digits:?}, {below} below");
        }
    }
}

#[test]
fn digits_are_as_wide_as_counts_and_settings_ask() {
    let of = |counters, base, count, fall| {
        let digits = Digits::new(counters, base, Largest { count, fall, ..Largest::default() });
        (digits.counters, digits.bits, digits.fields)
    };
    use Counters::{Float, Words};
    // Equations 7 to 10: 3, 4, 6 and 8 counters a channel.
    assert_eq!(
        [8, 16, 64, 256].map(|base| of(Float, base, 0, 0)),
        [(Float, 3, 8), (Float, 4, 6), (Float, 6, 4), (Float, 8, 3)]
    );
    assert_eq!(
        [8, 16, 64, 256].map(|base| of(Words, base, 0, 0)),
        [(Words, 4, 8), (Words, 4, 8), (Words, 6, 5), (Words, 8, 4)]
    );
    // What is counted widens them; what is taken away matters where an order does.
    assert_eq!([6, 7, 13, 14].map(|count| of(Float, 8, count, 0).1), [3, 4, 4, 6]);
    assert_eq!([7, 8, 16, 64, 256].map(|fall| of(Float, 8, 0, fall).1), [3, 4, 6, 8, 12]);
    assert_eq!(
        [13, 14, 55, 56, 239, 240, 65_519, 65_520].map(|count| of(Words, 8, count, u32::MAX).1),
        [4, 6, 6, 8, 8, 16, 16, 32]
    );
    // More than a channel holds.
    assert_eq!(of(Float, 8, 1 << 24, 0), (Words, 32, 1));
}

#[test]
fn draws_count_every_sample_once_within_the_hosts_limits() {
    let wide = softshadow_plan::Limits { color_bytes: 128, ..Host::default().limits };
    for limits in [Host::default().limits, wide] {
        for digits in WORDS.into_iter().chain(CHANNELS) {
            for samples in [1, 3, 16, 33, 64, 100, 256] {
                let (draws, targets) = digits.draws(samples, &limits);
                let mut next = 0;
                for draw in &draws {
                    assert_eq!(draw.first_sample, next);
                    assert!(
                        draw.sample_count > 0 && draw.sample_count <= draw.words * draw.fields,
                        "{digits:?} {draw:?}"
                    );
                    next += draw.sample_count;
                }
                assert_eq!(next, samples);
                assert!(targets as u32 * TARGET_BYTES <= limits.color_bytes);
                let is_float = digits.counters == Counters::Float;
                assert_eq!((is_float, draws.len() > 1 && !is_float), (targets > 0, false));
            }
        }
    }
    // The paper's four targets of base 64 hold 64 samples; two are allowed everywhere.
    let of = |bits: usize, limits: &softshadow_plan::Limits| {
        let (draws, targets) = CHANNELS[bits].draws(64, limits);
        (draws.len(), targets)
    };
    assert_eq!([0, 1, 2, 3].map(|base| of(base, &wide)), [(1, 2), (1, 3), (1, 4), (1, 6)]);
    assert_eq!([0, 1, 2, 3].map(|base| of(base, &Host::default().limits)), [(1, 2), (2, 2), (2, 2), (3, 2)]);
}
