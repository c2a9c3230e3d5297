//! Plans as text: `{plan}` is what snapshots compare, [`Plan::explain`] is what people read.

use std::fmt::{self, Display, Write as _};

use crate::pass::{Count, Over, Raster, VertexSource, Work};
use crate::plan::Plan;
use crate::resource::{Origin, Resource, ResourceId, Shape};

impl Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "plan '{}'", self.name)?;
        for resource in &self.resources {
            writeln!(f, "  {resource}")?;
        }
        for pass in &self.passes {
            write!(f, "  {}: ", pass.label)?;
            self.write_work(f, &pass.work)?;
            for (name, id) in &pass.bindings {
                write!(f, " {name}={}", self.label(*id))?;
            }
            writeln!(f)?;
        }
        for (word, ids) in [("output", self.outputs.as_slice()), ("decision", self.decision.as_slice())] {
            for id in ids {
                writeln!(f, "  {word}: {}", self.label(*id))?;
            }
        }
        Ok(())
    }
}

impl Display for Resource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let origin = match self.origin {
            Origin::Transient => "transient",
            Origin::Uploaded(_) => "uploaded",
            Origin::Persistent => "persistent",
            Origin::Parameter => "parameter",
            Origin::External => "external",
        };
        match self.shape {
            Shape::Buffer { bytes } => write!(f, "[{}] {origin} buffer, {bytes} bytes", self.label),
            Shape::Texture { format, size: [width, height], layers } => {
                write!(f, "[{}] {origin} {format:?} {width} × {height} × {layers}", self.label)
            }
        }
    }
}

impl Plan {
    /// Every pass with the reason for it, and every resource with its bytes.
    #[must_use]
    pub fn explain(&self) -> String {
        let mut text = format!("{}\n", self.name);
        for pass in &self.passes {
            let _ = writeln!(text, "  {}: {}", pass.label, pass.why);
        }
        let mut total = 0;
        for resource in &self.resources {
            total += resource.bytes();
            let _ = writeln!(text, "  {:>12} bytes  {resource}", resource.bytes());
        }
        let _ = writeln!(text, "  {total:>12} bytes in all");
        text
    }

    fn label(&self, id: ResourceId) -> &str {
        &self.resources[id.index()].label
    }

    fn write_work(&self, f: &mut fmt::Formatter<'_>, work: &Work) -> fmt::Result {
        match work {
            Work::Clear { target } => write!(f, "clear [{}]", self.label(*target)),
            Work::Copy { source, target, bytes } => {
                write!(f, "copy {bytes} bytes [{}] to [{}]", self.label(*source), self.label(*target))
            }
            Work::Compute { kernel, over: Over::Items { count, .. } } => write!(f, "{kernel} over {count}"),
            Work::Compute { kernel, over: Over::Indirect(buffer) } => {
                write!(f, "{kernel} over the groups in [{}]", self.label(*buffer))
            }
            Work::Raster(raster) => self.write_raster(f, raster),
        }
    }

    fn write_raster(&self, f: &mut fmt::Formatter<'_>, raster: &Raster) -> fmt::Result {
        write!(f, "{} ", raster.kernel)?;
        match raster.vertices {
            VertexSource::Corners { buffer, count } => write!(f, "draws {count} corners of [{}]", self.label(buffer))?,
            VertexSource::Generated(Count::Fixed(count)) => write!(f, "draws {count} vertices")?,
            VertexSource::Generated(Count::Indirect(buffer)) => {
                write!(f, "draws the vertices counted in [{}]", self.label(buffer))?;
            }
        }
        for color in &raster.colors {
            write!(f, " into [{}] layer {} ({:?})", self.label(color.texture), color.layer, color.blend)?;
        }
        if let Some(depth) = &raster.depth {
            write!(f, " depth [{}] layer {} ({:?})", self.label(depth.texture), depth.layer, depth.compare)?;
        }
        Ok(())
    }
}
