//! One open device for all tests, and one way to ask it.

use std::cell::Cell;
use std::sync::OnceLock;

use softshadow::{
    Camera, Context, DepthComplexity, DeviceChoice, HardShadowMap, Light, LightShape, OcclusionCamera, Options,
    PenumbraMap, Points, Ramp, RayTraced, Receivers, Scene, Technique, Visibility, look_at, procedural, visibility,
};

use crate::shapes::Point;

thread_local! {
    static ON_DRIVER: Cell<bool> = const { Cell::new(false) };
}

/// While it lives, this test runs on a software driver, whatever other tests run on.
pub(crate) struct OnDriver;

/// For what concerns drivers alone: receivers that are drawn, limits of bindings and of loops.
#[must_use]
pub(crate) fn on_driver() -> OnDriver {
    ON_DRIVER.set(true);
    OnDriver
}

impl Drop for OnDriver {
    fn drop(&mut self) {
        ON_DRIVER.set(false);
    }
}

/// The device of all tests that do not break theirs.
pub(crate) fn context() -> &'static Context {
    static CONTEXT: OnceLock<Context> = OnceLock::new();
    static DRIVER: OnceLock<Context> = OnceLock::new();
    let (kept, choice) =
        if ON_DRIVER.get() { (&DRIVER, DeviceChoice::Software) } else { (&CONTEXT, DeviceChoice::Auto) };
    kept.get_or_init(|| Context::new(&choice).unwrap())
}

/// Visibility with nothing left out: standard errors, receivers and masks.
pub(crate) fn see(scene: &Scene, lights: &[Light], receivers: &Receivers, technique: &Technique) -> Visibility {
    let options = Options { standard_error: true, receivers: true, sample_masks: true, ..Options::default() };
    visibility(context(), scene, lights, receivers, technique, &options, &mut |_, _| true).unwrap()
}

pub(crate) fn rays(samples: u32) -> RayTraced {
    RayTraced { samples, ..RayTraced::default() }
}

pub(crate) fn ray_traced(samples: u32) -> Technique {
    Technique::RayTraced(rays(samples))
}

pub(crate) fn hard_shadow_map(resolution: u32) -> Technique {
    Technique::HardShadowMap(HardShadowMap { resolution })
}

pub(crate) fn penumbra_map(resolution: u32, ramp: Ramp) -> Technique {
    Technique::PenumbraMap(PenumbraMap { resolution, ramp })
}

pub(crate) fn occlusion_camera(resolution: u32) -> Technique {
    Technique::OcclusionCamera(OcclusionCamera { resolution, ..OcclusionCamera::default() })
}

pub(crate) fn depth_complexity(samples: u32) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, ..DepthComplexity::default() })
}

pub(crate) fn points(positions: Vec<Point>) -> Receivers {
    Receivers::Points(Points::new(positions, None).unwrap())
}

/// Points that all have the same normal.
pub(crate) fn surface_points(positions: Vec<Point>, normal: Point) -> Receivers {
    let normals = vec![normal; positions.len()];
    Receivers::Points(Points::new(positions, Some(normals)).unwrap())
}

/// A pose without rotation: a light there shines along −z.
pub(crate) fn pose_at([x, y, z]: Point) -> [[f64; 4]; 4] {
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]
}

/// A light that shines straight down, with its axes along x and y.
pub(crate) fn lamp(shape: LightShape, center: Point) -> Light {
    Light::new(shape, pose_at(center)).unwrap()
}

pub(crate) fn rectangle(width: f64, height: f64) -> LightShape {
    LightShape::Rectangle { width, height }
}

/// A scene that comes with the library, its light, and its camera with another image size.
pub(crate) fn shipped(name: &str, size: [u32; 2]) -> (Scene, Light, Camera) {
    let described = procedural::shipped(name).unwrap();
    let (l, c) = (described.light(), described.camera());
    let shape = match l.shape {
        procedural::LightShape::Rectangle { width, height } => LightShape::Rectangle { width, height },
        procedural::LightShape::Disc { radius } => LightShape::Disc { radius },
        procedural::LightShape::Sphere { radius } => LightShape::Sphere { radius },
        procedural::LightShape::Sun { angular_diameter_deg } => {
            LightShape::Sun { angular_diameter: angular_diameter_deg.to_radians() }
        }
    };
    let light = Light::new(shape, look_at(l.position, l.target, Some(l.up)).unwrap()).unwrap();
    let camera = Camera::look_at(c.eye, c.target, Some(c.up), c.fov_y_deg, size).unwrap();
    (described.build().unwrap(), light, camera)
}

/// What two results consist of, bit by bit.
pub(crate) fn bits(seen: &Visibility) -> (Vec<u32>, Vec<u32>) {
    let masks = seen.masks.as_ref().map_or(Vec::new(), |m| m.bits.clone());
    (seen.values.iter().map(|v| v.to_bits()).collect(), masks)
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In `[low, high)`.
    pub(crate) fn within(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn point(&mut self, x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Point {
        [self.within(x), self.within(y), self.within(z)]
    }

    pub(crate) fn points(&mut self, count: usize, x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Vec<Point> {
        (0..count).map(|_| self.point(x, y, z)).collect()
    }
}
