//! The run itself: solve, dim the first luminaire to half, update.

use cortex_m::singleton;
use isolux::Error;
#[cfg(not(integer_tables))]
use isolux::luminance::Colour;
use isolux::shoot::{Solved, Stop};
use semihosting::process;

use crate::clock::Clock;
use crate::job::{self, baked};
use crate::meter::{Cost, Meter};
use baked::{DARK, Light, Value};

/// What a luminaire's radiance is in.
#[cfg(not(integer_tables))]
type Radiance = Value;
#[cfg(integer_tables)]
type Radiance = f32;

/// Half of it.
fn half(radiance: Radiance) -> Radiance {
    #[cfg(not(integer_tables))]
    return radiance.times(0.5);
    // Its exponent less 1: this core may have no other way.
    #[cfg(integer_tables)]
    return f32::from_bits(radiance.to_bits() - (1 << 23));
}

#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_load(light: &mut Light) -> Result<(), Error> {
    light.enter(baked::load()?)
}

#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_solve(light: &mut Light, stop: Stop) -> Solved {
    light.solve(stop)
}

#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_step_update(light: &mut Light, radiance: Radiance, stop: Stop) -> Result<Solved, Error> {
    light.set_radiance(0, radiance)?;
    Ok(light.update(stop))
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
    let (Some(peripherals), Some(light)) =
        (cortex_m::Peripherals::take(), singleton!(: Light = DARK))
    else {
        defmt::error!("a singleton was taken twice");
        process::exit(1)
    };
    let meter = Meter::new(Clock::start(peripherals.SYST));
    let (loaded, cost) = meter.measure(|| isolux_step_load(light));
    loaded?;
    log("load", cost);
    let (solved, cost) = meter.measure(|| isolux_step_solve(light, job::STOP));
    log("solve", cost);
    shots(solved);
    let radiance = half(light.radiance(0));
    let (updated, cost) = meter.measure(|| isolux_step_update(light, radiance, job::STOP));
    log("update", cost);
    shots(updated?);
    values(light.irradiance());
    for index in 0..light.scene().points().len() {
        values(&[light.point(index)?]);
    }
    defmt::info!("end relight");
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

/// Logs how shooting ended.
fn shots(solved: Solved) {
    defmt::info!("shots {=u32} unshot {=f32}", solved.shots, solved.unshot);
}

/// Logs the bits of values, channel by channel.
fn values(values: &[Value]) {
    for value in values {
        #[cfg(integer_tables)]
        defmt::info!("value {=u32}", value.cast_unsigned());
        #[cfg(not(integer_tables))]
        value.map(|channel| {
            defmt::info!("value {=u32}", channel.to_bits());
            channel
        });
    }
}
