//! Names of images that are one file per UDIM tile: `skin.<UDIM>.png` stands for `skin.1001.png` and so on.

use std::path::{Path, PathBuf};

/// Token in a file name that stands for the number of a tile.
const TOKEN: &str = "<UDIM>";

/// Whether a file name stands for one file per UDIM tile.
pub fn is_udim_pattern(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.contains(TOKEN))
}

/// The file of a tile, by its number; a path without `<UDIM>` in its last part stays what it is.
pub fn udim_file(pattern: &Path, tile: u32) -> PathBuf {
    let name = pattern.file_name().and_then(|name| name.to_str());
    match name.filter(|name| name.contains(TOKEN)) {
        Some(name) => pattern.with_file_name(udim_name(name, tile)),
        None => pattern.to_owned(),
    }
}

/// Text with the number of a tile where it has `<UDIM>`.
pub fn udim_name(pattern: &str, tile: u32) -> String {
    pattern.replace(TOKEN, &tile.to_string())
}

/// A file name with `<UDIM>` before its extension.
pub fn udim_pattern(file: &str) -> String {
    match file.rsplit_once('.') {
        Some((stem, extension)) => format!("{stem}.{TOKEN}.{extension}"),
        None => format!("{file}.{TOKEN}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_stands_for_a_file_per_tile() {
        let pattern = Path::new("masks/skin.<UDIM>.png");
        assert!(is_udim_pattern(pattern));
        assert_eq!(udim_file(pattern, 1012), Path::new("masks/skin.1012.png"));
        assert_eq!(udim_name("a_<UDIM>", 1001), "a_1001");
        // Only the name counts, not the folder.
        let plain = Path::new("<UDIM>/skin.png");
        assert!(!is_udim_pattern(plain));
        assert_eq!(udim_file(plain, 1012), plain);
    }

    #[test]
    fn the_number_stands_before_the_extension() {
        assert_eq!(
            udim_pattern("maps/a_50_normal.png"),
            "maps/a_50_normal.<UDIM>.png"
        );
        assert_eq!(udim_pattern("a"), "a.<UDIM>");
    }
}
