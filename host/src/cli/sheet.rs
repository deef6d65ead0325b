//! The budget sheet: what a planned scene holds, costs and is predicted to err by.

use super::failure::Failure;
use super::pipeline::Planned;
use crate::plan::{SurfacePlan, Tag};
use crate::report::percent;
use isolux::budget;
use serde::Serialize;
use std::collections::BTreeMap;

/// The budget sheet of a planned scene.
#[derive(Clone, Serialize)]
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
}

#[derive(Clone, Serialize)]
struct RungNames {
    arithmetic: &'static str,
    visibility: &'static str,
    emitters: &'static str,
    transfer: &'static str,
    placement: &'static str,
    reconstruction: &'static str,
}

#[derive(Clone, Serialize)]
struct OfSurface {
    name: String,
    samples: usize,
    by_tag: BTreeMap<&'static str, usize>,
    free_samples: usize,
    emitters: usize,
    predicted_error: Option<f64>,
    /// The same of every part of its light.
    parts: Vec<OfPart>,
}

#[derive(Clone, Serialize)]
struct OfPart {
    part: &'static str,
    /// In percent of all light there.
    error: f64,
    /// The area in m² that it is the mean over.
    area: f64,
}

impl Sheet {
    /// The sheet of a planned scene.
    ///
    /// # Errors
    /// Where the kernel does not take its tables.
    pub(super) fn of(planned: &Planned) -> Result<Self, Failure> {
        let (ram, sight) = planned.ram()?;
        let workspace = budget::sight_bytes(&sight);
        let room = match planned.rung.is_integer() {
            true => 0,
            false => budget::room_bytes(&planned.tables.counts),
        };
        let areas = planned.scene.surfaces.iter().map(|surface| surface.area);
        let error = planned.plan.predicted_error(areas);
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
            parts: parts(planned),
        };
        Ok(Self {
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
            ram_bytes: ram as u64,
            light_bytes: ram - workspace - room,
            workspace_bytes: workspace,
            room_bytes: room,
            table_bytes: planned.tables.bytes().len() as u64,
            predicted_error: error.map(|error| 100.0 * error),
            surfaces: looked_at.map(of_surface).collect(),
        })
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
        text
    }

    /// The sheet as Markdown.
    pub(super) fn in_markdown(&self) -> String {
        let rungs = &self.rungs;
        let mut text = format!(
            "# Budget sheet of `{}`\n\n\
             {} samples, {} values that are free, {} emitters beside {} luminaires; arithmetic `{}`, \
             visibility `{}`, emitters `{}`, transfer `{}`, placement `{}`, reconstruction `{}`.\n\n",
            self.scene,
            self.samples,
            self.free_samples,
            self.emitters,
            self.luminaires,
            rungs.arithmetic,
            rungs.visibility,
            rungs.emitters,
            rungs.transfer,
            rungs.placement,
            rungs.reconstruction
        );
        text += "| bytes | |\n| --- | ---: |\n";
        for (what, bytes) in [
            ("RAM: light", self.light_bytes as u64),
            ("RAM: workspace of visibility", self.workspace_bytes as u64),
            ("RAM: room to reconstruct in", self.room_bytes as u64),
            ("RAM in all", self.ram_bytes),
            ("flash: tables", self.table_bytes),
        ] {
            text += &format!("| {what} | {bytes} |\n");
        }
        let error = |error: Option<f64>| error.map_or("-".to_owned(), percent);
        text += &format!(
            "\nPredicted error in percent, relative, the root of the mean square: {} on all \
             surfaces together.\n\n\
             | surface | samples | free | emitters | error | by part |\n\
             | --- | ---: | ---: | ---: | ---: | --- |\n",
            error(self.predicted_error)
        );
        for surface in &self.surfaces {
            let parts = surface.parts.iter();
            let parts: Vec<String> = parts
                .map(|part| format!("{} {}", part.part, percent(part.error)))
                .collect();
            let tags = surface.by_tag.iter();
            let tags: Vec<String> = tags.map(|(tag, count)| format!("{count} {tag}")).collect();
            text += &format!(
                "| {} | {} ({}) | {} | {} | {} | {} |\n",
                surface.name.replace('|', "\\|"),
                surface.samples,
                tags.join(", "),
                surface.free_samples,
                surface.emitters,
                error(surface.predicted_error),
                parts.join(", ")
            );
        }
        text
    }
}

fn parts(planned: &SurfacePlan) -> Vec<OfPart> {
    let of = |part: &crate::plan::Predicted| OfPart {
        part: part.part.name(),
        error: 100.0 * part.rms,
        area: part.area,
    };
    planned.predicted.iter().map(of).collect()
}

fn by_tag(planned: &SurfacePlan) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    let tags = planned.samples.iter().map(|sample| sample.tag);
    tags.for_each(|tag: Tag| *counts.entry(tag.name()).or_insert(0) += 1);
    counts
}
