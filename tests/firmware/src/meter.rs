//! What a step costs: its instructions and the deepest stack it reaches.

use core::arch::asm;
use core::ptr;
use core::sync::atomic::{Ordering, compiler_fence};

use crate::clock::{Clock, instructions};

/// What unused stack is painted with.
const PAINT: u32 = 0xc0de_cafe;

unsafe extern "C" {
    /// End of the statics and start of the free memory, from the linker.
    static mut __sheap: u32;
}

/// The cost of one step.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    /// Instructions executed.
    pub(crate) instructions: u64,
    /// Deepest stack below the caller, in bytes.
    pub(crate) stack: u32,
}

impl Cost {
    /// This step and another after it: instructions add, stack does not.
    pub(crate) fn and_then(&mut self, next: Cost) {
        self.instructions += next.instructions;
        if next.stack > self.stack {
            self.stack = next.stack;
        }
    }
}

/// Measures steps, less what measuring itself costs.
pub(crate) struct Meter {
    clock: Clock,
    own: u64,
}

impl Meter {
    /// A meter that has measured the empty step.
    pub(crate) fn new(clock: Clock) -> Self {
        let mut meter = Meter { clock, own: 0 };
        let ((), empty) = meter.measure(|| nothing());
        meter.own = empty.instructions;
        meter
    }

    /// Runs a step, which should be one call of a function that is not inlined,
    /// and says what it cost.
    #[inline(always)]
    pub(crate) fn measure<T>(&self, step: impl FnOnce() -> T) -> (T, Cost) {
        let pointer = stack_pointer();
        paint(pointer);
        let begun = self.clock.ticks();
        compiler_fence(Ordering::SeqCst);
        let result = step();
        compiler_fence(Ordering::SeqCst);
        let ended = self.clock.ticks();
        let cost = Cost {
            instructions: instructions(ended - begun).saturating_sub(self.own),
            stack: depth(pointer),
        };
        (result, cost)
    }
}

/// The step that does nothing.
#[inline(never)]
extern "C" fn nothing() {
    compiler_fence(Ordering::SeqCst);
}

/// The stack pointer here. Without `nomem`: it also keeps memory accesses on
/// their side of it.
#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) pointer) };
    pointer
}

/// Paints the free memory from the statics' end up to the stack in use. Always
/// inlined: a frame of its own would lie in what it paints.
#[inline(always)]
fn paint(pointer: usize) {
    if cfg!(feature = "trace") {
        return; // every instruction is emulated by itself: too many here
    }
    let mut at = &raw mut __sheap;
    while (at as usize) < pointer {
        // SAFETY: between the statics' end and the stack pointer lies memory
        // that nothing uses: there is no heap, and no interrupt is enabled.
        unsafe {
            ptr::write_volatile(at, PAINT);
            at = at.add(1);
        }
    }
}

/// How far below `pointer` the paint is gone, in bytes.
#[inline(always)]
fn depth(pointer: usize) -> u32 {
    if cfg!(feature = "trace") {
        return 0;
    }
    let mut at = (&raw const __sheap).cast::<u32>();
    // SAFETY: as in `paint`; the walk ends at the stack pointer at the latest.
    unsafe {
        while (at as usize) < pointer && ptr::read_volatile(at) == PAINT {
            at = at.add(1);
        }
    }
    (pointer - at as usize) as u32
}
