//! Damage to bytes and to lines of text, whatever they mean.

use super::Chance;

/// Damages a file in one of the ways in which files are damaged: cut, overwritten, bits turned,
/// parts repeated, left out or taken from `other`.
pub fn damage_bytes(bytes: &mut Vec<u8>, other: &[u8], chance: &mut Chance) {
    if bytes.is_empty() {
        return;
    }
    let at = chance.below(bytes.len());
    let length = 1 + chance.below(16.min(bytes.len() - at));
    match chance.below(7) {
        0 => bytes.truncate(at),
        1 => bytes[at] ^= 1 << chance.below(8),
        2 => bytes[at] = *chance.pick(&[&0, &1, &0x7f, &0x80, &0xff]),
        3 => {
            let word = (chance.wild_whole() as u32).to_le_bytes();
            let end = bytes.len().min(at + word.len());
            bytes[at..end].copy_from_slice(&word[..end - at]);
        }
        4 => drop(bytes.drain(at..at + length)),
        5 => {
            let again: Vec<u8> = bytes[at..at + length].to_vec();
            bytes.splice(at..at, again);
        }
        _ => {
            let from = chance.below(other.len() + 1);
            bytes.truncate(at);
            bytes.extend_from_slice(&other[from..]);
        }
    }
}

/// Damages a text of lines: numbers become extreme, words change places, lines come twice, go, or
/// come from `other`; now and then bytes are damaged.
pub fn damage_text(text: &mut Vec<u8>, other: &[u8], chance: &mut Chance) {
    if chance.one_in(8) {
        return damage_bytes(text, other, chance);
    }
    let mut lines: Vec<Vec<u8>> = split_lines(text);
    let at = chance.below(lines.len());
    match chance.below(8) {
        0..=3 => change_word(&mut lines[at], chance),
        4 => drop(lines.remove(at)),
        5 => {
            let to = chance.below(lines.len());
            let line = lines[at].clone();
            lines.insert(to, line);
        }
        6 => {
            let to = chance.below(lines.len());
            lines.swap(at, to);
        }
        _ => {
            let others = split_lines(other);
            let line = others[chance.below(others.len())].clone();
            lines.insert(at, line);
        }
    }
    *text = lines.join(&b'\n');
}

fn split_lines(text: &[u8]) -> Vec<Vec<u8>> {
    text.split(|byte| *byte == b'\n')
        .map(<[u8]>::to_vec)
        .collect()
}

/// Replaces one run of letters, digits, signs and points.
fn change_word(line: &mut Vec<u8>, chance: &mut Chance) {
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-._".contains(byte);
    let mut words = Vec::new();
    let mut start = None;
    for at in 0..=line.len() {
        let inside = line.get(at).is_some_and(is_word);
        match (start, inside) {
            (None, true) => start = Some(at),
            (Some(from), false) => {
                words.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    if words.is_empty() {
        return;
    }
    // Numbers outnumber the rest among what is worth changing.
    let numbers: Vec<_> = words
        .iter()
        .filter(|word| line[word.start].is_ascii_digit() || line[word.start] == b'-')
        .cloned()
        .collect();
    let among = if numbers.is_empty() || chance.one_in(4) {
        &words
    } else {
        &numbers
    };
    let word = among[chance.below(among.len())].clone();
    let new: Vec<u8> = match chance.below(8) {
        0 => Vec::new(),
        1 => chance
            .pick(&[
                "true", "\"\"", "[]", "{}", "'x'", "[[[[[[[[", "//", "\u{e9}",
            ])
            .into(),
        2 => line[words[chance.below(words.len())].clone()].to_vec(),
        3 => vec![b'9'; 1 + chance.below(400)],
        _ => chance.wild_number().into(),
    };
    line.splice(word, new);
}
