//! The worst-case stack of functions, from the linked program alone.
//!
//! The program is disassembled; every function's frame is what its
//! instructions take off the stack pointer, and its bound is that frame plus
//! the largest bound of what it calls. Instructions are summed in a straight
//! line, whatever path is taken: an upper bound. What would make it a guess is
//! refused: an indirect call, recursion, a stack pointer set from a register.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use super::error::Error;

/// The bound of one function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bound {
    /// Bytes of stack that it and all it calls can take at the most.
    pub bytes: u64,
    /// The calls that take the most stack, from the function down.
    pub path: Vec<String>,
}

/// The bounds of some functions of a program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bounds {
    /// By name.
    pub functions: BTreeMap<String, Bound>,
    /// Bytes of code that can be reached from any of them, themselves included.
    pub code: u64,
}

impl Bounds {
    /// The largest of the bounds, in bytes.
    pub fn deepest(&self) -> u64 {
        let all = self.functions.values().map(|bound| bound.bytes);
        all.max().unwrap_or(0)
    }
}

/// The bounds of every function of a linked program whose name begins with
/// `prefix`. `disassembler` is an llvm-objdump.
///
/// # Errors
/// [`Error::Unbounded`] where a function within reach is recursive, calls
/// through a pointer, or moves the stack pointer by an amount that is not in
/// the code; [`Error::Program`] where no function has that prefix or the
/// disassembly is not what this reads.
pub fn bounds(disassembler: &Path, program: &Path, prefix: &str) -> Result<Bounds, Error> {
    let output = Command::new(disassembler)
        .args(["--disassemble", "--no-show-raw-insn", "--demangle"])
        .args(["--mattr=+vfp4,+dsp,+thumb2"])
        .arg(program)
        .output()
        .map_err(Error::io(format!("running {}", disassembler.display())))?;
    if !output.status.success() {
        return Err(Error::Program {
            what: String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        });
    }
    Program::read(&String::from_utf8_lossy(&output.stdout))?.bounds(prefix)
}

/// A function as disassembled.
#[derive(Clone, Debug, Default)]
struct Function {
    name: String,
    frame: u64,
    size: u64,
    /// Addresses it calls or jumps to, itself only where it calls itself.
    calls: BTreeSet<u64>,
    hazard: Option<&'static str>,
}

/// A disassembled program: functions by address.
#[derive(Debug, Default)]
struct Program {
    functions: BTreeMap<u64, Function>,
}

/// What one instruction means for the stack.
#[derive(Debug, PartialEq, Eq)]
enum Effect {
    None,
    /// Takes so many bytes.
    Takes(u64),
    /// A call that comes back.
    Calls(u64),
    /// A jump, within the function or for good.
    Jumps(u64),
    Hazard(&'static str),
}

const INDIRECT: &str = "it jumps or calls through a register";
const MOVED: &str = "it moves the stack pointer by an amount that is not in the code";
const RECURSIVE: &str = "it is recursive";

impl Program {
    /// Reads llvm-objdump's output.
    fn read(disassembly: &str) -> Result<Self, Error> {
        let mut program = Self::default();
        // Jumps are told from tail calls once every function's end is known.
        let mut jumps: Vec<(u64, u64)> = Vec::new();
        let mut current = None;
        for line in disassembly.lines() {
            if let Some((address, name)) = header(line) {
                program.functions.entry(address).or_default().name = name.to_owned();
                current = Some(address);
                continue;
            }
            let (Some(start), Some((address, instruction))) = (current, instruction(line)) else {
                continue;
            };
            let Some(function) = program.functions.get_mut(&start) else {
                continue;
            };
            // To within the last instruction's second half.
            function.size = address + 2 - start;
            match effect(instruction) {
                Effect::None => {}
                Effect::Takes(bytes) => function.frame += bytes,
                Effect::Calls(target) => {
                    function.calls.insert(target);
                }
                Effect::Jumps(target) => jumps.push((start, target)),
                Effect::Hazard(why) => function.hazard = Some(why),
            }
        }
        if program.functions.is_empty() {
            return Err(Error::Program {
                what: "its disassembly holds no function".to_owned(),
            });
        }
        for (start, target) in jumps {
            let into = program.containing(target);
            if into != Some(start)
                && let Some(function) = program.functions.get_mut(&start)
            {
                function.calls.insert(target);
            }
        }
        Ok(program)
    }

