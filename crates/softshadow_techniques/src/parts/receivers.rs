//! The receiver stage: one record a receiver, written once a block, from which every technique starts.

use glam::DVec3;
use softshadow_plan::{
    Blend, ColorTarget, Compare, DepthTarget, Kernel, Origin, Over, Plan, Raster, RasterKernel, ResourceId,
    TextureFormat, Values, VertexSource,
};
use softshadow_scene::{LocalCamera, LocalPoint, Points};

use crate::parts::scene_buffers::{append_corners, append_nodes};
use crate::request::{ReceiverSource, Request};

/// Label of the receivers' buffer.
pub const RECEIVERS: &str = "receivers";
/// Bytes of one receiver.
pub const RECEIVER_BYTES: u64 = 32;

const DRAW_IDS: RasterKernel =
    RasterKernel { file: "receivers/draw_triangle_ids.wgsl", vertex: "draw", fragment: Some("write_id") };
const PLACE_ON_TRIANGLES: Kernel = Kernel { file: "receivers/place_on_triangles.wgsl", entry: "place" };
const TRACE_CAMERA: Kernel = Kernel { file: "receivers/trace_camera.wgsl", entry: "trace_camera" };
const PLACE_POINTS: Kernel = Kernel { file: "receivers/place_points.wgsl", entry: "place" };

/// A receiver as the kernels write it.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Receiver {
    /// Local float32 position, lifted off its surface.
    pub position: [f32; 3],
    /// Local triangle index, or `u32::MAX`.
    pub triangle: u32,
    /// Unit geometric normal on the viewer's side, or zero.
    pub normal: [f32; 3],
    /// 0: none, 1: with horizon, 2: without.
    pub kind: u32,
}

/// `CameraClip` of `draw_triangle_ids.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CameraClip {
    eye: [f32; 3],
    near: f32,
    clip_x: [f32; 3],
    reserved0: u32,
    clip_y: [f32; 3],
    reserved1: u32,
    forward: [f32; 3],
    reserved2: u32,
}

/// The ways of a camera's clip space: coordinates of p are dots with p − eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipWays {
    /// Across.
    pub x: DVec3,
    /// Up.
    pub y: DVec3,
}

/// The clip space of `count` rows of a camera's image.
#[must_use]
pub fn clip_ways(camera: &LocalCamera, first: usize, count: usize) -> ClipWays {
    let (width, height) = (f64::from(camera.size[0]), count as f64);
    // right·fx and up·fy in pixels, from steps of length 1/fx and 1/fy.
    let (x_pixels, y_pixels) =
        (camera.step_x / camera.step_x.length_squared(), camera.step_y / camera.step_y.length_squared());
    let (cx, cy) = (-camera.corner.dot(x_pixels), -camera.corner.dot(y_pixels) - first as f64);
    ClipWays {
        x: x_pixels * (2.0 / width) + camera.forward * (2.0 * cx / width - 1.0),
        y: y_pixels * (-2.0 / height) + camera.forward * (1.0 - 2.0 * cy / height),
    }
}

/// `CameraRays` of `place_on_triangles.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CameraRays {
    eye: [f32; 3],
    scene_extent: f32,
    corner: [f32; 3],
    width: u32,
    step_x: [f32; 3],
    first_pixel: u32,
    step_y: [f32; 3],
    reserved: u32,
}

/// `SubScene` of `place_on_triangles.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SubScene {
    first_triangle: u32,
    triangle_count: u32,
}

/// `PointRange` of `place_points.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PointRange {
    scene_extent: f32,
}

/// Nothing nearer to the eye than this is seen; local units, where the scene spans about 2.
const NEAR: f32 = 1.0 / 1_048_576.0;

/// Adds the receivers' buffer and, where the block begins, the passes that fill it.
pub fn append(plan: &mut Plan, request: &Request<'_>) -> ResourceId {
    let receivers = plan.persistent(RECEIVERS, request.block.count as u64 * RECEIVER_BYTES);
    if request.opens_block {
        match request.receivers {
            ReceiverSource::Camera(camera) => append_camera(plan, request, camera.size(), receivers),
            ReceiverSource::Points(_) => append_points(plan, request, receivers),
        }
    }
    receivers
}

/// The values of the parameters that [`append`] added.
pub fn values(request: &Request<'_>, values: &mut Values) {
    if !request.opens_block {
        return;
    }
    match request.receivers {
        ReceiverSource::Camera(camera) => camera_values(request, &camera.local(&request.scene.local.frame), values),
        ReceiverSource::Points(points) => point_values(request, points, values),
    }
}

