//! What single Thumb instructions mean for the stack, as llvm-objdump writes
//! them.

/// What one instruction means for the stack.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Effect {
    None,
    /// Takes so many bytes.
    Takes(u64),
    /// A call that comes back.
    Calls(u64),
    /// A jump, within the function or for good.
    Jumps(u64),
    Hazard(&'static str),
}

/// Why a call through a register has no bound.
pub(super) const INDIRECT: &str = "it jumps or calls through a register";
/// Why a stack pointer from a register has no bound.
pub(super) const MOVED: &str = "it moves the stack pointer by an amount that is not in the code";

/// What an instruction means for the stack.
pub(super) fn effect(instruction: &str) -> Effect {
    let (name, operands) = instruction
        .split_once(char::is_whitespace)
        .unwrap_or((instruction, ""));
    let operands = operands.trim();
    let name = name.trim_end_matches(".w").trim_end_matches(".n");
    let stem = unconditional(name);
    let first = operands.split(',').next().unwrap_or("").trim();
    match stem {
        "push" | "vpush" => Effect::Takes(registers(operands)),
        "bl" => target(operands).map_or(Effect::Hazard(INDIRECT), Effect::Calls),
        "b" | "cbz" | "cbnz" => target(operands).map_or(Effect::Hazard(INDIRECT), Effect::Jumps),
        "blx" => Effect::Hazard(INDIRECT),
        "bx" if first != "lr" => Effect::Hazard(INDIRECT),
        "stmdb" | "vstmdb" if first == "sp!" => Effect::Takes(registers(operands)),
        "ldr" if first == "pc" && !operands.contains("[sp]") => Effect::Hazard(INDIRECT),
        "mov" | "add" if first == "pc" => Effect::Hazard(INDIRECT),
        // A return where it is from the stack, else a jump to what was loaded.
        "ldm" | "ldmia" | "ldmdb" if operands.contains("pc") && first != "sp!" => {
            Effect::Hazard(INDIRECT)
        }
        "sub" | "subw" if first == "sp" => {
            immediate(operands).map_or(Effect::Hazard(MOVED), Effect::Takes)
        }
        "add" | "addw" if first == "sp" => {
            immediate(operands).map_or(Effect::Hazard(MOVED), |_| Effect::None)
        }
        _ if operands.contains("[sp, #-") => before(operands),
        "msr" => Effect::Hazard(MOVED),
        "cmp" | "cmn" | "tst" | "str" => Effect::None,
        // Through the stack pointer, which stays: without the `!` of a write-back.
        "stm" | "stmia" | "vstmia" | "ldm" | "ldmia" | "vldmia" if first == "sp" => Effect::None,
        // Anything else that writes the stack pointer.
        _ if first == "sp" => Effect::Hazard(MOVED),
        _ => Effect::None,
    }
}

/// An instruction's name without the condition of an IT block or a branch.
fn unconditional(name: &str) -> &str {
    const CONDITIONS: [&str; 16] = [
        "eq", "ne", "hs", "cs", "lo", "cc", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt",
        "le",
    ];
    const STEMS: [&str; 17] = [
        "push", "vpush", "bl", "b", "blx", "bx", "stmdb", "vstmdb", "ldr", "mov", "add", "addw",
        "sub", "subw", "cmp", "cmn", "str",
    ];
    STEMS
        .into_iter()
        .find(|stem| {
            name.strip_prefix(stem)
                .is_some_and(|condition| CONDITIONS.contains(&condition))
        })
        .unwrap_or(name)
}

/// The address a branch names, `0x9bc <name+0x10>`; the last operand.
fn target(operands: &str) -> Option<u64> {
    let before_name = operands.split('<').next().unwrap_or(operands);
    let address = before_name.split(',').next_back()?.trim();
    let address = address.trim_start_matches('#');
    u64::from_str_radix(address.strip_prefix("0x")?, 16).ok()
}

/// The last operand, if it is a number: `sp, sp, #0x40`.
fn immediate(operands: &str) -> Option<u64> {
    number(operands.split(',').next_back()?.trim().strip_prefix('#')?)
}

/// `[sp, #-0x10]!`: taken before the store; no `!`, nothing taken.
fn before(operands: &str) -> Effect {
    let Some((_, rest)) = operands.split_once("[sp, #-") else {
        return Effect::None;
    };
    match rest.split_once("]!") {
        Some((bytes, _)) => number(bytes).map_or(Effect::Hazard(MOVED), Effect::Takes),
        None => Effect::None,
    }
}

fn number(text: &str) -> Option<u64> {
    match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// Bytes of a register list, `{r4, r5, lr}` or `{d8-d11}`.
fn registers(operands: &str) -> u64 {
    let list = operands
        .split_once('{')
        .and_then(|(_, rest)| rest.split_once('}'))
        .map_or("", |(list, _)| list);
    let index = |name: &str| name.get(1..).and_then(|digits| digits.parse::<u64>().ok());
    list.split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty())
        .map(|name| {
            let width = if name.starts_with('d') { 8 } else { 4 };
            let count = match name.split_once('-') {
                Some((from, to)) => match (index(from.trim()), index(to.trim())) {
                    (Some(from), Some(to)) => to.saturating_sub(from) + 1,
                    _ => 16,
                },
                None => 1,
            };
            width * count
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_no_part_of_the_name() {
        assert_eq!(effect("blne\t0x440 <tail>"), Effect::Calls(0x440));
        assert_eq!(effect("bls\t0x440 <tail>"), Effect::Jumps(0x440));
        assert_eq!(effect("blxeq\tr3"), Effect::Hazard(INDIRECT));
        assert_eq!(effect("subne\tsp, #0x8"), Effect::Takes(8));
        assert_eq!(effect("bxeq\tlr"), Effect::None);
        assert_eq!(effect("bfi\tr0, r1, #0x3, #0x4"), Effect::None);
        assert_eq!(effect("mov\tsp, r4"), Effect::Hazard(MOVED));
        assert_eq!(effect("stm.w\tsp, {r0, r3, r4}"), Effect::None);
        assert_eq!(effect("ldm\tsp, {r0, pc}"), Effect::Hazard(INDIRECT));
        assert_eq!(effect("ldm.w\tr0, {r4, pc}"), Effect::Hazard(INDIRECT));
        assert_eq!(effect("ldm.w\tsp!, {r4, pc}"), Effect::None);
        assert_eq!(effect("add\tsp, r1"), Effect::Hazard(MOVED));
        assert_eq!(effect("bic\tsp, sp, #0x7"), Effect::Hazard(MOVED));
        assert_eq!(effect("ldr\tpc, [r0, r1]"), Effect::Hazard(INDIRECT));
        assert_eq!(effect("ldr\tpc, [sp], #4"), Effect::None);
    }

    #[test]
    fn register_lists_have_a_size() {
        assert_eq!(registers("{r4, r5, lr}"), 12);
        assert_eq!(registers("{d8-d11}"), 32);
        assert_eq!(registers("sp!, {r4-r11, lr}"), 36);
        assert_eq!(registers("{s16, s17}"), 8);
    }
}
