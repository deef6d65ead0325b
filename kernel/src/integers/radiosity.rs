//! How radiosity varies over an emitter, in whole numbers.

/// Coefficients of an emitter's radiosity, the mean first: one where it is constant,
/// three where it is linear in place (the mean, and what it grows by along both of the
/// emitter's own coordinates).
pub trait Radiosity: Copy + Send + Sync {
    /// How many there are.
    const COEFFICIENTS: u32;
    /// None of it.
    const DARK: Self;

    /// What these say of every coefficient, by its index.
    fn of(coefficient: impl FnMut(usize) -> i32) -> Self;

    /// The mean.
    fn mean(&self) -> i32;

    /// What emitters are compared by, about the mean of its magnitude over the emitter:
    /// the mean's, or a third of the gradient's where that is more, as
    /// [`Luminance::strength`](crate::luminance::Luminance::strength) has it.
    fn strength(&self) -> u32;

    /// Coefficient by coefficient.
    #[must_use]
    fn zip(self, other: Self, with: impl Fn(i32, i32) -> i32) -> Self;
}

impl<const N: usize> Radiosity for [i32; N] {
    const COEFFICIENTS: u32 = N as u32;
    const DARK: Self = [0; N];

    #[inline(always)]
    fn of(coefficient: impl FnMut(usize) -> i32) -> Self {
        core::array::from_fn(coefficient)
    }

    #[inline(always)]
    fn mean(&self) -> i32 {
        self.first().copied().unwrap_or(0)
    }

    #[inline(always)]
    fn strength(&self) -> u32 {
        let steep = self.iter().skip(1).fold(0, |sum: u32, along| {
            sum.saturating_add(along.unsigned_abs())
        });
        self.mean().unsigned_abs().max(steep / 3)
    }

    #[inline(always)]
    fn zip(mut self, other: Self, with: impl Fn(i32, i32) -> i32) -> Self {
        for (one, other) in self.iter_mut().zip(other) {
            *one = with(*one, other);
        }
        self
    }
}
