//! Runs a linked firmware on an emulated core.
//!
//! `qemu-system-arm` counts instructions (`-icount`): every one takes 2⁷ ns of
//! the device's time, whatever the machine it runs on is doing, so two runs of
//! one firmware give the same counts. The firmware's console and its exit
//! status come back by semihosting.

use std::io::Read;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::error::Error;

/// The emulator's program.
pub(crate) const PROGRAM: &str = "qemu-system-arm";

/// A core the firmware runs on; each has a program of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Core {
    /// Cortex-M4 with the single-precision FPU, on Arm's AN386 board: the
    /// device isolux is made for.
    CortexM4F,
    /// Cortex-M7 with the double-precision FPU, on Arm's AN500 board. Its real
    /// counterpart issues two instructions at a time; counts, not cycles, are
    /// comparable.
    CortexM7,
    /// Cortex-M3, on Arm's AN385 board: no FPU, so that every operation of
    /// `f32` is a function of the compiler's runtime.
    CortexM3,
}

impl Core {
    /// Every core, the device first.
    pub const ALL: [Self; 3] = [Self::CortexM4F, Self::CortexM7, Self::CortexM3];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4F => "cortex-m4f",
            Self::CortexM7 => "cortex-m7",
            Self::CortexM3 => "cortex-m3",
        }
    }

    /// The Rust target its program is built for.
    pub fn target(self) -> &'static str {
        match self {
            Self::CortexM4F | Self::CortexM7 => "thumbv7em-none-eabihf",
            Self::CortexM3 => "thumbv7m-none-eabi",
        }
    }

    /// The processor its program is tuned for (`-C target-cpu`). Tuned for
    /// none, the compiler joins products and sums to VMLA, which rounds as
    /// often and takes 3 cycles where VMUL and VADD take 2.
    pub fn cpu(self) -> &'static str {
        match self {
            Self::CortexM4F => "cortex-m4",
            Self::CortexM7 => "cortex-m7",
            Self::CortexM3 => "cortex-m3",
        }
    }

    /// The emulator's board.
    pub fn machine(self) -> &'static str {
        match self {
            Self::CortexM4F => "mps2-an386",
            Self::CortexM7 => "mps2-an500",
            Self::CortexM3 => "mps2-an385",
        }
    }
}

/// What a run left behind.
pub(crate) struct Output {
    /// Exit status; `None` where a signal ended the emulator.
    pub(crate) status: Option<i32>,
    /// The firmware's console.
    pub(crate) console: Vec<u8>,
    /// What the emulator itself said.
    pub(crate) complaints: String,
}

/// Runs a firmware to its end, or to the time limit.
pub(crate) fn run(core: Core, program: &Path, limit: Duration) -> Result<Output, Error> {
    let everything = |mut pipe: ChildStderr| {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).map(|_| bytes)
    };
    let (status, console, complaints) = run_reading(core, program, &[], limit, everything)?;
    Ok(Output {
        status,
        console,
        complaints: String::from_utf8_lossy(&complaints).trim().to_owned(),
    })
}

/// As [`run`], with more arguments for the emulator; `read` has what it writes
/// to its stderr as it comes. Gives status, console, and what `read` gives.
pub(crate) fn run_reading<T: Send + 'static>(
    core: Core,
    program: &Path,
    arguments: &[String],
    limit: Duration,
    read: impl FnOnce(ChildStderr) -> std::io::Result<T> + Send + 'static,
) -> Result<(Option<i32>, Vec<u8>, T), Error> {
    let doing = || format!("running {PROGRAM}");
    let mut child = Command::new(PROGRAM)
        .args(["-machine", core.machine()])
        .args(["-nographic", "-monitor", "none", "-serial", "null"])
        .args(["-icount", "shift=7"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(arguments)
        .arg("-kernel")
        .arg(program)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(Error::io(doing()))?;
    let console = drain(child.stdout.take(), |mut pipe| {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).map(|_| bytes)
    });
    let complaints = drain(child.stderr.take(), read);
    let ended = wait(&mut child, limit);
    if !matches!(ended, Ok(Some(_))) {
        // Already gone is as good as stopped.
        let _ = child.kill();
        let _ = child.wait();
    }
    let (console, complaints) = (collect(console)?, collect(complaints)?);
    match ended.map_err(Error::io(doing()))? {
        None => Err(Error::TimeLimit {
            core: core.name(),
            limit,
        }),
        Some(status) => Ok((status.code(), console, complaints)),
    }
}

/// Waits for the child's end; `None` when the limit comes first.
fn wait(child: &mut Child, limit: Duration) -> std::io::Result<Option<std::process::ExitStatus>> {
    let deadline = Instant::now() + limit;
    let mut pause = Duration::from_millis(2);
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        let now = Instant::now();
        if now >= deadline {
            return Ok(None);
        }
        thread::sleep(pause.min(deadline - now));
        pause = (pause * 2).min(Duration::from_millis(50));
    }
}

/// The arguments that make every instruction a block of its own, as a trace
/// of instructions needs it: the emulators since 8.1 have them as a property of
/// their translator, the older ones as an option, which 10 has no more.
pub(crate) fn one_by_one() -> Result<&'static [&'static str], Error> {
    let help = Command::new(PROGRAM)
        .arg("-h")
        .stdin(Stdio::null())
        .output()
        .map_err(Error::io(format!("running {PROGRAM}")))?;
    let help = String::from_utf8_lossy(&help.stdout);
    one_by_one_of(&help).ok_or_else(|| Error::Missing {
        what: format!("a {PROGRAM} that runs one instruction at a time"),
        remedy: "install version 7 or later".to_owned(),
    })
}

/// As [`one_by_one`], from the emulator's help.
fn one_by_one_of(help: &str) -> Option<&'static [&'static str]> {
    if help.contains("one-insn-per-tb") {
        Some(&["-accel", "tcg,one-insn-per-tb=on"])
    } else if help.contains("-singlestep") {
        Some(&["-singlestep"])
    } else {
        None
    }
}

/// A thread that empties a pipe.
type Drain<T> = thread::JoinHandle<std::io::Result<T>>;

/// Empties a pipe beside the waiting, so that a talkative child never blocks.
fn drain<P: Send + 'static, T: Send + 'static>(
    pipe: Option<P>,
    read: impl FnOnce(P) -> std::io::Result<T> + Send + 'static,
) -> Drain<T> {
    thread::spawn(move || {
        let none = || std::io::Error::other("the child has no such pipe");
        read(pipe.ok_or_else(none)?)
    })
}

/// What a pipe held.
fn collect<T>(drain: Drain<T>) -> Result<T, Error> {
    drain
        .join()
        .unwrap_or_else(|_| Err(std::io::Error::other("the reading thread failed")))
        .map_err(Error::io(format!("reading the output of {PROGRAM}")))
}

#[cfg(test)]
mod tests {
    use super::one_by_one_of;

    #[test]
    fn the_emulator_is_asked_in_its_own_words() {
        let old = "-singlestep     always run in singlestep mode\n";
        let both = "                one-insn-per-tb=on|off (one guest instruction per TCG translation block)\n\
                    -singlestep     deprecated synonym for -accel tcg,one-insn-per-tb=on\n";
        let new = both.lines().next().expect("a line");
        assert_eq!(one_by_one_of(old), Some(&["-singlestep"][..]));
        for help in [both, new] {
            let found = one_by_one_of(help).expect("known");
            assert_eq!(found, ["-accel", "tcg,one-insn-per-tb=on"], "{help}");
        }
        assert_eq!(one_by_one_of(""), None);
    }
}
