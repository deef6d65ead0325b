//! What is asked of the reference, and why it may refuse.

use std::fmt;

/// Which light counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflections {
    /// Light reflected at most this often; 0 is direct light alone.
    AtMost(usize),
    /// Every generation until the power that is still to be shot, `Σ ρ ∫ E dA`
    /// with E of the last generation, is below this fraction of the emitted
    /// power `Σ π L A`. At least the direct light.
    UntilUnshot(f64),
}

impl Reflections {
    /// Whether light reflected `count` times is the last to count.
    pub(super) fn enough(self, count: usize, unshot: f64, power: f64) -> bool {
        match self {
            Self::AtMost(most) => count >= most,
            Self::UntilUnshot(fraction) => unshot <= 0.0 || unshot < fraction * power,
        }
    }
}

/// Why there is no reference.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The fraction of unshot power is not a positive number.
    Fraction(f64),
    /// A polygon cannot be triangulated: its outline crosses itself.
    Outline {
        /// The surface's name.
        surface: String,
    },
    /// Even the coarsest mesh of the reflecting surfaces is too large.
    TooFine {
        /// Cells it would have.
        cells: usize,
        /// Cells it may have.
        most: usize,
    },
    /// The light would have to be followed further than is sensible.
    DoesNotDieOut {
        /// Generations followed.
        generations: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fraction(fraction) => write!(
                f,
                "the fraction of unshot power is {fraction}; it must be a number above 0"
            ),
            Self::Outline { surface } => write!(
                f,
                "surface \"{surface}\" cannot be triangulated; its outline must not cross itself"
            ),
            Self::TooFine { cells, most } => write!(
                f,
                "the reflecting surfaces need {cells} cells and the reference holds {most}; \
                 ask for at most one reflection or use fewer surfaces"
            ),
            Self::DoesNotDieOut { generations } => write!(
                f,
                "after {generations} reflections too much light is left; \
                 allow a larger unshot fraction or state a number of reflections"
            ),
        }
    }
}

impl std::error::Error for Error {}
