//! # `occlusion_camera`: penumbrae from one camera at the light's centre
//!
//! Q. Mo, V. Popescu, C. Wyman, "The Soft Shadow Occlusion Camera", Pacific Graphics 2007.
//!
//! A depth map from the light's centre says what lies in the hard shadow. Around every silhouette edge a second map, the distortion map, holds
//! by how much the camera bends its rays around that edge: nothing at the outer border of the penumbra, all of its half width at the inner
//! one. A receiver is moved by that much, away from the silhouette: how far, as a share of the half width, is how much of the light it
//! misses. So both halves of the penumbra exist, and the umbra shrinks as the light grows. Edges are found, extruded and drawn on the
//! device, within one submission.
//!
//! With the silhouette at depth z_n and offsets o on the light from its centre, the shadow's border on what lies at depth z is moved in the image
//! (at distance 1) by o·(1/z_n − 1/z): the paper's d_max(z), whose formula the stored text has lost. Beyond the paper, the share is
//! that of the light's own outline beyond the plane through receiver and silhouette: a rectangle's, a disc's or a polygon's, and of what lies
//! above the receiver's horizon. The paper takes spheres and the Bernstein ramp 3x² − 2x³ for all (`ramp: bernstein`).
//!
//! **Maps.** One for each side of the hard shadow: the silhouette's image, its normal away from the occluder, its depth and that of what is seen
//! past it; six floats and the edge's number in a texel, which is four texels of the depth map wide: it knows exactly where the silhouette
//! lies. Where edges overlap, the nearest stays. Quads grow longer outwards, which fills the gaps at corners up to 90 degrees. They reach as far as the surface that is seen past the edge, and half as far again, can be shaded. The map is never
//! filtered: light is evaluated in four texels and interpolated.
//!
//! **Parameters.** `resolution` of the depth map, 16 to 4,096 texels a side, a multiple of 4. `steps`, 1 to 3: how often a receiver is distorted anew by the
//! silhouette at the place where it arrived. What belongs to one penumbra (normals within 45 degrees, lines within a quarter of the half
//! width) counts once, a silhouette whose range of depths does not hold the receiver not at all, others are multiplied. `bias`: a receiver counts
//! as hidden where it arrives only by what is nearer to the light by this share of the distance from silhouette to receiver; `info` has
//! the largest in world units. `ramp`: `outline` or `bernstein`.
//!
//! **When it is wrong.** Two or three edges before a receiver are what a map can tell apart; combs, forks and foliage exceed that, and `info`
//! counts the receivers with more (`colliding_receivers`). Products are right where occluders are independent: two complementary
//! half planes let a quarter through where nothing passes. An edge is taken to run across the light's view where it is
//! nearest; silhouettes are those of the light's centre. Occluders within the bias of what is shaded leak at inner penumbrae; with too small
//! a bias surfaces that rise towards the light are dark there (the paper's figure 9). Penumbrae narrower than a texel are hard.
//! Penumbrae at corners sharper than 90 degrees are not filled. Semi-opaque triangles are taken for opaque, and every result says so. Refused: GL, which draws into no float32 target; triangles that touch a sphere light, and
//! polygons of more than 64 corners. A polygon is looked at from its local origin, which should lie within it.

use serde::{Deserialize, Serialize};
use softshadow_plan::{
    Blend, ColorTarget, Compare, Count, DepthTarget, Host, Kernel, Origin, Over, Plan, Raster, RasterKernel,
    ResourceId, Shape, TextureFormat, Values, VertexSource,
};
use softshadow_scene::{Light, LightShape};

use crate::TechniqueError;
use crate::parts::VISIBILITY;
use crate::parts::light_buffers::LightRecord;
use crate::parts::light_silhouettes::{self, LightSilhouettes};
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::shadow_views::{self, ShadowMaps};
use crate::parts::{receivers, seen_values};
use crate::request::Request;

/// Settings of `occlusion_camera`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OcclusionCamera {
    /// Texels a side of a map.
    pub resolution: u32,
    /// Distortions of a receiver.
    pub steps: u32,
    /// What hides a moved receiver is nearer to the light by this share of the distance from silhouette to receiver.
    pub bias: f32,
    /// What share of the light a silhouette hides.
    pub ramp: CameraRamp,
}

