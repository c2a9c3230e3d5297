// Finds the parts of tiles with any face between them and the light.
//#import shared/slice.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/tree.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<storage, read> face_tree: array<EightWords>;
@group(0) @binding(2) var<storage, read_write> parts: array<TilePart>;

@compute @workgroup_size(64)
fn find_faces(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    if (parts[index].receiver_count == 0u) {
        return;
    }
    let planes = parts[index].planes;
    var found = false;
    var node = 0u;
    var steps = 0u;
    while (node < arrayLength(&face_tree) && !found && steps < LONGEST_WALK) {
        steps++;
        let box = node_of(face_tree[node]);
        let met = shaft_meets_box(planes, box.low, box.high);
        found = met && box.leaf != 0u;
        node = select(box.skip, node + 1u, met);
    }
    // A walk that was not finished may have met something.
    parts[index].has_faces = select(0u, 1u, found || node < arrayLength(&face_tree));
}
