//! Receivers: the points whose visibility is asked for, either what a camera sees or points with optional normals.

use glam::DVec3;

use crate::camera::Camera;
use crate::error::SceneError;
use crate::frame::LocalFrame;

/// Where visibility is asked for.
#[derive(Debug, Clone, PartialEq)]
pub enum Receivers {
    /// The surface point behind every pixel, row by row.
    Camera(Camera),
    /// Points in world coordinates.
    Points(Points),
}

impl Receivers {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        match self {
            Self::Camera(camera) => camera.size().iter().map(|&n| u64::from(n)).product(),
            Self::Points(points) => points.positions.len() as u64,
        }
    }
}

/// Checked points with optional normals. With a normal the receiver's own plane blocks what lies below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    positions: Vec<[f64; 3]>,
    normals: Option<Vec<[f64; 3]>>,
}

impl Points {
    /// Points and, for each, a normal of any length but zero.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`] and [`SceneError::Invalid`] name the array and the first bad row.
    pub fn new(positions: Vec<[f64; 3]>, normals: Option<Vec<[f64; 3]>>) -> Result<Self, SceneError> {
        let first_bad = |rows: &[[f64; 3]]| rows.iter().position(|row| !row.iter().all(|x| x.is_finite()));
        if let Some(index) = first_bad(&positions) {
            return Err(SceneError::NotFinite { what: "points".into(), index });
        }
        if let Some(normals) = &normals {
            if normals.len() != positions.len() {
                let (n, p) = (normals.len(), positions.len());
                return Err(SceneError::invalid("normals", format!("{n} normals for {p} points")));
            }
            if let Some(index) = first_bad(normals) {
                return Err(SceneError::NotFinite { what: "normals".into(), index });
            }
            if let Some(index) = normals.iter().position(|n| DVec3::from(*n).try_normalize().is_none()) {
                return Err(SceneError::invalid("normals", format!("entry {index} has no length")));
            }
        }
        Ok(Self { positions, normals })
    }

    /// World positions, as given.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Normals, as given.
    #[must_use]
    pub fn normals(&self) -> Option<&[[f64; 3]]> {
        self.normals.as_deref()
    }

    /// Checks that every point fits local float32.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`] names the first point that lies too far from the scene.
    pub fn check_local(&self, frame: &LocalFrame) -> Result<(), SceneError> {
        let is_far = |p: &[f64; 3]| !frame.local_from_world(*p).as_vec3().is_finite();
        match self.positions.iter().position(is_far) {
            Some(index) => {
                Err(SceneError::NotFinite { what: "points, relative to the scene in float32,".into(), index })
            }
            None => Ok(()),
        }
    }

    /// A block of the points in local float32: position, unit normal, and whether there is a normal.
    #[must_use]
    pub fn local_block(&self, frame: &LocalFrame, range: std::ops::Range<usize>) -> Vec<LocalPoint> {
        range
            .map(|index| {
                let normal = self.normals.as_ref().map(|n| DVec3::from(n[index]).normalize_or_zero().as_vec3());
                LocalPoint {
                    position: frame.local_from_world(self.positions[index]).as_vec3().to_array(),
                    has_normal: u32::from(normal.is_some()),
                    normal: normal.unwrap_or_default().to_array(),
                    unused: 0,
                }
            })
            .collect()
    }
}

/// A point as the kernels read it.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LocalPoint {
    /// Local float32 position.
    pub position: [f32; 3],
    /// 1 with a normal, 0 without.
    pub has_normal: u32,
    /// Unit normal, or zero.
    pub normal: [f32; 3],
    /// Fills the record to 32 bytes.
    pub unused: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_points_are_named() {
        let good = vec![[0.0; 3], [1.0, 2.0, 3.0]];
        assert!(Points::new(good.clone(), Some(vec![[0.0, 0.0, 2.0]; 2])).is_ok());
        let nan = Points::new(vec![[0.0; 3], [f64::NAN, 0.0, 0.0]], None).unwrap_err();
        assert_eq!(nan, SceneError::NotFinite { what: "points".into(), index: 1 });
        let zero = Points::new(good.clone(), Some(vec![[0.0, 0.0, 1.0], [0.0; 3]])).unwrap_err().to_string();
        assert!(zero.contains("entry 1"), "{zero}");
        assert!(Points::new(good, Some(vec![[0.0, 0.0, 1.0]])).is_err());
    }

    #[test]
    fn normals_are_given_unit_length() {
        let points = Points::new(vec![[0.0; 3]], Some(vec![[0.0, 0.0, 5.0]])).unwrap();
        let block = points.local_block(&LocalFrame::around(None), 0..1);
        assert_eq!(block[0].normal, [0.0, 0.0, 1.0]);
        assert_eq!(block[0].has_normal, 1);
    }
}
