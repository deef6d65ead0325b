//! Bytes of flash and RAM a linked program takes, from its sections and symbols.

use object::elf::{SHF_ALLOC, SHT_NOBITS};
use object::read::elf::ElfFile32;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind};

use std::collections::BTreeMap;

use super::error::Error;

/// The symbol of the baked tables in the firmware.
const TABLES: &str = "ISOLUX_TABLES";

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
    let broken = |what: String| Error::Program { what };
    let elf: ElfFile32<'_> =
        ElfFile32::parse(program).map_err(|error| broken(error.to_string()))?;
    let mut sizes = Sizes::default();
    for section in elf.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        if sh_flags & u64::from(SHF_ALLOC) == 0 {
            continue;
        }
        let empty = section.elf_section_header().sh_type.get(elf.endian()) == SHT_NOBITS;
        if !empty {
            sizes.flash += section.size();
        }
        let writable = matches!(
            section.kind(),
            SectionKind::Data | SectionKind::UninitializedData
        );
        if empty || writable {
            sizes.ram += section.size();
        }
    }
    sizes.tables = elf
        .symbols()
        .find(|symbol| symbol.name() == Ok(TABLES))
        .map(|symbol| symbol.size())
        .ok_or_else(|| broken(format!("no symbol {TABLES}")))?;
    Ok(sizes)
}

/// Bytes of code of each function that states them, by address.
pub(crate) fn functions(program: &[u8]) -> Result<BTreeMap<u64, u64>, Error> {
    let elf: ElfFile32<'_> = ElfFile32::parse(program).map_err(|error| Error::Program {
        what: error.to_string(),
    })?;
    Ok(elf
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
        // Bit 0 of a function's address only says that it is Thumb code.
        .map(|symbol| (symbol.address() & !1, symbol.size()))
        .collect())
}
