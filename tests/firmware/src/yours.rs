//! What a firmware of one's own links for a baked scene: the tables, the light in a
//! `static`, and the calls that load, light and put surfaces together; no logger. For
//! what that takes of flash, RAM and stack; it is linked, and never run.
//!
//! With the feature `samples-alone` the samples are read, and no surface is put together
//! from them.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
#[allow(dead_code, reason = "it also names how long a run is")]
mod job;
#[cfg(target_os = "none")]
#[cfg_attr(integer_tables, path = "integers.rs")]
#[cfg_attr(not(integer_tables), path = "floats.rs")]
#[allow(dead_code, reason = "samples alone need not all of it")]
mod kernel;
#[cfg(all(target_os = "none", not(integer_tables)))]
mod root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This program is for the device; it is linked, and never run.");
    std::process::exit(2);
}

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;

    use cortex_m::singleton;
    use isolux::Error;

    use crate::job::{STOP, baked};
    use crate::kernel::Light;
    #[cfg(not(feature = "samples-alone"))]
    use crate::kernel::{self, DARK, Value};

    /// Checks the tables and takes them.
    #[inline(never)]
    #[unsafe(no_mangle)]
    fn isolux_step_load(light: &mut Light) -> Result<(), Error> {
        light.enter(baked::load()?)
    }

    /// Lights the scene.
    #[inline(never)]
    #[unsafe(no_mangle)]
    fn isolux_step_solve(light: &mut Light) {
        light.solve(STOP);
    }

    /// Puts a surface together and gives a row of it.
    #[cfg(not(feature = "samples-alone"))]
    #[inline(never)]
    #[unsafe(no_mangle)]
    fn isolux_step_row(
        light: &Light,
        room: &mut [Value; baked::ROOM],
        surface: usize,
        row: &mut [Value; ROW],
    ) -> Result<(), Error> {
        kernel::reconstruct(light, surface, room)?;
        kernel::resample_row(light, surface, room, [ROW as u32; 2], 0, row)
    }

    /// Values of a row.
    #[cfg(not(feature = "samples-alone"))]
    const ROW: usize = 16;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        if let Some(light) = singleton!(: Light = baked::DARK) {
            let _ = black_box(isolux_step_load(light));
            isolux_step_solve(light);
            black_box(light.irradiance());
            #[cfg(not(feature = "samples-alone"))]
            if let Some(room) = singleton!(: [Value; baked::ROOM] = [DARK; baked::ROOM]) {
                let mut row = [DARK; ROW];
                let _ = black_box(isolux_step_row(light, room, black_box(0), &mut row));
                black_box(&row);
            }
        }
        loop {
            cortex_m::asm::nop();
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::nop();
        }
    }
}
