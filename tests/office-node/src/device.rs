//! The node on its part: the kernel's light, the log, the end.

use cortex_m as _; // its critical section, which the logger takes
use cortex_m::singleton;
use defmt_semihosting as _; // the global logger
use isolux::Error;
use isolux::shoot::Stop;
use semihosting::process;

use crate::control::{DESKS, LUMINAIRES};
use crate::node::{self, DAY, Office};
use crate::office::{self, DARK, Light, luminaires, points};

/// The luminaires and desks by the names that the scene file gives them.
const LAMPS: [usize; LUMINAIRES] = [
    luminaires::LUM00,
    luminaires::LUM01,
    luminaires::LUM10,
    luminaires::LUM11,
];
const PLACES: [usize; DESKS] = [
    points::DESK_1,
    points::DESK_2,
    points::DESK_3,
    points::DESK_4,
];

/// The light, and what its luminaires were baked with.
struct Lit<'a> {
    light: &'a mut Light,
    full: [f32; LUMINAIRES],
}

impl Office for Lit<'_> {
    fn dim(&mut self, levels: &[f32; LUMINAIRES]) {
        for ((&lamp, full), level) in LAMPS.iter().zip(self.full).zip(levels) {
            if let Err(error) = self.light.set_radiance(lamp, full * level) {
                defmt::error!("{}", error);
            }
        }
        self.light.update(Stop::below(0.001));
    }

    fn desks(&self) -> [f32; DESKS] {
        PLACES.map(|place| self.light.point(place).unwrap_or(0.0))
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    match run() {
        Ok(()) => process::exit(0),
        Err(error) => defmt::error!("{}", error),
    }
    process::exit(1)
}

fn run() -> Result<(), Error> {
    let Some(light) = singleton!(: Light = DARK) else {
        defmt::error!("the light was taken twice");
        process::exit(1)
    };
    light.enter(office::load()?)?;
    let full = LAMPS.map(|lamp| light.radiance(lamp));
    let mut lit = Lit { light, full };
    let response = node::learn(&mut lit);
    for row in &response {
        defmt::info!("response {}", row);
    }
    for (hour, daylight) in &DAY {
        let decided = node::decide(&mut lit, &response, daylight);
        defmt::info!(
            "at {=u32} levels {} desks {} W {=f32}",
            *hour,
            decided.levels,
            decided.desks,
            decided.power
        );
    }
    defmt::info!("end of the day");
    Ok(())
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    defmt::error!("{}", defmt::Display2Format(info));
    process::exit(1)
}
