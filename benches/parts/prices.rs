//! What single operations of either method cost in instructions on the device.

use isolux_host::device::{self, Core, Cost, Error};
use std::time::Duration;

/// The device the instructions are for.
pub(crate) const CORE: Core = Core::CortexM4F;

/// What single operations cost in instructions on the device.
pub(crate) struct Prices {
    /// A delta form factor among the 400 on a light source.
    pub(crate) on_source: f64,
    /// A delta form factor among the 16 on a patch.
    pub(crate) on_patch: f64,
    /// An exact form factor of a rectangle that is large and unclipped.
    pub(crate) exact: f64,
}

impl Prices {
    /// Runs the firmware's program `cost`.
    pub(crate) fn measure() -> Result<Self, Error> {
        let costs = device::costs(&[CORE], Duration::from_secs(120))?;
        let costs = costs.into_iter().next().unwrap_or_default();
        let of = |wanted: &dyn Fn(&Cost) -> bool| {
            let cost = costs.iter().find(|cost| wanted(cost));
            cost.map(Cost::mean).ok_or_else(|| Error::Log {
                what: "an operation is missing".to_owned(),
            })
        };
        let delta =
            |size| move |cost: &Cost| cost.operation == "delta-form-factors" && cost.size == size;
        let exact = |cost: &Cost| {
            let names = [&cost.operation, &cost.rung, &cost.root, &cost.case];
            names.map(String::as_str) == ["form-factor", "best", "fpu", "large-unclipped"]
                && cost.size == 4
        };
        Ok(Self {
            on_source: of(&delta(400))? / 400.0,
            on_patch: of(&delta(16))? / 16.0,
            exact: of(&exact)?,
        })
    }
}
