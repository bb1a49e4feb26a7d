//! Names that become parts of file names, on every system.

/// Why a name cannot be part of a file name; `None` when it can.
pub(crate) fn file_name_fault(name: &str) -> Option<&'static str> {
    const RESERVED: [&str; 22] = [
        "con", "prn", "aux", "nul", "com1", "com2", "com3", "com4", "com5", "com6", "com7", "com8",
        "com9", "lpt1", "lpt2", "lpt3", "lpt4", "lpt5", "lpt6", "lpt7", "lpt8", "lpt9",
    ];
    // Leaves room for `_12p5_normal.png` and the mark of a temporary below 255 bytes.
    const LONGEST: usize = 100;
    let stem = name.split('.').next().unwrap_or_default();
    if name.is_empty() {
        Some("it is empty")
    } else if name.len() > LONGEST {
        Some("it is longer than 100 bytes")
    } else if name.chars().any(is_forbidden) {
        Some("it has one of / \\ : * ? \" < > | or a control character")
    } else if name.starts_with([' ', '.']) || name.ends_with([' ', '.']) {
        Some("it begins or ends with a space or a full stop")
    } else if RESERVED.contains(&stem.to_lowercase().as_str()) {
        Some("Windows reserves it for a device")
    } else {
        None
    }
}

/// Whether a name can stand in a file name on Windows, macOS and Linux.
pub fn is_usable_file_name(name: &str) -> bool {
    file_name_fault(name).is_none()
}

/// A usable file name made from any text, different from those `taken`, letter case aside.
pub fn usable_file_name(text: &str, taken: &[String]) -> String {
    let plain: String = text
        .chars()
        .map(|c| if is_forbidden(c) { '_' } else { c })
        .take(30)
        .collect();
    let plain = plain.trim_matches([' ', '.']);
    let mut name = if is_usable_file_name(plain) {
        plain.to_owned()
    } else {
        format!("shape_{plain}")
    };
    let base = name.clone();
    let mut number = 2;
    while taken.iter().any(|other| same_file(other, &name)) {
        name = format!("{base}_{number}");
        number += 1;
    }
    name
}

/// Whether two names are one file where letter case does not count.
pub(crate) fn same_file(a: &str, b: &str) -> bool {
    a.to_lowercase() == b.to_lowercase()
}

fn is_forbidden(c: char) -> bool {
    c.is_control() || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
}
