//! What a run on the device found: the JSON of `isolux device`.

use serde::Serialize;

use super::log::Log;

/// What a [`run`](super::run) found; serialises to the JSON of `isolux device`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// The scene's name.
    pub scene: String,
    /// One entry for each core, and one for the software root.
    pub targets: Vec<Target>,
    /// Cores that could not be run.
    pub skipped: Vec<Skipped>,
    /// Whether every value has the host's bits on every target.
    pub bits_equal: bool,
    /// Values compared on each target.
    pub values: usize,
    /// Instructions of the first core: load, direct light, shooting, resampling.
    pub instructions: u64,
    /// The same by step.
    pub instructions_by_step: Steps,
    /// The same with libm's square root in place of the FPU's.
    pub instructions_software_root: Option<u64>,
    /// Shots taken.
    pub shots: u32,
    /// Form factors evaluated for direct light and shots.
    pub form_factors: u32,
    /// Power left unshot, as a fraction of the emitted power.
    pub unshot: f32,
    /// What the running program found of itself between the linker's marks.
    pub memory: Memory,
    /// Deepest stack of the kernel's steps as painted, in bytes.
    pub stack_bytes: u64,
    /// Upper bound of the same from the linked program, in bytes.
    pub stack_bound_bytes: u64,
    /// Statics in RAM, in bytes: the kernel's state, one row, the logger.
    pub ram_bytes: u64,
    /// Flash of the whole program, in bytes.
    pub flash_bytes: u64,
    /// The part of the flash that is baked tables.
    pub flash_tables_bytes: u64,
    /// The rest of the flash: kernel, start-up code, logger.
    pub flash_code_bytes: u64,
    /// The part of the code that the kernel's steps can reach.
    pub flash_kernel_code_bytes: u64,
    /// What was allowed.
    pub budget: Allowed,
}

/// Memory that a running program takes, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Memory {
    /// Statics.
    pub ram_bytes: u64,
    /// Vector table, code, constants, tables, and the image of initialised statics.
    pub flash_bytes: u64,
}

/// A program on a core.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// The core, and the root where it is not the core's own.
    pub core: String,
    /// Whether every value has the host's bits.
    pub bits_equal: bool,
    /// Instructions: load, direct light, shooting, resampling.
    pub instructions: u64,
    /// Values that differ.
    pub differences: usize,
    /// The first of them.
    pub first_difference: Option<Difference>,
}

/// A value that differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Its position among the values.
    pub index: usize,
    /// The host's bits, in hexadecimal.
    pub host: String,
    /// The device's bits, in hexadecimal.
    pub device: String,
}

/// A core that could not be run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// The core.
    pub core: String,
    /// Why, and what would change it.
    pub why: String,
}

/// Instructions by step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Steps {
    /// Checking the tables and making the dark state.
    pub load: u64,
    /// Direct light.
    pub direct: u64,
    /// Every shot after it.
    pub shoot: u64,
    /// Every row of every grid.
    pub resample: u64,
}

/// What was allowed, and whether it was kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Allowed {
    /// RAM the scene allows, in bytes; `None` is no limit but the device's.
    pub ram_bytes: Option<u64>,
    /// Flash the scene allows, in bytes; `None` is no limit but the device's.
    pub flash_bytes: Option<u64>,
    /// RAM of the device, in bytes.
    pub device_ram_bytes: u64,
    /// Flash of the device, in bytes.
    pub device_flash_bytes: u64,
    /// Whether statics and the bound of the stack together, and the flash, are
    /// within all of these.
    pub kept: bool,
}

impl Target {
    /// Compares the bits of a run with the host's.
    pub(crate) fn new(core: String, log: &Log, expected: &[u32]) -> Self {
        let length = log.values.len().abs_diff(expected.len());
        let mut differing = log
            .values
            .iter()
            .zip(expected)
            .enumerate()
            .filter(|(_, (device, host))| device != host);
        let first_difference = differing.next().map(|(index, (device, host))| Difference {
            index,
            host: format!("{host:08x}"),
            device: format!("{device:08x}"),
        });
        let differences = usize::from(first_difference.is_some()) + differing.count() + length;
        Self {
            core,
            bits_equal: differences == 0,
            instructions: Steps::of(log).total(),
            differences,
            first_difference,
        }
    }
}

impl Steps {
    /// The steps of a log. The firmware measures direct light alone, and then
    /// the whole solution, which begins with it: shooting is the difference.
    pub(crate) fn of(log: &Log) -> Self {
        let instructions = |name| log.steps.get(name).map_or(0, |step| step.instructions);
        let direct = instructions("direct");
        Self {
            load: instructions("load"),
            direct,
            shoot: instructions("solve").saturating_sub(direct),
            resample: instructions("resample"),
        }
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.load + self.direct + self.shoot + self.resample
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(values: &[u32]) -> Log {
        Log {
            values: values.to_vec(),
            ..Log::default()
        }
    }

    #[test]
    fn one_bit_is_a_difference() {
        let target = Target::new("core".to_owned(), &log(&[1, 2, 7, 4]), &[1, 2, 3, 4]);
        assert!(!target.bits_equal);
        assert_eq!(target.differences, 1);
        let first = target.first_difference.expect("a difference");
        assert_eq!((first.index, first.host.as_str()), (2, "00000003"));
        assert_eq!(first.device, "00000007");
    }

    #[test]
    fn a_missing_value_is_a_difference() {
        for (device, host) in [
            (&[1_u32][..], &[1_u32, 2][..]),
            (&[1, 2], &[1]),
            (&[], &[1]),
        ] {
            let target = Target::new("core".to_owned(), &log(device), host);
            assert!(!target.bits_equal, "{device:?} {host:?}");
            assert_eq!(target.differences, 1);
        }
    }
}
