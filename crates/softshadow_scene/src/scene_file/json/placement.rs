//! Where meshes and lights stand: a matrix, or what it is made of.

use glam::{DMat3, DMat4, DVec3};

use super::model::{LightFields, Matrix, MeshFields};
use crate::frame::look_at;

/// Scaled first, then turned about X, Y and Z in this order, then moved, as UsdGeom's `rotateXYZ`.
pub(super) fn world_from_mesh(fields: &MeshFields) -> Result<Matrix, String> {
    let parts = [fields.translate, fields.rotate_xyz_deg, fields.scale];
    let Some(rows) = fields.world_from_mesh else { return composed(parts) };
    if parts != [None; 3] {
        return Err("give either world_from_mesh or translate, rotate_xyz_deg and scale".into());
    }
    if rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err("the last row of world_from_mesh must be 0 0 0 1; rows are given one after the other".into());
    }
    Ok(rows)
}

/// Lights are turned towards a target or by angles.
pub(super) fn world_from_light(fields: &LightFields) -> Result<Matrix, String> {
    let is_composed = fields.translate.is_some() || fields.rotate_xyz_deg.is_some() || fields.target.is_some();
    match (fields.world_from_light, fields.target, fields.rotate_xyz_deg) {
        (Some(_), ..) if is_composed => {
            Err("give either world_from_light or translate with rotate_xyz_deg or target".into())
        }
        (_, None, _) if fields.up.is_some() => Err("up needs a target".into()),
        (Some(rows), ..) => Ok(rows),
        (None, Some(_), Some(_)) => Err("give either rotate_xyz_deg or target".into()),
        (None, Some(target), None) => {
            look_at(fields.translate.unwrap_or_default(), target, fields.up).map_err(|error| error.to_string())
        }
        (None, None, rotate) => composed([fields.translate, rotate, None]),
    }
}

fn composed([translate, rotate_xyz_deg, scale]: [Option<[f64; 3]>; 3]) -> Result<Matrix, String> {
    let [x, y, z] = rotate_xyz_deg.unwrap_or_default().map(f64::to_radians);
    let turned = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
    let linear = turned * DMat3::from_diagonal(DVec3::from(scale.unwrap_or([1.0; 3])));
    let matrix = DMat4::from_mat3_translation(linear, DVec3::from(translate.unwrap_or_default()));
    if !matrix.is_finite() {
        return Err("its transform is not finite".into());
    }
    Ok(matrix.transpose().to_cols_array_2d())
}
