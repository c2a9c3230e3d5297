//! The frame in which a scene is sliced: where the light stands, and from where the scene is projected.

use glam::{DVec2, DVec3};
use softshadow_scene::{Light, LightShape};

use super::settings::{Filter, NAME, OcclusionLayers, Projection};
use crate::TechniqueError;
use crate::request::{ReceiverSource, Request};

/// `LayerFrame` of `layers.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LayerFrame {
    origin: [f32; 3],
    kind: u32,
    row_x: [f32; 3],
    tangent: f32,
    row_y: [f32; 3],
    slices: u32,
    row_z: [f32; 3],
    resolution: u32,
    successors: u32,
    filter_kind: u32,
    reserved0: u32,
    reserved1: u32,
}

/// `CasterRange` of `casters.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CasterRange {
    box_center: [f32; 3],
    inverse_distance: f32,
    box_half: [f32; 3],
    farthest: f32,
    hull_low: [f32; 2],
    hull_high: [f32; 2],
    light: [[f32; 4]; 4],
    light_reach: f32,
    extent: f32,
    is_square: u32,
    reserved: u32,
}

const FLAT: u32 = 0;
const SPHERE: u32 = 1;
const SUN: u32 = 2;

/// Half size, in local units, that a smaller light is given in the frame; its parts stay as small as they are. A frame has to have a scale, and
/// the centre of projection stands the closer behind a light the smaller it is.
const LEAST_HALF_SIZE: f64 = 1.0 / 1024.0;

/// Receivers must see a sphere's middle below this slope, across by depth: from farther aside its outline is no disc of one plane.
const STEEPEST: f64 = 3.0;

/// A light's own axes, in the local frame of a scene.
#[derive(Debug, Clone)]
pub(super) struct LightAxes {
    kind: u32,
    origin: DVec3,
    /// Unit ways across, and away from the light.
    axes: [DVec3; 3],
    /// Half sizes of the frame.
    scale: DVec2,
    /// Half sizes of the light in those of the frame: 1, or less where it is smaller than frames are.
    pub(super) reach: DVec2,
    tangent: f64,
    radius: f64,
}

impl LightAxes {
    pub(super) fn new(request: &Request<'_>, light: &Light) -> Self {
        let place = light.local(&request.scene.local.frame);
        let axes = [place.x_axis, -place.y_axis, place.emission];
        let flat = |middle: DVec2, half: DVec2| {
            let half = half * place.length_scale;
            let scale = half.max(DVec2::splat(LEAST_HALF_SIZE));
            let middle = middle * place.length_scale;
            let origin = place.center + place.x_axis * middle.x + place.y_axis * middle.y;
            Self { kind: FLAT, origin, axes, scale, reach: half / scale, tangent: 0.0, radius: 0.0 }
        };
        match light.shape() {
            LightShape::Rectangle { width, height } => flat(DVec2::ZERO, DVec2::new(*width, *height) * 0.5),
            LightShape::Disc { radius } => flat(DVec2::ZERO, DVec2::splat(*radius)),
            LightShape::Polygon { outline } => {
                let [middle, half] = middle_and_half(outline);
                flat(middle, half)
            }
            LightShape::Sphere { radius } => {
                let ball = flat(DVec2::ZERO, DVec2::splat(*radius));
                Self { kind: SPHERE, tangent: 1.0 / ball.scale.x, radius: radius * place.length_scale, ..ball }
            }
            LightShape::Sun { angular_diameter } => Self {
                kind: SUN,
                origin: DVec3::ZERO,
                axes,
                scale: DVec2::ONE,
                reach: DVec2::ONE,
                tangent: (angular_diameter * 0.5).tan(),
                radius: 0.0,
            },
        }
    }

    pub(super) fn record(&self, settings: &OcclusionLayers) -> LayerFrame {
        let [x, y, z] = self.axes;
        LayerFrame {
            origin: single(self.origin),
            kind: self.kind,
            row_x: single(x / self.scale.x),
            tangent: self.tangent as f32,
            row_y: single(y / self.scale.y),
            slices: settings.slices,
            row_z: single(z),
            resolution: settings.resolution,
            successors: u32::from(settings.repair_leaks),
            filter_kind: match settings.filter {
                Filter::SummedArea => 0,
                Filter::Nbuffer => 1,
                Filter::Mipmap => 2,
            },
            reserved0: 0,
            reserved1: 0,
        }
    }

    fn place(&self, p: DVec3) -> DVec3 {
        let way = p - self.origin;
        DVec3::new(way.dot(self.axes[0]) / self.scale.x, way.dot(self.axes[1]) / self.scale.y, way.dot(self.axes[2]))
    }