fn append_camera(plan: &mut Plan, request: &Request<'_>, size: [u32; 2], receivers: ResourceId) {
    let corners = append_corners(plan, request.scene);
    let ids = request.host.features.raster.then(|| append_ids(plan, request, size, &corners));
    let rays = plan.parameter("camera rays", size_of::<CameraRays>() as u64);
    let traced = ids
        .is_none()
        .then(|| (append_nodes(plan, request.scene), plan.buffer("distances", request.block.count as u64 * 4)));
    let over = Over::Items { count: request.block.count as u32, work_per_item: if ids.is_some() { 1 } else { 64 } };
    for (index, buffer) in corners.iter().enumerate() {
        let sub_scene = plan.parameter(format!("sub-scene {index}"), size_of::<SubScene>() as u64);
        let label = format!("place receivers {index}");
        let pass = match (ids, &traced) {
            (Some(ids), _) => {
                let why = "puts a receiver where the pixel's ray meets its triangle";
                plan.compute(label, why, PLACE_ON_TRIANGLES, over).bind("triangle_ids", ids)
            }
            (None, Some((nodes, distances))) => {
                let why = "puts a receiver where the pixel's ray meets a triangle first";
                plan.compute(label, why, TRACE_CAMERA, over).bind("nodes", nodes[index]).bind("distances", *distances)
            }
            (None, None) => unreachable!("receivers are drawn or traced"),
        };
        pass.bind("camera_rays", rays)
            .bind("sub_scene", sub_scene)
            .bind("corners", *buffer)
            .bind("receivers", receivers);
    }
}

/// Which triangle each pixel sees, drawn where the run begins.
fn append_ids(plan: &mut Plan, request: &Request<'_>, size: [u32; 2], corners: &[ResourceId]) -> ResourceId {
    let ids = plan.texture("triangle ids", TextureFormat::R32Uint, size, Origin::Persistent);
    if request.opens_run {
        let depth = plan.texture("camera depth", TextureFormat::Depth32Float, size, Origin::Transient);
        let clip = plan.parameter("camera clip", size_of::<CameraClip>() as u64);
        for (index, (buffer, sub_scene)) in corners.iter().zip(&request.scene.local.sub_scenes).enumerate() {
            let first = index == 0;
            let raster = Raster {
                kernel: DRAW_IDS,
                vertices: VertexSource::Corners { buffer: *buffer, count: sub_scene.corners.len() as u32 },
                colors: vec![ColorTarget {
                    texture: ids,
                    layer: 0,
                    clear: first.then_some(0.0),
                    blend: Blend::Replace,
                }],
                depth: Some(DepthTarget {
                    texture: depth,
                    layer: 0,
                    clear: first.then_some(0.0),
                    compare: Compare::Greater,
                }),
            };
            let why = "finds the triangle that each pixel sees";
            plan.raster(format!("draw triangle ids {index}"), why, raster).bind("camera_clip", clip);
        }
    }
    ids
}

fn append_points(plan: &mut Plan, request: &Request<'_>, receivers: ResourceId) {
    let count = request.block.count;
    let points = plan.parameter("points", (count * size_of::<LocalPoint>()) as u64);
    let range = plan.parameter("point range", size_of::<PointRange>() as u64);
    let over = Over::Items { count: count as u32, work_per_item: 1 };
    plan.compute("place points", "lifts the given points off their surface", PLACE_POINTS, over)
        .bind("point_range", range)
        .bind("points", points)
        .bind("receivers", receivers);
}

fn camera_values(request: &Request<'_>, camera: &LocalCamera, values: &mut Values) {
    let f32s = |v: DVec3| v.as_vec3().to_array();
    let ways = clip_ways(camera, 0, camera.size[1] as usize);
    let clip = CameraClip {
        eye: f32s(camera.eye),
        near: NEAR,
        clip_x: f32s(ways.x),
        clip_y: f32s(ways.y),
        forward: f32s(camera.forward),
        ..bytemuck::Zeroable::zeroed()
    };
    let rays = CameraRays {
        eye: f32s(camera.eye),
        scene_extent: request.scene.local.extent,
        corner: f32s(camera.corner),
        width: camera.size[0],
        step_x: f32s(camera.step_x),
        first_pixel: request.block.first as u32,
        step_y: f32s(camera.step_y),
        reserved: 0,
    };
    if request.opens_run && request.host.features.raster {
        values.insert("camera clip".into(), bytemuck::bytes_of(&clip).to_vec());
    }
    values.insert("camera rays".into(), bytemuck::bytes_of(&rays).to_vec());
    for (index, sub_scene) in request.scene.local.sub_scenes.iter().enumerate() {
        let range =
            SubScene { first_triangle: sub_scene.first_triangle, triangle_count: (sub_scene.corners.len() / 3) as u32 };
        values.insert(format!("sub-scene {index}"), bytemuck::bytes_of(&range).to_vec());
    }
}

fn point_values(request: &Request<'_>, points: &Points, values: &mut Values) {
    let block = request.block;
    let local = points.local_block(&request.scene.local.frame, block.first..block.first + block.count);
    values.insert("points".into(), bytemuck::cast_slice(&local).to_vec());
    let range = PointRange { scene_extent: request.scene.local.extent };
    values.insert("point range".into(), bytemuck::bytes_of(&range).to_vec());
}
