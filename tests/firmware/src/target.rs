//! The run itself: load, light, resample, log.

use cortex_m::singleton;
use isolux::Error;
use isolux::shoot::{Solved, Stop};
use semihosting::process;

use crate::clock::Clock;
use crate::job::baked::{self, ROOM, TABLES};
use crate::job::{self, RESOLUTION};
use crate::kernel::{self, DARK, Light, Value, WORDS};
use crate::meter::{Cost, Meter};

/// Rounding mode, flush to zero and default NaN in FPSCR: all must be 0, or the
/// bits are not IEEE 754's.
#[cfg(target_abi = "eabihf")]
const FPSCR_MODES: u32 = 0x03c0_0000;

// The kernel's steps, one function each: their costs are measured around the
// call, and the bound of the stack is read off the linked program by name.

/// Loads the tables in place and makes the dark state.
#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_load(light: &mut Light) -> Result<(), Error> {
    light.enter(baked::load()?)
}

/// Direct light alone.
#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_direct(light: &mut Light) {
    light.direct();
}

/// Direct light and shots until the stop rule holds.
#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_solve(light: &mut Light, stop: Stop) -> Solved {
    light.solve(stop)
}

/// What the rows of a surface's grid have in common.
#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_reconstruct(
    light: &Light,
    surface: usize,
    room: &mut [Value; ROOM],
) -> Result<(), Error> {
    kernel::reconstruct(light, surface, room)
}

/// One row of a surface's grid.
#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_resample(
    light: &Light,
    surface: usize,
    room: &[Value; ROOM],
    row: u32,
    out: &mut [Value; RESOLUTION],
) -> Result<(), Error> {
    let grid = [RESOLUTION as u32; 2];
    kernel::resample_row(light, surface, room, grid, row, out)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    match run() {
        Ok(()) => process::exit(0),
        Err(Failure::Kernel(error)) => defmt::error!("{}", error),
        Err(Failure::Because(why)) => defmt::error!("{=str}", why),
    }
    process::exit(1)
}

/// Why the run ended early.
enum Failure {
    /// The kernel refused the scene.
    Kernel(Error),
    /// The device or the build is not what it must be.
    Because(&'static str),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Failure::Kernel(error)
    }
}

fn run() -> Result<(), Failure> {
    if TABLES.0.is_empty() {
        return Err(Failure::Because(
            "built without tables: set ISOLUX_BAKED, as `isolux device SCENE` does",
        ));
    }
    #[cfg(target_abi = "eabihf")]
    if cortex_m::register::fpscr::read().bits() & FPSCR_MODES != 0 {
        return Err(Failure::Because(
            "FPSCR asks for another rounding than IEEE 754's default",
        ));
    }
    let twice = Failure::Because("a singleton was taken twice");
    let Some(peripherals) = cortex_m::Peripherals::take() else {
        return Err(twice);
    };
    let Some(light) = singleton!(: Light = baked::DARK) else {
        return Err(twice);
    };
    let Some(row) = singleton!(: [Value; RESOLUTION] = [DARK; RESOLUTION]) else {
        return Err(twice);
    };
    let Some(room) = singleton!(: [Value; ROOM] = [DARK; ROOM]) else {
        return Err(twice);
    };
    let clock = Clock::start(peripherals.SYST);
    let (timer, systick) = clock.cross_check();
    defmt::info!("cross-check timer {=u64} systick {=u64}", timer, systick);
    let meter = Meter::new(clock);

    let (loaded, cost) = meter.measure(|| isolux_step_load(light));
    loaded?;
    log("load", cost);
    let ((), cost) = meter.measure(|| isolux_step_direct(light));
    log("direct", cost);
    let (solved, cost) = meter.measure(|| isolux_step_solve(light, job::STOP));
    log("solve", cost);
    defmt::info!(
        "solved shots {=u32} form-factors {=u32} unshot {=f32}",
        solved.shots,
        solved.form_factors,
        solved.unshot
    );

    values(light.irradiance());
    let mut count = light.irradiance().len() * WORDS;
    let mut total = Cost::default();
    let mut wrong_bit = cfg!(feature = "wrong-bit");
    for surface in 0..light.scene().surfaces().len() {
        if light.scene().surface(surface)?.samples == 0 {
            continue;
        }
        let (done, cost) = meter.measure(|| isolux_step_reconstruct(light, surface, room));
        done?;
        total.and_then(cost);
        for number in 0..RESOLUTION as u32 {
            let (done, cost) =
                meter.measure(|| isolux_step_resample(light, surface, room, number, row));
            done?;
            total.and_then(cost);
            if wrong_bit && let Some(value) = row.last_mut() {
                *value = kernel::wrong(*value);
                wrong_bit = false;
            }
            values(row);
            count += row.len() * WORDS;
        }
    }
    log("resample", total);
    defmt::info!("end values {=usize}", count);
    Ok(())
}

/// Logs what a step cost.
fn log(step: &'static str, cost: Cost) {
    defmt::info!(
        "step {=str} instructions {=u64} stack {=u32}",
        step,
        cost.instructions,
        cost.stack
    );
}

/// Logs the bits of values.
fn values(values: &[Value]) {
    // SAFETY: any initialised f32 or u32 is four initialised bytes, of no alignment.
    let bytes =
        unsafe { core::slice::from_raw_parts(values.as_ptr().cast::<u8>(), size_of_val(values)) };
    defmt::info!("values {=[u8]}", bytes);
}
