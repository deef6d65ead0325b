//! What a plan holds, costs and is predicted to err by.

use super::search::Found;
use crate::plan::{SurfacePlan, Tag};
use crate::report::percent;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The budget sheet of a plan.
#[derive(Serialize)]
pub(super) struct Sheet {
    scene: String,
    rungs: RungNames,
    samples: usize,
    /// Values on outlines of shadows that are known without a sample.
    free_samples: usize,
    luminaires: usize,
    /// Emitters that reflect.
    emitters: usize,
    /// Light, workspace and room together.
    ram_bytes: u64,
    light_bytes: usize,
    workspace_bytes: usize,
    room_bytes: usize,
    table_bytes: u64,
    /// In percent; `null` where the planner made no prediction.
    predicted_error: Option<f64>,
    surfaces: Vec<OfSurface>,
    file: String,
}

#[derive(Serialize)]
struct RungNames {
    arithmetic: &'static str,
    visibility: &'static str,
    emitters: &'static str,
    transfer: &'static str,
    placement: &'static str,
    reconstruction: &'static str,
}

#[derive(Serialize)]
struct OfSurface {
    name: String,
    samples: usize,
    by_tag: BTreeMap<&'static str, usize>,
    free_samples: usize,
    emitters: usize,
    predicted_error: Option<f64>,
}

impl Sheet {
    pub(super) fn of(found: &Found, file: &Path) -> Self {
        let planned = &found.planned;
        let (scene, plan) = (&planned.scene, &planned.plan);
        let counts = &planned.tables.counts;
        let surfaces = scene.surfaces.iter().zip(&plan.surfaces);
        let looked_at = surfaces.filter(|(_, planned)| !planned.samples.is_empty());
        let of_surface = |(surface, planned): (&crate::scene::Surface, &SurfacePlan)| OfSurface {
            name: surface.name.clone(),
            samples: planned.samples.len(),
            by_tag: by_tag(planned),
            free_samples: planned.free_samples(),
            emitters: planned.areas().len(),
            predicted_error: planned
                .predicted_error(surface.area)
                .map(|error| 100.0 * error),
        };
        Self {
            scene: scene.name.clone(),
            rungs: RungNames {
                arithmetic: planned.rung.name(),
                visibility: planned.sight.name(),
                emitters: planned.emitters.name(),
                transfer: planned.transfer.name(),
                placement: planned.placement.name(),
                reconstruction: planned.reconstruction(),
            },
            samples: plan.samples(),
            free_samples: plan.free_samples(),
            luminaires: counts.luminaires as usize,
            emitters: counts.emitters.saturating_sub(counts.luminaires) as usize,
            ram_bytes: found.ram(),
            light_bytes: found.state - found.workspace,
            workspace_bytes: found.workspace,
            room_bytes: found.room,
            table_bytes: found.flash(),
            predicted_error: found.error.map(|error| 100.0 * error),
            surfaces: looked_at.map(of_surface).collect(),
            file: file.display().to_string(),
        }
    }

    pub(super) fn in_words(&self) -> String {
        let rungs = &self.rungs;
        let mut text = format!(
            "scene `{}`: {} samples, {} values that are free, {} emitters beside {} luminaires\n",
            self.scene, self.samples, self.free_samples, self.emitters, self.luminaires
        );
        text += &format!(
            "  arithmetic {}, visibility {}, emitters {}, transfer {}, placement {}, reconstruction {}\n",
            rungs.arithmetic,
            rungs.visibility,
            rungs.emitters,
            rungs.transfer,
            rungs.placement,
            rungs.reconstruction
        );
        text += &format!(
            "  RAM {} bytes: light {}, workspace of visibility {}, room to reconstruct in {}\n  \
             tables {} bytes of flash\n",
            self.ram_bytes,
            self.light_bytes,
            self.workspace_bytes,
            self.room_bytes,
            self.table_bytes
        );
        text += &match self.predicted_error {
            Some(error) => format!("  predicted error {} % (relative, rms)\n", percent(error)),
            None => "  no error is predicted: the placement is not by error\n".to_owned(),
        };
        let width = self
            .surfaces
            .iter()
            .map(|s| s.name.chars().count())
            .max()
            .unwrap_or(0);
        for surface in &self.surfaces {
            let tags = surface
                .by_tag
                .iter()
                .map(|(tag, count)| format!("{count} {tag}"));
            let tags: Vec<String> = tags.collect();
            let error = surface.predicted_error;
            let error = error.map_or(String::new(), |error| {
                format!(", error {} %", percent(error))
            });
            text += &format!(
                "  {:width$}  {:>4} samples ({}), {} free, {} emitters{error}\n",
                surface.name,
                surface.samples,
                tags.join(", "),
                surface.free_samples,
                surface.emitters,
            );
        }
        text + &format!("wrote {}\n", self.file)
    }
}

fn by_tag(planned: &SurfacePlan) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    let tags = planned.samples.iter().map(|sample| sample.tag);
    tags.for_each(|tag: Tag| *counts.entry(tag.name()).or_insert(0) += 1);
    counts
}