/// How much of the light lies beyond a silhouette.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CameraRamp {
    /// The share of the light's own outline.
    #[default]
    Outline,
    /// 3x² − 2x³, as published.
    Bernstein,
}

impl Default for OcclusionCamera {
    fn default() -> Self {
        Self { resolution: 1024, steps: MOST_STEPS, bias: 0.25, ramp: CameraRamp::Outline }
    }
}

/// Label of what a call reports: `CameraCounts`.
pub const CAMERA_COUNTS: &str = "camera counts";

const NAME: &str = "occlusion_camera";
/// `MOST_STEPS` of `look_up.wgsl`.
const MOST_STEPS: u32 = 3;
/// `COARSER` of `camera.wgsl`.
const COARSER: u32 = 4;
/// Corners of a polygonal light.
const MOST_CORNERS: usize = 64;
/// Two triangles.
const QUAD_CORNERS: u32 = 6;
/// Two textures of four floats, for each side of the hard shadow.
const MAP_LAYERS: u32 = 4;
const LOOK_UP: Kernel = Kernel { file: "occlusion_camera/look_up.wgsl", entry: "look_up" };
const LOOK_UP_OPEN: Kernel = Kernel { file: "occlusion_camera/look_up.wgsl", entry: "look_up_open" };

const fn draw_distortion(vertex: &'static str, fragment: &'static str) -> RasterKernel {
    RasterKernel { file: "occlusion_camera/draw_distortion.wgsl", vertex, fragment: Some(fragment) }
}

/// The two sides of the hard shadow's border.
const SIDES: [(&str, RasterKernel); 2] = [
    ("outside", draw_distortion("extrude_outside", "distort_outside")),
    ("inside", draw_distortion("extrude_inside", "distort_inside")),
];

/// `CameraLight` of `camera.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CameraLight {
    x_way: [f32; 3],
    outline: u32,
    y_way: [f32; 3],
    corner_count: u32,
    low: [f32; 3],
    half_size: f32,
    high: [f32; 3],
    ramp: u32,
    steps: u32,
    bias: f32,
    twice_area: f32,
    reserved: u32,
    corners: [[f32; 2]; MOST_CORNERS],
}

/// `MapLayer` of `draw_distortion.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MapLayer {
    layer: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

/// `CameraCounts` of `look_up.wgsl`, and the silhouettes that were drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CameraCounts {
    /// Receivers near a silhouette.
    pub receivers: u32,
    /// Receivers with more silhouettes before them than were found.
    pub colliding: u32,
    /// Most steps of any receiver.
    pub steps: u32,
    /// The largest bias in local units, as bits of a float32.
    pub bias: u32,
}

