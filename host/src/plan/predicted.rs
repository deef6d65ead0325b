//! What a plan is predicted to err by, before anything is solved with it.

use super::{Plan, SurfacePlan};

/// The predicted error of one part of a surface's reconstruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted {
    /// Which part.
    pub part: Part,
    /// The root of the mean square error as a part of all light at the place; in
    /// rooms an error above a quarter counts as a quarter.
    pub rms: f64,
    /// The area in m² that it is the mean over.
    pub area: f64,
}

/// What of a surface's light errs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All light, on a tensor grid.
    All,
    /// What its samples give to other surfaces as points, as a part of its own
    /// power.
    Points,
    /// What luminaires would send if nothing hid anything.
    Unshadowed,
    /// The fraction of it that is seen.
    Shadows,
    /// Reflected light.
    Reflected,
}

impl Part {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::All,
        Self::Points,
        Self::Unshadowed,
        Self::Shadows,
        Self::Reflected,
    ];

    /// What the part is called in plan files.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Points => "points",
            Self::Unshadowed => "unshadowed",
            Self::Shadows => "shadows",
            Self::Reflected => "reflected",
        }
    }

    /// The part of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }
}

impl SurfacePlan {
    /// The predicted relative error of the surface, the root of the mean square over
    /// its `area` in m², √(Σ ε² a / A): as if its parts erred independently. `None`
    /// where the planner made no prediction.
    pub fn predicted_error(&self, area: f64) -> Option<f64> {
        let predicted = !self.predicted.is_empty() && area > 0.0;
        predicted.then(|| (self.predicted_loss() / area).sqrt())
    }

    /// Σ ε² a in m².
    fn predicted_loss(&self) -> f64 {
        let parts = self.predicted.iter();
        parts.map(|part| part.rms * part.rms * part.area).sum()
    }
}

impl Plan {
    /// The predicted relative error of all surfaces with samples together, the root
    /// of the mean square over their area; `areas` in m², one a surface. `None` where
    /// one of them has no prediction.
    pub fn predicted_error(&self, areas: impl IntoIterator<Item = f64>) -> Option<f64> {
        let (mut loss, mut area) = (0.0, 0.0);
        for (surface, its) in self.surfaces.iter().zip(areas) {
            if surface.samples.is_empty() {
                continue;
            }
            if surface.predicted.is_empty() {
                return None;
            }
            loss += surface.predicted_loss();
            area += its;
        }
        (area > 0.0).then(|| (loss / area).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::frame::Frame;
    use crate::scene::{file, shipped};

    #[test]
    fn parts_add_up_by_the_area_they_err_on() {
        let (name, source) = shipped::ALL[0];
        let scene = file::parse(name, source).unwrap();
        let frame = Frame::new(&scene.surfaces[0]);
        let of = |part, rms, area| Predicted { part, rms, area };
        let surface = SurfacePlan {
            predicted: vec![
                of(Part::Unshadowed, 0.03, 2.0),
                of(Part::Shadows, 0.08, 0.5),
            ],
            ..SurfacePlan::without_samples(frame)
        };
        let error = surface.predicted_error(2.0).unwrap();
        assert!((error - 0.05).abs() < 1e-15, "{error}");
        assert_eq!(surface.predicted_error(0.0), None);
        assert!(
            Part::ALL
                .into_iter()
                .all(|part| Part::named(part.name()) == Some(part))
        );
    }
}
