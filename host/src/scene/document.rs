//! Reading TOML values with their places, so that every fault can be shown.

use core::ops::Range;

use glam::DVec3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::diagnostic::{Diagnostic, nearest_name};

/// Largest absolute coordinate in metres.
///
/// The kernel multiplies up to six lengths in single precision
/// (f32::MAX = 3.4e38), so lengths stay below about 1e6.
pub const MAX_COORDINATE: f64 = 1e6;

/// The text that is being read and the name it goes by.
#[derive(Clone, Copy)]
pub(crate) struct Document<'d> {
    pub(crate) name: &'d str,
    pub(crate) source: &'d str,
}

impl Document<'_> {
    /// A fault in the bytes `span` of this document.
    pub(crate) fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic::at(self.name, self.source, span, message, remedy)
    }

    /// The line number of a byte offset, counted from 1.
    pub(crate) fn line_of(&self, offset: usize) -> usize {
        self.source
            .bytes()
            .take(offset)
            .filter(|&byte| byte == b'\n')
            .count()
            + 1
    }

    /// A fault of the TOML syntax itself.
    pub(crate) fn syntax_error(&self, error: &toml::de::Error) -> Diagnostic {
        let span = error.span().unwrap_or(0..0);
        let message = error.message();
        let remedy = if message.contains("duplicate key") {
            "remove one of the two, or give the second its own `[[...]]` table"
        } else if message.contains("recurs") {
            "no value of this file needs nested brackets this deep"
        } else {
            "write it as TOML (https://toml.io): `key = value`, strings in quotes, lists in brackets with commas"
        };
        self.error(span, format!("not valid TOML: {message}"), remedy)
    }
}

/// A table whose keys are known.
#[derive(Clone, Copy)]
pub(crate) struct Table<'d> {
    document: Document<'d>,
    entries: &'d DeTable<'d>,
    span_start: usize,
    span_end: usize,
    /// What the table is, for messages: "a surface".
    what: &'d str,
}

impl<'d> Table<'d> {
    /// The document's outermost table. Its keys are not checked yet.
    pub(crate) fn root(document: Document<'d>, entries: &'d DeTable<'d>, what: &'d str) -> Self {
        Self {
            document,
            entries,
            span_start: 0,
            span_end: 0,
            what,
        }
    }

    /// Refuses keys other than `known`, the first in the file first.
    pub(crate) fn only(self, known: &[&'static str]) -> Result<Self, Diagnostic> {
        let unknown = self
            .entries
            .keys()
            .filter(|key| !known.contains(&key.get_ref().as_ref()))
            .min_by_key(|key| key.span().start);
        let Some(key) = unknown else {
            return Ok(self);
        };
        let remedy = match nearest_name(key.get_ref(), known.iter().copied()) {
            Some(name) => format!("did you mean `{name}`?"),
            None => format!("the keys of {} are {}", self.what, listed(known)),
        };
        let message = format!("unknown key `{}` in {}", key.get_ref(), self.what);
        Err(self.document.error(key.span(), message, remedy))
    }

    /// The value of `key`, if there is one.
    pub(crate) fn optional(&self, key: &'static str) -> Option<Field<'d>> {
        let value = self.entries.get(key)?;
        Some(Field {
            document: self.document,
            key,
            value,
        })
    }

    /// The value of `key`; its absence is a fault, mended as in `example`.
    pub(crate) fn required(
        &self,
        key: &'static str,
        example: &str,
    ) -> Result<Field<'d>, Diagnostic> {
        self.optional(key).ok_or_else(|| {
            let message = format!("{} has no `{key}`", self.what);
            self.error(message, format!("add a line such as `{example}`"))
        })
    }

    /// A fault of the table as a whole.
    pub(crate) fn error(
        &self,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Diagnostic {
        self.document
            .error(self.span_start..self.span_end, message, remedy)
    }
}

/// The value of a key, or an element of it.
#[derive(Clone, Copy)]
pub(crate) struct Field<'d> {
    document: Document<'d>,
    key: &'static str,
    value: &'d Spanned<DeValue<'d>>,
}

impl<'d> Field<'d> {
    /// The bytes the value takes in the document.
    pub(crate) fn span(&self) -> Range<usize> {
        self.value.span()
    }

    /// A fault of this value.
    pub(crate) fn error(
        &self,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Diagnostic {
        self.document.error(self.span(), message, remedy)
    }

    fn wrong_type(&self, wanted: &str, example: &str) -> Diagnostic {
        let found = match self.value.get_ref() {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "a truth value",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        };
        let message = format!("`{}` must be {wanted}, not {found}", self.key);
        self.error(message, format!("write it like {example}"))
    }

    /// The value as a string.
    pub(crate) fn string(&self, example: &str) -> Result<&'d str, Diagnostic> {
        self.value
            .get_ref()
            .as_str()
            .ok_or_else(|| self.wrong_type("a string", example))
    }

    /// The value as a name: not empty, without control characters, which
    /// would garble tables and listings.
    pub(crate) fn name(&self) -> Result<String, Diagnostic> {
        let name = self.string("`name = \"desk-1\"`")?;
        if name.trim().is_empty() || name.chars().any(char::is_control) {
            return Err(self.error(
                "a name must have at least one visible character and no control characters",
                "give it a short name such as \"desk-1\"",
            ));
        }
        Ok(name.to_owned())
    }

