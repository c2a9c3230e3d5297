//! # `penumbra_map`: a shadow map, and beside it the penumbra of what it shows
//!
//! Wyman and Hansen, *Penumbra Maps: Approximate Soft Shadows in Real-Time*, Eurographics Symposium on Rendering 2003. The shadow map from
//! the light's centre gives the umbra. From every silhouette edge, as that centre sees it, a sheet runs to the farthest receiver, with a
//! cone at either end whose section is the light's outline reflected in that end; a second map, texel by texel the first one's, keeps the
//! darkest intensity of all that lies before the surface there. Two lookups a receiver.
//!
//! The intensity of a fragment at depth `z_F` over a surface at depth `z_P`, behind an occluder at `z_V`, is
//! `I = (1/z_V − 1/z_F) / (1/z_V − 1/z_P)`: the distance of the edge's image from the light's centre as the surface sees it, in
//! units of the light's outline. The fragment computes that image, so that sheets need no subdivision and nothing is interpolated.
//! The darkest wins as depth, in a `depth32float` target with `Less`: exact, in any order, on every device. All on the device: edges
//! are listed by a kernel and drawn by an indirect draw.
//!
//! **Parameters.** `resolution` of both maps, 16 to 16,384 texels a side. `ramp`: how I becomes light. `light`, the default: the share of
//! the light's outline on one side of a line across it; `linear`: I; `paper`: `3I² − 2I³` of the paper's `I = (z_F − z_V) / (z_P − z_V)`, which
//! perspective bends.
//!
//! **When it is wrong.** Always, and darker: the umbra is the hard shadow and never shrinks, so half of every penumbra is missing, 0.5 at the
//! hard edge, 0.25 on average of an isolated one. In root mean square that is as far off as a hard shadow, 0.289: what is gained is
//! that no step is seen. The larger the light, and the farther the surface behind its occluder, the worse.
//! Where penumbrae overlap the darkest stands for their sum or product. Silhouettes are those of the light's centre. Maps show
//! the foremost surfaces alone: a receiver that no texel shows is lit, and counted. A penumbra narrower than a texel is hard. Horizons
//! that cut the light are none. Semi-opaque triangles are taken for opaque, textures of lights are left out, a concave outline is
//! taken for its hull, and what touches a ball of light has a hard shadow; results say so.
//!
//! **Proxies.** The paper draws shadows of simplified models. Here a call has one scene: give the simplified one, and the
//! receivers of the full one as points.

mod record;
mod settings;

use softshadow_plan::{
    Compare, Count, DepthTarget, Kernel, Origin, Over, Plan, Raster, RasterKernel, ResourceId, Shape, TextureFormat,
    Values, VertexSource,
};
use softshadow_scene::{Light, LightShape};

use crate::TechniqueError;
use crate::parts::VISIBILITY;
use crate::parts::light_buffers::LightRecord;
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::shadow_views::{self, ShadowMaps};
use crate::parts::{light_silhouettes, receivers, seen_values};
use crate::request::Request;
pub use record::{MapLayer, PenumbraLight};
pub use settings::{PenumbraMap, Ramp};

/// Label of the count of receivers that no texel shows.
pub const STRAYS: &str = "receivers astray";

const LOOK_UP: Kernel = Kernel { file: "penumbra_map/look_up.wgsl", entry: "look_up" };
const LOOK_UP_DEPTH: Kernel = Kernel { file: "penumbra_map/look_up.wgsl", entry: "look_up_depth" };
const SEE_ALL: Kernel = Kernel { file: "penumbra_map/look_up.wgsl", entry: "see_all" };

/// Corners drawn at each edge: `HULL_TRIANGLES` of `hull.wgsl`.
pub const HULL_CORNERS: u32 = 12;

/// Bytes of `LookUpCounts`.
const COUNT_BYTES: u64 = 4;

fn draw_kernel(shape: &LightShape) -> RasterKernel {
    let (vertex, fragment) = match shape {
        LightShape::Disc { .. } => ("extrude_disc", "shade_disc"),
        LightShape::Sun { .. } => ("extrude_sun", "shade_sun"),
        LightShape::Sphere { .. } => ("extrude_sphere", "shade_sphere"),
        LightShape::Rectangle { .. } => ("extrude_rectangle", "shade_rectangle"),
        LightShape::Polygon { .. } => ("extrude_polygon", "shade_polygon"),
    };
    RasterKernel { file: "penumbra_map/draw.wgsl", vertex, fragment: Some(fragment) }
}

