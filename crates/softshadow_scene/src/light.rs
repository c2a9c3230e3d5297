//! Area lights. A light lies in its local XY plane and emits along local −Z, sizes in world units (UsdLux, glTF).

use earcut::Earcut;
use glam::{DMat4, DVec2, DVec3};

use crate::error::SceneError;
use crate::frame::{LocalFrame, rigid};

/// The outline of a light and what measures it: area, or solid angle for sphere and sun.
#[derive(Debug, Clone, PartialEq)]
pub enum LightShape {
    /// `width` along local X, `height` along local Y; one-sided.
    Rectangle {
        /// Full width in world units.
        width: f64,
        /// Full height in world units.
        height: f64,
    },
    /// A disc of `radius`; one-sided.
    Disc {
        /// Radius in world units.
        radius: f64,
    },
    /// A ball of `radius`; every receiver outside sees its own tangent disc, measured by solid angle.
    Sphere {
        /// Radius in world units.
        radius: f64,
    },
    /// A simple polygon in the local XY plane, wound either way; one-sided.
    Polygon {
        /// Corners in world units.
        outline: Vec<[f64; 2]>,
    },
    /// A disc at infinity; the light comes along local −Z.
    Sun {
        /// Angle that the disc spans, in radians.
        angular_diameter: f64,
    },
}

/// Linear radiance over a rectangular light, bilinear between texel centres. Row 0 lies at local +Y.
#[derive(Debug, Clone, PartialEq)]
pub struct LightTexture {
    width: u32,
    height: u32,
    texels: Vec<[f32; 3]>,
}

impl LightTexture {
    /// `texels` row by row, `width·height` of them, finite and not negative.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for a wrong count, [`SceneError::NotFinite`] for a bad texel.
    pub fn new(width: u32, height: u32, texels: Vec<[f32; 3]>) -> Result<Self, SceneError> {
        let expected = u64::from(width) * u64::from(height);
        if expected == 0 || texels.len() as u64 != expected {
            let got = texels.len();
            return Err(SceneError::invalid(
                "light texture",
                format!("{width} × {height} texels expected, {got} given"),
            ));
        }
        if let Some(index) = texels.iter().position(|t| !t.iter().all(|x| x.is_finite() && *x >= 0.0)) {
            return Err(SceneError::NotFinite { what: "light texture (finite and not negative)".into(), index });
        }
        Ok(Self { width, height, texels })
    }

    /// The radiance at `(u, v)` in `[-1, 1]²`, u along local X, v along local Y.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> [f32; 3] {
        let (x, fx) = split((u * 0.5 + 0.5) * f64::from(self.width) - 0.5, self.width);
        let (y, fy) = split((0.5 - v * 0.5) * f64::from(self.height) - 0.5, self.height);
        let texel = |x: u32, y: u32| self.texels[(y * self.width + x) as usize];
        let (x1, y1) = ((x + 1).min(self.width - 1), (y + 1).min(self.height - 1));
        let (a, b, c, d) = (texel(x, y), texel(x1, y), texel(x, y1), texel(x1, y1));
        [0, 1, 2].map(|k| {
            let top = f64::from(a[k]) * (1.0 - fx) + f64::from(b[k]) * fx;
            let bottom = f64::from(c[k]) * (1.0 - fx) + f64::from(d[k]) * fx;
            (top * (1.0 - fy) + bottom * fy) as f32
        })
    }
}

/// Texel index and fraction, clamped to the centres of the border texels.
fn split(position: f64, count: u32) -> (u32, f64) {
    let clamped = position.clamp(0.0, f64::from(count - 1));
    let index = clamped.floor() as u32;
    (index, clamped - f64::from(index))
}

/// The largest length of a light in local units: float32 holds products of four of them.
const MAX_LOCAL_LENGTH: f64 = (1 << 30) as f64;

/// A checked area light.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    shape: LightShape,
    world_from_light: [[f64; 4]; 4],
    radiance: [f32; 3],
    texture: Option<LightTexture>,
}

impl Light {
    /// A light of white radiance 1 without texture.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for sizes that are negative or not finite, an outline that crosses itself, or a matrix that
    /// is no rotation and translation. A size of zero is allowed: the shadow is hard.
    pub fn new(shape: LightShape, world_from_light: [[f64; 4]; 4]) -> Result<Self, SceneError> {
        rigid("world_from_light", &world_from_light)?;
        match &shape {
            LightShape::Rectangle { width, height } => {
                check_size("light width", *width)?;
                check_size("light height", *height)?;
            }
            LightShape::Disc { radius } | LightShape::Sphere { radius } => check_size("light radius", *radius)?,
            LightShape::Polygon { outline } => {
                triangulate(outline)?;
            }
            LightShape::Sun { angular_diameter } => {
                check_size("sun angular diameter", *angular_diameter)?;
                if *angular_diameter >= std::f64::consts::PI {
                    return Err(SceneError::invalid("sun angular diameter", "must be below 180 degrees"));
                }
            }
        }
        Ok(Self { shape, world_from_light, radiance: [1.0; 3], texture: None })
    }

