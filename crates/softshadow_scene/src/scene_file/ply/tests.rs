use super::*;

const HEADER: &str = "ply\nformat FORMAT 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nproperty float quality\nend_header\n";
const VERTICES: [[f32; 3]; 5] = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 2.0, 2.0]];
const FACES: [&[i32]; 2] = [&[0, 1, 4], &[0, 1, 2, 3]];

fn read(bytes: &[u8]) -> Result<Scene, SceneError> {
    parse(Path::new("roof.ply"), bytes)
}

fn refusal(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

fn text() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("{x} {y} {z} 255\n")).concat();
    let faces = FACES.map(|face| {
        let corners: Vec<String> = face.iter().map(ToString::to_string).collect();
        format!("{} {} 0.5\n", face.len(), corners.join(" "))
    });
    HEADER.replace("FORMAT", "ascii") + &vertices + &faces.concat()
}

fn binary(format: &str, four: fn([u8; 4]) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = HEADER.replace("FORMAT", format).into_bytes();
    for vertex in VERTICES {
        bytes.extend(vertex.iter().flat_map(|x| four(x.to_le_bytes())));
        bytes.push(255);
    }
    for face in FACES {
        bytes.push(face.len() as u8);
        bytes.extend(face.iter().flat_map(|corner| four(corner.to_le_bytes())));
        bytes.extend(four(0.5_f32.to_le_bytes()));
    }
    bytes
}

fn little() -> Vec<u8> {
    binary("binary_little_endian", |bytes| bytes)
}

fn big() -> Vec<u8> {
    binary("binary_big_endian", |[a, b, c, d]| [d, c, b, a])
}

