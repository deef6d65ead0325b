//! Our side: solutions on the host, and what they cost on the device.

use super::by_default::Failed;
use super::prices::CORE;
use isolux::shoot::Stop;
use isolux_host::bake::Tables;
use isolux_host::device::{self, Job, Measured, Options};
use isolux_host::scene::Scene;
use isolux_host::solve::{self, Rung, Sight, Solution};

/// Tables with how they are solved.
pub(crate) struct Ours<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) tables: Tables,
    pub(crate) arithmetic: Rung,
    pub(crate) sight: Sight,
    pub(crate) stop: Stop,
}

impl Ours<'_> {
    /// The kernel's solution on the host.
    pub(crate) fn solved(&self) -> Result<Solution<'_>, Failed> {
        let solution = solve::solve(&self.tables, self.arithmetic, self.sight, self.stop);
        solution.map_err(|error| error.to_string().into())
    }

    /// The run on the device.
    pub(crate) fn on_device(&self) -> Result<Measured, Failed> {
        let job = Job {
            scene: &self.scene.name,
            tables: self.tables.bytes(),
            arithmetic: self.arithmetic.name(),
            visibility: self.sight.name(),
            stop: self.stop,
            // The picture is part of neither method's count.
            resolution: 1,
            expected: &[],
            budget: self.scene.budget,
        };
        let options = Options {
            cores: vec![CORE],
            software_root: false,
            ..Options::default()
        };
        device::run(&job, &options).map_err(|error| error.to_string().into())
    }

    /// Instructions of direct light and all shots on the device, bookkeeping included.
    pub(crate) fn instructions(&self) -> Result<f64, Failed> {
        let steps = self.on_device()?.instructions_by_step;
        Ok((steps.direct + steps.shoot) as f64)
    }
}
