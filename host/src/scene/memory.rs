//! What a device has: the regions of its linker script.

use super::diagnostic::Diagnostic;
use std::ops::Range;

/// The memory of a device in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// The region `FLASH`: code, constants and tables.
    pub flash: u64,
    /// The region `RAM`: stack and state.
    pub ram: u64,
}

/// Bytes of flash that tables leave to the code.
const CODE: u64 = 96 << 10;

/// The board that isolux is tested on: `memory.x` of its source.
const BOARD: &str = include_str!("../../../memory.x");

impl Memory {
    /// The board of `memory.x`.
    pub fn of_the_board() -> Self {
        // A test reads the same text: it has both regions.
        Self::parse("memory.x", BOARD).unwrap_or(Self { flash: 0, ram: 0 })
    }

    /// The lengths of the regions `FLASH` and `RAM` of a linker script, as the crate
    /// `cortex-m-rt` asks for them: `FLASH : ORIGIN = 0x08000000, LENGTH = 256K`. Lengths are
    /// decimal or hexadecimal numbers of bytes, of KiB (`K`) or MiB (`M`).
    ///
    /// # Errors
    /// [`Diagnostic`] with its place where a region is missing, given twice, empty, or its
    /// length is an expression.
    pub fn parse(file: &str, source: &str) -> Result<Self, Diagnostic> {
        // Of the same length, so that places stay what they are.
        let script = without_comments(source);
        let region = |name| region(file, source, &script, name);
        Ok(Self {
            flash: region("FLASH")?,
            ram: region("RAM")?,
        })
    }

    /// Bytes of flash for tables: what 96 KiB of code leave, and half of it where that is
    /// more.
    pub fn for_tables(self) -> u64 {
        self.flash - CODE.min(self.flash / 2)
    }
}

fn without_comments(source: &str) -> String {
    let mut script = String::with_capacity(source.len());
    let mut rest = source;
    while let Some(start) = rest.find("/*") {
        let end = rest[start + 2..]
            .find("*/")
            .map_or(rest.len(), |end| start + end + 4);
        script.push_str(&rest[..start]);
        script.extend(std::iter::repeat_n(' ', end - start));
        rest = &rest[end..];
    }
    script + rest
}

/// The length of a region in bytes.
fn region(file: &str, source: &str, script: &str, name: &str) -> Result<u64, Diagnostic> {
    let example = format!("give it as `{name} : ORIGIN = 0x20000000, LENGTH = 64K`");
    let mut found = statements(script).filter(|statement| {
        script[statement.clone()]
            .trim()
            .split([' ', '\t', ':', '('])
            .next()
            == Some(name)
    });
    let Some(statement) = found.next() else {
        let message = format!("there is no memory region {name}");
        return Err(Diagnostic::of_file(file, message, example));
    };
    if let Some(second) = found.next() {
        let message = format!("the memory region {name} is given twice");
        return Err(Diagnostic::at(
            file,
            source,
            trimmed(script, second),
            message,
            "leave one",
        ));
    }
    let fault = |span, message: String| {
        Err(Diagnostic::at(
            file,
            source,
            trimmed(script, span),
            message,
            example.clone(),
        ))
    };
    let Some(value) = value(script, statement.clone()) else {
        return fault(statement, format!("the memory region {name} has no LENGTH"));
    };
    match bytes(script[value.clone()].trim()) {
        Some(0) => fault(value, format!("the memory region {name} is empty")),
        Some(bytes) => Ok(bytes),
        None => fault(
            value,
            format!("the LENGTH of {name} is not a number of bytes"),
        ),
    }
}

/// The lines of a script, also where several statements share one.
fn statements(script: &str) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut from = 0;
    script
        .split_inclusive(['\n', '{', '}', ';'])
        .map(move |line| {
            let start = from;
            from += line.len();
            start..from - usize::from(line.ends_with(['\n', '{', '}', ';']))
        })
}