    /// What casters have to lie between.
    ///
    /// # Errors
    /// [`TechniqueError::Setting`] for a sphere among the receivers.
    pub(super) fn range(
        &self,
        request: &Request<'_>,
        settings: &OcclusionLayers,
    ) -> Result<CasterRange, TechniqueError> {
        let [low, high] = receiver_box(request);
        let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let corners: [DVec3; 8] = std::array::from_fn(|i| {
            let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
            self.place(DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z)))
        });
        let across = |c: &DVec3| c.x.abs().max(c.y.abs());
        let widest = corners.iter().map(across).fold(0.0, f64::max);
        let farthest = corners.iter().map(|c| c.z).fold(f64::NEG_INFINITY, f64::max);
        if self.kind == SPHERE && corners.iter().any(|c| across(c) * self.scale.x > STEEPEST * c.z) {
            let reason = "this sphere light stands among the receivers or too near them to be sliced from one side; trace rays or \
                          count edges"
                .to_owned();
            return Err(TechniqueError::Setting { technique: NAME, setting: "light", reason });
        }
        let is_parallel = self.kind == SUN || settings.projection == Projection::Parallel || farthest <= 0.0;
        let inverse_distance = if is_parallel { 0.0 } else { ((widest - 1.0) / farthest).max(0.0) };
        let projected = |z: f64| z / (1.0 + z.max(0.0) * inverse_distance);
        let crosses = corners.iter().any(|c| c.z <= 0.0);
        // Towards the light the frustum narrows: corners behind it are not projected, and what crosses its plane stays as wide.
        let images = corners.iter().map(|c| c.truncate() / (1.0 + c.z.max(0.0) * inverse_distance));
        let wide = corners.iter().filter(|_| crosses).map(|c| c.truncate());
        let light = [-self.reach, self.reach];
        let all = images.chain(wide).chain(light).collect::<Vec<DVec2>>();
        let (hull_low, hull_high) = match self.kind {
            SUN => (DVec2::splat(-1e30), DVec2::splat(1e30)),
            _ => (
                all.iter().fold(DVec2::INFINITY, |low, p| low.min(*p)),
                all.iter().fold(DVec2::NEG_INFINITY, |high, p| high.max(*p)),
            ),
        };
        // Two texels more: kernels of at least one texel end beyond what they are kernels of.
        let room = (hull_high - hull_low) * (2.0 / f64::from(settings.resolution));
        let (hull_low, hull_high) = (hull_low - room, hull_high + room);
        let signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let light = signs.map(|[a, b]| {
            let half = self.scale * self.reach;
            let (p, w) = match self.kind {
                SUN => (-self.axes[2] + (self.axes[0] * a + self.axes[1] * b) * self.tangent, 0.0),
                SPHERE => (self.origin, 1.0),
                _ => (self.origin + self.axes[0] * (a * half.x) + self.axes[1] * (b * half.y), 1.0),
            };
            let p = single(p);
            [p[0], p[1], p[2], w]
        });
        Ok(CasterRange {
            box_center: single(center),
            inverse_distance: inverse_distance as f32,
            box_half: single(half),
            farthest: (projected(farthest) * (1.0 + 1e-6)) as f32,
            hull_low: hull_low.as_vec2().to_array(),
            hull_high: hull_high.as_vec2().to_array(),
            light,
            light_reach: self.radius as f32,
            extent: request.scene.local.extent,
            // Levels know squares of texels alone.
            is_square: u32::from(settings.filter != Filter::SummedArea),
            reserved: 0,
        })
    }
}

/// Lowest and highest corner of a box around all receivers of the call: a camera sees nothing but the scene.
fn receiver_box(request: &Request<'_>) -> [DVec3; 2] {
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut add = |low: DVec3, high: DVec3| bounds = [bounds[0].min(low), bounds[1].max(high)];
    match request.receivers {
        ReceiverSource::Points(points) => {
            for p in points.positions() {
                let p = request.scene.local.frame.local_from_world(*p);
                add(p, p);
            }
        }
        ReceiverSource::Camera(_) => {
            for root in request.scene.local.sub_scenes.iter().filter_map(|s| s.nodes.first()) {
                add(DVec3::from(root.low.map(f64::from)), DVec3::from(root.high.map(f64::from)));
            }
        }
    }
    if bounds[0].x > bounds[1].x { [DVec3::ZERO; 2] } else { bounds }
}

/// Middle and half sizes of the box around an outline, in the light's own axes.
pub(super) fn middle_and_half(outline: &[[f64; 2]]) -> [DVec2; 2] {
    let points = outline.iter().map(|c| DVec2::from(*c));
    let low = points.clone().fold(DVec2::INFINITY, DVec2::min);
    let high = points.fold(DVec2::NEG_INFINITY, DVec2::max);
    [(low + high) * 0.5, (high - low) * 0.5]
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}
