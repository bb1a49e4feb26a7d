//! Numbers as the integers of an image: a middle and a scale.

/// Least temperature that white stands for, K. Hardly a fire is hotter, so that the keys of a pose share one
/// scale, and a step of 16 bits is 0.03 K.
const LEAST_WHITE: f64 = 2000.0;

/// Rule for a stored value from 0 to 1: `number = (stored - mid) * scale`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoding {
    /// The stored value that means zero.
    pub mid: f64,
    /// Difference of the numbers that black and white stand for.
    pub scale: f64,
}

impl Encoding {
    /// Numbers from 0 to 1 as they are.
    pub const SHARE: Self = Self {
        mid: 0.0,
        scale: 1.0,
    };

    /// Components of unit vectors, from -1 to 1.
    pub const DIRECTION: Self = Self {
        mid: 0.5,
        scale: 2.0,
    };

    /// Temperatures from 0 K, black, to 2000 K, white, or to `hottest` where that is more.
    pub fn temperature(hottest: f64) -> Self {
        Self {
            mid: 0.0,
            scale: hottest.max(LEAST_WHITE),
        }
    }

    /// Numbers of both signs in images of `bits` bits, 8 or 16, over a range of `scale`.
    ///
    /// The middle is a whole code, 128 or 32768, so that zero is stored exactly.
    pub fn signed(bits: u32, scale: f64) -> Self {
        let codes = f64::from((1_u32 << bits) - 1);
        Self {
            mid: f64::from(1_u32 << (bits - 1)) / codes,
            scale,
        }
    }

    /// The smallest symmetric range of 16 bits that holds all `values`, and at least `least`.
    pub fn holding(values: &[f32], least: f64) -> Self {
        let largest = values
            .iter()
            .fold(0.0_f64, |most, &v| most.max(f64::from(v).abs()));
        // The codes reach 32767 above the middle one, not 32767.5.
        Self::signed(16, (2.0 * largest * 65535.0 / 65534.0).max(least))
    }

    /// Codes of 16 bits, what does not fit clamped.
    pub fn to_u16(self, values: &[f32]) -> Vec<u16> {
        let code = |v: &f32| self.code(*v, 65535.0) as u16;
        values.iter().map(code).collect()
    }

    /// Codes of 8 bits, what does not fit clamped.
    pub fn to_u8(self, values: &[f32]) -> Vec<u8> {
        let code = |v: &f32| self.code(*v, 255.0) as u8;
        values.iter().map(code).collect()
    }

    /// The number of a stored value.
    pub fn number(self, stored: f64) -> f64 {
        (stored - self.mid) * self.scale
    }

    fn code(self, value: f32, codes: f64) -> f64 {
        let stored = self.mid + f64::from(value) / self.scale;
        (codes * stored).round().clamp(0.0, codes)
    }
}
