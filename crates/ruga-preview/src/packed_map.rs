//! A normal map as the page holds it.

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter};

use crate::PreviewError;

/// Longest side of a map in the page, texels; larger ones are averaged down.
pub const MAX_SIDE: u32 = 2048;

/// Cells along a side of the grid that remembers where a map wrinkles.
pub(crate) const CELLS: usize = 128;

/// Code of zero; codes from 1 to 255 are -1 to 1, so that neutral is stored exactly.
const NEUTRAL: u8 = 128;

/// Texels by which the stored part goes beyond what wrinkles: smaller copies of it are neutral at its edges.
const MARGIN: u32 = 8;

/// Codes by which a texel is off neutral where the eye can see it: two degrees.
const VISIBLE: i32 = 5;

/// A normal map of two channels of 8 bits, cut to the part that is not neutral.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedMap {
    /// Lowest U and V of the unit square of texture space that it shows, V down; `None` where it shows the first
    /// one and repeats.
    pub(crate) square: Option<[i32; 2]>,
    /// Texels per side of the whole map.
    pub(crate) size: u32,
    /// Texels to the left of the part that is stored.
    pub(crate) left: u32,
    /// Texels above it.
    pub(crate) top: u32,
    /// Its columns.
    pub(crate) width: u32,
    /// Its rows.
    pub(crate) height: u32,
    /// It as a PNG: X in red, Y in green, blue empty.
    pub(crate) png: Vec<u8>,
    /// `CELLS * CELLS` cells of the whole map, row by row: whether the skin visibly wrinkles there.
    pub(crate) wrinkled: Vec<bool>,
}

impl PackedMap {
    /// Packs a map of `size * size` unit normals, X along U, Y up, Z outwards, row by row from the top.
    ///
    /// One that is larger than [`MAX_SIDE`] is made smaller by a whole factor: means of its normals.
    ///
    /// # Errors
    /// [`PreviewError::TexelCount`], [`PreviewError::Encoding`].
    pub fn new(size: u32, normals: &[[f32; 3]]) -> Result<Self, PreviewError> {
        let found = normals.len();
        if size == 0 || size as usize * size as usize != found {
            return Err(PreviewError::TexelCount { size, found });
        }
        let factor = size.div_ceil(MAX_SIDE);
        // Texels beyond the last whole block are left out: no more than `factor - 1` of thousands.
        let small = size / factor;
        let codes: Vec<[u8; 2]> = match factor {
            1 => normals.iter().map(codes).collect(),
            _ => averaged(normals, size, factor).iter().map(codes).collect(),
        };
        let [left, top, width, height] = stored_part(&codes, small);
        let png = encoded(&codes, small, [left, top, width, height])
            .map_err(|error| PreviewError::Encoding(error.to_string()))?;
        Ok(Self {
            square: None,
            size: small,
            left,
            top,
            width,
            height,
            png,
            wrinkled: wrinkled_cells(&codes, small),
        })
    }

    /// The map of one unit square of texture space alone, such as a UDIM tile, by its lowest U and V (V down); as
    /// packed, a map repeats over all squares.
    pub fn in_square(self, square: [i32; 2]) -> Self {
        let square = Some(square);
        Self { square, ..self }
    }

    /// Whether it shows no wrinkles at all.
    pub fn is_neutral(&self) -> bool {
        // What is stored of other maps has a margin.
        [self.width, self.height] == [1, 1]
    }
}

fn codes(normal: &[f32; 3]) -> [u8; 2] {
    // 1 to 255 around 128: adding an integer keeps the rounding symmetric.
    [0, 1].map(|c| (f32::from(NEUTRAL) + (127.0 * normal[c]).round()).clamp(1.0, 255.0) as u8)
}

