//! # `hard_shadow_map`: one depth map from the light's centre
//!
//! The baseline: what does softness cost, and what does it change? Depth of the nearest occluder is drawn as seen from the
//! light's centre; a receiver is dark when something nearer lies in its texel. V is 0 or 1.
//!
//! **Parameters.** `resolution` of the map, 16 to 16,384 texels a side. There is no bias to find: the receiver's plane is
//! evaluated at the texel's centre, and what remains is half a texel and the slope within it.
//!
//! **When it is wrong.** Everywhere in a penumbra, by up to 1: the light is a point. Shadows end within a texel of where they
//! should; what lies inside a sphere light, but farther than half its radius from the centre, still shadows; gaps below about a
//! texel are not resolved, on strongly curved surfaces a texel's width of light or dark may show. Semi-opaque triangles are taken for
//! opaque, and every result says so.
//!
//! **Maps.** A frustum fitted to casters and receivers; beyond 120 degrees, or with the light inside the scene, six faces of a
//! cube; for a sun one parallel view.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use softshadow_plan::{
    Compare, DepthTarget, Kernel, Origin, Over, Plan, Raster, RasterKernel, Shape, TextureFormat, Values, VertexSource,
};
use softshadow_scene::{Light, LightSampling, LightShape, SamplePattern};

use crate::TechniqueError;
use crate::parts::VISIBILITY;
use crate::parts::light_buffers::{self, Sampling};
use crate::parts::shading::{self, Seen};
use crate::parts::{receivers, scene_buffers};
use crate::request::{ReceiverSource, Request};

/// Settings of `hard_shadow_map`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HardShadowMap {
    /// Texels a side.
    pub resolution: u32,
}

impl Default for HardShadowMap {
    fn default() -> Self {
        Self { resolution: 2048 }
    }
}

const DRAW_DEPTH: RasterKernel =
    RasterKernel { file: "hard_shadow_map/draw_depth.wgsl", vertex: "draw", fragment: Some("write_depth") };
const LOOK_UP: Kernel = Kernel { file: "hard_shadow_map/look_up.wgsl", entry: "look_up" };

/// Light samples of the unshadowed light in a picture.
const SHADING_SAMPLES: u32 = 64;

/// Distance of the near plane from a light without depth, in local units.
const NEAREST: f64 = 1.0 / 65_536.0;

/// `ShadowView` of `view.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ShadowView {
    eye: [f32; 3],
    near: f32,
    clip_x: [f32; 3],
    perspective: f32,
    clip_y: [f32; 3],
    resolution: f32,
    forward: [f32; 3],
    texel: f32,
}

/// `ShadowViews` of `look_up.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ShadowViews {
    views: [ShadowView; 6],
    count: u32,
    channels: u32,
    reserved0: u32,
    reserved1: u32,
}

impl HardShadowMap {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        if (16..=16_384).contains(&self.resolution) {
            return Ok(());
        }
        let reason = format!("must lie between 16 and 16384, got {}", self.resolution);
        Err(TechniqueError::Setting { technique: "hard_shadow_map", setting: "resolution", reason })
    }
}

