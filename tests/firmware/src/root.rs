//! The square root the device offers.

/// VSQRT of the FPU: one instruction, correctly rounded as libm's software root
/// is, so the bits stay the same and only the cost changes.
#[cfg(all(target_abi = "eabihf", not(feature = "software-root")))]
#[derive(Clone, Copy)]
pub(crate) enum Vsqrt {}

#[cfg(all(target_abi = "eabihf", not(feature = "software-root")))]
impl isolux::number::Root<f32> for Vsqrt {
    #[inline(always)]
    fn sqrt(x: f32) -> f32 {
        let mut bits = x.to_bits();
        // SAFETY: moves through s0, which is declared overwritten, and touches
        // neither memory nor stack.
        unsafe {
            core::arch::asm!(
                "vmov s0, {bits}",
                "vsqrt.f32 s0, s0",
                "vmov {bits}, s0",
                bits = inout(reg) bits,
                out("s0") _,
                options(pure, nomem, nostack, preserves_flags),
            );
        }
        f32::from_bits(bits)
    }
}

/// The root this firmware is built with.
#[cfg(all(target_abi = "eabihf", not(feature = "software-root")))]
pub(crate) type Chosen = Vsqrt;

/// The root this firmware is built with.
#[cfg(any(not(target_abi = "eabihf"), feature = "software-root"))]
pub(crate) type Chosen = isolux::number::SoftRoot;
