//! One receiver's projection on to the light.

use glam::{Vec2, Vec3};
use softshadow_scene::{LightFrame, LightKind};

/// A point whose visibility is asked for, where every technique starts: lifted off its surface already.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Receiver {
    /// Local position.
    pub position: [f32; 3],
    /// Normal of its surface; light on or below its plane is hidden.
    pub normal: Option<[f32; 3]>,
    /// The triangle it lies on, which never hides anything from it.
    pub triangle: Option<u32>,
}

/// How one receiver sees the light. A corner `v` has its image at `g.xy / g.z` with `g = rows·(v − p)`, relative to the reference
/// point c; `g.z > 0` iff it lies on the light's side of the plane through p along the light. `v − p` is rounded first: a corner
/// near the receiver keeps its relative accuracy, and whatever rounding does to `rows` it does to all corners alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightView {
    /// The receiver.
    pub position: Vec3,
    /// The projection, row by row.
    pub rows: [Vec3; 3],
    /// The way from p to the light's point (x, y) relative to c is `ways[2] + x·ways[0] + y·ways[1]`; on sun and sphere its
    /// direction.
    pub ways: [Vec3; 3],
    /// A sphere's disc: geometry counts where `limit.0·(v − p) < limit.1`.
    pub limit: Option<(Vec3, f32)>,
    /// A sphere: its samples are points q of the unit disc; the tangent, and 1 − cosine of the half angle, that place them.
    pub cap: Option<Cap>,
}

/// The disc that a ball of light is to one receiver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cap {
    /// Tangent of its half angle.
    pub tangent: f32,
    /// 1 − cosine of its half angle.
    pub height: f32,
    /// Squared sine of its half angle.
    pub sine_squared: f32,
    /// Distance of the ball's centre.
    pub distance: f32,
}

/// What a receiver sees of the light before anything is in the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sight {
    /// The light.
    View(LightView),
    /// Nothing: it is behind a light with a front.
    Behind,
    /// Everything: it is inside a ball of light.
    Inside,
}

impl LightView {
    /// What a receiver at a position sees of a light.
    #[must_use]
    pub fn towards(light: &LightFrame, position: [f32; 3]) -> Sight {
        let p = Vec3::from(position);
        let c = Vec2::from(light.reference);
        match &light.kind {
            LightKind::Flat { origin, rows, axes } => {
                let [x, y, z] = rows.map(Vec3::from);
                let from_light = p - Vec3::from(*origin);
                let height = z.dot(from_light);
                if height <= 0.0 {
                    return Sight::Behind;
                }
                // h = (d.x·p.z − p.x·d.z, d.y·p.z − p.y·d.z, −d.z) in the light's frame, with c·h.z subtracted.
                let rows = [x * height - z * (x.dot(from_light) - c.x), y * height - z * (y.dot(from_light) - c.y), -z];
                let [u, v] = axes.map(Vec3::from);
                let ways = [u, v, u * c.x + v * c.y - from_light];
                Sight::View(Self { position: p, rows, ways, limit: None, cap: None })
            }
            LightKind::Sun { axes, tangent } => {
                let [x, y, towards] = axes.map(Vec3::from);
                Sight::View(Self::angular(p, [x, y, towards], *tangent, c))
            }
            LightKind::Sphere { center, radius } => {
                let way = Vec3::from(*center) - p;
                let squared = way.length_squared();
                let sine_squared = radius * radius / squared.max(1e-37);
                if sine_squared >= 1.0 || squared == 0.0 {
                    return Sight::Inside;
                }
                let distance = squared.sqrt();
                let towards = way / distance;
                let outside = 1.0 - sine_squared;
                // On the surface the disc would be without end: its half angle stays below the right angle, as in the kernels.
                let height = (sine_squared / (1.0 + outside.sqrt())).min(0.999);
                let tangent = reach(height, 1.0);
                let (x, y) = towards.any_orthonormal_pair();
                let view = Self::angular(p, [x, -y, towards], if tangent > 0.0 { tangent } else { 1.0 }, c);
                let cap = Cap { tangent, height, sine_squared, distance };
                Sight::View(Self { limit: Some((towards, distance * outside)), cap: Some(cap), ..view })
            }
        }
    }

    /// A light that is known by directions alone: the unit disc at distance 1 / `tangent`.
    fn angular(position: Vec3, [x, y, towards]: [Vec3; 3], tangent: f32, c: Vec2) -> Self {
        let depth = towards * tangent;
        let ways = [x * tangent, y * tangent, towards + (x * c.x + y * c.y) * tangent];
        Self { position, rows: [x - depth * c.x, y - depth * c.y, depth], ways, limit: None, cap: None }
    }

    /// The image of a way `v − p`, or of a difference of two.
    #[must_use]
    pub fn project(&self, way: Vec3) -> Vec3 {
        Vec3::new(self.rows[0].dot(way), self.rows[1].dot(way), self.rows[2].dot(way))
    }

    /// The way to a point of the light, relative to c.
    #[must_use]
    pub fn way_to(&self, [x, y]: [f32; 2]) -> Vec3 {
        self.ways[2] + self.ways[0] * x + self.ways[1] * y
    }

    /// Where the samples of a sphere lie, relative to c: they move with the receiver because their measure is solid angle. Those of other
    /// lights stand still.
    #[must_use]
    pub fn place_samples(&self, light: &LightFrame, samples: &[[f32; 2]]) -> Vec<[f32; 2]> {
        let Some(cap) = self.cap else { return samples.to_vec() };
        let place = |q: &[f32; 2]| {
            let stretch =
                if cap.tangent > 0.0 { reach(cap.height, q[0] * q[0] + q[1] * q[1]) / cap.tangent } else { 0.0 };
            [q[0] * stretch - light.reference[0], q[1] * stretch - light.reference[1]]
        };
        samples.iter().map(place).collect()
    }
}

/// How far a point of the unit disc, at squared radius `share`, is moved off the axis at distance 1, so that equal areas of the disc
/// become equal solid angles of a cap of this height.
fn reach(height: f32, share: f32) -> f32 {
    (height * (2.0 - share * height)).sqrt() / (1.0 - share * height)
}