impl OcclusionCamera {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        let fail = |setting, reason| Err(TechniqueError::Setting { technique: NAME, setting, reason });
        if !(16..=4096).contains(&self.resolution) {
            return fail("resolution", format!("must lie between 16 and 4096, got {}", self.resolution));
        }
        if !self.resolution.is_multiple_of(COARSER) {
            return fail("resolution", format!("must be a multiple of {COARSER}, got {}", self.resolution));
        }
        if !(1..=MOST_STEPS).contains(&self.steps) {
            return fail("steps", format!("must lie between 1 and {MOST_STEPS}, got {}", self.steps));
        }
        if !(0.0..=1.0).contains(&self.bias) {
            return fail("bias", format!("must lie between 0 and 1, got {}", self.bias));
        }
        Ok(())
    }

    #[expect(clippy::unused_self, reason = "all techniques ask their settings")]
    pub(crate) fn check_call(&self, lights: &[Light], host: &Host) -> Result<(), TechniqueError> {
        if !host.features.float32_drawable {
            let reason = "draws into rgba32float targets, which this device does not do (GL does not); use a Vulkan, Metal or D3D12 \
                          device, or trace rays";
            return Err(TechniqueError::Setting { technique: NAME, setting: "device", reason: reason.into() });
        }
        let corners = lights.iter().map(|light| match light.shape() {
            LightShape::Polygon { outline } => outline.len(),
            _ => 0,
        });
        match corners.max() {
            Some(count) if count > MOST_CORNERS => {
                let reason =
                    format!("a polygon has {count} corners, at most {MOST_CORNERS} are taken; trace rays instead");
                Err(TechniqueError::Setting { technique: NAME, setting: "light", reason })
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn check_occluders<'a>(
        &self,
        mut occluders: impl Iterator<Item = &'a OccluderContents>,
    ) -> Result<(), TechniqueError> {
        match occluders.find_map(|o| o.touching.as_ref()) {
            Some(touching) => {
                let count = touching.count;
                let reason = format!(
                    "{count} triangles touch the ball of a sphere, and no silhouette says where their shadows end; move them \
                     apart, or trace rays"
                );
                Err(TechniqueError::Setting { technique: NAME, setting: "light", reason })
            }
            None => Ok(()),
        }
    }
}

/// Depth of every view, the silhouettes, both sides of the distortion map, then one lookup a receiver.
pub(crate) fn plan(request: &Request<'_>, settings: &OcclusionCamera) -> Plan {
    let mut plan = Plan::new("occlusion camera");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = plan.parameter("light", size_of::<LightRecord>() as u64);
    let camera_light = plan.parameter("camera light", size_of::<CameraLight>() as u64);
    let visibility = plan.persistent(VISIBILITY, count as u64 * 4 * u64::from(request.channels));
    let over = |work| Over::Items { count: count as u32, work_per_item: work };
    match request.occluders.filter(|occluders| occluders.edge_count > 0) {
        Some(occluders) => {
            let maps = shadow_views::append(&mut plan, request, settings.resolution);
            let silhouettes = light_silhouettes::append(&mut plan, occluders, light);
            let distortion = append_distortion(&mut plan, request, settings, &maps, &silhouettes, camera_light);
            let counts = plan.buffer(CAMERA_COUNTS, size_of::<CameraCounts>() as u64);
            plan.clear("no receivers", "nothing is counted yet", counts);
            plan.compute("look up", "moves each receiver past its silhouettes", LOOK_UP, over(4))
                .bind("light", light)
                .bind("shadow_views", maps.views)
                .bind("camera_light", camera_light)
                .bind("depth_map", maps.depth)
                .bind("distortion_map", distortion)
                .bind("receivers", receivers)
                .bind("visibility", visibility)
                .bind("counts", counts);
            plan.outputs.push(counts);
        }
        None => {
            let views = plan.parameter("shadow views", size_of::<shadow_views::ShadowViews>() as u64);
            plan.compute("look up", "finds the light above the horizon: nothing hides it", LOOK_UP_OPEN, over(1))
                .bind("light", light)
                .bind("shadow_views", views)
                .bind("camera_light", camera_light)
                .bind("receivers", receivers)
                .bind("visibility", visibility);
        }
    }
    seen_values::append(&mut plan, request, receivers, light, visibility);
    plan
}

/// Both sides of every view's distortion map.
fn append_distortion(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &OcclusionCamera,
    maps: &ShadowMaps,
    silhouettes: &LightSilhouettes,
    camera_light: ResourceId,
) -> ResourceId {
    let views = shadow_views::views(request, settings.resolution).len() as u32;
    let size = [settings.resolution / COARSER; 2];
    let texture = |plan: &mut Plan, label: &str, format, layers| {
        plan.resource(label, Shape::Texture { format, size, layers }, Origin::Transient)
    };
    let distortion = texture(plan, "distortion map", TextureFormat::Rgba32Float, MAP_LAYERS * views.max(1));
    let distance = texture(plan, "distance to silhouettes", TextureFormat::Depth32Float, 1);
    for layer in 0..views {
        let view = plan.find(&shadow_views::view_label(layer)).unwrap_or(maps.views);
        let map_layer = plan.parameter(layer_label(layer), size_of::<MapLayer>() as u64);
        for (side, (name, kernel)) in SIDES.into_iter().enumerate() {
            let target = |part| ColorTarget {
                texture: distortion,
                layer: MAP_LAYERS * layer + 2 * side as u32 + part,
                clear: Some(0.0),
                blend: Blend::Replace,
            };
            let raster = Raster {
                kernel,
                vertices: VertexSource::Generated(Count::Indirect(silhouettes.draw)),
                colors: vec![target(0), target(1)],
                depth: Some(DepthTarget { texture: distance, layer: 0, clear: Some(1.0), compare: Compare::Less }),
            };
            let why = format!("draws what the camera does {name} the hard shadow, the nearest silhouette in front");
            plan.raster(format!("draw distortion {layer} {name}"), why, raster)
                .bind("shadow_view", view)
                .bind("camera_light", camera_light)
                .bind("map_layer", map_layer)
                .bind("silhouettes", silhouettes.list)
                .bind("depth_map", maps.depth);
        }
    }
    distortion
}

fn layer_label(layer: u32) -> String {
    format!("map layer {layer}")
}

/// The values of the plan's parameters for one light.
pub(crate) fn values(
    request: &Request<'_>,
    settings: &OcclusionCamera,
    light: &Light,
) -> Result<Values, TechniqueError> {
    let mut values = seen_values::values(request, light)?;
    shadow_views::values(request, settings.resolution, &mut values);
    light_silhouettes::values(QUAD_CORNERS, &mut values);
    values.insert("camera light".into(), bytemuck::bytes_of(&camera_light(request, settings, light)).to_vec());
    for layer in 0..shadow_views::views(request, settings.resolution).len() as u32 {
        let record = MapLayer { layer, reserved0: 0, reserved1: 0, reserved2: 0 };
        values.insert(layer_label(layer), bytemuck::bytes_of(&record).to_vec());
    }
    Ok(values)
}

const RECTANGLE: u32 = 0;
const DISC: u32 = 1;
const BALL: u32 = 2;
const POLYGON: u32 = 3;

fn camera_light(request: &Request<'_>, settings: &OcclusionCamera, light: &Light) -> CameraLight {
    let place = light.local(&request.scene.local.frame);
    let scale = place.length_scale;
    let (outline, half, corners) = match light.shape() {
        LightShape::Rectangle { width, height } => (RECTANGLE, [width * 0.5 * scale, height * 0.5 * scale], &[][..]),
        LightShape::Disc { radius } => (DISC, [radius * scale; 2], &[][..]),
        LightShape::Sphere { radius } => (BALL, [radius * scale, 0.0], &[][..]),
        LightShape::Sun { angular_diameter } => (DISC, [(angular_diameter * 0.5).tan(); 2], &[][..]),
        LightShape::Polygon { outline } => (POLYGON, [scale; 2], &outline[..]),
    };
    let farthest = corners.iter().map(|c| c[0].hypot(c[1])).fold(0.0, f64::max);
    let half_size = match outline {
        RECTANGLE => half[0].hypot(half[1]),
        POLYGON => farthest * scale,
        _ => half[0],
    };
    let mut listed = [[0.0; 2]; MOST_CORNERS];
    let next = corners.iter().cycle().skip(1);
    let twice_area: f64 = corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    for (to, from) in listed.iter_mut().zip(corners) {
        *to = from.map(|x| x as f32);
    }
    // Areas beyond a line are summed counter-clockwise.
    if twice_area < 0.0 {
        listed[..corners.len().min(MOST_CORNERS)].reverse();
    }
    let (low, high) = shadow_views::bounds(request).unwrap_or_default();
    CameraLight {
        x_way: (place.x_axis * half[0]).as_vec3().to_array(),
        outline,
        y_way: (place.y_axis * half[1]).as_vec3().to_array(),
        corner_count: corners.len().min(MOST_CORNERS) as u32,
        low: low.as_vec3().to_array(),
        half_size: half_size as f32,
        high: high.as_vec3().to_array(),
        ramp: u32::from(settings.ramp == CameraRamp::Bernstein),
        steps: settings.steps,
        bias: settings.bias,
        twice_area: twice_area.abs() as f32,
        reserved: 0,
        corners: listed,
    }
}
