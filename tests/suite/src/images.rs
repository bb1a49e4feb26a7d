//! PNG and EXR files of every kind, and damage that keeps their checksums right.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, SmallVec, Vec2, WritableImage, f16,
};

use super::{Chance, damage_bytes};

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Every colour type of PNG.
pub const PNG_COLOURS: [u8; 5] = [0, 2, 3, 4, 6];

/// Sets of channels of an EXR, some that no image has.
pub const EXR_CHANNELS: [&[&str]; 4] = [
    &["R", "G", "B"],
    &["Y"],
    &["R", "G", "B", "A"],
    &["x.Y", "Z"],
];

/// A PNG as its chunks.
#[derive(Clone, Debug)]
pub struct PngChunks(Vec<([u8; 4], Vec<u8>)>);

impl PngChunks {
    /// An image of a few texels, of any depth and interlacing and one of the colour types: 0 grey,
    /// 2 colours, 3 palette, 4 and 6 with alpha.
    pub fn sound(colours: &[u8], chance: &mut Chance) -> Self {
        let colour = colours[chance.below(colours.len())];
        let depths: &[u8] = match colour {
            0 => &[1, 2, 4, 8, 16],
            3 => &[1, 2, 4, 8],
            _ => &[8, 16],
        };
        let depth = depths[chance.below(depths.len())];
        let [width, height] = [1 + chance.below(9), 1 + chance.below(9)];
        let interlaced = chance.one_in(3);
        let mut header = Vec::new();
        header.extend((width as u32).to_be_bytes());
        header.extend((height as u32).to_be_bytes());
        header.extend([depth, colour, 0, 0, u8::from(interlaced)]);
        let mut chunks = vec![(*b"IHDR", header)];
        if chance.one_in(4) {
            chunks.push((*b"gAMA", 45_455_u32.to_be_bytes().to_vec()));
        }
        if colour == 3 {
            let colours = 1 + chance.below(1 << depth.min(6));
            chunks.push((*b"PLTE", (0..3 * colours).map(|i| (i * 41) as u8).collect()));
        }
        if colour < 4 && chance.one_in(3) {
            let bytes = [2, 0, 6, 1][colour as usize];
            chunks.push((*b"tRNS", vec![0; bytes]));
        }
        let channels = [1, 0, 3, 1, 2, 0, 4][colour as usize];
        let rows = scanlines([width, height], interlaced);
        let raw: Vec<u8> = rows
            .iter()
            .flat_map(|texels| {
                let bytes = (texels * channels * depth as usize).div_ceil(8);
                let filter = chance.below(5) as u8;
                // Small numbers, so that palettes of few colours have them.
                let texels =
                    (0..bytes).map(|_| (chance.bits() & if colour == 3 { 0 } else { 255 }) as u8);
                std::iter::once(filter).chain(texels).collect::<Vec<u8>>()
            })
            .collect();
        let data = zlib_stored(&raw);
        let cut = chance.below(data.len());
        chunks.push((*b"IDAT", data[..cut].to_vec()));
        chunks.push((*b"IDAT", data[cut..].to_vec()));
        chunks.push((*b"IEND", Vec::new()));
        Self(chunks)
    }

    /// Damages a chunk, or their order.
    pub fn damage(&mut self, other: &Self, chance: &mut Chance) {
        let at = chance.below(self.0.len());
        match chance.below(7) {
            0 | 1 => {
                let field = chance.below(7);
                let header = &mut self.0[0].1;
                let value = (chance.wild_whole() as u32).to_be_bytes();
                if header.len() == 13 {
                    match field {
                        0 | 1 => header[4 * field..4 * field + 4].copy_from_slice(&value),
                        _ => header[field + 6] = chance.below(18) as u8,
                    }
                }
            }
            2 => drop(self.0.remove(at)),
            3 => {
                let to = chance.below(self.0.len());
                let chunk = other.0[chance.below(other.0.len())].clone();
                self.0.insert(to, chunk);
            }
            4 => self.0[at].0[chance.below(4)] ^= 0x20,
            _ => damage_bytes(&mut self.0[at].1, b"", chance),
        }
        if self.0.is_empty() {
            self.0.push((*b"IEND", Vec::new()));
        }
    }

    /// The file, every checksum right.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut file = SIGNATURE.to_vec();
        for (name, data) in &self.0 {
            file.extend((data.len() as u32).to_be_bytes());
            let start = file.len();
            file.extend(name);
            file.extend(data);
            let sum = crc32(&file[start..]);
            file.extend(sum.to_be_bytes());
        }
        file
    }
}

