//! Cycles of form factors, estimated from every instruction they execute.
//!
//! The emulator counts instructions, all alike; a division is not like a move.
//! So it is asked to log the address of every instruction inside the rungs'
//! functions (one instruction a block, `-d exec,nochain` and a filter of
//! addresses), and each is weighted by what the disassembly has there ([`model`]). Calls are
//! told apart by the addresses of a rung's entry and of a marker that the
//! program calls behind it.

mod model;

use std::collections::{BTreeMap, VecDeque};
use std::io::{BufRead, BufReader, Read};
use std::time::Duration;

use super::cost::{self, Cost};
use super::emulator::{self, Core};
use super::error::Error;
use super::firmware::{Build, Toolchain};
use super::stack;
use model::Weight;

/// Functions of the program that are rungs, and the marker behind them.
const PREFIX: &str = "isolux_rung_";
/// The marker.
const END: &str = "isolux_rung_end";

/// Instructions by which a counted call may differ from a traced one.
const CALL: u64 = 8;

/// What calls of a rung's form factor, or of its sum alone, execute.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// The calls, with the instructions that the program itself counted.
    pub cost: Cost,
    /// Instructions in the trace of all calls.
    pub instructions: u64,
    /// Estimated cycles of all calls.
    pub cycles: u64,
}

/// Traces the form factors of every rung on the Cortex-M4F; the model of
/// cycles is that core's.
///
/// # Errors
/// See [`Error`]; [`Error::Log`] where the trace is not the program's.
pub fn traces(time_limit: Duration) -> Result<Vec<Traced>, Error> {
    let core = Core::CortexM4F;
    let toolchain = Toolchain::find()?;
    toolchain.require(core)?;
    let disassembler = toolchain.tool("llvm-objdump")?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let program = directory.path().join(cost::PROGRAM);
    let build = Build {
        features: &["trace"],
        ..Build::of(cost::PROGRAM)
    };
    toolchain.link(core, &build, &program)?;
    let disassembly = stack::disassemble(&disassembler, &program)?;
    let rungs = Rungs::new(&disassembly)?;
    let mut ranges = BTreeMap::from([(rungs.end, 2)]);
    for name in rungs.entries.values() {
        ranges.extend(stack::bounds(&disassembler, &program, name)?.reached);
    }
    let filter: Vec<String> = ranges
        .iter()
        .map(|(start, size)| format!("{start:#x}+{size:#x}"))
        .collect();
    let filter = filter.join(",");
    let log = ["-d", "exec,nochain", "-dfilter", &filter];
    let arguments = emulator::one_by_one()?.iter().chain(&log);
    let arguments: Vec<String> = arguments.map(|word| (*word).to_owned()).collect();
    let (tables, entries) = (Tables::new(&disassembly), rungs.clone());
    let (status, console, trace) =
        emulator::run_reading(core, &program, &arguments, time_limit, move |pipe| {
            Trace::read(pipe, &tables, &entries)
        })?;
    let (costs, mut errors) = cost::read(&super::read(&program)?, &console)?;
    if status != Some(0) {
        errors.push(trace.complaints);
        return Err(Error::Firmware {
            core: core.name(),
            status,
            said: errors.join("; "),
        });
    }
    attribute(costs, trace.calls, &rungs)
}

/// Gives the calls of a trace to the lines of the program's log: both have
/// each rung's calls in the same order.
fn attribute(costs: Vec<Cost>, calls: Vec<Call>, rungs: &Rungs) -> Result<Vec<Traced>, Error> {
    let mut queues: BTreeMap<u64, VecDeque<Call>> = BTreeMap::new();
    for call in calls {
        queues.entry(call.entry).or_default().push_back(call);
    }
    let mut traced = Vec::new();
    for cost in costs
        .into_iter()
        .filter(|cost| ["form-factor", "ready-sum"].contains(&&*cost.operation))
    {
        let name = match cost.root.as_str() {
            "-" => format!("{PREFIX}{}", cost.rung),
            root => format!("{PREFIX}{}_{root}", cost.rung),
        };
        let entry = rungs.entries.iter().find(|(_, known)| **known == name);
        let few = || Error::Log {
            what: format!("the trace has too few calls of {name}"),
        };
        let (&entry, _) = entry.ok_or_else(few)?;
        let queue = queues.get_mut(&entry).ok_or_else(few)?;
        let (mut instructions, mut cycles) = (0, 0);
        for _ in 0..cost.calls {
            let call = queue.pop_front().ok_or_else(few)?;
            instructions += call.instructions;
            cycles += call.cycles;
        }
        // The call itself and its arguments are counted there, not here.
        let apart = cost.instructions.abs_diff(instructions);
        if apart > CALL * u64::from(cost.calls) {
            return Err(Error::Log {
                what: format!(
                    "{name} on {}: {instructions} instructions traced, {} counted",
                    cost.case, cost.instructions
                ),
            });
        }
        traced.push(Traced {
            cost,
            instructions,
            cycles,
        });
    }
    Ok(traced)
}

/// Where the rungs and the marker are.
#[derive(Clone, Debug)]
struct Rungs {
    entries: BTreeMap<u64, String>,
    end: u64,
}

