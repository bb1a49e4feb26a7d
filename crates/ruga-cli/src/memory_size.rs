//! An amount of memory as it is typed.

use std::fmt;
use std::str::FromStr;

/// Units by their names in small letters, in bytes.
const UNITS: [(&str, f64); 10] = [
    ("", 1.0),
    ("b", 1.0),
    ("kb", 1e3),
    ("mb", 1e6),
    ("gb", 1e9),
    ("tb", 1e12),
    ("kib", 1024.0),
    ("mib", 1_048_576.0),
    ("gib", 1_073_741_824.0),
    ("tib", 1_099_511_627_776.0),
];

const ACCEPTED: &str = "it is a number with a unit, such as 4GB, 800MB or 1.5GiB, or a number of bytes; \
                        the units are kB, MB, GB, TB (by thousands) and KiB, MiB, GiB, TiB (by 1024)";

/// An amount of memory, at least one byte, that remembers how it was typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct MemorySize {
    pub(crate) bytes: u64,
    typed: String,
}

impl MemorySize {
    /// The least round amount in decimal units that is not below so many bytes.
    pub(crate) fn rounded_up(bytes: u64) -> Self {
        let (step, typed) = match bytes {
            0..1_000_000_000 => {
                let megabytes = bytes.div_ceil(1_000_000).max(1);
                (1_000_000, format!("{megabytes}MB"))
            }
            _ => {
                let tenths = bytes.div_ceil(100_000_000);
                (100_000_000, format!("{}.{}GB", tenths / 10, tenths % 10))
            }
        };
        Self {
            bytes: bytes.div_ceil(step).max(1).saturating_mul(step),
            typed,
        }
    }
}

impl FromStr for MemorySize {
    type Err = &'static str;

    /// Reads `4GB`, `1.5 GiB` or a number of bytes; capital and small letters are the same.
    ///
    /// # Errors
    /// What would be accepted.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let typed = text.trim();
        // Only digits and a point: `f64` would take `1e9`, `inf` and signs as well.
        let end = typed.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (number, unit) = typed.split_at(end.unwrap_or(typed.len()));
        let unit = unit.trim_start().to_ascii_lowercase();
        let unit = UNITS.iter().find(|(name, _)| *name == unit);
        let (_, factor) = unit.ok_or(ACCEPTED)?;
        let number: f64 = number.parse().map_err(|_| ACCEPTED)?;
        let bytes = (number * factor).round();
        if !(1.0..=u64::MAX as f64).contains(&bytes) {
            return Err(ACCEPTED);
        }
        Ok(Self {
            bytes: bytes as u64,
            typed: typed.to_owned(),
        })
    }
}

impl fmt::Display for MemorySize {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.typed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_what_their_names_say() {
        for (text, bytes) in [
            ("4GB", 4_000_000_000),
            ("4gb", 4_000_000_000),
            ("800MB", 800_000_000),
            (" 1.5 GiB ", 1_610_612_736),
            ("2KiB", 2048),
            ("3kB", 3000),
            ("1tib", 1 << 40),
            (".5 TB", 500_000_000_000),
            ("1234567", 1_234_567),
            ("7 B", 7),
        ] {
            let size: MemorySize = text.parse().expect(text);
            assert_eq!(size.bytes, bytes, "{text}");
            assert_eq!(size.to_string(), text.trim());
        }
    }

    #[test]
    fn other_texts_are_refused_with_what_is_accepted() {
        for text in [
            "",
            " ",
            "GB",
            ".",
            "1.2.3GB",
            "-1GB",
            "+1GB",
            "4G",
            "4 GBit",
            "4GB!",
            "1e9",
            "inf",
            "nan",
            "0",
            "0.2",
            "1,5GB",
            "four",
            "99999999TB",
            "4½GB",
        ] {
            let error = text.parse::<MemorySize>().expect_err(text);
            assert!(error.contains("4GB") && error.contains("GiB"), "{text}");
        }
    }

    #[test]
    fn an_amount_that_is_told_suffices_when_it_is_typed() {
        for (bytes, text) in [
            (0, "1MB"),
            (1_000_000, "1MB"),
            (1_000_001, "2MB"),
            (999_999_999, "1000MB"),
            (1_000_000_000, "1.0GB"),
            (1_300_000_001, "1.4GB"),
            (12_345_678_901, "12.4GB"),
        ] {
            let told = MemorySize::rounded_up(bytes);
            assert_eq!(told.to_string(), text);
            assert_eq!(text.parse(), Ok(told.clone()));
            assert!(told.bytes >= bytes);
        }
    }
}