    /// The sun at an azimuth (degrees clockwise from north, seen from above) and elevation (degrees above the horizon).
    ///
    /// `up` is the world's up axis: with +Z up, north is +Y; with +Y up, north is −Z; in both, east is +X.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for angles that are not finite or a diameter out of range.
    pub fn sun(azimuth_deg: f64, elevation_deg: f64, diameter_deg: f64, up: UpAxis) -> Result<Self, SceneError> {
        if !(azimuth_deg.is_finite() && elevation_deg.is_finite()) {
            return Err(SceneError::invalid("sun", "azimuth and elevation must be finite degrees"));
        }
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let (east, north) = (elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos());
        let towards_sun = match up {
            UpAxis::Y => [east, elevation.sin(), -north],
            UpAxis::Z => [east, north, elevation.sin()],
        };
        let world_from_light = crate::frame::look_at(towards_sun, [0.0; 3], None)?;
        Self::new(LightShape::Sun { angular_diameter: diameter_deg.to_radians() }, world_from_light)
    }

    /// The same light with a linear radiance, red, green, blue.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] when a channel is negative or not finite.
    pub fn with_radiance(mut self, radiance: [f32; 3]) -> Result<Self, SceneError> {
        if !radiance.iter().all(|x| x.is_finite() && *x >= 0.0) {
            return Err(SceneError::invalid("light radiance", "must be finite and not negative"));
        }
        self.radiance = radiance;
        Ok(self)
    }

    /// The same light with a texture that multiplies its radiance.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for any shape but a rectangle.
    pub fn with_texture(mut self, texture: LightTexture) -> Result<Self, SceneError> {
        if !matches!(self.shape, LightShape::Rectangle { .. }) {
            return Err(SceneError::invalid("light texture", "only a rectangular light carries a texture"));
        }
        self.texture = Some(texture);
        Ok(self)
    }

    /// The light's shape.
    #[must_use]
    pub fn shape(&self) -> &LightShape {
        &self.shape
    }

    /// The light's pose, row-major.
    #[must_use]
    pub fn world_from_light(&self) -> [[f64; 4]; 4] {
        self.world_from_light
    }

    /// Linear radiance, red, green, blue.
    #[must_use]
    pub fn radiance(&self) -> [f32; 3] {
        self.radiance
    }

    /// The texture over a rectangular light.
    #[must_use]
    pub fn texture(&self) -> Option<&LightTexture> {
        self.texture.as_ref()
    }

    /// Checks that place and sizes can be reckoned with in float32 beside a scene.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for a light that is too far away or too large, with what to take instead.
    pub fn check_local(&self, frame: &LocalFrame) -> Result<(), SceneError> {
        let place = self.local(frame);
        let sizes: &[f64] = match &self.shape {
            LightShape::Rectangle { width, height } => &[*width, *height],
            LightShape::Disc { radius } | LightShape::Sphere { radius } => &[*radius],
            LightShape::Polygon { outline } => {
                let largest = |axis: usize| outline.iter().map(|corner| corner[axis].abs()).fold(0.0, f64::max);
                &[largest(0), largest(1)]
            }
            LightShape::Sun { .. } => return Ok(()),
        };
        let refused = |what: &str, local: f64, fix: &str| {
            let reason = format!("{what} is {local:.1e} times half the extent of the scene; {fix}");
            Err(SceneError::invalid("light", reason))
        };
        let distance = place.center.abs().max_element();
        if distance.is_nan() || distance > MAX_LOCAL_LENGTH {
            return refused("its distance", distance, "use a sun");
        }
        for size in sizes.iter().map(|size| size * place.length_scale) {
            if size.is_nan() || size > MAX_LOCAL_LENGTH {
                return refused("its size", size, "make it smaller");
            }
        }
        Ok(())
    }

    /// The light in the local frame of a scene, in float64.
    #[must_use]
    pub fn local(&self, frame: &LocalFrame) -> LocalLight {
        let m = DMat4::from_cols_array_2d(&self.world_from_light).transpose();
        LocalLight {
            center: frame.local_from_world(m.w_axis.truncate().to_array()),
            x_axis: m.x_axis.truncate(),
            y_axis: m.y_axis.truncate(),
            emission: -m.z_axis.truncate(),
            length_scale: frame.local_length(1.0),
        }
    }
}

/// Which world axis points up, where that matters: only for [`Light::sun`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpAxis {
    /// +Y, as in glTF.
    Y,
    /// +Z, as in maps and buildings.
    Z,
}

/// Where a light stands in local float64: unit axes, the direction of emission, and local units a world unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalLight {
    /// The light's centre; without meaning for a sun.
    pub center: DVec3,
    /// Local X of the light.
    pub x_axis: DVec3,
    /// Local Y of the light.
    pub y_axis: DVec3,
    /// The direction in which the light emits: its local −Z.
    pub emission: DVec3,
    /// Local units a world unit.
    pub length_scale: f64,
}

fn check_size(what: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(SceneError::invalid(what, format!("must be finite and not negative, got {value}")))
}

