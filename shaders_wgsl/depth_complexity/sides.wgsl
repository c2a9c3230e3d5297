// The side of a face by which an edge is weighed.
//#import depth_complexity/frame.wgsl
//#import shared/occluders.wgsl

// The side that the light's reference point is on, as seen from beyond the face.
fn side_from_reference(frame: LightFrame, face: IncidentFace) -> i32 {
    let c = frame.reference;
    let towards_sun = frame.z_row + (frame.x_row * c.x + frame.y_row * c.y) * frame.size;
    let offset = select(vec3<f32>(0.0), frame.x_way * c.x + frame.y_way * c.y, frame.kind == FRAME_FLAT);
    let height = select(
        dot(face.normal, frame.origin + offset - face.point),
        dot(face.normal, towards_sun),
        frame.kind == FRAME_SUN,
    );
    return select(0, 1, height < -face.flatness) - select(0, 1, height > face.flatness);
}

// As a receiver sees it. Standard silhouettes are those of the light's reference point, and so are their sides: with the receiver's own, the
// loops that those edges make would not close.
fn weighing_side(frame: LightFrame, view: FrameView, face: IncidentFace) -> i32 {
    let seen = side_of_plane(face.normal, face.point, face.flatness, view.position);
    return turned(select(seen, side_from_reference(frame, face), frame.weighs_from_light != 0u), face);
}