    /// The value as a string or nothing.
    pub(crate) fn as_str(&self) -> Option<&'d str> {
        self.value.get_ref().as_str()
    }

    /// The value as true or false.
    pub(crate) fn truth(&self, example: &str) -> Result<bool, Diagnostic> {
        self.value
            .get_ref()
            .as_bool()
            .ok_or_else(|| self.wrong_type("true or false", example))
    }

    /// The value as an integer, if it is one that fits.
    pub(crate) fn as_integer(&self) -> Option<i128> {
        let integer = self.value.get_ref().as_integer()?;
        i128::from_str_radix(integer.as_str(), integer.radix()).ok()
    }

    /// The value as a finite number; integers count. A negative zero reads as
    /// zero.
    pub(crate) fn number(&self, example: &str) -> Result<f64, Diagnostic> {
        Ok(self.signed_number(example)? + 0.0)
    }

    /// As [`number`](Self::number), with the sign of a zero: for what was written
    /// from a number and must become the same bits.
    pub(crate) fn signed_number(&self, example: &str) -> Result<f64, Diagnostic> {
        let number = match self.value.get_ref() {
            DeValue::Float(float) => float.as_str().parse().unwrap_or(f64::NAN),
            DeValue::Integer(integer) if integer.radix() == 10 => {
                integer.as_str().parse().unwrap_or(f64::NAN)
            }
            // Written in hexadecimal, octal or binary: beyond i128 it is
            // beyond every limit too.
            DeValue::Integer(_) => self.as_integer().map_or(f64::INFINITY, |n| n as f64),
            _ => return Err(self.wrong_type("a number", example)),
        };
        if !number.is_finite() {
            let text = self.document.source.get(self.span()).unwrap_or("it");
            return Err(self.error(
                format!("`{}` must be a finite number, not {text}", self.key),
                format!("write it like {example}"),
            ));
        }
        Ok(number)
    }

    /// The elements of a list.
    pub(crate) fn elements(
        &self,
        wanted: &str,
        example: &str,
    ) -> Result<Vec<Field<'d>>, Diagnostic> {
        let array = self
            .value
            .get_ref()
            .as_array()
            .ok_or_else(|| self.wrong_type(wanted, example))?;
        Ok(array.iter().map(|value| Field { value, ..*self }).collect())
    }

    /// The value as a list of exactly three numbers.
    pub(crate) fn triple(&self, wanted: &str, example: &str) -> Result<[f64; 3], Diagnostic> {
        let elements = self.elements(wanted, example)?;
        let [a, b, c] = elements.as_slice() else {
            let message = format!(
                "`{}` must be {wanted}, not {} of them",
                self.key,
                elements.len()
            );
            return Err(self.error(message, format!("write it like {example}")));
        };
        Ok([a.number(example)?, b.number(example)?, c.number(example)?])
    }

    /// The value as a direction or position.
    pub(crate) fn vector(&self, example: &str) -> Result<DVec3, Diagnostic> {
        Ok(self.triple("three numbers [x, y, z]", example)?.into())
    }

    /// The value as a position: coordinates within [`MAX_COORDINATE`].
    pub(crate) fn position(&self, example: &str) -> Result<DVec3, Diagnostic> {
        let position = self.vector(example)?;
        if position.abs().max_element() > MAX_COORDINATE {
            return Err(self.error(
                format!(
                    "a coordinate of `{}` is beyond {MAX_COORDINATE} m, where the device's single precision ends",
                    self.key
                ),
                "coordinates are metres: move the scene to the origin or scale it",
            ));
        }
        Ok(position)
    }

    /// The value of every channel: one number for all, or `[r, g, b]`; with
    /// each number the field it stands in.
    pub(crate) fn channels(&self, example: &str) -> Result<[(f64, Field<'d>); 3], Diagnostic> {
        if self.value.get_ref().is_array() {
            let wanted = "a number or three numbers [r, g, b]";
            let numbers = self.triple(wanted, example)?;
            let fields = self.elements(wanted, example)?;
            return Ok(core::array::from_fn(|i| (numbers[i], fields[i])));
        }
        let number = self.number(example)?;
        Ok([(number, *self); 3])
    }

    /// The value as one table.
    pub(crate) fn table(&self, what: &'d str) -> Result<Table<'d>, Diagnostic> {
        let DeValue::Table(entries) = self.value.get_ref() else {
            let example = format!("`[{}]` on a line of its own", self.key);
            return Err(self.wrong_type("a table", &example));
        };
        let span = self.span();
        Ok(Table {
            document: self.document,
            entries,
            span_start: span.start,
            span_end: span.end,
            what,
        })
    }

    /// The value as tables, one for each `[[key]]`.
    pub(crate) fn tables(&self, what: &'d str) -> Result<Vec<Table<'d>>, Diagnostic> {
        let example = format!("`[[{}]]` on a line of its own", self.key);
        self.elements("a list of tables", &example)?
            .iter()
            .map(|element| match element.value.get_ref() {
                DeValue::Table(_) => element.table(what),
                _ => Err(element.wrong_type("a list of tables", &example)),
            })
            .collect()
    }
}

/// Names for a message: "`a`, `b` and `c`".
pub(crate) fn listed(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}
