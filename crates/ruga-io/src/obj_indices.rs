//! The indices of an OBJ file, checked before tobj uses them.
//!
//! tobj multiplies indices of texture coordinates and normals unchecked, and its messages name
//! neither line nor value.

use std::path::Path;

use crate::IoError;

/// Words that define something which faces number, in the order of a corner's indices.
const DEFINITIONS: [(&[u8], &str); 3] = [
    (b"v", "vertices"),
    (b"vt", "texture coordinates"),
    (b"vn", "normals"),
];

/// Checks that every index of a face names something that is in the file.
///
/// Where a file has no texture coordinates or normals at all, indices into them mean nothing and
/// are let be. What is no number is left to tobj.
pub(crate) fn check_indices(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let lines = || bytes.split(|byte| *byte == b'\n').map(words);
    let mut total = [0; 3];
    for mut words in lines() {
        count(words.next(), &mut total);
    }
    let mut so_far = [0; 3];
    for (number, mut words) in lines().enumerate() {
        let first = words.next();
        count(first, &mut so_far);
        if first != Some(b"f") {
            continue;
        }
        for corner in words {
            if let Some(reason) = corner_fault(corner, so_far, total) {
                let element = format!("line {}", number + 1);
                return Err(IoError::malformed(path, element, reason));
            }
        }
    }
    Ok(())
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

fn count(word: Option<&[u8]>, counts: &mut [usize; 3]) {
    let kind = DEFINITIONS.iter().position(|d| word == Some(d.0));
    if let Some(kind) = kind {
        counts[kind] += 1;
    }
}

/// Fault of a corner such as `3/-1/2`, if it has one.
///
/// Negative indices count back from the last so far.
fn corner_fault(corner: &[u8], so_far: [usize; 3], total: [usize; 3]) -> Option<String> {
    let parts = corner.split(|byte| *byte == b'/');
    for (kind, part) in parts.enumerate().take(3) {
        let text = std::str::from_utf8(part).ok()?;
        let Ok(index) = text.parse::<i64>() else {
            continue;
        };
        let back = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
        let exists = match index {
            0 => false,
            1.. => back <= total[kind],
            _ => back <= so_far[kind],
        };
        if !exists && (kind == 0 || total[kind] > 0) {
            let (count, what) = (total[kind], DEFINITIONS[kind].1);
            return Some(format!(
                "face index {index}: the file has {count} {what}; accepted: 1 to {count}, or \
                 negative numbers that count back from the face"
            ));
        }
    }
    None
}
