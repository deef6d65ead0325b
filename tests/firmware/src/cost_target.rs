//! The measurements themselves.

use core::hint::black_box;

use cortex_m as _; // its critical section
use defmt_semihosting as _; // the global logger
use isolux::Error;
use isolux::form_factor::fixed_point::{self, Format, Q24, Q29};
use isolux::form_factor::{Best, Libm, Outline, of_loops};
use isolux::geometry::{Plane, Receiver};
use isolux::number::SoftRoot;
use semihosting::process;

use crate::clock::Clock;
use crate::cost_cases::{CASES, Case, VERTICES};
use crate::cost_samples::{RECEIVERS, Samples};
use crate::meter::{Cost, Meter};
use crate::root::Chosen;

/// Whether [`Chosen`] is the FPU's root, and not libm's a second time.
const HARDWARE_ROOT: bool = cfg!(all(target_abi = "eabihf", not(feature = "software-root")));

/// A form factor as the tables have it: the emitter's plane and reach are known.
type Entry = fn(&Receiver<f32>, &Plane<f32>, &Outline<'_, f32>) -> f32;

/// Defines a rung with a root as a function of its own: the cost is measured
/// around its call.
macro_rules! entry {
    ($name:ident, $rung:ty) => {
        #[inline(never)]
        fn $name(receiver: &Receiver<f32>, plane: &Plane<f32>, outline: &Outline<'_, f32>) -> f32 {
            of_loops::<$rung, f32>(receiver, plane, core::iter::once(*outline))
        }
    };
}

entry!(best_fpu, Best<Chosen>);
entry!(best_libm, Best<SoftRoot>);
entry!(libm_fpu, Libm<Chosen>);
entry!(libm_libm, Libm<SoftRoot>);

/// Rung, root, whether the root is [`Chosen`], function.
const ENTRIES: [(&str, &str, bool, Entry); 4] = [
    ("best", "fpu", true, best_fpu),
    ("best", "libm", false, best_libm),
    ("libm", "fpu", true, libm_fpu),
    ("libm", "libm", false, libm_libm),
];

/// A form factor in integers, with the emitter's plane known.
type FixedEntry<F> = fn(&fixed_point::Receiver<F>, &fixed_point::Plane, &[[i64; 3]]) -> F;

#[inline(never)]
fn q24(
    receiver: &fixed_point::Receiver<Q24>,
    plane: &fixed_point::Plane,
    outline: &[[i64; 3]],
) -> Q24 {
    fixed_point::of_loops(receiver, plane, core::iter::once(outline))
}

#[inline(never)]
fn q29(
    receiver: &fixed_point::Receiver<Q29>,
    plane: &fixed_point::Plane,
    outline: &[[i64; 3]],
) -> Q29 {
    fixed_point::of_loops(receiver, plane, core::iter::once(outline))
}

/// The plane and the reach of an emitter that is given by its vertices alone.
#[inline(never)]
fn outline<'a>(vertices: &'a [[f32; 3]]) -> (Plane<f32>, Outline<'a, f32>) {
    (Plane::of_polygon(vertices), Outline::new(vertices))
}

/// The classical form factor of a vertex.
#[inline(never)]
fn delta_form_factors(receiver: &Receiver<f32>, samples: &Samples) -> f32 {
    samples.form_factor(receiver)
}

/// What the calls of one operation cost together.
#[derive(Default)]
struct Account {
    calls: u32,
    total: Cost,
    largest: u64,
    answers: f32,
}

impl Account {
    fn add(&mut self, (answer, cost): (f32, Cost)) {
        self.calls += 1;
        self.total.and_then(cost);
        if cost.instructions > self.largest {
            self.largest = cost.instructions;
        }
        self.answers += answer;
    }

    /// Logs it under a name of up to four words.
    fn log(&self, name: [&str; 4], number: usize) {
        defmt::info!(
            "cost {=str} {=str} {=str} {=str} {=usize} calls {=u32} instructions {=u64} largest {=u64} stack {=u32} answers {=u32}",
            name[0],
            name[1],
            name[2],
            name[3],
            number,
            self.calls,
            self.total.instructions,
            self.largest,
            self.total.stack,
            self.answers.to_bits()
        );
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
    let Some(peripherals) = cortex_m::Peripherals::take() else {
        defmt::error!("a singleton was taken twice");
        process::exit(1)
    };
    let clock = Clock::start(peripherals.SYST);
    let (timer, systick) = clock.cross_check();
    defmt::info!("cross-check timer {=u64} systick {=u64}", timer, systick);
    let meter = Meter::new(clock);
    let mut lines = 0_u32;
    for vertices in VERTICES {
        outlines(&meter, vertices);
        lines += 1;
    }
    for case in &CASES {
        for vertices in VERTICES {
            for entry in ENTRIES {
                if entry.2 && !HARDWARE_ROOT {
                    continue;
                }
                form_factors(&meter, case, vertices, entry)?;
                lines += 1;
            }
            fixed_form_factors(&meter, case, vertices, ("q24", q24))?;
            fixed_form_factors(&meter, case, vertices, ("q29", q29))?;
            lines += 2;
        }
    }
    for side in [4, 20] {
        classical(&meter, side)?;
        lines += 1;
    }
    defmt::info!("end costs {=u32}", lines);
    Ok(())
}

fn outlines(meter: &Meter, vertices: usize) {
    let corners = CASES[0].emitter(vertices);
    let corners = black_box(&corners[..vertices]);
    let mut account = Account::default();
    let ((plane, outline), cost) = meter.measure(|| outline(corners));
    account.add((plane.normal.z + outline.reach_squared(), cost));
    account.log(["outline", "-", "-", "-"], vertices);
}

fn form_factors(
    meter: &Meter,
    case: &Case,
    vertices: usize,
    (rung, root, _, entry): (&str, &str, bool, Entry),
) -> Result<(), Error> {
    let corners = case.emitter(vertices);
    let (plane, outline) = outline(&corners[..vertices]);
    let entry = black_box(entry);
    let mut account = Account::default();
    for index in 0..RECEIVERS {
        let receiver = case.receiver(index)?;
        account.add(meter.measure(|| entry(&receiver, &plane, &outline)));
    }
    account.log(["form-factor", rung, root, case.name], vertices);
    Ok(())
}

fn fixed_form_factors<F: Format>(
    meter: &Meter,
    case: &Case,
    vertices: usize,
    (rung, entry): (&str, FixedEntry<F>),
) -> Result<(), Error> {
    let entry = black_box(entry);
    let mut account = Account::default();
    for index in 0..RECEIVERS {
        let (corners, receiver) = case.fixed::<F>(vertices, index)?;
        let corners = &corners[..vertices];
        let plane = fixed_point::Plane::of_polygon(corners);
        let (answer, cost) = meter.measure(|| entry(&receiver, &plane, corners));
        account.add((answer.to_bits() as f32, cost));
    }
    account.log(["form-factor", rung, "-", case.name], vertices);
    Ok(())
}

fn classical(meter: &Meter, side: usize) -> Result<(), Error> {
    let samples = Samples::on_the_light(side);
    let samples = black_box(&samples);
    let mut account = Account::default();
    for index in 0..RECEIVERS {
        let receiver = Samples::receiver(index)?;
        account.add(meter.measure(|| delta_form_factors(&receiver, samples)));
    }
    account.log(["delta-form-factors", "-", "-", "-"], side * side);
    Ok(())
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    defmt::error!("{}", defmt::Display2Format(info));
    process::exit(1)
}

#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    defmt::error!("hard fault at {=u32:#x}", frame.pc());
    process::exit(1)
}