/// Unit means over blocks of `factor * factor` texels.
fn averaged(normals: &[[f32; 3]], size: u32, factor: u32) -> Vec<[f32; 3]> {
    let small = size / factor;
    let mean = |texel: u32| {
        let (row, column) = (texel / small * factor, texel % small * factor);
        let mut sum = [0.0_f32; 3];
        for index in 0..factor * factor {
            let at = (row + index / factor) as usize * size as usize;
            let normal = normals[at + (column + index % factor) as usize];
            sum = [0, 1, 2].map(|c| sum[c] + normal[c]);
        }
        // Z is positive in every texel.
        let length = sum.iter().map(|c| c * c).sum::<f32>().sqrt();
        sum.map(|c| c / length)
    };
    (0..small * small).map(mean).collect()
}

/// Left, top, width and height of the part that is stored; one texel where all are neutral.
fn stored_part(codes: &[[u8; 2]], size: u32) -> [u32; 4] {
    let rows = codes.chunks_exact(size as usize);
    let is_off = |code: &[u8; 2]| *code != [NEUTRAL; 2];
    let (mut columns, mut lines) = ((u32::MAX, 0), (u32::MAX, 0));
    for (row, texels) in (0u32..).zip(rows) {
        let Some(first) = texels.iter().position(is_off) else {
            continue;
        };
        let last = texels.iter().rposition(is_off).unwrap_or(first);
        columns = (columns.0.min(first as u32), columns.1.max(last as u32));
        lines = (lines.0.min(row), row);
    }
    if columns.0 == u32::MAX {
        return [0, 0, 1, 1];
    }
    let start = |at: u32| at.saturating_sub(MARGIN);
    let length = |(first, last): (u32, u32)| (last + 1 + MARGIN).min(size) - start(first);
    [
        start(columns.0),
        start(lines.0),
        length(columns),
        length(lines),
    ]
}

fn encoded(codes: &[[u8; 2]], size: u32, part: [u32; 4]) -> Result<Vec<u8>, EncodingError> {
    let [left, top, width, height] = part;
    let mut texels = Vec::with_capacity(3 * (width * height) as usize);
    for row in top..top + height {
        let start = row as usize * size as usize + left as usize;
        let row = &codes[start..start + width as usize];
        // A PNG of two channels would be grey with alpha, which browsers multiply into each other.
        texels.extend(row.iter().flat_map(|[x, y]| [*x, *y, 0]));
    }
    rgb_png([width, height], &texels)
}

/// A PNG of three bytes per texel, row by row.
pub(crate) fn rgb_png([width, height]: [u32; 2], texels: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_filter(Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(texels)?;
    writer.finish()?;
    Ok(file)
}

fn wrinkled_cells(codes: &[[u8; 2]], size: u32) -> Vec<bool> {
    let size = size as usize;
    let mut cells = vec![false; CELLS * CELLS];
    for (texel, code) in codes.iter().enumerate() {
        let off = |code: u8| (i32::from(code) - i32::from(NEUTRAL)).abs();
        if off(code[0]).max(off(code[1])) >= VISIBLE {
            let (row, column) = (texel / size * CELLS / size, texel % size * CELLS / size);
            cells[row * CELLS + column] = true;
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_symmetric_and_neutral_is_exact() {
        assert_eq!(codes(&[0.0, -0.0, 1.0]), [128, 128]);
        assert_eq!(codes(&[1.0, -1.0, 0.0]), [255, 1]);
        let [up, down] = [codes(&[0.1, 0.0, 1.0])[0], codes(&[-0.1, 0.0, 1.0])[0]];
        assert_eq!(i32::from(up) - 128, 128 - i32::from(down));
    }

    #[test]
    fn a_large_map_is_averaged() {
        let tilted = [0.6, 0.0, 0.8];
        let normals = [tilted, [-0.6, 0.0, 0.8], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]];
        assert_eq!(averaged(&normals, 2, 2), [[0.0, 0.0, 1.0]]);
        assert_eq!(averaged(&[tilted; 9], 3, 2).len(), 1);
    }
}