    /// The start of the function that an address lies in.
    fn containing(&self, address: u64) -> Option<u64> {
        self.functions
            .range(..=address)
            .next_back()
            .map(|(&start, _)| start)
    }

    fn bounds(&self, prefix: &str) -> Result<Bounds, Error> {
        let mut known = BTreeMap::new();
        let mut reached = BTreeSet::new();
        let mut bounds = Bounds::default();
        for (&start, function) in &self.functions {
            if !function.name.starts_with(prefix) {
                continue;
            }
            let (bytes, path) = self.deepest(start, &mut Vec::new(), &mut known)?;
            self.reach(start, &mut reached);
            let path = path
                .iter()
                .filter_map(|start| self.functions.get(start))
                .map(|function| function.name.clone())
                .collect();
            let name = function.name.clone();
            bounds.functions.insert(name, Bound { bytes, path });
        }
        if bounds.functions.is_empty() {
            return Err(Error::Program {
                what: format!("no function's name begins with {prefix}"),
            });
        }
        bounds.code = reached
            .iter()
            .filter_map(|start| self.functions.get(start))
            .map(|function| function.size)
            .sum();
        Ok(bounds)
    }

    /// The bound of a function and the path that has it. `above` is the chain
    /// of callers: meeting one again is recursion.
    fn deepest(
        &self,
        start: u64,
        above: &mut Vec<u64>,
        known: &mut BTreeMap<u64, (u64, Vec<u64>)>,
    ) -> Result<(u64, Vec<u64>), Error> {
        if let Some(found) = known.get(&start) {
            return Ok(found.clone());
        }
        let Some(function) = self.functions.get(&start) else {
            return Err(Error::Program {
                what: format!("nothing is at {start:#x}, which is called"),
            });
        };
        let refuse = |why| Error::Unbounded {
            function: function.name.clone(),
            why,
        };
        if above.contains(&start) {
            return Err(refuse(RECURSIVE));
        }
        if let Some(why) = function.hazard {
            return Err(refuse(why));
        }
        above.push(start);
        let mut deepest = (0, Vec::new());
        for &target in &function.calls {
            let callee = self.containing(target).unwrap_or(target);
            let found = self.deepest(callee, above, known)?;
            if deepest.1.is_empty() || found.0 > deepest.0 {
                deepest = found;
            }
        }
        above.pop();
        let mut path = vec![start];
        path.extend(deepest.1);
        let found = (function.frame + deepest.0, path);
        known.insert(start, found.clone());
        Ok(found)
    }

