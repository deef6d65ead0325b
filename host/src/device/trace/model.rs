//! Cycles of single instructions.

/// What an instruction costs, as far as it says so itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    /// So many cycles.
    Fixed(u32),
    /// A single load or store: 2, or 1 right behind another.
    Memory,
}

/// The model of a Cortex-M4F's cycles, stated here and nowhere else.
///
/// | instruction | cycles |
/// | --- | --- |
/// | integer and FPU arithmetic, moves, compares, products (also to 64 bits) | 1 |
/// | VDIV, VSQRT | 14 |
/// | VMLA, VFMA and their negations | 3 |
/// | SDIV, UDIV | 12, the most they take |
/// | LDR, STR, VLDR, VSTR | 2, then 1 right behind another |
/// | LDRD, STRD, LDM, STM, PUSH, POP, VLDM, VSTM, VPUSH, VPOP of N words | 1 + N |
/// | a branch, call or return that is taken | 2 more |
///
/// After Arm's technical reference manual of the Cortex-M4 (r0p1, 3.3.1 and
/// 7.2.3). Left out: stalls of a result that is used at once, wait states of
/// the flash, and lazy stacking. A model for comparing rungs with each other,
/// not a promise of a part's time: ±20 % is to be expected of silicon, in the
/// same direction for all rungs.
pub(super) fn weight(instruction: &str) -> Weight {
    let (name, operands) = instruction
        .split_once(char::is_whitespace)
        .unwrap_or((instruction, ""));
    let stem = name.split('.').next().unwrap_or(name);
    let begins = |prefixes: &[&str]| prefixes.iter().any(|prefix| stem.starts_with(prefix));
    if begins(&["vdiv", "vsqrt"]) {
        Weight::Fixed(14)
    } else if begins(&["vmla", "vmls", "vnml", "vfma", "vfms", "vfnm"]) {
        Weight::Fixed(3)
    } else if begins(&["sdiv", "udiv"]) {
        Weight::Fixed(12)
    } else if begins(&["ldrd", "strd"]) {
        Weight::Fixed(3)
    } else if begins(&["push", "pop", "vpush", "vpop", "ldm", "stm", "vldm", "vstm"]) {
        Weight::Fixed(1 + words(operands))
    } else if begins(&["ldr", "str", "vldr", "vstr"]) {
        Weight::Memory
    } else {
        Weight::Fixed(1)
    }
}

/// Words in a register list, `{r4-r7, lr}` or `{d8-d11}`.
fn words(operands: &str) -> u32 {
    let list = operands
        .split_once('{')
        .and_then(|(_, rest)| rest.split_once('}'))
        .map_or("", |(list, _)| list);
    let index = |name: &str| name.get(1..).and_then(|digits| digits.parse::<u32>().ok());
    let names = list
        .split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty());
    names
        .map(|name| {
            let each = if name.starts_with('d') { 2 } else { 1 };
            let range = name.split_once('-').and_then(|(from, to)| {
                Some(index(to.trim())?.saturating_sub(index(from.trim())?) + 1)
            });
            each * range.unwrap_or(1)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_weigh_what_the_table_says() {
        for (instruction, cycles) in [
            ("vdiv.f32\ts0, s1, s2", 14),
            ("vsqrt.f32\ts0, s0", 14),
            ("vmul.f32\ts0, s1, s2", 1),
            ("vfma.f32\ts0, s1, s2", 3),
            ("push.w\t{r4, r5, lr}", 4),
            ("vpop\t{d8-d11}", 9),
            ("vpush\t{d8, d9}", 5),
            ("ldrd\tr0, r1, [sp]", 3),
            ("smull\tr0, r1, r2, r3", 1),
            ("vmrs\tAPSR_nzcv, fpscr", 1),
        ] {
            assert_eq!(weight(instruction), Weight::Fixed(cycles), "{instruction}");
        }
        for instruction in ["ldr.w\tr0, [r1]", "vldr\ts0, [sp, #4]", "strb\tr0, [r1]"] {
            assert_eq!(weight(instruction), Weight::Memory, "{instruction}");
        }
    }
}
