//! The classical method's work, measured beside the kernel's: a vertex and the
//! samples of an emitter, and where the receivers are.

use isolux::Error;
use isolux::geometry::{Receiver, Vector};
use isolux::number::SoftRoot;

/// Receivers of every measurement.
pub(crate) const RECEIVERS: usize = ROWS * ROWS;

/// Receivers along each side of their square.
const ROWS: usize = 6;

/// Where on the square the receiver `index` is, −1 to 1: shifted a little off
/// the symmetries.
pub(crate) fn place(index: usize) -> [f32; 2] {
    let coordinate = |step: usize| 0.36 * step as f32 - 0.9;
    [
        coordinate(index % ROWS) + 0.047,
        coordinate(index / ROWS % ROWS) + 0.031,
    ]
}

/// Samples on an emitter, as the classical method has them: each is a disc of
/// the area it stands for.
pub(crate) struct Samples {
    places: [[f32; 3]; Self::MOST],
    count: usize,
    facing: Vector<f32>,
    area: f32,
}

impl Samples {
    /// Samples on the paper's light source.
    pub(crate) const MOST: usize = 400;

    /// `side` × `side` samples on the 3 m × 3 m light of the paper's scene;
    /// at most [`Samples::MOST`].
    pub(crate) fn on_the_light(side: usize) -> Self {
        let step = 3.0 / side as f32;
        let mut places = [[0.0; 3]; Self::MOST];
        for (index, place) in places.iter_mut().enumerate().take(side * side) {
            let centre = |number: usize| (number as f32 + 0.5) * step;
            *place = [centre(index % side) - 0.3, centre(index / side) - 1.5, 2.2];
        }
        Self {
            places,
            count: side * side,
            facing: Vector::from([0.0, 0.0, -1.0]),
            area: step * step,
        }
    }

    /// A receiver on the paper's surface A, which sees all of them.
    pub(crate) fn receiver(index: usize) -> Result<Receiver<f32>, Error> {
        let [x, y] = place(index).map(|t| 2.5 * t);
        Receiver::new::<SoftRoot>([x, y, 0.0], [0.0, 0.0, 1.0])
    }

    /// The classical form factor, Σ cos cos' ΔA/(π r² + ΔA), with what the
    /// method asks of it and nothing else: one division a sample, no ray.
    #[inline(always)]
    pub(crate) fn form_factor(&self, receiver: &Receiver<f32>) -> f32 {
        let (position, normal) = (receiver.position(), receiver.normal());
        let mut sum = 0.0;
        for &place in self.places.iter().take(self.count) {
            let towards = Vector::from(place) - position;
            let square = towards.norm_squared();
            let (here, there) = (normal.dot(towards), -self.facing.dot(towards));
            if here > 0.0 && there > 0.0 {
                let disc = core::f32::consts::PI * square + self.area;
                sum += here * there * self.area / (square * disc);
            }
        }
        sum
    }
}
