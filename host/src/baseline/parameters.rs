//! How finely the baseline divides a scene.

use super::Error;
use crate::scene::{Scene, Surface};

/// How one surface is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Patches that shoot, in each direction (2 makes 4).
    pub patches_a_side: usize,
    /// Element vertices that receive, in each direction (10 makes 100).
    pub vertices_a_side: usize,
}

/// Parameters of a baseline solution.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameters {
    /// Surfaces with a resolution of their own, by name. They receive even if
    /// they reflect nothing.
    pub surfaces: Vec<(String, Resolution)>,
    /// Resolution of every other surface that reflects.
    pub others: Resolution,
    /// Samples on a luminaire in each direction (20 makes 400).
    pub source_samples_a_side: usize,
    /// Samples on a shooting patch in each direction (4 makes 16).
    pub patch_samples_a_side: usize,
    /// Rounds in which patches shoot: how often light is reflected at most.
    pub reflections: usize,
}

impl Default for Parameters {
    /// As the paper's first column has surface A: 4 patches and 100 element
    /// vertices a surface, 400 samples on a luminaire, 16 on a patch, one
    /// reflection.
    fn default() -> Self {
        Self {
            surfaces: Vec::new(),
            others: Resolution {
                patches_a_side: 2,
                vertices_a_side: 10,
            },
            source_samples_a_side: 20,
            patch_samples_a_side: 4,
            reflections: 1,
        }
    }
}

impl Parameters {
    /// The columns "Scene 1" to "Scene 4" of Table 2 in Drettakis and Fiume
    /// 1992, for a scene whose receivers are called A and B: 100, 64, 64, 64
    /// element vertices on A and 36, 36, 16, 9 on B; 4 patches on A, 400
    /// samples on the source, 16 on a patch.
    #[must_use]
    pub fn table_2() -> [Self; 4] {
        [(10, 6), (8, 6), (8, 4), (8, 3)].map(|(on_a, on_b)| {
            let divided = |name: &str, vertices_a_side: usize| {
                let resolution = Resolution {
                    patches_a_side: 2,
                    vertices_a_side,
                };
                (name.to_owned(), resolution)
            };
            Self {
                surfaces: vec![divided("A", on_a), divided("B", on_b)],
                ..Self::default()
            }
        })
    }

    /// The resolution of a surface.
    pub(super) fn resolution(&self, name: &str) -> Resolution {
        let own = self.surfaces.iter().find(|(known, _)| known == name);
        own.map_or(self.others, |(_, resolution)| *resolution)
    }

    /// Whether a surface receives.
    pub(super) fn receives(&self, surface: &Surface) -> bool {
        surface.reflectance[0] > 0.0 || self.surfaces.iter().any(|(name, _)| *name == surface.name)
    }

    /// Refuses counts and names that make no sense.
    pub(super) fn check(&self, scene: &Scene) -> Result<(), Error> {
        let fine = |resolution: &Resolution| {
            resolution.patches_a_side >= 1 && resolution.vertices_a_side >= 2
        };
        if !fine(&self.others) || self.source_samples_a_side == 0 || self.patch_samples_a_side == 0
        {
            return Err(Error::Count { surface: None });
        }
        for (name, resolution) in &self.surfaces {
            if !fine(resolution) {
                return Err(Error::Count {
                    surface: Some(name.clone()),
                });
            }
            if !scene.surfaces.iter().any(|surface| surface.name == *name) {
                return Err(Error::Unknown {
                    surface: name.clone(),
                });
            }
        }
        Ok(())
    }
}
