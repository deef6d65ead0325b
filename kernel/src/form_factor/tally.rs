//! The sum of a loop's terms.

use crate::number::Number;

/// Degree from which on sums are compensated: with a lower one the fit errs by
/// more than they.
const COMPENSATED: usize = 6;

/// A sum that keeps, for fits of degree 6 and 8, what rounding takes from it
/// (Kahan 1965).
///
/// A receiver that an emitter surrounds has terms that add up to nearly a whole
/// turn: each partial sum is then rounded by up to 3e-8, and a triangle's or a
/// quad's would be off by 2.8e-7 where 2.5e-7 is promised. 3 operations a term.
#[derive(Clone, Copy)]
pub(super) struct Tally<const DEGREE: usize, N> {
    sum: N,
    /// What the sum has too much.
    excess: N,
}

impl<const DEGREE: usize, N: Number> Tally<DEGREE, N> {
    pub(super) const ZERO: Self = Self {
        sum: N::ZERO,
        excess: N::ZERO,
    };

    /// With one term more.
    #[inline(always)]
    pub(super) fn plus(self, term: N) -> Self {
        if DEGREE < COMPENSATED {
            return Self {
                sum: self.sum + term,
                ..self
            };
        }
        let term = term - self.excess;
        let sum = self.sum + term;
        Self {
            sum,
            excess: (sum - self.sum) - term,
        }
    }

    /// The sum and a last term.
    #[inline(always)]
    pub(super) fn total(self, last: N) -> N {
        if DEGREE < COMPENSATED {
            self.sum + last
        } else {
            self.sum + (last - self.excess)
        }
    }

    /// The sum.
    #[inline(always)]
    pub(super) fn sum(self) -> N {
        self.sum
    }
}
