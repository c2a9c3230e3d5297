//! Direct illumination in float64 (Forest et al., equation 6): everything from triangles to the sum written anew, nothing shared with
//! what it judges. `L = Σ radiance·f·visible·cosθ at the receiver·cosθ at the light·A/(N·distance²)`; for a sphere and a sun the last
//! three are their solid angle.

use std::f64::consts::{PI, TAU};

use crate::shapes::{Point, Triangle};

/// A light as this file sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lamp {
    pub(crate) shape: Emitter,
    /// Row-major, as the library takes it; the light shines along its −z.
    pub(crate) pose: [[f64; 4]; 4],
    pub(crate) radiance: Point,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Emitter {
    Rectangle {
        width: f64,
        height: f64,
    },
    /// Left and right colour, each whole beyond a quarter of the width, and blended between.
    Textured {
        width: f64,
        height: f64,
        colors: [Point; 2],
    },
    Disc {
        radius: f64,
    },
    Sphere {
        radius: f64,
    },
    Sun {
        angle: f64,
    },
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Surface {
    pub(crate) position: Point,
    pub(crate) normal: Point,
    pub(crate) eye: Point,
    pub(crate) base_color: Point,
    pub(crate) roughness: f64,
    pub(crate) specular: f64,
}

/// A factor that is left out, so that the comparison must fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Flaw {
    None,
    CosineAtReceiver,
    CosineAtLight,
    Distance,
    Measure,
    ScaleOfLobe,
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// The unit normal of a triangle on the side of `eye`.
pub(crate) fn normal_towards(triangle: &Triangle, eye: Point) -> Point {
    let n = unit(cross(minus(triangle[1], triangle[0]), minus(triangle[2], triangle[0])));
    if dot(n, minus(eye, triangle[0])) < 0.0 { n.map(|x| -x) } else { n }
}

/// Whether the way from a point meets none of the triangles but `own` before its end.
pub(crate) fn is_free(triangles: &[Triangle], own: usize, from: Point, way: Point, endless: bool) -> bool {
    triangles.iter().enumerate().all(|(id, t)| {
        let (e1, e2, s) = (minus(t[1], t[0]), minus(t[2], t[0]), minus(from, t[0]));
        let (p, q) = (cross(way, e2), cross(s, e1));
        let det = dot(p, e1);
        let (u, v, at) = (dot(p, s) / det, dot(q, way) / det, dot(q, e2) / det);
        let hits = det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at > 0.0 && (endless || at < 1.0);
        id == own || !hits
    })
}

impl Lamp {
    fn column(&self, k: usize) -> Point {
        [0, 1, 2].map(|row| self.pose[row][k])
    }

    fn placed(&self, x: f64, y: f64) -> Point {
        let (right, up, center) = (self.column(0), self.column(1), self.column(3));
        [0, 1, 2].map(|k| center[k] + x * right[k] + y * up[k])
    }

    pub(crate) fn at_infinity(&self) -> bool {
        matches!(self.shape, Emitter::Sun { .. })
    }

    /// Radiance at a position on the light.
    pub(crate) fn radiance_at(&self, position: Point) -> Point {
        let Emitter::Textured { width, colors: [left, right], .. } = self.shape else { return self.radiance };
        let x = dot(minus(position, self.column(3)), self.column(0));
        let share = (2.0 * x / width + 0.5).clamp(0.0, 1.0);
        [0, 1, 2].map(|k| self.radiance[k] * (left[k] * (1.0 - share) + right[k] * share))
    }

    /// What one sample would send to the eye were it alone: equation 6 without its sum, its `1/N` and its visibility.
    pub(crate) fn contribution(&self, surface: &Surface, target: Point, flaw: Flaw) -> Point {
        let way = if self.at_infinity() { target } else { minus(target, surface.position) };
        let (direction, squared) = (unit(way), dot(way, way));
        let without = |is: Flaw, factor: f64| if flaw == is { 1.0 } else { factor };
        let flat = |area: f64| {
            // The light's −z is where it shines.
            let at_light = dot(direction, self.column(2)).max(0.0);
            without(Flaw::Measure, area) * without(Flaw::CosineAtLight, at_light) / without(Flaw::Distance, squared)
        };
        let solid_angle = match self.shape {
            Emitter::Rectangle { width, height } | Emitter::Textured { width, height, .. } => flat(width * height),
            Emitter::Disc { radius } => flat(PI * radius * radius),
            Emitter::Sphere { radius } => {
                let to_center = minus(self.column(3), surface.position);
                let cosine = (1.0 - radius * radius / dot(to_center, to_center)).sqrt();
                without(Flaw::Measure, TAU * (1.0 - cosine))
            }
            Emitter::Sun { angle } => without(Flaw::Measure, TAU * (1.0 - (angle / 2.0).cos())),
        };
        let at_receiver = dot(direction, surface.normal).max(0.0);
        if at_receiver == 0.0 {
            return [0.0; 3];
        }
        let to_eye = unit(minus(surface.eye, surface.position));
        let halfway = unit([0, 1, 2].map(|k| direction[k] + to_eye[k]));
        // The exponent for a glTF roughness r is 2/r⁴ − 2, and (n + 8)/(8π) makes the lobe reflect its share.
        let exponent = 2.0 / surface.roughness.powi(4) - 2.0;
        let scale = without(Flaw::ScaleOfLobe, (exponent + 8.0) / (8.0 * PI));
        let lobe = surface.specular * scale * dot(halfway, surface.normal).max(0.0).powf(exponent);
        let all = without(Flaw::CosineAtReceiver, at_receiver) * solid_angle;
        let radiance = self.radiance_at(target);
        [0, 1, 2].map(|k| radiance[k] * (surface.base_color[k] / PI + lobe) * all)
    }

    /// The integral over the light without shadows, by a grid of `n` × `n` midpoints; on a sphere over all of its surface, with the
    /// cosine there, so that not even the measure is that of [`Self::contribution`].
    pub(crate) fn integral(&self, surface: &Surface, n: u32) -> Point {
        let mut sum = [0.0; 3];
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let (u, v) = ((f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n));
            let part = self.midpoint(surface, u, v);
            sum = [0, 1, 2].map(|k| sum[k] + part[k] / f64::from(n * n));
        }
        sum
    }

    fn midpoint(&self, surface: &Surface, u: f64, v: f64) -> Point {
        let (sine, cosine) = (TAU * v).sin_cos();
        match self.shape {
            Emitter::Rectangle { width, height } | Emitter::Textured { width, height, .. } => {
                self.contribution(surface, self.placed((u - 0.5) * width, (v - 0.5) * height), Flaw::None)
            }
            Emitter::Disc { radius } => {
                let r = radius * u.sqrt();
                self.contribution(surface, self.placed(r * cosine, r * sine), Flaw::None)
            }
            Emitter::Sphere { radius } => {
                // Archimedes: equal steps along the axis are equal areas.
                let (along, ring) = (2.0 * u - 1.0, (1.0 - (2.0 * u - 1.0).powi(2)).sqrt());
                let outwards = [ring * cosine, ring * sine, along];
                let on_it = [0, 1, 2].map(|k| self.column(3)[k] + radius * outwards[k]);
                let way = minus(on_it, surface.position);
                let at_light = -dot(outwards, unit(way)).min(0.0);
                let one = self.contribution(surface, on_it, Flaw::Measure);
                one.map(|x| x * 4.0 * PI * radius * radius * at_light / dot(way, way))
            }
            Emitter::Sun { angle } => {
                let (x, y, towards) = (self.column(0), self.column(1), self.column(2));
                let height = 1.0 - u * (1.0 - (angle / 2.0).cos());
                let ring = (1.0 - height * height).sqrt();
                let direction = [0, 1, 2].map(|k| height * towards[k] + ring * (cosine * x[k] + sine * y[k]));
                self.contribution(surface, direction, Flaw::None)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor(specular: f64) -> Surface {
        Surface {
            position: [0.1, -0.2, 0.0],
            normal: [0.0, 0.0, 1.0],
            eye: [1.0, 1.0, 3.0],
            base_color: [1.0; 3],
            roughness: 0.5,
            specular,
        }
    }

    /// Over the floor's receiver, shining down, at a height of 2.
    fn above(shape: Emitter) -> Lamp {
        let pose = [[1.0, 0.0, 0.0, 0.1], [0.0, 1.0, 0.0, -0.2], [0.0, 0.0, 1.0, 2.0], [0.0, 0.0, 0.0, 1.0]];
        Lamp { shape, pose, radiance: [PI; 3] }
    }

    #[test]
    fn integrals_over_lamberts_floor_are_the_closed_forms() {
        // Irradiance over π, under the middle of each light.
        let (a, b) = (0.6_f64, 0.4_f64);
        let side = |a: f64, b: f64| a / (a * a + 4.0).sqrt() * (b / (a * a + 4.0).sqrt()).atan();
        let expected = [
            (Emitter::Rectangle { width: 2.0 * a, height: 2.0 * b }, 2.0 / PI * (side(a, b) + side(b, a))),
            (Emitter::Disc { radius: 0.5 }, 0.25 / (0.25 + 4.0)),
            (Emitter::Sphere { radius: 0.5 }, 0.25 / 4.0),
            (Emitter::Sun { angle: 0.2 }, 0.1_f64.sin().powi(2)),
        ];
        for (shape, share) in expected {
            let [found, ..] = above(shape).integral(&floor(0.0), 200);
            assert!((found / (PI * share) - 1.0).abs() < 1e-4, "{shape:?}: {found} for {}", PI * share);
        }
    }

    #[test]
    fn a_lobe_of_blinn_adds_light_around_the_mirror_direction_only() {
        let lamp = above(Emitter::Disc { radius: 0.1 });
        let towards =
            |eye: Point| lamp.integral(&Surface { eye, ..floor(0.5) }, 50)[0] / lamp.integral(&floor(0.0), 50)[0];
        assert!(towards([0.1, -0.2, 5.0]) > 3.0 && towards([9.0, 0.0, 0.2]) < 1.01);
    }

    #[test]
    fn a_way_ends_before_what_lies_beyond_the_light() {
        let plate: [Triangle; 1] = [[[-1.0, -1.0, 1.0], [2.0, -1.0, 1.0], [-1.0, 2.0, 1.0]]];
        let free = |way, endless| is_free(&plate, 7, [0.0; 3], way, endless);
        assert!(!free([0.0, 0.0, 2.0], false) && free([0.0, 0.0, 0.9], false) && !free([0.0, 0.0, 0.9], true));
        assert!(free([0.0, 0.0, -2.0], true) && is_free(&plate, 0, [0.0; 3], [0.0, 0.0, 2.0], false));
    }
}