/// Silhouettes, where something has a penumbra.
fn softened<'a>(request: &Request<'a>) -> Option<&'a OccluderContents> {
    request.occluders.filter(|occluders| occluders.edge_count > 0 && record::has_size(request.light))
}

/// Depth of every view, the silhouettes, the penumbra map, then one lookup a receiver.
pub(crate) fn plan(request: &Request<'_>, settings: &PenumbraMap) -> Plan {
    let mut plan = Plan::new("penumbra map");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = plan.parameter("light", size_of::<LightRecord>() as u64);
    let bytes = count as u64 * 4 * u64::from(request.channels);
    let visibility = plan.persistent(VISIBILITY, bytes);
    let over = Over::Items { count: count as u32, work_per_item: 1 };
    let views = shadow_views::views(request, settings.resolution).len() as u32;
    if views == 0 {
        let all = plan.parameter("shadow views", size_of::<shadow_views::ShadowViews>() as u64);
        plan.compute("see all", "nothing casts a shadow", SEE_ALL, over)
            .bind("light", light)
            .bind("shadow_views", all)
            .bind("receivers", receivers)
            .bind("visibility", visibility);
    } else {
        let maps = shadow_views::append(&mut plan, request, settings.resolution);
        let soft = softened(request).map(|occluders| {
            let penumbra = append_map(&mut plan, request, settings, occluders, maps, views, light);
            let strays = plan.buffer(STRAYS, COUNT_BYTES);
            plan.clear("no strays", "no receiver is looked up yet", strays);
            [penumbra, strays]
        });
        let kernel = if soft.is_some() { LOOK_UP } else { LOOK_UP_DEPTH };
        let pass = plan.compute("look up", "compares each receiver with the maps", kernel, over);
        pass.bind("light", light)
            .bind("shadow_views", maps.views)
            .bind("depth_map", maps.depth)
            .bind("receivers", receivers)
            .bind("visibility", visibility);
        if let Some([penumbra, strays]) = soft {
            pass.bind("penumbra_map", penumbra).bind("counts", strays);
            plan.outputs.push(strays);
        }
    }
    seen_values::append(&mut plan, request, receivers, light, visibility);
    plan
}

/// Lists the silhouettes and draws their cones and sheets into every view.
fn append_map(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &PenumbraMap,
    occluders: &OccluderContents,
    maps: ShadowMaps,
    views: u32,
    light: ResourceId,
) -> ResourceId {
    let silhouettes = light_silhouettes::append(plan, occluders, light);
    let record = plan.parameter("penumbra light", size_of::<PenumbraLight>() as u64);
    let layers = shadow_views::layers(views);
    let shape = Shape::Texture { format: TextureFormat::Depth32Float, size: [settings.resolution; 2], layers };
    let texture = plan.resource("penumbra map", shape, Origin::Transient);
    for layer in 0..views {
        // The corners' pass has added it.
        let Some(view) = plan.find(&shadow_views::view_label(layer)) else { continue };
        let map_layer = plan.parameter(layer_label(layer), size_of::<MapLayer>() as u64);
        let depth = DepthTarget { texture, layer, clear: Some(1.0), compare: Compare::Less };
        let vertices = VertexSource::Generated(Count::Indirect(silhouettes.draw));
        let kernel = draw_kernel(request.light.shape());
        let raster = Raster { kernel, vertices, colors: Vec::new(), depth: Some(depth) };
        let why = "draws cones and sheets of silhouettes, and keeps the darkest";
        plan.raster(format!("draw penumbra {layer}"), why, raster)
            .bind("shadow_view", view)
            .bind("penumbra_light", record)
            .bind("map_layer", map_layer)
            .bind("silhouettes", silhouettes.list)
            .bind("depth_map", maps.depth);
    }
    texture
}

/// Label of the parameter that names a layer.
fn layer_label(layer: u32) -> String {
    format!("map layer {layer}")
}

/// The values of the plan's parameters for one light.
pub(crate) fn values(request: &Request<'_>, settings: &PenumbraMap, light: &Light) -> Result<Values, TechniqueError> {
    let mut values = seen_values::values(request, light)?;
    shadow_views::values(request, settings.resolution, &mut values);
    light_silhouettes::values(HULL_CORNERS, &mut values);
    let record = PenumbraLight::new(request, light, settings.ramp);
    values.insert("penumbra light".into(), bytemuck::bytes_of(&record).to_vec());
    for layer in 0..6 {
        values.insert(layer_label(layer), bytemuck::bytes_of(&MapLayer::new(layer)).to_vec());
    }
    Ok(values)
}
