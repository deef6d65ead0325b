//! How every program that logs ends, well or not: the log over semihosting, and
//! exit status 1 on a panic or a fault.

use cortex_m as _; // its critical section, which the logger takes
use defmt_semihosting as _; // the global logger
use semihosting::process;

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
