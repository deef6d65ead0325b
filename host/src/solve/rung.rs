//! The rungs by name, and form factors by themselves.

use isolux::Error;
use isolux::form_factor::fixed_point::{self, Format, Q24, Q29, Scale};
use isolux::form_factor::{Best, Libm, Micromath, Poly3, Poly5, Poly8, form_factor};
use isolux::geometry::Receiver;
use isolux::number::Root;

/// The host's square root: an instruction, correctly rounded like every
/// other [`Root`].
#[derive(Clone, Copy, Debug, Default)]
pub struct HostRoot;

impl Root<f32> for HostRoot {
    #[inline]
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }
}

/// The arithmetic rungs of this build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rung {
    /// [`Libm`].
    Libm,
    /// [`Micromath`].
    Micromath,
    /// [`Poly3`].
    Poly3,
    /// [`Poly5`].
    Poly5,
    /// [`Poly8`].
    Poly8,
    /// [`Best`].
    #[default]
    Best,
}

/// Evaluates an expression with `$kernel` as the kernel's type of a rung.
macro_rules! with_rung {
    ($rung:expr, $kernel:ident => $body:expr) => {
        match $rung {
            Rung::Libm => {
                type $kernel = Libm<HostRoot>;
                $body
            }
            Rung::Micromath => {
                type $kernel = Micromath;
                $body
            }
            Rung::Poly3 => {
                type $kernel = Poly3<HostRoot>;
                $body
            }
            Rung::Poly5 => {
                type $kernel = Poly5<HostRoot>;
                $body
            }
            Rung::Poly8 => {
                type $kernel = Poly8<HostRoot>;
                $body
            }
            Rung::Best => {
                type $kernel = Best<HostRoot>;
                $body
            }
        }
    };
}
pub(super) use with_rung;

impl Rung {
    /// All rungs, in the order of the ladder.
    pub const ALL: [Self; 6] = [
        Self::Libm,
        Self::Micromath,
        Self::Poly3,
        Self::Poly5,
        Self::Poly8,
        Self::Best,
    ];

    /// The rung of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rung| rung.name() == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Libm => "libm",
            Self::Micromath => "micromath",
            Self::Poly3 => "poly3",
            Self::Poly5 => "poly5",
            Self::Poly8 => "poly8",
            Self::Best => "best",
        }
    }

    /// The form factor of a polygon in `f32`, as the device computes it.
    ///
    /// # Errors
    /// [`Error::Receiver`] where position or normal are no receiver.
    pub fn form_factor(
        self,
        position: [f32; 3],
        normal: [f32; 3],
        vertices: &[[f32; 3]],
    ) -> Result<f32, Error> {
        let receiver = Receiver::new::<HostRoot>(position, normal)?;
        Ok(self.form_factor_at(&receiver, vertices))
    }

    /// The form factor of a polygon from a receiver that is one already.
    pub fn form_factor_at(self, receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
        with_rung!(self, Kernel => form_factor::<Kernel, f32>(receiver, vertices))
    }
}

/// What a form factor, and a scene baked for it, can be computed with: the
/// rungs in floating point, and the integer ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormFactorRung {
    /// A rung in floating point, which every scene can be solved with.
    Float(Rung),
    /// [`Q24`].
    Q24,
    /// [`Q29`].
    Q29,
}

impl Default for FormFactorRung {
    fn default() -> Self {
        Rung::default().into()
    }
}

impl From<Rung> for FormFactorRung {
    fn from(rung: Rung) -> Self {
        Self::Float(rung)
    }
}

impl FormFactorRung {
    /// Whether a scene is baked in integers for it.
    pub fn is_integer(self) -> bool {
        !matches!(self, Self::Float(_))
    }

    /// All rungs, in the order of the ladder.
    pub const ALL: [Self; 8] = [
        Self::Float(Rung::Libm),
        Self::Float(Rung::Micromath),
        Self::Float(Rung::Poly3),
        Self::Float(Rung::Poly5),
        Self::Float(Rung::Poly8),
        Self::Float(Rung::Best),
        Self::Q24,
        Self::Q29,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Float(rung) => rung.name(),
            Self::Q24 => "q24",
            Self::Q29 => "q29",
        }
    }

    /// The form factor of a polygon as the device computes it, and its bits
    /// there.
    ///
    /// # Errors
    /// Those of [`Rung::form_factor`] and [`fixed_form_factor`].
    pub fn form_factor(
        self,
        position: [f32; 3],
        normal: [f32; 3],
        vertices: &[[f32; 3]],
    ) -> Result<(f64, u32), Error> {
        Ok(match self {
            Self::Float(rung) => {
                let found = rung.form_factor(position, normal, vertices)?;
                (found.into(), found.to_bits())
            }
            Self::Q24 => {
                let found = fixed_form_factor::<Q24>(position, normal, vertices)?;
                (found.into(), found.to_bits() as u32)
            }
            Self::Q29 => {
                let found = fixed_form_factor::<Q29>(position, normal, vertices)?;
                (found.into(), found.to_bits() as u32)
            }
        })
    }

    /// The rung of a name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "q24" => Some(Self::Q24),
            "q29" => Some(Self::Q29),
            name => Rung::named(name).map(Self::Float),
        }
    }
}

/// The form factor of a polygon in integers, as a core without FPU computes
/// it; both its scale and everything after are the kernel's.
///
/// # Errors
/// [`Error::Receiver`] where position or normal are no receiver, or a vertex is
/// not finite.
pub fn fixed_form_factor<F: Format>(
    position: [f32; 3],
    normal: [f32; 3],
    vertices: &[[f32; 3]],
) -> Result<F, Error> {
    let places = vertices.iter().flatten().chain(&position);
    let scale = Scale::of(places.copied()).ok_or(Error::Receiver)?;
    let normal = Scale::of(normal).ok_or(Error::Receiver)?.place(normal);
    let receiver = fixed_point::Receiver::<F>::new(scale.place(position), normal)?;
    let vertices: Vec<[i64; 3]> = vertices.iter().map(|&v| scale.place(v)).collect();
    Ok(fixed_point::form_factor(&receiver, &vertices))
}

/// The rungs of visibility.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sight {
    /// Nothing hides anything.
    #[default]
    None,
    /// [`VertexRays`](isolux::visibility::VertexRays).
    VertexRays,
    /// [`Exact`](isolux::visibility::Exact).
    Exact,
}

impl Sight {
    /// Its name on the ladder.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::VertexRays => "vertex-rays",
            Self::Exact => "exact",
        }
    }

    /// The rung of a name.
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::None, Self::VertexRays, Self::Exact];
        all.into_iter().find(|sight| sight.name() == name)
    }
}