impl Rungs {
    fn new(disassembly: &str) -> Result<Self, Error> {
        let mut entries: BTreeMap<u64, String> = disassembly
            .lines()
            .filter_map(stack::header)
            .filter(|(_, name)| name.starts_with(PREFIX))
            .map(|(address, name)| (address, name.to_owned()))
            .collect();
        let end = entries.iter().find(|(_, name)| *name == END);
        let end = end.map(|(&address, _)| address).ok_or(Error::Program {
            what: format!("it has no function {END}"),
        })?;
        entries.remove(&end);
        Ok(Self { entries, end })
    }
}

/// Weight and length of every instruction by address.
struct Tables(BTreeMap<u64, (Weight, u64)>);

impl Tables {
    fn new(disassembly: &str) -> Self {
        let mut table = BTreeMap::new();
        let mut lines = disassembly
            .lines()
            .filter_map(stack::instruction)
            .peekable();
        while let Some((address, instruction)) = lines.next() {
            // What follows the last instruction of all is nothing.
            let next = lines.peek().map_or(address, |&(next, _)| next);
            let length = next.saturating_sub(address);
            table.insert(address, (model::weight(instruction), length));
        }
        Self(table)
    }
}

/// One call of a rung.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Call {
    entry: u64,
    instructions: u64,
    cycles: u64,
}

/// What the emulator wrote.
#[derive(Debug, Default)]
struct Trace {
    calls: Vec<Call>,
    complaints: String,
    current: Option<Call>,
    /// The instruction before, and whether it was a single load or store.
    before: Option<(u64, bool)>,
}

impl Trace {
    fn read(pipe: impl Read, tables: &Tables, rungs: &Rungs) -> std::io::Result<Self> {
        let mut trace = Self::default();
        for line in BufReader::with_capacity(1 << 16, pipe).lines() {
            let line = line?;
            match address(&line) {
                Some(address) => trace.step(address, tables, rungs),
                None => trace.complaints.push_str(&line),
            }
        }
        Ok(trace)
    }

    /// Takes one executed instruction in.
    fn step(&mut self, address: u64, tables: &Tables, rungs: &Rungs) {
        if let Some(call) = &mut self.current
            && let Some((before, _)) = self.before
            && let Some(&(_, length)) = tables.0.get(&before)
            && address != before + length
        {
            call.cycles += 2;
        }
        if address == rungs.end {
            self.calls.extend(self.current.take());
            self.before = None;
            return;
        }
        if self.current.is_none() && rungs.entries.contains_key(&address) {
            self.current = Some(Call {
                entry: address,
                ..Call::default()
            });
            self.before = None;
        }
        let Some(call) = &mut self.current else {
            return;
        };
        let behind_memory = self.before.is_some_and(|(_, memory)| memory);
        let weight = tables.0.get(&address).map(|&(weight, _)| weight);
        call.instructions += 1;
        call.cycles += u64::from(match weight {
            Some(Weight::Memory) if behind_memory => 1,
            Some(Weight::Memory) => 2,
            Some(Weight::Fixed(cycles)) => cycles,
            None => 1,
        });
        self.before = Some((address, weight == Some(Weight::Memory)));
    }
}

/// `Trace 0: 0x7f80c0 [00400000/00000466/00000110/ff000000] name`: the second
/// number in the brackets.
fn address(line: &str) -> Option<u64> {
    let (_, rest) = line.strip_prefix("Trace ")?.split_once('[')?;
    let number = rest.split('/').nth(1)?;
    u64::from_str_radix(number, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROGRAM: &str = "
00000400 <isolux_rung_best_fpu>:
     400:      \tldr\tr0, [r1]
     402:      \tldr\tr2, [r1, #4]
     404:      \tvdiv.f32\ts0, s1, s2
     408:      \tbne\t0x40c <isolux_rung_best_fpu+0xc>
     40a:      \tnop
     40c:      \tbx\tlr

00000410 <between>:
     410:      \tnop

00000420 <isolux_rung_end>:
     420:      \tbx\tlr
";

    fn traced(addresses: &[u64]) -> Vec<Call> {
        let lines = addresses.iter().map(|address| {
            format!("Trace 0: 0x7f80c0 [00400000/{address:08x}/00000110/ff000000] x\n")
        });
        let text: String = lines.collect();
        let rungs = Rungs::new(PROGRAM).expect("a rung and the marker");
        let trace = Trace::read(text.as_bytes(), &Tables::new(PROGRAM), &rungs);
        trace.expect("nothing to fail").calls
    }

    #[test]
    fn calls_are_weighted_and_told_apart() {
        let taken = [0x400, 0x402, 0x404, 0x408, 0x40c, 0x420];
        let through = [0x400, 0x402, 0x404, 0x408, 0x40a, 0x40c, 0x420];
        let calls = traced(&[&[0x404], &taken[..], &[0x402], &through[..]].concat());
        let counts: Vec<_> = calls.iter().map(|c| (c.instructions, c.cycles)).collect();
        // 2 + 1 loads, 14 the division, 1 + 2 the branch, 1 + 2 the return.
        assert_eq!(counts, [(5, 23), (6, 22)]);
    }

    #[test]
    fn what_is_no_trace_is_a_complaint() {
        assert_eq!(address("qemu-system-arm: no such option"), None);
        assert_eq!(address("Trace 0: 0x1 [0/00000466/0/0] f"), Some(0x466));
    }
}
