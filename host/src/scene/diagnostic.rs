//! What is wrong with an input, where, and what to do about it.

use core::fmt;
use core::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use serde::Serialize;

/// One fault of an input file, with its place and its remedy.
///
/// [`Display`](fmt::Display) shows it as compilers do, in plain text:
///
/// ```text
/// error: unknown key `reflectanse` in a surface
///  --> room.toml:7:1
///   |
/// 7 | reflectanse = 0.5
///   | ^^^^^^^^^^^
///   |
///   = help: did you mean `reflectance`?
/// ```
///
/// Serialised it is an object with `message`, `file`, `line`, `column` and
/// `remedy`; line and column are `null` where the fault has no place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// What is wrong.
    pub message: String,
    /// The file as the user named it.
    pub file: String,
    /// Line, counted from 1; `None` where the file as a whole is at fault.
    pub line: Option<usize>,
    /// Column in characters, counted from 1; `None` together with `line`.
    pub column: Option<usize>,
    /// What to do about it.
    pub remedy: String,
    /// The line to show; boxed to keep `Result<_, Diagnostic>` small.
    #[serde(skip)]
    excerpt: Option<Box<Excerpt>>,
}

/// One line of the input and the bytes of it that are at fault.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Excerpt {
    text: String,
    span: Range<usize>,
}

impl Diagnostic {
    /// A fault in the bytes `span` of `source`.
    ///
    /// Of a span over several lines the first is shown. A span that is empty,
    /// reaches past the end or cuts a character is moved to the nearest
    /// characters, so every span is safe.
    pub fn at(
        file: &str,
        source: &str,
        span: Range<usize>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let start = floor_boundary(source, span.start);
        let line_start = source[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = source[start..]
            .find('\n')
            .map_or(source.len(), |at| start + at);
        let text = source[line_start..line_end].trim_end_matches('\r');
        let line = source[..start].matches('\n').count() + 1;
        let in_line = start - line_start..span.end.saturating_sub(line_start);
        Self::in_line(file, line, text, in_line, message, remedy)
    }

    /// A fault in the bytes `span` of one line whose text and number (from 1)
    /// are given: for inputs that are read line by line.
    pub fn in_line(
        file: &str,
        line: usize,
        text: &str,
        span: Range<usize>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let start = floor_boundary(text, span.start);
        let end = floor_boundary(text, span.end).max(start);
        Self {
            message: message.into(),
            file: file.to_owned(),
            line: Some(line),
            column: Some(text[..start].chars().count() + 1),
            remedy: remedy.into(),
            excerpt: Some(Box::new(Excerpt {
                text: text.to_owned(),
                span: start..end,
            })),
        }
    }

    /// A fault of the file as a whole: it cannot be opened, say.
    pub fn of_file(file: &str, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            file: file.to_owned(),
            line: None,
            column: None,
            remedy: remedy.into(),
            excerpt: None,
        }
    }

    /// The fault as text without a final newline, with terminal colours where
    /// `colour` is set.
    pub fn render(&self, colour: bool) -> String {
        let mut group: Group<'_> = match (&self.excerpt, self.line) {
            (Some(excerpt), Some(line)) => {
                Level::ERROR.primary_title(self.message.as_str()).element(
                    Snippet::source(excerpt.text.as_str())
                        .line_start(line)
                        .path(self.file.as_str())
                        .annotation(AnnotationKind::Primary.span(excerpt.span.clone())),
                )
            }
            _ => Group::with_title(
                Level::ERROR.primary_title(format!("{}: {}", self.file, self.message)),
            ),
        };
        if !self.remedy.is_empty() {
            group = group.element(Level::HELP.message(self.remedy.as_str()));
        }
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        renderer.render(&[group])
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostic {}

/// The largest character boundary of `text` that is not above `index`.
fn floor_boundary(text: &str, index: usize) -> usize {
    let mut at = index.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// The name of `known` that is most like `name`, if any is like it at all:
/// at most a third of the letters differ.
pub(crate) fn nearest_name<'k>(
    name: &str,
    known: impl IntoIterator<Item = &'k str>,
) -> Option<&'k str> {
    // Comparing costs the product of the lengths; no known name is so long.
    if name.len() > 200 {
        return None;
    }
    let lower = name.to_lowercase();
    known
        .into_iter()
        .map(|candidate| {
            let distance = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
            (distance, candidate)
        })
        .filter(|(distance, candidate)| 3 * distance <= candidate.chars().count().max(3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}