#[test]
fn text_and_both_byte_orders_give_the_same_mesh() {
    let scene = read(text().as_bytes()).unwrap();
    let [mesh] = scene.meshes() else { panic!("one mesh expected") };
    assert_eq!(mesh.name, "roof");
    assert_eq!(mesh.vertices, VERTICES.map(|v| v.map(f64::from)));
    assert_eq!(mesh.triangles, [[0, 1, 4], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(scene.notes(), ["vertex colours left out"]);
    assert_eq!(read(text().replace('\n', "\r\n").as_bytes()).unwrap().meshes(), scene.meshes());
    assert_eq!(read(text().trim_end().as_bytes()).unwrap().meshes(), scene.meshes());
    assert_eq!(read(&little()).unwrap().meshes(), scene.meshes());
    assert_eq!(read(&big()).unwrap().meshes(), scene.meshes());
}

#[test]
fn text_keeps_what_float32_has_no_room_for() {
    let scene = read(text().replacen("0 0 0.5", "500000.123456789 .5 1.", 1).as_bytes()).unwrap();
    assert_eq!(scene.meshes()[0].vertices[0], [500_000.123_456_789, 0.5, 1.0]);
}

#[test]
fn faces_may_come_first_and_other_elements_are_passed_by() {
    let bytes = b"ply\nformat ascii 1.0\nelement face 1\nproperty list uint8 uint32 vertex_index\nelement edge 2\n\
        property int vertex1\nproperty list int double weights\nelement nothing 18446744073709551615\nelement vertex 3\n\
        property double z\nproperty double y\nproperty double x\nend_header\n3 2 1 0\n7 0\n8 2 0.5 0.5\n3 2 1\n6 5 4\n9 8 8\n";
    let scene = read(bytes).unwrap();
    assert_eq!(scene.meshes()[0].vertices, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [8.0, 8.0, 9.0]]);
    assert_eq!(scene.meshes()[0].triangles, [[2, 1, 0]]);
    assert_eq!(scene.notes(), ["element 'edge' left out", "element 'nothing' left out"]);
}

#[test]
fn concave_polygons_are_cut_along_their_outline() {
    let arrow =
        text().replacen("0 0 0.5 255\n1 0 0 255\n1 1 0 255\n0 1 0 255", "0 2 0 0\n1 0.5 0 0\n2 2 0 0\n1 -1 0 0", 1);
    let scene = read(arrow.as_bytes()).unwrap();
    let mut pair: Vec<_> = scene.meshes()[0].triangles[1..].to_vec();
    pair.iter_mut().for_each(|t| t.sort_unstable());
    pair.sort_unstable();
    assert_eq!(pair, [[0, 1, 3], [1, 2, 3]], "the notch at 1 stays open");
}

#[test]
fn every_truncation_is_an_error() {
    for good in [little(), big()] {
        for length in 0..good.len() {
            assert!(read(&good[..length]).is_err(), "{length}");
        }
    }
    // A text may lose its last digits and still be one.
    let good = text();
    for length in 0..good.len() - 4 {
        assert!(read(&good.as_bytes()[..length]).is_err(), "{length}");
    }
}

#[test]
fn counts_are_held_against_the_bytes_that_are_there() {
    for rows in ["6", "4294967296", "18446744073709551615"] {
        for good in [text().into_bytes(), little(), big()] {
            let header = good.windows(16).position(|w| w == b"element vertex 5").unwrap();
            let more = [&good[..header], format!("element vertex {rows}").as_bytes(), &good[header + 16..]].concat();
            let reason = refusal(&more);
            assert!(reason.contains("element '"), "{reason}");
            assert!(rows == "6" || reason.contains("announced"), "{reason}");
        }
    }
    assert!(
        refusal(text().replacen("vertex 5", "vertex 99999999999999999999", 1).as_bytes()).contains("number of rows")
    );
    // A list that announces four thousand million corners.
    let long = little().windows(6).position(|w| w == [3, 0, 0, 0, 0, 1]).unwrap();
    let header = String::from_utf8(little()[..long - 65].to_vec()).unwrap().replace("list uchar", "list uint");
    let bytes =
        [header.as_bytes(), &little()[long - 65..long], &u32::MAX.to_le_bytes(), &little()[long + 1..]].concat();
    assert!(refusal(&bytes).contains("row 0: it ends here; it is truncated"));
}

#[test]
fn the_other_byte_order_is_refused() {
    let swapped = binary("binary_big_endian", |bytes| bytes);
    assert!(matches!(read(&swapped).unwrap_err(), SceneError::IndexOutOfRange { triangle: 0, .. }));
    let swapped = binary("binary_little_endian", |[a, b, c, d]| [d, c, b, a]);
    assert!(matches!(read(&swapped).unwrap_err(), SceneError::IndexOutOfRange { vertex: 0x0100_0000, .. }));
}

#[test]
fn broken_files_are_refused_with_what_is_wrong() {
    for (old, new, words) in [
        ("ply\n", "plx\n", "does not begin with 'ply'"),
        ("format ascii 1.0\n", "", "no 'format'"),
        ("ascii 1.0", "ascii 2.0", "header line 2: format 'ascii 2.0' is unknown"),
        ("float x", "real x", "type 'real' is unknown"),
        ("float x", "float", "needs a type and a name"),
        ("float x", "float y", "a second property 'y'"),
        ("float x", "float u", "element 'vertex': it has no number 'x'"),
        ("element face", "element vertex", "a second element 'vertex'"),
        ("list uchar", "list float", "must be a whole number"),
        ("vertex_indices", "corners", "it has no list 'vertex_indices'"),
        ("comment made", "made", "'made' is unknown"),
        ("element vertex 5\n", "", "before the first element"),
        ("end_header", "end", "'end' is unknown"),
        ("3 0 1 4", "2 0 1", "element 'face': row 0: a face needs 3 corners, here are 2"),
        ("3 0 1 4", "3 0 1 -4", "-4 is not the number of a vertex"),
        ("3 0 1 4", "3 0 1 1.5", "1.5 is not the number"),
        ("3 0 1 4", "3 0 1 nan", "NaN is not the number"),
        ("3 0 1 4", "-3 0 1 4", "-3 is not the length"),
        ("1 0 0 255", "1 x 0 255", "element 'vertex': row 1: 'x' is not a number"),
        ("face 2", "face 0", "it has no faces; vertex colours left out; export"),
    ] {
        let reason = refusal(text().replacen(old, new, 1).as_bytes());
        assert!(reason.contains(words), "{old} → {new}: {reason}");
    }
    let error = read(text().replacen("1 0 0 255", "1 1e999 0 255", 1).as_bytes()).unwrap_err();
    assert!(matches!(error, SceneError::NotFinite { index: 1, .. }), "{error}");
    let error = read(text().replacen("3 0 1 4", "3 0 1 5", 1).as_bytes()).unwrap_err();
    assert_eq!(error, SceneError::IndexOutOfRange { mesh: "roof".into(), triangle: 0, vertex: 5, vertices: 5 });
}
