//! The measurements themselves.

use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};

use isolux::Error;
use isolux::form_factor::fixed_point::{self, Format, Q24, Q29};
use isolux::form_factor::{
    Baked, Best, Edge, Libm, Micromath, Outline, Poly3, Poly5, Poly8, of_baked_loops, of_loops,
};
use isolux::geometry::{Plane, Receiver};
use isolux::number::SoftRoot;
use semihosting::process;

use crate::clock::Clock;
use crate::cost_cases::{CASES, Case, VERTICES};
use crate::cost_ready::{ready, seen};
use crate::cost_samples::{RECEIVERS, Samples};
use crate::meter::{Cost, Meter};
use crate::root::Chosen;

/// Whether [`Chosen`] is the FPU's root, and not libm's a second time.
const HARDWARE_ROOT: bool = cfg!(all(target_abi = "eabihf", not(feature = "software-root")));

/// A form factor as the tables have it: the emitter's plane and reach are known.
type Entry = fn(&Receiver<f32>, &Plane<f32>, &Outline<'_, f32>) -> f32;

/// A rung with a root.
struct Rung {
    name: &'static str,
    /// `fpu` where the root is [`Chosen`], `libm` where it is the software one,
    /// `own` where the rung brings its own.
    root: &'static str,
    entry: Entry,
}

/// Defines each rung with its root as a function of its own, around whose call
/// the cost is measured. `isolux trade` finds it in the linked program by its
/// name, `isolux_rung_NAME_ROOT`.
macro_rules! rungs {
    ($($function:ident: $name:literal, $root:literal, $kernel:ty;)*) => {
        $(
            #[inline(never)]
            #[unsafe(no_mangle)]
            fn $function(
                receiver: &Receiver<f32>,
                plane: &Plane<f32>,
                outline: &Outline<'_, f32>,
            ) -> f32 {
                of_loops::<$kernel, f32>(receiver, plane, core::iter::once(*outline))
            }
        )*
        const RUNGS: &[Rung] = &[
            $(Rung { name: $name, root: $root, entry: $function },)*
        ];
    };
}

rungs! {
    isolux_rung_best_fpu: "best", "fpu", Best<Chosen>;
    isolux_rung_best_libm: "best", "libm", Best<SoftRoot>;
    isolux_rung_libm_fpu: "libm", "fpu", Libm<Chosen>;
    isolux_rung_libm_libm: "libm", "libm", Libm<SoftRoot>;
    isolux_rung_micromath_own: "micromath", "own", Micromath;
    isolux_rung_poly3_fpu: "poly3", "fpu", Poly3<Chosen>;
    isolux_rung_poly3_libm: "poly3", "libm", Poly3<SoftRoot>;
    isolux_rung_poly5_fpu: "poly5", "fpu", Poly5<Chosen>;
    isolux_rung_poly5_libm: "poly5", "libm", Poly5<SoftRoot>;
    isolux_rung_poly8_fpu: "poly8", "fpu", Poly8<Chosen>;
    isolux_rung_poly8_libm: "poly8", "libm", Poly8<SoftRoot>;
}

impl Rung {
    /// Whether this program measures it: not without an FPU what would be
    /// libm's root a second time, and under a trace, which is for one FPU,
    /// nothing but what is best there.
    fn is_measured(&self) -> bool {
        if cfg!(feature = "trace") {
            self.root != "libm"
        } else {
            HARDWARE_ROOT || self.root != "fpu"
        }
    }
}

/// A form factor in integers, with the emitter's plane known.
type FixedEntry<F> = fn(&fixed_point::Receiver<F>, &fixed_point::Plane, &[[i64; 3]]) -> F;

#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_rung_q24(
    receiver: &fixed_point::Receiver<Q24>,
    plane: &fixed_point::Plane,
    outline: &[[i64; 3]],
) -> Q24 {
    fixed_point::of_loops(receiver, plane, core::iter::once(outline))
}