/// Depth of every view, then one lookup a receiver.
pub(crate) fn plan(request: &Request<'_>, settings: &HardShadowMap) -> Plan {
    let mut plan = Plan::new("hard shadow map");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = plan.parameter("light", size_of::<light_buffers::LightRecord>() as u64);
    let views = views(request, settings);
    let bytes = count as u64 * 4 * u64::from(request.channels);
    let visibility = plan.persistent(VISIBILITY, bytes);
    let map = Shape::Texture {
        format: TextureFormat::Depth32Float,
        size: [settings.resolution; 2],
        // An array of one layer could not be told from a plain texture.
        layers: (views.len() as u32).max(2),
    };
    let depth_map = plan.resource("depth map", map, Origin::Transient);
    let corners = scene_buffers::append_corners(&mut plan, request.scene);
    for layer in 0..views.len() as u32 {
        let view = plan.parameter(format!("shadow view {layer}"), size_of::<ShadowView>() as u64);
        for (index, (buffer, sub_scene)) in corners.iter().zip(&request.scene.local.sub_scenes).enumerate() {
            let depth = DepthTarget {
                texture: depth_map,
                layer,
                clear: (index == 0).then_some(0.0),
                compare: Compare::Greater,
            };
            let vertices = VertexSource::Corners { buffer: *buffer, count: sub_scene.corners.len() as u32 };
            let raster = Raster { kernel: DRAW_DEPTH, vertices, colors: Vec::new(), depth: Some(depth) };
            let why = "draws the occluders' depth from the light's centre";
            plan.raster(format!("draw depth {layer} {index}"), why, raster).bind("shadow_view", view);
        }
    }
    let shadow_views = plan.parameter("shadow views", size_of::<ShadowViews>() as u64);
    if corners.is_empty() {
        // Nothing is drawn, so nothing would define the map; the kernel reads only views that exist, of which there are none.
        plan.resources[depth_map.index()].origin = Origin::Persistent;
    }
    let over = Over::Items { count: count as u32, work_per_item: 1 };
    plan.compute("look up", "compares each receiver with the map", LOOK_UP, over)
        .bind("light", light)
        .bind("shadow_views", shadow_views)
        .bind("depth_map", depth_map)
        .bind("receivers", receivers)
        .bind("visibility", visibility);
    if request.wants.picture.is_some() {
        let sampling = plan.parameter("sampling", size_of::<Sampling>() as u64);
        let samples = plan.parameter("light samples", u64::from(SHADING_SAMPLES) * 16);
        let buffers = light_buffers::LightBuffers { light, sampling, samples };
        shading::append(&mut plan, request, receivers, &buffers, Seen::Values(visibility), &shading_samples());
    }
    plan.outputs.push(visibility);
    plan.outputs.extend(request.opens_block.then_some(receivers));
    plan
}

/// The values of the plan's parameters for one light.
pub(crate) fn values(request: &Request<'_>, settings: &HardShadowMap, light: &Light) -> Result<Values, TechniqueError> {
    let mut values = Values::new();
    receivers::values(request, &mut values);
    light_buffers::values(request, light, &shading_samples(), &mut values)?;
    let sampling = Sampling::new(request, &shading_samples(), 0, 1);
    values.insert("sampling".into(), bytemuck::bytes_of(&sampling).to_vec());
    let views = views(request, settings);
    let mut all = ShadowViews {
        views: [bytemuck::Zeroable::zeroed(); 6],
        count: views.len() as u32,
        channels: request.channels,
        reserved0: 0,
        reserved1: 0,
    };
    for (layer, view) in views.iter().enumerate() {
        all.views[layer] = *view;
        values.insert(format!("shadow view {layer}"), bytemuck::bytes_of(view).to_vec());
    }
    values.insert("shadow views".into(), bytemuck::bytes_of(&all).to_vec());
    shading::values(request, 1, &mut values);
    Ok(values)
}

fn shading_samples() -> LightSampling {
    LightSampling::correlated(SamplePattern::Stratified, SHADING_SAMPLES, 0)
}

/// The views that cover casters and receivers; none without casters.
fn views(request: &Request<'_>, settings: &HardShadowMap) -> Vec<ShadowView> {
    let Some(corners) = hull(request) else { return Vec::new() };
    let place = request.light.local(&request.scene.local.frame);
    if let LightShape::Sun { .. } = request.light.shape() {
        return vec![parallel_view(&corners, place.emission, settings.resolution)];
    }
    let eye = place.center;
    // What lies inside a sphere light casts no shadow. In the corners of a view of 60 degrees to either side, and so of a cube's
    // face, a point at the depth of the near plane is up to twice as far away.
    let radius = match request.light.shape() {
        LightShape::Sphere { radius } => request.scene.local.frame.local_length(*radius),
        _ => 0.0,
    };
    let near = (radius * 0.5).max(NEAREST);
    let middle = corners.iter().sum::<DVec3>() / 8.0;
    let half_angle = |forward: DVec3| corners.iter().map(|c| (*c - eye).angle_between(forward)).fold(0.0, f64::max);
    match (middle - eye).try_normalize() {
        // NaN, from a corner at the eye, compares as false and takes the cube.
        Some(forward) if half_angle(forward) <= std::f64::consts::FRAC_PI_3 => {
            vec![fitted_view(&corners, eye, forward, near, settings.resolution)]
        }
        _ => [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]
            .map(|forward| face(eye, forward, [1.0, 1.0], near, settings.resolution))
            .to_vec(),
    }
}

