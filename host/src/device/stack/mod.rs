//! The worst-case stack of functions, from the linked program alone.
//!
//! The program is disassembled; every function's frame is what its
//! instructions take off the stack pointer, and its bound is that frame plus
//! the largest bound of what it calls. Instructions are summed in a straight
//! line, whatever path is taken: an upper bound. What would make it a guess is
//! refused: an indirect call, recursion, a stack pointer set from a register.

mod instruction;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

use super::error::Error;
use super::size;
use instruction::{Effect, effect};

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
    /// The functions that can be reached, bytes of code by address.
    pub reached: BTreeMap<u64, u64>,
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
    let disassembly = disassemble(disassembler, program)?;
    let bytes = fs::read(program).map_err(Error::io(format!("reading {}", program.display())))?;
    let sizes = size::functions(&bytes)?;
    let functions = size::named(&bytes, prefix)?;
    if functions.is_empty() {
        return Err(Error::Program {
            what: format!("no function's name begins with {prefix}"),
        });
    }
    Program::read(&disassembly, &sizes)?.bounds(&functions)
}

/// What llvm-objdump says of a linked program.
pub(super) fn disassemble(disassembler: &Path, program: &Path) -> Result<String, Error> {
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
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
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

const RECURSIVE: &str = "it is recursive";

impl Program {
    /// Reads llvm-objdump's output. `sizes` are the bytes of functions by
    /// address: behind the end of one the linker pads with what would
    /// disassemble to a jump.
    fn read(disassembly: &str, sizes: &BTreeMap<u64, u64>) -> Result<Self, Error> {
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
            match sizes.get(&start) {
                Some(&size) if address >= start + size => continue,
                Some(&size) => function.size = size,
                // Assembly need not state a size.
                None => function.size = address + 2 - start,
            }
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

    /// The bounds of functions given by name and address.
    fn bounds(&self, functions: &[(String, u64)]) -> Result<Bounds, Error> {
        let mut known = BTreeMap::new();
        let mut reached = BTreeSet::new();
        let mut bounds = Bounds::default();
        for (name, start) in functions {
            let start = *start;
            let (bytes, path) = self.deepest(start, &mut Vec::new(), &mut known)?;
            self.reach(start, &mut reached);
            let path = path
                .iter()
                .filter_map(|start| self.functions.get(start))
                .map(|function| function.name.clone())
                .collect();
            bounds.functions.insert(name.clone(), Bound { bytes, path });
        }
        bounds.reached = reached
            .iter()
            .filter_map(|start| Some((*start, self.functions.get(start)?.size)))
            .collect();
        bounds.code = bounds.reached.values().sum();
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
pub(super) fn header(line: &str) -> Option<(u64, &str)> {
    let (address, name) = line.strip_suffix(">:")?.split_once(" <")?;
    Some((u64::from_str_radix(address, 16).ok()?, name))
}

/// `     9bc:       push {r4, lr}   @ comment`: the address and the instruction.
pub(super) fn instruction(line: &str) -> Option<(u64, &str)> {
    let (address, rest) = line.trim_start().split_once(':')?;
    let rest = rest.split(" @ ").next().unwrap_or(rest);
    Some((u64::from_str_radix(address, 16).ok()?, rest.trim()))
}

#[cfg(test)]
mod tests {
    use super::instruction::{INDIRECT, MOVED};
    use super::*;

    /// As llvm-objdump writes it.
    const PROGRAM: &str = "
Disassembly of section .text:

00000400 <entry_a>:
     400:      \tpush\t{r4, r5, r7, lr}
     402:      \tvpush\t{d8, d9}
     406:      \tsub\tsp, #0x28
     408:      \tcbz\tr0, 0x40e <entry_a+0xe>
     40a:      \tblne\t0x420 <core::leaf<f32>>  @ imm = #0x12
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
     446:      \tbmi\t0x404 <entry_a+0x4>

00000450 <entry_loop>:
     450:      \tbl\t0x460 <back>

00000460 <back>:
     460:      \tbl\t0x450 <entry_loop>

00000470 <entry_pointer>:
     470:      \tblx\tr0

00000480 <entry_alloca>:
     480:      \tsub.w\tsp, sp, r1
";

    /// The jump behind `tail` is padding.
    fn sizes() -> BTreeMap<u64, u64> {
        BTreeMap::from([(0x440, 6)])
    }

    #[test]
    fn frames_add_up_along_the_deepest_path() {
        let program = Program::read(PROGRAM, &sizes()).expect("functions");
        let twice = [("one".to_owned(), 0x400), ("other".to_owned(), 0x400)];
        let bounds = program.bounds(&twice).expect("bounded");
        assert_eq!(bounds.functions["one"], bounds.functions["other"]);
        assert_eq!(bounds.reached.len(), 3);
        let (bytes, path) = program
            .deepest(0x400, &mut Vec::new(), &mut BTreeMap::new())
            .expect("bounded");
        assert_eq!(bytes, (16 + 16 + 0x28) + 8 + 16);
        assert_eq!(path, [0x400, 0x420, 0x440]);
    }

    #[test]
    fn what_has_no_bound_is_refused() {
        let program = Program::read(PROGRAM, &sizes()).expect("functions");
        for (name, start, reason) in [
            ("entry_loop", 0x450, RECURSIVE),
            ("entry_pointer", 0x470, INDIRECT),
            ("entry_alloca", 0x480, MOVED),
        ] {
            match program.bounds(&[(name.to_owned(), start)]) {
                Err(Error::Unbounded { why, .. }) => assert_eq!(why, reason, "{name}"),
                other => panic!("{name}: {other:?}"),
            }
        }
    }
}
