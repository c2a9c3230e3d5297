//! Visibilities that can be written down: one occluder, one light, no mesh.
//!
//! Every function returns the visible fraction of the light in [0, 1]. They are exact to rounding (flat occluders) or to
//! about 1e-11 (spheres, by quadrature between the points where the integrand is not smooth).

mod flat;
mod quadrature;
mod sphere;

pub use flat::{AxisRectangle, disc_over_disc, half_plane_over_rectangle, rectangle_over_rectangle};
pub use sphere::{Sphere, sphere_over_rectangle, sphere_over_sphere_light};
