//! The page around the data.

/// The page's HTML, with places in double braces.
const PAGE: &str = include_str!("../page/page.html");

/// Scripts and three.js, made by `cargo xtask page`.
const SCRIPT: &str = include_str!("../page/bundle.js");

const STYLE: &str = include_str!("../page/page.css");

/// What the places of the page are filled with.
pub(crate) struct Content<'a> {
    /// Plain text: name of the mesh.
    pub(crate) title: &'a str,
    /// Plain text: what the page holds.
    pub(crate) facts: &'a str,
    /// JSON that describes the data.
    pub(crate) about: &'a str,
    /// Base64 of the mesh.
    pub(crate) mesh: &'a str,
    /// Script elements with the maps, or the pictures of a plan.
    pub(crate) maps: &'a str,
}

/// Fills the page.
pub(crate) fn filled(content: &Content<'_>) -> String {
    let data = content.mesh.len() + content.maps.len() + content.about.len();
    let mut page = String::with_capacity(data + SCRIPT.len() + 2 * PAGE.len());
    let mut rest = PAGE;
    // Piece by piece: what has been filled in is never searched for places itself.
    while let Some((before, after)) = rest.split_once("{{") {
        let (place, after) = after.split_once("}}").unwrap_or((after, ""));
        page.push_str(before);
        match place {
            "title" => page.push_str(&escaped(content.title)),
            "facts" => page.push_str(&escaped(content.facts)),
            "generator" => page.push_str(concat!("ruga ", env!("CARGO_PKG_VERSION"))),
            "style" => page.push_str(STYLE.trim_end()),
            "script" => page.push_str(SCRIPT.trim_end()),
            // A name in it could end the element that it stands in.
            "about" => page.push_str(&content.about.replace('<', "\\u003c")),
            "mesh" => page.push_str(content.mesh),
            "maps" => page.push_str(content.maps),
            unknown => unreachable!("the page has a place `{unknown}` that nothing fills"),
        }
        rest = after;
    }
    page.push_str(rest);
    page
}

/// An element that holds base64 for the script.
pub(crate) fn data_element(id: &str, base64: &str) -> String {
    format!("<script type=\"text/plain\" id=\"{id}\">{base64}</script>")
}

/// Text as it stands in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