/// What is assigned to the attribute `LENGTH`, which may be written `len` or `l`.
fn value(script: &str, statement: Range<usize>) -> Option<Range<usize>> {
    let text = &script[statement.clone()];
    let mut from = statement.start;
    for part in text.split([':', ',']) {
        let here = from..from + part.len();
        from = here.end + 1;
        let Some((name, _)) = part.split_once('=') else {
            continue;
        };
        if matches!(name.trim(), "LENGTH" | "len" | "l") {
            return Some(here.start + name.len() + 1..here.end);
        }
    }
    None
}

/// Without the white space around it.
fn trimmed(script: &str, span: Range<usize>) -> Range<usize> {
    let text = &script[span.clone()];
    let start = span.start + text.len() - text.trim_start().len();
    start..start + text.trim().len()
}

fn bytes(number: &str) -> Option<u64> {
    let (digits, unit) = match number.strip_suffix(['K', 'k']) {
        Some(digits) => (digits, 1 << 10),
        None => match number.strip_suffix(['M', 'm']) {
            Some(digits) => (digits, 1 << 20),
            None => (number, 1),
        },
    };
    let count = match digits.strip_prefix("0x").or(digits.strip_prefix("0X")) {
        Some(digits) => u64::from_str_radix(digits, 16),
        None => digits.parse(),
    };
    count.ok()?.checked_mul(unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_board_has_both_regions() {
        let board = Memory::of_the_board();
        assert_eq!(Ok(board), Memory::parse("memory.x", BOARD));
        assert!(board.ram > 0 && board.for_tables() + CODE == board.flash);
    }

    #[test]
    fn scripts_are_read_as_the_linker_does() {
        for script in [
            "MEMORY\n{\n  FLASH (rx) : ORIGIN = 0x08000000, LENGTH = 512K\n  RAM : ORIGIN = 0x20000000, LENGTH = 96K\n}\n",
            "MEMORY { FLASH : org = 0, len = 0x80000; RAM : o = 0x20000000, l = 98304 }",
            "/* RAM : LENGTH = 1K */\nMEMORY {\n RAM(rwx): ORIGIN = 1, LENGTH = /* all */ 96k\n CCMRAM : LENGTH = 8K\n FLASH : LENGTH = 524288 }",
        ] {
            let memory =
                Memory::parse("memory.x", script).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(
                (memory.flash, memory.ram),
                (512 << 10, 96 << 10),
                "{script}"
            );
        }
        let small = Memory {
            flash: 64 << 10,
            ram: 1,
        };
        assert_eq!(small.for_tables(), 32 << 10);
    }

    #[test]
    fn what_is_no_memory_is_shown_with_its_place() {
        let ram = "RAM : ORIGIN = 0x20000000, LENGTH = 64K";
        for (script, words, place) in [
            (format!("{ram}\n"), "no memory region FLASH", None),
            (
                format!("FLASH : LENGTH = 2K\n{ram}\n  {ram}"),
                "RAM is given twice",
                Some((3, 3)),
            ),
            (
                format!("FLASH : ORIGIN = 0\n{ram}"),
                "FLASH has no LENGTH",
                Some((1, 1)),
            ),
            (
                format!("{ram}\nFLASH : LENGTH = 1M - 4K"),
                "not a number",
                Some((2, 18)),
            ),
            (
                format!("{ram}\nFLASH : LENGTH = 0x0"),
                "is empty",
                Some((2, 18)),
            ),
            (
                format!("{ram}\nFLASH : LENGTH = 99999999999999M"),
                "not a number",
                Some((2, 18)),
            ),
        ] {
            let error = Memory::parse("memory.x", &script).unwrap_err();
            assert!(error.message.contains(words), "{error}");
            assert_eq!(error.line.zip(error.column), place, "{error}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "(FLASH|RAM|LENGTH|[:=,{};/*\n KM0-9xé]){0,40}") {
            let _ = Memory::parse("memory.x", &text);
        }
    }
}
