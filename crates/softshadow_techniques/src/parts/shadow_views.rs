//! Depth of the nearest occluder as seen from the light's centre.
//!
//! A frustum fitted to casters and receivers; beyond 120 degrees, or with the light inside the scene, six faces of a cube; for a sun one
//! parallel view. Depth is reversed, near / distance.

use glam::DVec3;
use softshadow_plan::{
    Compare, DepthTarget, Origin, Plan, Raster, RasterKernel, ResourceId, Shape, TextureFormat, Values, VertexSource,
};
use softshadow_scene::LightShape;

use crate::parts::scene_buffers;
use crate::request::{ReceiverSource, Request};

const DRAW_DEPTH: RasterKernel =
    RasterKernel { file: "light_depth/draw_depth.wgsl", vertex: "draw", fragment: Some("write_depth") };

/// Distance of the near plane from a light without depth, in local units.
const NEAREST: f64 = 1.0 / 65_536.0;

/// `ShadowView` of `shadow_view.wgsl`.
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

/// `ShadowViews` of `shadow_view.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ShadowViews {
    views: [ShadowView; 6],
    count: u32,
    channels: u32,
    reserved0: u32,
    reserved1: u32,
}

/// What passes read of the views.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShadowMaps {
    /// `ShadowViews`.
    pub(crate) views: ResourceId,
    /// Depth, a layer a view.
    pub(crate) depth: ResourceId,
}

/// Draws the occluders' depth in every view.
pub(crate) fn append(plan: &mut Plan, request: &Request<'_>, resolution: u32) -> ShadowMaps {
    let views = views(request, resolution);
    let shape = Shape::Texture {
        format: TextureFormat::Depth32Float,
        size: [resolution; 2],
        // An array of one layer could not be told from a plain texture.
        layers: (views.len() as u32).max(2),
    };
    let texture = plan.resource("depth map", shape, Origin::Transient);
    let corners = scene_buffers::append_corners(plan, request.scene);
    for layer in 0..views.len() as u32 {
        let view = plan.parameter(view_label(layer), size_of::<ShadowView>() as u64);
        for (index, (buffer, sub_scene)) in corners.iter().zip(&request.scene.local.sub_scenes).enumerate() {
            let clear = (index == 0).then_some(0.0);
            let depth = DepthTarget { texture, layer, clear, compare: Compare::Greater };
            let vertices = VertexSource::Corners { buffer: *buffer, count: sub_scene.corners.len() as u32 };
            let raster = Raster { kernel: DRAW_DEPTH, vertices, colors: Vec::new(), depth: Some(depth) };
            let why = "draws the occluders' depth from the light's centre";
            plan.raster(format!("draw depth {layer} {index}"), why, raster).bind("shadow_view", view);
        }
    }
    if corners.is_empty() {
        // Nothing is drawn, so nothing would define the map; kernels read only views that exist, of which there are none.
        plan.resources[texture.index()].origin = Origin::Persistent;
    }
    ShadowMaps { views: plan.parameter("shadow views", size_of::<ShadowViews>() as u64), depth: texture }
}

/// Label of the parameter that holds one view.
pub(crate) fn view_label(layer: u32) -> String {
    format!("shadow view {layer}")
}

/// The values of those parameters.
pub(crate) fn values(request: &Request<'_>, resolution: u32, values: &mut Values) {
    let views = views(request, resolution);
    let mut all = ShadowViews {
        views: [bytemuck::Zeroable::zeroed(); 6],
        count: views.len() as u32,
        channels: request.channels,
        reserved0: 0,
        reserved1: 0,
    };
    for (layer, view) in views.iter().enumerate() {
        all.views[layer] = *view;
        values.insert(view_label(layer as u32), bytemuck::bytes_of(view).to_vec());
    }
    values.insert("shadow views".into(), bytemuck::bytes_of(&all).to_vec());
}

/// The views that cover casters and receivers; none without casters.
pub(crate) fn views(request: &Request<'_>, resolution: u32) -> Vec<ShadowView> {
    let Some(corners) = hull(request) else { return Vec::new() };
    let place = request.light.local(&request.scene.local.frame);
    if let LightShape::Sun { .. } = request.light.shape() {
        return vec![parallel_view(&corners, place.emission, resolution)];
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
            vec![fitted_view(&corners, eye, forward, near, resolution)]
        }
        _ => [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]
            .map(|forward| face(eye, forward, [1.0, 1.0], near, resolution))
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
