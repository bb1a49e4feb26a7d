//! Links of the documentation: what `mdbook` would complain about, without having to install it.

use std::fs;
use std::io;
use std::path::Path;

use crate::repository::root;

/// A line for every link to a file that is not there, and for every page that the book's summary
/// leaves out.
pub(crate) fn broken_links() -> io::Result<Vec<String>> {
    let mut wrong = Vec::new();
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md"))?;
    for folder in ["", "docs"] {
        let mut paths: Vec<_> = fs::read_dir(root().join(folder))?
            .map(|entry| entry.map(|entry| entry.path()))
            .collect::<io::Result<_>>()?;
        paths.retain(|path| path.extension().is_some_and(|e| e == "md"));
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if folder == "docs" && name != "SUMMARY.md" && !targets(&summary).any(|t| t == name) {
                wrong.push(format!("docs/SUMMARY.md: no link to {name}"));
            }
            let text = fs::read_to_string(&path)?;
            let missing = targets(&text).filter(|target| !exists(&path, target));
            wrong.extend(missing.map(|target| format!("{}: no {target}", path.display())));
        }
    }
    Ok(wrong)
}

/// Where the links of a page lead, without the ones to the web.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    let links = text.split("](").skip(1);
    let targets = links.filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://"))
}

/// Whether a link leads to a file; a place within it is not looked for.
fn exists(page: &Path, target: &str) -> bool {
    let file = target.split('#').next().unwrap_or_default();
    file.is_empty() || page.with_file_name(file).exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_within_the_repository_are_found() {
        let text = "see [a](a.md#b), [the web](https://x.org) and ![a picture](../p.png)";
        assert!(targets(text).eq(["a.md#b", "../p.png"]));
        let page = root().join("docs/theory.md");
        assert!(exists(&page, "scene.md#keys") && exists(&page, "../README.md"));
        assert!(!exists(&page, "nothing.md"));
    }
}