/// Corners of the box around casters and receivers in local space; `None` without casters.
fn hull(request: &Request<'_>) -> Option<[DVec3; 8]> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    // The hierarchy's root knows the bounds of its sub-scene.
    for root in request.scene.local.sub_scenes.iter().filter_map(|s| s.nodes.first()) {
        low = low.min(DVec3::from(root.low.map(f64::from)));
        high = high.max(DVec3::from(root.high.map(f64::from)));
    }
    if low.x > high.x {
        return None;
    }
    if let ReceiverSource::Points(points) = request.receivers {
        for p in points.positions() {
            let p = request.scene.local.frame.local_from_world(*p);
            (low, high) = (low.min(p), high.max(p));
        }
    }
    // A hair of room, so that no receiver stands on the border.
    let room = (high - low).max_element() * 1e-4;
    let (low, high) = (low - room, high + room);
    Some(std::array::from_fn(|i| {
        let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
        DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    }))
}

fn fitted_view(corners: &[DVec3; 8], eye: DVec3, forward: DVec3, near: f64, resolution: u32) -> ShadowView {
    let (x, y) = forward.any_orthonormal_pair();
    let slope = |axis: DVec3| {
        corners.iter().map(|c| ((*c - eye).dot(axis) / (*c - eye).dot(forward)).abs()).fold(1e-6, f64::max)
    };
    face(eye, forward, [slope(x), slope(y)], near, resolution)
}

/// A perspective view with the given tangents of its half angles.
fn face(eye: DVec3, forward: DVec3, tangents: [f64; 2], near: f64, resolution: u32) -> ShadowView {
    let (x, y) = forward.any_orthonormal_pair();
    let f32s = |v: DVec3| v.as_vec3().to_array();
    ShadowView {
        eye: f32s(eye),
        near: near as f32,
        clip_x: f32s(x / tangents[0]),
        perspective: 1.0,
        clip_y: f32s(y / tangents[1]),
        resolution: resolution as f32,
        forward: f32s(forward),
        texel: (tangents[0].max(tangents[1]) / f64::from(resolution)) as f32,
    }
}

fn parallel_view(corners: &[DVec3; 8], forward: DVec3, resolution: u32) -> ShadowView {
    let (x, y) = forward.any_orthonormal_pair();
    let range = |axis: DVec3| {
        let along = corners.map(|c| c.dot(axis));
        (along.iter().copied().fold(f64::INFINITY, f64::min), along.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    let ([x0, x1], [y0, y1], [z0, z1]) = (range(x).into(), range(y).into(), range(forward).into());
    let eye = x * ((x0 + x1) * 0.5) + y * ((y0 + y1) * 0.5) + forward * z0;
    let half = [(x1 - x0) * 0.5, (y1 - y0) * 0.5].map(|h| h.max(1e-6));
    let f32s = |v: DVec3| v.as_vec3().to_array();
    ShadowView {
        eye: f32s(eye),
        near: ((z1 - z0) * 1.0001).max(1e-6) as f32,
        clip_x: f32s(x / half[0]),
        perspective: 0.0,
        clip_y: f32s(y / half[1]),
        resolution: resolution as f32,
        forward: f32s(forward),
        texel: (half[0].max(half[1]) / f64::from(resolution)) as f32,
    }
}