/// Texels of every row that is stored, pass by pass where the image is interlaced (Adam7).
fn scanlines([width, height]: [usize; 2], interlaced: bool) -> Vec<usize> {
    if !interlaced {
        return vec![width; height];
    }
    let passes = [
        [0, 0, 8, 8],
        [4, 0, 8, 8],
        [0, 4, 4, 8],
        [2, 0, 4, 4],
        [0, 2, 2, 4],
        [1, 0, 2, 2],
        [0, 1, 1, 2],
    ];
    let count = |size: usize, from: usize, step: usize| size.saturating_sub(from).div_ceil(step);
    passes
        .iter()
        .flat_map(|&[x, y, dx, dy]| {
            let texels = count(width, x, dx);
            let rows = if texels > 0 { count(height, y, dy) } else { 0 };
            std::iter::repeat_n(texels, rows)
        })
        .collect()
}

/// A zlib stream without compression.
fn zlib_stored(raw: &[u8]) -> Vec<u8> {
    let mut stream = vec![0x78, 0x01, 0x01];
    let length = raw.len() as u16;
    stream.extend(length.to_le_bytes());
    stream.extend((!length).to_le_bytes());
    stream.extend(raw);
    let (mut low, mut high) = (1_u32, 0_u32);
    for byte in raw {
        low = (low + u32::from(*byte)) % 65_521;
        high = (high + low) % 65_521;
    }
    stream.extend((high << 16 | low).to_be_bytes());
    stream
}

/// The checksum of PNG chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |mut sum: u32, byte: &u8| {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
        sum
    };
    !bytes.iter().fold(u32::MAX, step)
}

/// An EXR of a few texels: any compression, sample type and tiling, and one of the sets of channels.
pub fn sound_exr(sets: &[&[&str]], chance: &mut Chance) -> Vec<u8> {
    let compression = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
    ][chance.below(8)];
    let blocks = match chance.below(2) {
        0 => Blocks::ScanLines,
        _ => Blocks::Tiles(Vec2(1 + chance.below(8), 1 + chance.below(8))),
    };
    let size = (1 + chance.below(20), 1 + chance.below(20));
    let names = sets[chance.below(sets.len())];
    let count = size.0 * size.1;
    let channels: SmallVec<[_; 4]> = names
        .iter()
        .map(|name| {
            let numbers = (0..count).map(|_| chance.between(0.0, 1.0) as f32);
            let numbers: Vec<f32> = numbers.collect();
            let samples = match chance.below(3) {
                0 => FlatSamples::F32(numbers),
                1 => FlatSamples::F16(numbers.iter().map(|n| f16::from_f32(*n)).collect()),
                _ => FlatSamples::U32(numbers.iter().map(|n| n.round() as u32).collect()),
            };
            AnyChannel::new(*name, samples)
        })
        .collect();
    let encoding = Encoding {
        compression,
        blocks,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(
        size,
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels),
    );
    let mut file = Cursor::new(Vec::new());
    let written = Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut file);
    match written {
        Ok(()) => file.into_inner(),
        // Some sets of choices are none that the format has.
        Err(_) => Vec::new(),
    }
}

/// Damages an EXR: a number in its header, or any byte.
pub fn damage_exr(bytes: &mut Vec<u8>, other: &[u8], chance: &mut Chance) {
    let attributes: [(&[u8], usize); 6] = [
        (b"dataWindow\0box2i\0", 16),
        (b"displayWindow\0box2i\0", 16),
        (b"channels\0chlist\0", 60),
        (b"tiles\0tiledesc\0", 9),
        (b"compression\0compression\0", 1),
        (b"lineOrder\0lineOrder\0", 1),
    ];
    let (name, length) = attributes[chance.below(attributes.len())];
    let found = bytes.windows(name.len()).position(|w| w == name);
    match found.filter(|_| !chance.one_in(3)) {
        Some(at) => {
            // The attribute's size comes first.
            let start = at + name.len() + if chance.one_in(8) { 0 } else { 4 };
            let place = start + chance.below(length);
            let place = if chance.one_in(2) {
                place
            } else {
                start + place.saturating_sub(start) / 4 * 4
            };
            let value = (chance.wild_whole() as u32).to_le_bytes();
            let width = if length == 1 || chance.one_in(3) {
                1
            } else {
                4
            };
            for (slot, byte) in bytes.iter_mut().skip(place).zip(value.iter().take(width)) {
                *slot = if width == 1 {
                    chance.below(16) as u8
                } else {
                    *byte
                };
            }
        }
        None => damage_bytes(bytes, other, chance),
    }
}