/// The polygon as triangles of its own corners.
///
/// # Errors
/// [`SceneError::Invalid`] for fewer than three corners, no area, or an outline that crosses itself.
pub(crate) fn triangulate(outline: &[[f64; 2]]) -> Result<Vec<[usize; 3]>, SceneError> {
    if outline.len() < 3 || !outline.iter().flatten().all(|x| x.is_finite()) {
        return Err(SceneError::invalid("light outline", "needs at least three finite corners"));
    }
    let mut indices: Vec<u32> = Vec::new();
    Earcut::new().earcut(outline.iter().copied(), &[], &mut indices);
    let triangles: Vec<[usize; 3]> = indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| t[k] as usize)).collect();
    let corner = |i: usize| DVec2::from(outline[i]);
    let covered: f64 =
        triangles.iter().map(|t| (corner(t[1]) - corner(t[0])).perp_dot(corner(t[2]) - corner(t[0])).abs() * 0.5).sum();
    // The first corner is subtracted: an outline far from the light's origin must not lose its area.
    let shoelace: f64 = (1..outline.len() - 1)
        .map(|i| (corner(i) - corner(0)).perp_dot(corner(i + 1) - corner(0)) * 0.5)
        .sum::<f64>()
        .abs();
    if shoelace == 0.0 {
        return Err(SceneError::invalid("light outline", "spans no area"));
    }
    if (covered - shoelace).abs() > 1e-9 * shoelace {
        return Err(SceneError::invalid("light outline", "crosses itself; give a simple polygon"));
    }
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDENTITY: [[f64; 4]; 4] =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

    #[test]
    fn bad_lights_are_refused_with_their_name() {
        let refused = |shape| Light::new(shape, IDENTITY).unwrap_err().to_string();
        assert!(refused(LightShape::Rectangle { width: -1.0, height: 1.0 }).contains("light width"));
        assert!(refused(LightShape::Disc { radius: f64::NAN }).contains("light radius"));
        let bow_tie = vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.5]];
        assert!(refused(LightShape::Polygon { outline: bow_tie }).contains("crosses itself"));
        let flat = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        assert!(refused(LightShape::Polygon { outline: flat }).contains("no area"));
        assert!(
            Light::new(LightShape::Disc { radius: 0.0 }, IDENTITY).is_ok(),
            "a light without size casts a hard shadow"
        );
    }

    #[test]
    fn lights_out_of_proportion_to_the_scene_are_refused() {
        let check = |shape: LightShape, distance: f64, extent: f64| {
            let mut pose = IDENTITY;
            pose[1][3] = distance;
            let frame = LocalFrame::around(Some(([-extent; 3], [extent; 3])));
            Light::new(shape, pose).unwrap().check_local(&frame).map_err(|error| error.to_string())
        };
        let square = |size: f64| LightShape::Rectangle { width: size, height: 1.0 };
        for (size, distance) in [(1.0, 3.0), (0.0, 0.0), (1e6, 1e6), (1e-8, 0.0)] {
            assert_eq!(check(square(size), distance, 1.0), Ok(()));
            assert_eq!(check(square(size), distance, 0.01), Ok(()));
        }
        assert!(check(square(1e154), 3.0, 1.0).unwrap_err().contains("its size is"));
        assert_eq!(check(square(1e-320), 3.0, 1.0), Ok(()));
        assert!(check(LightShape::Sphere { radius: 1.0 }, 1e11, 1.0).unwrap_err().contains("use a sun"));
        assert!(check(LightShape::Disc { radius: 1.0 }, 1.0, 1e-30).is_err());
        let long = LightShape::Polygon { outline: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1e20]] };
        assert!(check(long, 1.0, 1.0).unwrap_err().contains("its size is"));
        assert_eq!(check(LightShape::Sun { angular_diameter: 0.01 }, 1e200, 1.0), Ok(()));
    }

    #[test]
    fn a_concave_outline_is_covered_once() {
        let arrow = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5]];
        assert_eq!(triangulate(&arrow).unwrap().len(), 2);
    }

    #[test]
    fn the_sun_stands_where_the_compass_says() {
        let towards = |azimuth, elevation, up| {
            let light = Light::sun(azimuth, elevation, 0.53, up).unwrap();
            -light.local(&LocalFrame::around(None)).emission
        };
        assert!(towards(90.0, 0.0, UpAxis::Z).distance(DVec3::X) < 1e-12, "east");
        assert!(towards(0.0, 0.0, UpAxis::Z).distance(DVec3::Y) < 1e-12, "north, z up");
        assert!(towards(0.0, 0.0, UpAxis::Y).distance(DVec3::NEG_Z) < 1e-12, "north, y up");
        assert!(towards(77.0, 90.0, UpAxis::Y).distance(DVec3::Y) < 1e-12, "zenith");
    }

    #[test]
    fn texture_row_zero_lies_at_plus_y() {
        let texture = LightTexture::new(1, 2, vec![[1.0; 3], [0.0; 3]]).unwrap();
        assert_eq!(texture.at(0.0, 1.0), [1.0; 3]);
        assert_eq!(texture.at(0.0, -1.0), [0.0; 3]);
        assert_eq!(texture.at(0.0, 0.0), [0.5; 3]);
    }
}
