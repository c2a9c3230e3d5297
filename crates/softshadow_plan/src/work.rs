//! How much a plan has to do, in numbers that are known before it runs.

use crate::pass::{Count, Over, VertexSource, Work};
use crate::plan::Plan;

/// The work of one pass. Units are those of its kernel alone: items times what an item costs, vertices, or bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct PassWork {
    /// The pass.
    pub label: String,
    /// What runs in it, by name; `clear` and `copy` for what is no kernel.
    pub kernel: String,
    /// How much.
    pub units: f64,
}

impl Plan {
    /// The work of every pass. Passes whose size an earlier one finds count `found` units: an upper bound that grows as they do.
    #[must_use]
    pub fn work(&self, found: f64) -> Vec<PassWork> {
        let bytes = |id: crate::ResourceId| self.resources[id.index()].bytes() as f64;
        let of = |work: &Work| match work {
            Work::Compute { kernel, over: Over::Items { count, work_per_item } } => {
                (kernel.to_string(), f64::from(*count) * f64::from((*work_per_item).max(1)))
            }
            Work::Compute { kernel, over: Over::Indirect(_) } => (kernel.to_string(), found),
            Work::Raster(raster) => {
                let vertices = match raster.vertices {
                    VertexSource::Corners { count, .. } | VertexSource::Generated(Count::Fixed(count)) => {
                        f64::from(count)
                    }
                    VertexSource::Generated(Count::Indirect(_)) => found,
                };
                (raster.kernel.to_string(), vertices)
            }
            Work::Clear { target } => ("clear".into(), bytes(*target)),
            Work::Copy { bytes, .. } => ("copy".into(), *bytes as f64),
        };
        let pass_work = |pass: &crate::Pass| {
            let (kernel, units) = of(&pass.work);
            PassWork { label: pass.label.clone(), kernel, units }
        };
        self.passes.iter().map(pass_work).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kernel;

    #[test]
    fn work_grows_with_what_a_plan_is_for() {
        let work = |items: u32, found: f64| {
            let mut plan = Plan::new("two passes");
            let buffer = plan.buffer("list", u64::from(items) * 4);
            plan.clear("empty", "starts the list", buffer);
            let kernel = Kernel { file: "a.wgsl", entry: "main" };
            plan.compute("fill", "fills it", kernel, Over::Items { count: items, work_per_item: 3 });
            plan.compute("read", "reads it", kernel, Over::Indirect(buffer));
            plan.work(found).into_iter().map(|pass| (pass.kernel, pass.units)).collect::<Vec<_>>()
        };
        let named = |units: [f64; 3]| {
            let kernels = ["clear", "a.wgsl:main", "a.wgsl:main"];
            kernels.map(str::to_owned).into_iter().zip(units).collect::<Vec<_>>()
        };
        assert_eq!(work(10, 7.0), named([40.0, 30.0, 7.0]));
        assert_eq!(work(20, 14.0), named([80.0, 60.0, 14.0]));
    }
}