#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_rung_q29(
    receiver: &fixed_point::Receiver<Q29>,
    plane: &fixed_point::Plane,
    outline: &[[i64; 3]],
) -> Q29 {
    fixed_point::of_loops(receiver, plane, core::iter::once(outline))
}

/// `best` with a table of the emitter's edges.
type BakedEntry = fn(&Receiver<f32>, &Plane<f32>, &Baked<'_>) -> f32;

#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_rung_baked_fpu(receiver: &Receiver<f32>, plane: &Plane<f32>, baked: &Baked<'_>) -> f32 {
    of_baked_loops::<Chosen>(receiver, plane, core::iter::once(*baked))
}

/// The rung `poly5` without translation and horizon.
#[inline(never)]
#[unsafe(no_mangle)]
fn isolux_rung_ready_fpu(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
    ready::<Chosen>(receiver.normal(), vertices)
}

/// The plane and the reach of an emitter that is given by its vertices alone.
#[inline(never)]
fn outline<'a>(vertices: &'a [[f32; 3]]) -> (Plane<f32>, Outline<'a, f32>) {
    (Plane::of_polygon(vertices), Outline::new(vertices))
}

/// Where a trace of a measured call ends.
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn isolux_rung_end() {
    compiler_fence(Ordering::SeqCst);
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
            for rung in RUNGS.iter().filter(|rung| rung.is_measured()) {
                form_factors(&meter, case, vertices, rung)?;
                lines += 1;
            }
            if HARDWARE_ROOT {
                baked_form_factors(&meter, case, vertices)?;
                lines += 1;
            }
            if HARDWARE_ROOT && !case.clipped {
                ready_sums(&meter, case, vertices)?;
                lines += 1;
            }
            fixed_form_factors(&meter, case, vertices, ("q24", isolux_rung_q24))?;
            fixed_form_factors(&meter, case, vertices, ("q29", isolux_rung_q29))?;
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

fn form_factors(meter: &Meter, case: &Case, vertices: usize, rung: &Rung) -> Result<(), Error> {
    let corners = case.emitter(vertices);
    let (plane, outline) = outline(&corners[..vertices]);
    let entry = black_box(rung.entry);
    let mut account = Account::default();
    for index in 0..RECEIVERS {
        let receiver = case.receiver(index)?;
        account.add(meter.measure(|| entry(&receiver, &plane, &outline)));
        isolux_rung_end();
    }
    account.log(["form-factor", rung.name, rung.root, case.name], vertices);
    Ok(())
}

fn baked_form_factors(meter: &Meter, case: &Case, vertices: usize) -> Result<(), Error> {
    let corners = case.emitter(vertices);
    let corners = &corners[..vertices];
    let (plane, outline) = outline(corners);
    let mut edges = [Edge::default(); 8];
    for (slot, edge) in edges.iter_mut().zip(Edge::of_loop(corners)) {
        *slot = edge;
    }
    let Some(baked) = Baked::new(outline, &edges[..vertices]) else {
        return Ok(());
    };
    let entry: BakedEntry = black_box(isolux_rung_baked_fpu);
    let mut account = Account::default();
    for index in 0..RECEIVERS {
        let receiver = case.receiver(index)?;
        account.add(meter.measure(|| entry(&receiver, &plane, &baked)));
        isolux_rung_end();
    }
    account.log(["form-factor", "baked", "fpu", case.name], vertices);
    Ok(())
}

fn ready_sums(meter: &Meter, case: &Case, vertices: usize) -> Result<(), Error> {
    let entry: fn(&Receiver<f32>, &[[f32; 3]]) -> f32 = black_box(isolux_rung_ready_fpu);
    let mut account = Account::default();
    for index in 0..RECEIVERS {
        let receiver = case.receiver(index)?;
        let corners = seen(case, &receiver, vertices);
        let corners = black_box(&corners[..vertices]);
        account.add(meter.measure(|| entry(&receiver, corners)));
        isolux_rung_end();
    }
    account.log(["ready-sum", "ready", "fpu", case.name], vertices);
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
        isolux_rung_end();
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
