//! A pinhole camera: looks along local −Z, +Y up; pixel centres at half integers, `(width, height)` in arguments.

use glam::{DMat4, DVec3};

use crate::error::SceneError;
use crate::frame::{LocalFrame, look_at, rigid};

/// A checked pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    world_from_camera: [[f64; 4]; 4],
    /// `[fx, fy, cx, cy]` in pixels, y downwards.
    intrinsics: [f64; 4],
    size: [u32; 2],
}

impl Camera {
    /// A camera from a pose and `[fx, fy, cx, cy]` in pixels, the principal point measured from the upper left corner.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for an empty image, focal lengths that are not positive, or a matrix that is not rigid.
    pub fn new(world_from_camera: [[f64; 4]; 4], intrinsics: [f64; 4], size: [u32; 2]) -> Result<Self, SceneError> {
        rigid("world_from_camera", &world_from_camera)?;
        if size.contains(&0) {
            return Err(SceneError::invalid("camera size", "must be at least 1 × 1 pixels, (width, height)"));
        }
        if !intrinsics.iter().all(|x| x.is_finite()) || intrinsics[0] <= 0.0 || intrinsics[1] <= 0.0 {
            return Err(SceneError::invalid(
                "camera intrinsics",
                "focal lengths must be positive and all entries finite",
            ));
        }
        Ok(Self { world_from_camera, intrinsics, size })
    }

    /// A camera with a vertical field of view in degrees and square pixels.
    ///
    /// # Errors
    /// As [`Camera::new`]; also for a field of view outside 0…180 degrees.
    pub fn with_fov(world_from_camera: [[f64; 4]; 4], fov_y_deg: f64, size: [u32; 2]) -> Result<Self, SceneError> {
        if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
            return Err(SceneError::invalid(
                "camera fov_y_deg",
                format!("must lie between 0 and 180, got {fov_y_deg}"),
            ));
        }
        let [width, height] = size.map(f64::from);
        let focal = height * 0.5 / (fov_y_deg.to_radians() * 0.5).tan();
        Self::new(world_from_camera, [focal, focal, width * 0.5, height * 0.5], size)
    }

    /// A camera at `eye` that looks at `target`.
    ///
    /// # Errors
    /// As [`Camera::with_fov`] and [`look_at`].
    pub fn look_at(
        eye: [f64; 3],
        target: [f64; 3],
        up: Option<[f64; 3]>,
        fov_y_deg: f64,
        size: [u32; 2],
    ) -> Result<Self, SceneError> {
        let pose = look_at(eye, target, up).map_err(|error| match error {
            SceneError::Invalid { reason, .. } => SceneError::invalid("camera", reason),
            other => other,
        })?;
        Self::with_fov(pose, fov_y_deg, size)
    }

    /// `[width, height]` in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The camera that sees every `step`th pixel of every `step`th row, from pixel `first` on: each of its pixels looks along the ray of one
    /// of this camera's.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for a step of 0, and where no pixel is left.
    pub fn every(&self, step: u32, first: [u32; 2]) -> Result<Self, SceneError> {
        let left = |size: u32, first: u32| size.saturating_sub(first).div_ceil(step.max(1));
        let size = [left(self.size[0], first[0]), left(self.size[1], first[1])];
        if step == 0 || size.contains(&0) {
            return Err(SceneError::invalid("camera step", "it must leave at least one pixel of the image"));
        }
        let [fx, fy, cx, cy] = self.intrinsics;
        let k = f64::from(step);
        let center = |c: f64, first: u32| 0.5 + (c - f64::from(first) - 0.5) / k;
        Ok(Self { intrinsics: [fx / k, fy / k, center(cx, first[0]), center(cy, first[1])], size, ..*self })
    }

    /// The camera in a scene's local frame.
    #[must_use]
    pub fn local(&self, frame: &LocalFrame) -> LocalCamera {
        let m = DMat4::from_cols_array_2d(&self.world_from_camera).transpose();
        let [fx, fy, cx, cy] = self.intrinsics;
        let (right, up, back) = (m.x_axis.truncate(), m.y_axis.truncate(), m.z_axis.truncate());
        LocalCamera {
            eye: frame.local_from_world(m.w_axis.truncate().to_array()),
            // A pixel (x, y) looks along (x − cx)/fx·right − (y − cy)/fy·up − back.
            step_x: right / fx,
            step_y: -up / fy,
            corner: right * (-cx / fx) + up * (cy / fy) - back,
            forward: -back,
            size: self.size,
        }
    }
}

/// A camera in local float64: the ray through the point `(x, y)` of the image, in pixels, has the direction
/// `corner + x·step_x + y·step_y`, whose component along `forward` is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalCamera {
    /// Centre of projection.
    pub eye: DVec3,
    /// Direction of the image's upper left corner.
    pub corner: DVec3,
    /// Change of direction a pixel to the right.
    pub step_x: DVec3,
    /// Change of direction a pixel down.
    pub step_y: DVec3,
    /// Unit direction of view.
    pub forward: DVec3,
    /// `[width, height]` in pixels.
    pub size: [u32; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_image_looks_at_the_target() {
        let camera = Camera::look_at([2.0, 3.0, 4.0], [0.5, 0.0, 0.0], None, 40.0, [640, 480]).unwrap();
        let local = camera.local(&LocalFrame::around(None));
        let direction = local.corner + local.step_x * 320.0 + local.step_y * 240.0;
        let expected = (DVec3::new(0.5, 0.0, 0.0) - DVec3::new(2.0, 3.0, 4.0)).normalize();
        assert!(direction.distance(expected) < 1e-12);
        let top = local.corner + local.step_x * 320.0;
        let half_angle = top.angle_between(direction).to_degrees();
        assert!((half_angle - 20.0).abs() < 1e-9, "{half_angle}");
        assert!(top.y > direction.y, "row 0 is the upper row");
    }

    #[test]
    fn a_thinned_camera_looks_along_the_rays_of_the_whole_one() {
        let camera = Camera::look_at([2.0, 3.0, 4.0], [0.5, 0.0, 0.0], None, 40.0, [64, 47]).unwrap();
        let thinned = camera.every(3, [2, 1]).unwrap();
        assert_eq!(thinned.size(), [21, 16]);
        let [whole, thin] = [camera, thinned].map(|camera| camera.local(&LocalFrame::around(None)));
        let ray = |c: &LocalCamera, x: f64, y: f64| c.corner + c.step_x * (x + 0.5) + c.step_y * (y + 0.5);
        for (x, y) in [(0.0, 0.0), (20.0, 15.0), (7.0, 11.0)] {
            assert!(ray(&thin, x, y).distance(ray(&whole, 3.0 * x + 2.0, 3.0 * y + 1.0)) < 1e-12);
        }
        assert!(camera.every(0, [0, 0]).is_err() && camera.every(3, [64, 0]).is_err());
    }

    #[test]
    fn a_camera_at_its_own_target_is_refused() {
        let error = Camera::look_at([1.0; 3], [1.0; 3], None, 40.0, [8, 8]).unwrap_err().to_string();
        assert!(error.contains("camera") && error.contains("same point"), "{error}");
        assert!(Camera::look_at([1.0; 3], [0.0; 3], None, 180.0, [8, 8]).is_err());
        assert!(Camera::look_at([1.0; 3], [0.0; 3], None, 40.0, [0, 8]).is_err());
    }
}
