//! Guess at what was meant by an unknown name.

/// The accepted name nearest to `name`, if one is near enough to be a slip of the hand.
pub fn nearest<'a>(name: &str, accepted: impl IntoIterator<Item = &'a str>) -> Option<String> {
    // Jaro-Winkler likes common beginnings, as typing errors do; below 0.75 the guesses annoy.
    const LEAST_SIMILARITY: f64 = 0.75;
    // Tools differ in how they capitalise the same names.
    let lower = name.to_lowercase();
    accepted
        .into_iter()
        .map(|candidate| {
            (
                strsim::jaro_winkler(&lower, &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|(similarity, _)| *similarity >= LEAST_SIMILARITY)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.to_owned())
}

/// The question that ends a message about an unknown name, with a space before it; empty without a
/// suggestion.
pub fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}
