//! Instructions spent, from the board's own timers.
//!
//! The emulator runs with `-icount shift=7`: every instruction takes 2⁷ = 128 ns
//! of the device's time, and the mps2 boards' timers tick at 25 MHz, every
//! 40 ns. So an instruction is 3.2 ticks; a difference of two readings is off
//! by less than one tick, 0.31 instructions, and rounding it is exact.
//!
//! Two timers make 64 bits without an interrupt (a handler would spoil both the
//! count and the painted stack): the 32-bit CMSDK APB timer gives the low bits,
//! one half of the CMSDK dual timer, behind a prescaler of 256, says how often
//! the first has wrapped. Good for 2⁴⁰ ticks, 3.4 · 10¹¹ instructions.

use core::ptr;
use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// CMSDK APB timer 0: CTRL, VALUE, RELOAD, INTSTATUS. Counts down.
const TIMER: *mut u32 = 0x4000_0000 as *mut u32;
/// First half of the CMSDK APB dual timer: LOAD, VALUE, CONTROL. Counts down.
const DUAL_TIMER: *mut u32 = 0x4000_2000 as *mut u32;
/// CONTROL of the dual timer: enabled, free running, prescaler 256, 32 bits.
const DUAL_TIMER_CONTROL: u32 = 1 << 7 | 0b10 << 2 | 1 << 1;
/// Ticks of the dual timer are this power of two of the other's.
const PRESCALER_BITS: u32 = 8;

/// The running timers.
pub(crate) struct Clock(());

impl Clock {
    /// Starts the timers from zero.
    pub(crate) fn start(mut systick: SYST) -> Self {
        // SAFETY: the addresses are those of the timers on the boards this
        // firmware is for (AN385, AN386, AN500), and nothing else here touches them.
        unsafe {
            ptr::write_volatile(DUAL_TIMER.add(0), u32::MAX);
            ptr::write_volatile(TIMER.add(2), u32::MAX);
            ptr::write_volatile(TIMER.add(1), u32::MAX);
            ptr::write_volatile(DUAL_TIMER.add(2), DUAL_TIMER_CONTROL);
            ptr::write_volatile(TIMER.add(0), 1);
        }
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(0x00ff_ffff);
        systick.clear_current();
        systick.enable_counter();
        Clock(())
    }

    /// Ticks of 40 ns since the start. Never inlined, so that it always costs
    /// the same.
    #[inline(never)]
    pub(crate) fn ticks(&self) -> u64 {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: as in `start`.
        let (low, coarse) = unsafe {
            (
                !ptr::read_volatile(TIMER.add(1)),
                !ptr::read_volatile(DUAL_TIMER.add(1)),
            )
        };
        compiler_fence(Ordering::SeqCst);
        let coarse = u64::from(coarse) << PRESCALER_BITS;
        // The two differ by a few ticks; the nearest number of wraps is right.
        let wraps = (coarse.wrapping_sub(u64::from(low)).wrapping_add(1 << 31)) >> 32;
        (wraps & 0xff) << 32 | u64::from(low)
    }

    /// Instructions of a short span on the timers and on SysTick: two clocks
    /// that know nothing of each other and must agree.
    pub(crate) fn cross_check(&self) -> (u64, u64) {
        let begun = (self.ticks(), SYST::get_current());
        for _ in 0..100_000 {
            cortex_m::asm::nop();
        }
        let ended = (self.ticks(), SYST::get_current());
        let systick = begun.1.wrapping_sub(ended.1) & 0x00ff_ffff;
        (
            instructions(ended.0 - begun.0),
            instructions(u64::from(systick)),
        )
    }
}

/// Instructions in so many ticks: 40 ns over 128 ns, rounded.
pub(crate) fn instructions(ticks: u64) -> u64 {
    (ticks * 5 + 8) / 16
}
