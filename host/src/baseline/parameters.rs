//! How finely the baseline divides a scene.

use super::Error;
use crate::scene::{Scene, Surface};

/// How one surface is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Patches that shoot, along u (from the first vertex to the second) and
    /// along v (from the first to the last).
    pub patches: [usize; 2],
    /// Element vertices that receive, along u and along v.
    pub vertices: [usize; 2],
}

impl Resolution {
    /// As many in each direction: 2 patches a side make 4, 10 vertices 100.
    #[must_use]
    pub fn square(patches_a_side: usize, vertices_a_side: usize) -> Self {
        Self {
            patches: [patches_a_side; 2],
            vertices: [vertices_a_side; 2],
        }
    }

    /// These vertices, and patches of 4.5 × 4.5 elements, as the paper's first
    /// column of Table 2 has them on A.
    fn with_vertices(vertices: [usize; 2]) -> Self {
        Self {
            patches: vertices.map(|count| (((count - 1) as f64 / 4.5).round() as usize).max(1)),
            vertices,
        }
    }
}

/// When the baseline stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// When every patch has shot this often, all of them in turn: light that is
    /// reflected at most as often.
    Reflections(usize),
    /// Progressive refinement, most unshot power first, until what is unshot is
    /// below this fraction of the emitted power; a hundred shots a patch at the
    /// most.
    Unshot(f64),
}

/// Parameters of a baseline solution.
#[derive(Clone, Debug, PartialEq)]
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
    /// How much of the reflected light is followed.
    pub stop: Stop,
    /// How far inside the surface a vertex of its border is evaluated, as a
    /// share of an element's side, below 1. With 0, the classical choice, what
    /// lies in the plane of an adjoining surface gets nothing from it.
    pub inset: f64,
}

impl Default for Parameters {
    /// As the paper's first column has surface A: 4 patches and 100 element
    /// vertices a surface, 400 samples on a luminaire, 16 on a patch, one
    /// reflection.
    fn default() -> Self {
        Self {
            surfaces: Vec::new(),
            others: Resolution::square(2, 10),
            source_samples_a_side: 20,
            patch_samples_a_side: 4,
            stop: Stop::Reflections(1),
            inset: 0.0,
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
                (name.to_owned(), Resolution::square(2, vertices_a_side))
            };
            Self {
                surfaces: vec![divided("A", on_a), divided("B", on_b)],
                ..Self::default()
            }
        })
    }

    /// The columns "Same speed", "Same quality" and "Converged" of Table 3 in
    /// Drettakis and Fiume 1992: 225, 400 and 4225 element vertices on the
    /// surface called floor, and at most 720, 900 and 12500 on all others that
    /// reflect, spread as evenly as whole numbers along each side allow. The
    /// rest the paper does not say: patches and samples are as in its Table 2,
    /// and light is followed until a thousandth of it is unshot.
    #[must_use]
    pub fn table_3(scene: &Scene) -> [Self; 3] {
        [(15, 720), (20, 900), (65, 12_500)].map(|(floor_side, others)| {
            let [floor, rest]: [Vec<&Surface>; 2] = [true, false].map(|floor| {
                let reflecting = scene.surfaces.iter().filter(|s| s.reflectance[0] > 0.0);
                reflecting
                    .filter(|s| (s.name == "floor") == floor)
                    .collect()
            });
            let floor = floor
                .into_iter()
                .map(|s| (s.name.clone(), Resolution::with_vertices([floor_side; 2])));
            Self {
                surfaces: floor.chain(spread(&rest, others)).collect(),
                stop: Stop::Unshot(0.001),
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
            resolution.patches.iter().all(|&count| count >= 1)
                && resolution.vertices.iter().all(|&count| count >= 2)
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

/// At most `most` vertices in all, at the same distance on every surface.
fn spread(surfaces: &[&Surface], most: usize) -> Vec<(String, Resolution)> {
    let vertices = |surface: &Surface, density: f64| {
        sides(surface).map(|side| ((density * side) as usize + 1).max(2))
    };
    let count = |density: f64| -> usize {
        let each = surfaces.iter().map(|surface| vertices(surface, density));
        each.map(|[along, across]| along * across).sum()
    };
    let longest = surfaces.iter().flat_map(|s| sides(s)).fold(0.0, f64::max);
    let (mut low, mut high) = (0.0, most as f64 / longest);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if count(middle) <= most {
            low = middle;
        } else {
            high = middle;
        }
    }
    let divided = |surface: &&Surface| {
        let resolution = Resolution::with_vertices(vertices(surface, low));
        (surface.name.clone(), resolution)
    };
    surfaces.iter().map(divided).collect()
}

/// Mean lengths of the sides along u and along v, in metres.
fn sides(surface: &Surface) -> [f64; 2] {
    let corner = |k: usize| surface.vertices[k.min(surface.vertices.len() - 1)];
    [[(0, 1), (3, 2)], [(0, 3), (1, 2)]].map(|pairs| {
        let lengths = pairs.map(|(from, to)| corner(from).distance(corner(to)));
        0.5 * (lengths[0] + lengths[1])
    })
}
