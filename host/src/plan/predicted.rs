//! What a plan is predicted to err by, before anything is solved with it.

use super::{Plan, SurfacePlan, Tag};

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

/// The predicted error of the places of one tag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedAt {
    /// What light does there.
    pub tag: Tag,
    /// The root of the mean square error of all light there, counted as in
    /// [`Predicted::rms`].
    pub rms: f64,
    /// The area in m² of these places.
    pub area: f64,
}

impl PredictedAt {
    /// Of a surface with this area in m², from places all over it: of each its tag, the
    /// square of its error and what it counts for. Tags without a place are left out.
    pub fn by_tag(area: f64, places: &[(Tag, f64, f64)]) -> Vec<Self> {
        let whole: f64 = places.iter().map(|(.., counts)| counts).sum();
        let of_tag = |tag| {
            let its = places.iter().filter(|(of_place, ..)| *of_place == tag);
            let (loss, counts) = its.fold((0.0, 0.0), |(loss, counts), (_, square, weight)| {
                (loss + square * weight, counts + weight)
            });
            (counts > 0.0).then(|| Self {
                tag,
                rms: (loss / counts).sqrt(),
                area: area * counts / whole,
            })
        };
        Tag::OF_PLACES.into_iter().filter_map(of_tag).collect()
    }
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
    /// What the places of each tag are predicted to err by, of all surfaces together.
    pub fn predicted_by_tag(&self) -> Vec<PredictedAt> {
        let all = || self.surfaces.iter().flat_map(|s| &s.predicted_by_tag);
        let places: Vec<_> = all().map(|p| (p.tag, p.rms * p.rms, p.area)).collect();
        PredictedAt::by_tag(all().map(|p| p.area).sum(), &places)
    }

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
    #[test]
    fn tags_add_up_to_the_surface() {
        let places = [
            (Tag::Lit, 4e-4, 1.0),
            (Tag::Penumbra, 9e-4, 0.5),
            (Tag::Lit, 1e-4, 2.0),
            (Tag::Contact, 1.0, 0.0),
        ];
        let by_tag = PredictedAt::by_tag(7.0, &places);
        let tags: Vec<Tag> = by_tag.iter().map(|at| at.tag).collect();
        assert_eq!(tags, [Tag::Lit, Tag::Penumbra], "of no weight, no place");
        let area: f64 = by_tag.iter().map(|at| at.area).sum();
        let loss: f64 = by_tag.iter().map(|at| at.rms * at.rms * at.area).sum();
        assert!((area - 7.0).abs() < 1e-12);
        assert!((loss - 7.0 * (4e-4 + 4.5e-4 + 2e-4) / 3.5).abs() < 1e-12);
    }
}
