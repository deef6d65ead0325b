//! The budget sheet in words and as Markdown.

use super::{Cost, OfTag, Sheet};
use crate::device::model::Predicted;
use crate::report::{percent, quantity};

impl Sheet {
    /// The sheet for people, a line a surface.
    pub(in crate::cli) fn in_words(&self) -> String {
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
            Some(error) => format!(
                "  predicted error {} % (relative, rms){}\n",
                percent(error),
                in_brackets(&self.predicted_by_tag)
            ),
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
            let error = surface.predicted_error.map_or(String::new(), |error| {
                let by_tag = in_brackets(&surface.predicted_by_tag);
                format!(", error {} %{by_tag}", percent(error))
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
        if let Some(cost) = &self.cost {
            text += &cost.in_words();
        }
        text
    }

    /// The sheet as Markdown.
    pub(in crate::cli) fn in_markdown(&self) -> String {
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
             surfaces together{}.\n\n\
             | surface | samples | free | emitters | error | by part | by tag |\n\
             | --- | ---: | ---: | ---: | ---: | --- | --- |\n",
            error(self.predicted_error),
            in_brackets(&self.predicted_by_tag)
        );
        for surface in &self.surfaces {
            let parts = surface.parts.iter();
            let parts: Vec<String> = parts
                .map(|part| format!("{} {}", part.part, percent(part.error)))
                .collect();
            let tags = surface.by_tag.iter();
            let tags: Vec<String> = tags.map(|(tag, count)| format!("{count} {tag}")).collect();
            text += &format!(
                "| {} | {} ({}) | {} | {} | {} | {} | {} |\n",
                surface.name.replace('|', "\\|"),
                surface.samples,
                tags.join(", "),
                surface.free_samples,
                surface.emitters,
                error(surface.predicted_error),
                parts.join(", "),
                errors(&surface.predicted_by_tag)
            );
        }
        if let Some(cost) = &self.cost {
            text += &cost.in_markdown();
        }
        text
    }
}

impl Cost {
    /// The steps with their names.
    fn steps(&self) -> [(&'static str, Predicted, f64); 4] {
        let steps = &self.instructions;
        [
            ("load", steps.load, self.error.load),
            ("direct", steps.direct, self.error.light),
            ("shoot", steps.shoot, self.error.light),
            ("resample", steps.resample, self.error.resample),
        ]
    }

    fn in_words(&self) -> String {
        let steps = self
            .steps()
            .map(|(name, step, error)| format!("{name} {} ± {} %", step.expected, percent(error)));
        let times = self.milliseconds.iter().map(|at| {
            let (time, clock) = (quantity(at.milliseconds), at.megahertz);
            format!("{time} ms at {clock} MHz")
        });
        let times: Vec<String> = times.collect();
        let charge = self
            .microcoulombs
            .map_or(String::new(), |charge| format!("; {} µC", quantity(charge)));
        format!(
            "  predicted instructions on {}: {}\n  in all {} in {} shots, about {}{charge}\n",
            self.core,
            steps.join(", "),
            self.instructions_total.expected,
            self.shots,
            times.join(", "),
        )
    }

    fn in_markdown(&self) -> String {
        let mut text = format!(
            "\nPredicted instructions on a {} with `{}`, linked for speed; `shoot` is {} shots \
             with those of direct light, `resample` grids of {} × {} of every surface.\n\n\
             | step | instructions | at most |\n| --- | ---: | ---: |\n",
            self.core, self.arithmetic, self.shots, self.resolution, self.resolution
        );
        let all = ("in all", self.instructions_total, 0.0);
        for (name, step, _) in self.steps().into_iter().chain([all]) {
            text += &format!("| {name} | {} | {} |\n", step.expected, step.at_most);
        }
        text += &format!("\nAbout {} cycles:", self.cycles);
        for at in &self.milliseconds {
            text += &format!(" {} ms at {} MHz,", quantity(at.milliseconds), at.megahertz);
        }
        text += " estimated, from flash without wait states";
        if let Some(charge) = self.microcoulombs {
            text += &format!("; {} µC", quantity(charge));
        }
        text + ".\n"
    }
}

/// `lit 0.5, penumbra 2.0`, in percent.
fn errors(tags: &[OfTag]) -> String {
    let tags = tags
        .iter()
        .map(|at| format!("{} {}", at.tag, percent(at.error)));
    tags.collect::<Vec<_>>().join(", ")
}

/// The same in brackets; nothing where nothing is predicted.
fn in_brackets(tags: &[OfTag]) -> String {
    match tags {
        [] => String::new(),
        tags => format!(" ({})", errors(tags)),
    }
}
