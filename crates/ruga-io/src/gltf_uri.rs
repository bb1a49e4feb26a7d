//! URIs in glTF files: data inside the text, or paths of files beside it.

use std::path::{Path, PathBuf};

/// The file that a relative URI means, beside the file at `path` that names it.
pub(crate) fn external_file(path: &Path, uri: &str) -> Result<PathBuf, String> {
    let has_scheme = uri
        .split_once(':')
        .is_some_and(|(scheme, _)| scheme.len() > 1 && !scheme.contains('/'));
    if has_scheme {
        let uri = shortened(uri);
        return Err(format!("uri `{uri}` is not a relative path or data: URI"));
    }
    let relative =
        decode_percent(uri).ok_or_else(|| format!("uri `{}` is not valid", shortened(uri)))?;
    Ok(path.parent().unwrap_or(Path::new("")).join(relative))
}

/// The text, or its ends: a data: URI with a slip in its first letters is megabytes long.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 200;
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    let start: String = text.chars().take(MOST / 2).collect();
    let end: String = text.chars().rev().take(MOST / 2).collect();
    let end: String = end.chars().rev().collect();
    format!("{start} ... {end}")
}

/// Replaces `%20` and the like; `None` when the result is not UTF-8.
fn decode_percent(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let hex = tail
            .get(..2)
            .filter(|_| first == b'%')
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match hex {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

/// The bytes of a base64 data: URI.
pub(crate) fn decode_data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let (_, data) = uri
        .split_once(";base64,")
        .ok_or("its data: URI is not base64")?;
    decode_base64(data).ok_or_else(|| "its data: URI holds bad base64".to_owned())
}

/// A data: URI of the bytes of a buffer.
pub(crate) fn encode_data_uri(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = "data:application/octet-stream;base64,".to_owned();
    text.reserve(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let mut word = [0; 4];
        word[1..=group.len()].copy_from_slice(group);
        let word = u32::from_be_bytes(word);
        for place in 0..4 {
            let symbol = ALPHABET[(word >> (18 - 6 * place)) as usize & 63];
            text.push(char::from(if place <= group.len() { symbol } else { b'=' }));
        }
    }
    text
}

/// Standard alphabet, padding optional.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut word = 0_u32;
        for &symbol in group {
            word = word << 6 | u32::from(base64_value(symbol)?);
        }
        let missing = 4 - group.len();
        if missing == 3 {
            return None;
        }
        let padded = (word << (6 * missing)).to_be_bytes();
        bytes.extend_from_slice(&padded[1..4 - missing]);
    }
    Some(bytes)
}

fn base64_value(symbol: u8) -> Option<u8> {
    match symbol {
        b'A'..=b'Z' => Some(symbol - b'A'),
        b'a'..=b'z' => Some(symbol - b'a' + 26),
        b'0'..=b'9' => Some(symbol - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_return() {
        for length in 0..8 {
            let bytes: Vec<u8> = (0..length).map(|i| 250 - 37 * i).collect();
            assert_eq!(decode_data_uri(&encode_data_uri(&bytes)), Ok(bytes));
        }
    }
}
