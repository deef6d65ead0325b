//! The form factors whose cost is measured, on the device and on the host: the
//! same numbers in the same order, so that instructions and nanoseconds speak
//! of the same work and the answers can be compared.

use crate::cost_samples::place;
use isolux::Error;
use isolux::form_factor::fixed_point::{self, Format, Scale};
use isolux::geometry::{Receiver, Vector};
use isolux::number::SoftRoot;

/// An emitter and how its receivers see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// Its name in reports.
    pub(crate) name: &'static str,
    /// Circumradius of the emitter in metres, which hangs 1 m above the
    /// receivers. The kernel takes one of 1 m for a large emitter and one of
    /// 0.1 m for a small one, whatever the receiver.
    radius: f32,
    /// Whether the receiver's horizon runs through the emitter.
    pub(crate) clipped: bool,
}

/// Both ways of summing a loop, with and without the horizon in it.
pub(crate) const CASES: [Case; 4] = [
    case("large-unclipped", 1.0, false),
    case("large-clipped", 1.0, true),
    case("small-unclipped", 0.1, false),
    case("small-clipped", 0.1, true),
];

/// Vertices of the emitters.
pub(crate) const VERTICES: [usize; 3] = [3, 4, 8];

/// cos 45°.
const DIAGONAL: f32 = core::f32::consts::FRAC_1_SQRT_2;

/// Corners of a regular octagon of circumradius 1.
const OCTAGON: [[f32; 2]; 8] = [
    [1.0, 0.0],
    [DIAGONAL, DIAGONAL],
    [0.0, 1.0],
    [-DIAGONAL, DIAGONAL],
    [-1.0, 0.0],
    [-DIAGONAL, -DIAGONAL],
    [0.0, -1.0],
    [DIAGONAL, -DIAGONAL],
];

/// Corners of a regular triangle of circumradius 1; √3/2.
const TRIANGLE: [[f32; 2]; 3] = [[1.0, 0.0], [-0.5, 0.866_025_4], [-0.5, -0.866_025_4]];

const fn case(name: &'static str, radius: f32, clipped: bool) -> Case {
    Case {
        name,
        radius,
        clipped,
    }
}

impl Case {
    /// The emitter, facing down; the first `vertices` of the corners are its.
    pub(crate) fn emitter(&self, vertices: usize) -> [[f32; 3]; 8] {
        let mut corners = [[0.0; 3]; 8];
        for (index, corner) in corners.iter_mut().enumerate() {
            let [x, y] = match vertices {
                3 => TRIANGLE[index % 3],
                4 => OCTAGON[2 * index % 8],
                _ => OCTAGON[index],
            };
            // The other way round: it is seen from below.
            *corner = [self.radius * x, -self.radius * y, 1.0];
        }
        corners
    }

    /// A receiver on the plane z = 0, within 1.5 m of the middle in x and y.
    /// It sees the whole emitter, or its horizon runs through a place 0.4
    /// radii from the emitter's centre.
    pub(crate) fn receiver(&self, index: usize) -> Result<Receiver<f32>, Error> {
        let [x, y] = place(index).map(|t| 1.5 * t);
        let normal = if self.clipped {
            let through = OCTAGON[index % 8].map(|t| 0.4 * self.radius * t);
            let towards = Vector::from([through[0] - x, through[1] - y, 1.0]);
            let [u, v] = OCTAGON[(3 * index + 1) % 8];
            towards.cross(Vector::from([u, v, 0.0])).into()
        } else {
            [0.1, -0.05, 1.0]
        };
        Receiver::new::<SoftRoot>([x, y, 0.0], normal)
    }

    /// Emitter and receiver as integers of one scale.
    pub(crate) fn fixed<F: Format>(
        &self,
        vertices: usize,
        index: usize,
    ) -> Result<([[i64; 3]; 8], fixed_point::Receiver<F>), Error> {
        let corners = self.emitter(vertices);
        let receiver = self.receiver(index)?;
        let (place, normal) = (receiver.position().into(), receiver.normal().into());
        let scale = Scale::of([4.0]).ok_or(Error::Receiver)?;
        let receiver = fixed_point::Receiver::new(scale.place(place), scale.place(normal))?;
        Ok((corners.map(|corner| scale.place(corner)), receiver))
    }
}
