//! The evaluations themselves.

use cortex_m as _; // its critical section
use defmt_semihosting as _; // the global logger
use isolux::form_factor::{Arithmetic, Best, Libm, Micromath, Poly3, Poly5, Poly8, form_factor};
use isolux::geometry::Receiver;
use semihosting::process;

use crate::hash_cases::{Cases, Hash};
use crate::root::Chosen;

include!(concat!(env!("OUT_DIR"), "/evaluations.rs"));

/// Hashes every case on one rung; a receiver that is none counts as 0.
#[inline(never)]
fn hash<A: Arithmetic<f32>>() -> u64 {
    let (mut cases, mut hash) = (Cases::new(), Hash::new());
    for _ in 0..EVALUATIONS {
        let case = cases.following();
        hash.add(match Receiver::new::<Chosen>(case.position, case.normal) {
            Ok(receiver) => form_factor::<A, f32>(&receiver, case.vertices()),
            Err(_) => 0.0,
        });
    }
    hash.0
}

/// The rungs.
const RUNGS: &[(&str, fn() -> u64)] = &[
    ("libm", hash::<Libm<Chosen>>),
    ("micromath", hash::<Micromath>),
    ("poly3", hash::<Poly3<Chosen>>),
    ("poly5", hash::<Poly5<Chosen>>),
    ("poly8", hash::<Poly8<Chosen>>),
    ("best", hash::<Best<Chosen>>),
];

#[cortex_m_rt::entry]
fn main() -> ! {
    for (rung, hash) in RUNGS {
        defmt::info!("hash {=str} {=u64:016x}", *rung, hash());
    }
    defmt::info!("end hashes {=usize}", RUNGS.len());
    process::exit(0)
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