    /// Every function within reach of one.
    fn reach(&self, start: u64, reached: &mut BTreeSet<u64>) {
        if reached.insert(start)
            && let Some(function) = self.functions.get(&start)
        {
            for &target in &function.calls {
                if let Some(callee) = self.containing(target) {
                    self.reach(callee, reached);
                }
            }
        }
    }
}

/// `000009bc <name>:`
fn header(line: &str) -> Option<(u64, &str)> {
    let (address, name) = line.strip_suffix(">:")?.split_once(" <")?;
    Some((u64::from_str_radix(address, 16).ok()?, name))
}

/// `     9bc:       push {r4, lr}`: the address and the rest.
fn instruction(line: &str) -> Option<(u64, &str)> {
    let (address, rest) = line.trim_start().split_once(':')?;
    Some((u64::from_str_radix(address, 16).ok()?, rest.trim()))
}

/// What an instruction means for the stack.
fn effect(instruction: &str) -> Effect {
    let (name, operands) = instruction
        .split_once(char::is_whitespace)
        .unwrap_or((instruction, ""));
    let operands = operands.trim();
    let stem = name.trim_end_matches(".w").trim_end_matches(".n");
    let first = operands.split(',').next().unwrap_or("").trim();
    match stem {
        "push" | "vpush" => Effect::Takes(registers(operands)),
        "bl" => target(operands).map_or(Effect::Hazard(INDIRECT), Effect::Calls),
        "blx" => Effect::Hazard(INDIRECT),
        "bx" if first != "lr" => Effect::Hazard(INDIRECT),
        "stmdb" | "vstmdb" if first == "sp!" => Effect::Takes(registers(operands)),
        "ldr" if first == "pc" && !operands.contains("[sp]") => Effect::Hazard(INDIRECT),
        "mov" | "add" if first == "pc" => Effect::Hazard(INDIRECT),
        "sub" | "subw" | "add" | "addw" | "mov" if first == "sp" => {
            match (stem.starts_with("sub"), immediate(operands)) {
                (true, Some(bytes)) => Effect::Takes(bytes),
                (false, Some(_)) if stem.starts_with("add") => Effect::None,
                _ => Effect::Hazard(MOVED),
            }
        }
        _ if operands.contains("[sp, #-") => before(operands),
        _ if is_branch(stem) => target(operands).map_or(Effect::Hazard(INDIRECT), Effect::Jumps),
        // Anything else that writes the stack pointer.
        _ if first == "sp" && !stem.starts_with("cmp") && !stem.starts_with("cmn") => {
            Effect::Hazard(MOVED)
        }
        _ => Effect::None,
    }
}

/// `b`, its conditional forms, and the branches that compare with 0.
fn is_branch(stem: &str) -> bool {
    const CONDITIONS: [&str; 15] = [
        "", "eq", "ne", "hs", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le",
    ];
    matches!(stem, "cbz" | "cbnz")
        || stem
            .strip_prefix('b')
            .is_some_and(|condition| CONDITIONS.contains(&condition))
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

    /// As llvm-objdump writes it.
    const PROGRAM: &str = "
Disassembly of section .text:

00000400 <entry_a>:
     400:      \tpush\t{r4, r5, r7, lr}
     402:      \tvpush\t{d8, d9}
     406:      \tsub\tsp, #0x28
     408:      \tcbz\tr0, 0x40e <entry_a+0xe>
     40a:      \tbl\t0x420 <core::leaf<f32>>
     40e:      \tadd\tsp, #0x28
     410:      \tvpop\t{d8, d9}
     414:      \tpop\t{r4, r5, r7, pc}

00000420 <core::leaf<f32>>:
     420:      \tstr\tlr, [sp, #-8]!
     424:      \tbne\t0x428 <core::leaf<f32>+0x8>
     426:      \tldr\tpc, [sp], #8
     428:      \tb.w\t0x440 <tail>

00000440 <tail>:
     440:      \tpush.w\t{r8, r9, r10, r11}
     444:      \tbx\tlr

00000450 <entry_loop>:
     450:      \tbl\t0x460 <back>

00000460 <back>:
     460:      \tbl\t0x450 <entry_loop>

00000470 <entry_pointer>:
     470:      \tblx\tr0

00000480 <entry_alloca>:
     480:      \tsub.w\tsp, sp, r1
";

    #[test]
    fn frames_add_up_along_the_deepest_path() {
        let program = Program::read(PROGRAM).expect("functions");
        let bounds = program.bounds("entry_a").err();
        assert!(bounds.is_some(), "entry_alloca begins with entry_a as well");
        let bounds = program.bounds("entry_a>").err();
        assert!(bounds.is_some(), "no such function");
        let (bytes, path) = program
            .deepest(0x400, &mut Vec::new(), &mut BTreeMap::new())
            .expect("bounded");
        assert_eq!(bytes, (16 + 16 + 0x28) + 8 + 16);
        assert_eq!(path, [0x400, 0x420, 0x440]);
    }

    #[test]
    fn what_has_no_bound_is_refused() {
        let program = Program::read(PROGRAM).expect("functions");
        for (name, reason) in [
            ("entry_loop", RECURSIVE),
            ("entry_pointer", INDIRECT),
            ("entry_alloca", MOVED),
        ] {
            match program.bounds(name) {
                Err(Error::Unbounded { why, .. }) => assert_eq!(why, reason, "{name}"),
                other => panic!("{name}: {other:?}"),
            }
        }
    }

    #[test]
    fn register_lists_have_a_size() {
        assert_eq!(registers("{r4, r5, lr}"), 12);
        assert_eq!(registers("{d8-d11}"), 32);
        assert_eq!(registers("sp!, {r4-r11, lr}"), 36);
        assert_eq!(registers("{s16, s17}"), 8);
    }
}
