//! A mistake in the syntax of TOML with the text around it, and words about it.

/// A message and advice on what to do.
pub type Words = (String, Option<String>);

/// A syntax error with the text around it.
pub struct Mistake<'t> {
    /// Text that the parser points at.
    pub found: &'t str,
    /// Text from there to the end of the line.
    pub rest: &'t str,
    /// Text of the line, without spaces around it.
    pub line: &'t str,
    /// Text left of the first `=`; `value` is the text right of it, without a comment.
    pub key: &'t str,
    pub value: &'t str,
    /// The parser's message.
    pub message: &'t str,
}

/// A message with advice.
pub fn words(message: impl Into<String>, help: impl Into<String>) -> Option<Words> {
    Some((message.into(), Some(help.into())))
}

/// Whether a text is a number without letters.
pub fn is_number(text: &str) -> bool {
    !text.is_empty() && text.parse::<f64>().is_ok() && !text.contains(char::is_alphabetic)
}
