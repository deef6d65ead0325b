//! Bytes of flash and RAM a linked program takes, from its sections and symbols.

use object::elf::{SHF_ALLOC, SHT_NOBITS};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind};

use std::collections::{BTreeMap, BTreeSet};

use super::error::Error;

/// The baked tables among the symbols of a firmware: `baked::TABLES`, each word with
/// its length before it.
const TABLES: &str = "5baked6TABLES";

/// The bytes a linked program takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sizes {
    /// Flash: code, constants, tables, and the image of initialised statics.
    pub(crate) flash: u64,
    /// The part of `flash` that is the baked tables.
    pub(crate) tables: u64,
    /// RAM of statics: the kernel's state and buffers; the stack is apart.
    pub(crate) ram: u64,
}

/// Reads the sizes of an ELF program.
pub(crate) fn of(program: &[u8]) -> Result<Sizes, Error> {
    let elf = parse(program)?;
    let mut sizes = Sizes::default();
    // What follows another section may begin at a multiple of eight bytes.
    let (mut end, mut images) = (0, 0);
    for section in elf.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        if sh_flags & u64::from(SHF_ALLOC) == 0 {
            continue;
        }
        let empty = section.elf_section_header().sh_type.get(elf.endian()) == SHT_NOBITS;
        let writable = matches!(
            section.kind(),
            SectionKind::Data | SectionKind::UninitializedData
        );
        match (empty || section.size() == 0, writable) {
            (false, true) => images += section.size(),
            (false, false) => end = end.max(section.address() + section.size()),
            _ => {}
        }
        if empty || writable {
            sizes.ram += section.size();
        }
    }
    // Flash begins at 0, with the vector table.
    sizes.flash = end + images;
    sizes.tables = elf
        .symbols()
        .find(|symbol| symbol.name().is_ok_and(|name| name.contains(TABLES)))
        .map(|symbol| symbol.size())
        .ok_or_else(|| Error::Program {
            what: "no symbol `baked::TABLES`".to_owned(),
        })?;
    Ok(sizes)
}

/// Bytes of a program's code and of its constants.
pub(crate) fn code_and_constants(program: &[u8]) -> Result<(u64, u64), Error> {
    let elf = parse(program)?;
    let bytes = |name| {
        elf.section_by_name(name)
            .map_or(0, |section| section.size())
    };
    Ok((bytes(".text"), bytes(".rodata")))
}

/// The mangled names of every function in a program: those of its symbols, and
/// those that the optimiser has put into others, from the debugger's strings.
pub(crate) fn function_names(program: &[u8]) -> Result<BTreeSet<String>, Error> {
    let elf = parse(program)?;
    let mut names: BTreeSet<String> = elf
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text)
        .filter_map(|symbol| symbol.name().ok().map(str::to_owned))
        .collect();
    let strings = elf.section_by_name(".debug_str");
    let strings = strings.ok_or_else(|| Error::Program {
        what: "it has no .debug_str; the profile asks for it".to_owned(),
    })?;
    let strings = strings.data().map_err(|error| Error::Program {
        what: error.to_string(),
    })?;
    let strings = strings.split(|&byte| byte == 0);
    let mangled = strings.filter(|name| name.starts_with(b"_ZN") || name.starts_with(b"_R"));
    names.extend(mangled.map(|name| String::from_utf8_lossy(name).into_owned()));
    Ok(names)
}

/// Bytes of code of each function that states them, by address.
pub(crate) fn functions(program: &[u8]) -> Result<BTreeMap<u64, u64>, Error> {
    Ok(parse(program)?
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
        // Bit 0 of a function's address only says that it is Thumb code.
        .map(|symbol| (symbol.address() & !1, symbol.size()))
        .collect())
}

/// The functions whose names begin with `prefix`, name and address. Two have
/// one address where the optimiser found them to be the same.
pub(crate) fn named(program: &[u8], prefix: &str) -> Result<Vec<(String, u64)>, Error> {
    let elf = parse(program)?;
    let text = elf
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text);
    Ok(text
        .filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.address() & !1)))
        .filter(|(name, _)| name.starts_with(prefix))
        .collect())
}

fn parse(program: &[u8]) -> Result<ElfFile32<'_>, Error> {
    ElfFile32::parse(program).map_err(|error| Error::Program {
        what: error.to_string(),
    })
}
