//! The accuracy ladders: the trades a scene, a plan or a flag may choose.

use super::Rungs;

/// One ladder and the names of its rungs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ladder {
    /// Key in a scene's `[rungs]` and name of the flag.
    pub name: &'static str,
    /// Rungs that may be chosen.
    pub rungs: &'static [&'static str],
}

/// Every ladder, in the order in which they are documented.
pub const LADDERS: [Ladder; 6] = [
    Ladder {
        name: "arithmetic",
        rungs: &[
            "libm",
            "micromath",
            "poly3",
            "poly5",
            "poly8",
            "best",
            "q24",
            "q29",
        ],
    },
    Ladder {
        name: "visibility",
        rungs: &["none", "vertex-rays", "exact"],
    },
    Ladder {
        name: "emitters",
        rungs: &["isolux", "layer-cake", "points", "few-points", "linear"],
    },
    Ladder {
        name: "transfer",
        rungs: &["exact", "codes", "matrix", "vectors"],
    },
    Ladder {
        name: "placement",
        rungs: &["isolux", "error"],
    },
    Ladder {
        name: "reconstruction",
        rungs: &["cone", "stencil", "tensor"],
    },
];

impl Ladder {
    /// The ladder of that name.
    pub fn named(name: &str) -> Option<Self> {
        LADDERS.into_iter().find(|ladder| ladder.name == name)
    }

    /// Whether `rung` is one of this ladder's.
    pub fn has(&self, rung: &str) -> bool {
        self.rungs.contains(&rung)
    }
}

impl Rungs {
    /// The place of a ladder's choice; `None` for an unknown ladder.
    pub fn choice_mut(&mut self, ladder: &str) -> Option<&mut Option<String>> {
        Some(match ladder {
            "arithmetic" => &mut self.arithmetic,
            "visibility" => &mut self.visibility,
            "emitters" => &mut self.emitters,
            "transfer" => &mut self.transfer,
            "placement" => &mut self.placement,
            "reconstruction" => &mut self.reconstruction,
            _ => return None,
        })
    }
}
