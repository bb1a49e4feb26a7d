//! Seeded choices, and the values that nobody expects.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Numbers at and beyond the ends of what formats and arithmetic hold, as text.
const WILD_NUMBERS: [&str; 34] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "3",
    "0.5",
    "1e-3",
    "1e-9",
    "1e-160",
    "1e-308",
    "5e-324",
    "1e9",
    "1e20",
    "1e39",
    "1e160",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "255",
    "65535",
    "65536",
    "2147483648",
    "-2147483649",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "0x7f",
];

/// Whole numbers of the same kind.
const WILD_WHOLES: [u64; 18] = [
    0,
    1,
    2,
    3,
    7,
    252,
    255,
    16_383,
    16_384,
    65_535,
    65_536,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_fffe,
    0xffff_ffff,
    0x1_0000_0000,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// Random choices that a number repeats.
#[derive(Clone, Debug)]
pub struct Chance(Pcg64Mcg);

impl Chance {
    /// The choices of input `number`; near numbers have nothing in common.
    pub fn new(number: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(number))
    }

    /// A whole number below `end`, which is at least 1.
    pub fn below(&mut self, end: usize) -> usize {
        self.0.random_range(0..end)
    }

    /// True once in `cases`.
    pub fn one_in(&mut self, cases: usize) -> bool {
        self.below(cases) == 0
    }

    /// One of several values; there is at least one.
    pub fn pick<'a, T: ?Sized>(&mut self, values: &[&'a T]) -> &'a T {
        values[self.below(values.len())]
    }

    /// A number from `low` to `high`, evenly.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random_range(0.0..1.0)
    }

    /// A power of ten with an exponent from `low` to `high`.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.random_range(0..=u64::MAX)
    }

    /// The text of an extreme number.
    pub fn wild_number(&mut self) -> &'static str {
        self.pick(&WILD_NUMBERS)
    }

    /// An extreme whole number.
    pub fn wild_whole(&mut self) -> u64 {
        WILD_WHOLES[self.below(WILD_WHOLES.len())]
    }

    /// An extreme number; infinite and undefined ones among them.
    pub fn wild_float(&mut self) -> f64 {
        const VALUES: [f64; 14] = [
            0.0,
            -0.0,
            -1.0,
            1e-320,
            1e-160,
            1e-30,
            1e-9,
            1e9,
            3e38,
            1e160,
            -1e308,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        VALUES[self.below(VALUES.len())]
    }
}
