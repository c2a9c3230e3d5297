"""One scene from arrays, files and trimesh; what is read is not changed."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
import trimesh

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, camera_above, light_above, render, visibility


def values_of(scene: ss.Scene) -> np.ndarray:
    return visibility(scene, light_above(), camera=camera_above((24, 18))).values


def test_arrays_files_and_trimesh_agree(scene, tmp_path):
    expected = values_of(scene)
    joined = np.concatenate([FLOOR, CARD])
    faces = np.concatenate([SQUARE, SQUARE + 4])
    mesh = trimesh.Trimesh(joined, faces, process=False)
    mesh.export(tmp_path / "scene.obj")
    mesh.export(tmp_path / "scene.glb")
    for other in (
        ss.Scene.from_arrays(joined, faces),
        ss.Scene.from_trimesh(mesh),
        ss.Scene.load(tmp_path / "scene.obj"),
        ss.Scene.load(str(tmp_path / "scene.glb")),
    ):
        assert other.triangle_count == 4
        np.testing.assert_array_equal(values_of(other), expected)


def test_every_instance_of_a_trimesh_scene_is_placed():
    card = trimesh.Trimesh(CARD - [0, 1, 0], SQUARE, process=False)
    source = trimesh.Scene()
    source.add_geometry(trimesh.Trimesh(FLOOR, SQUARE, process=False), geom_name="floor", node_name="floor")
    source.geometry["card"] = card
    poses = []
    for index in range(3):
        pose = trimesh.transformations.rotation_matrix(0.4 * index, [0.3, 1, 0.2]) @ np.diag([1, 1 + index, 1, 1])
        pose[:3, 3] = [2 * index - 2, 1, 0]
        poses.append(pose)
        source.graph.update(frame_to=f"card {index}", matrix=pose, geometry="card")
    assert len(source.geometry) == 2
    scene = ss.Scene.from_trimesh(source)
    assert [mesh.name for mesh in scene.meshes] == ["floor", "card 0", "card 1", "card 2"]
    by_hand = [FLOOR] + [(CARD - [0, 1, 0]) @ pose[:3, :3].T + pose[:3, 3] for pose in poses]
    for mesh, vertices in zip(scene.meshes, by_hand, strict=True):
        np.testing.assert_allclose(mesh.vertices, vertices, atol=1e-14)
    meshes = [ss.Mesh(vertices=vertices, faces=SQUARE) for vertices in by_hand]
    np.testing.assert_array_equal(values_of(scene), values_of(ss.Scene(meshes)))


def test_nested_transforms_of_a_trimesh_graph_are_multiplied():
    source = trimesh.Scene()
    shift = trimesh.transformations.translation_matrix
    source.graph.update(frame_to="arm", matrix=shift([1, 0, 0]))
    card = trimesh.Trimesh(CARD, SQUARE, process=False)
    source.add_geometry(card, node_name="hand", parent_node_name="arm", transform=shift([0, 2, 0]))
    (mesh,) = ss.Scene.from_trimesh(source).meshes
    np.testing.assert_allclose(mesh.vertices, CARD + [1, 2, 0])


def test_trimesh_objects_are_not_changed():
    # Duplicate vertices and a triangle without area: what trimesh would merge and drop.
    vertices = np.concatenate([CARD, CARD[:1]])
    mesh = trimesh.Trimesh(vertices, [[0, 1, 2], [4, 2, 3], [0, 0, 1]], process=False)
    source = trimesh.Scene(mesh)
    before = copy.deepcopy((mesh.vertices, mesh.faces, dict(mesh.metadata), source.graph.to_flattened()))
    ss.Scene.from_trimesh(mesh)
    scene = ss.Scene.from_trimesh(source)
    assert not source.has_camera
    assert scene.triangle_count == 3
    after = (mesh.vertices, mesh.faces, dict(mesh.metadata), source.graph.to_flattened())
    for a, b in zip(before, after, strict=True):
        np.testing.assert_equal(a, b)


def test_what_trimesh_holds_besides_meshes_is_noted():
    source = trimesh.Scene([trimesh.Trimesh(FLOOR, SQUARE, process=False)])
    source.add_geometry(trimesh.PointCloud([[0.0, 0, 0]]), node_name="cloud")
    scene = ss.Scene.from_trimesh(source)
    assert len(scene.meshes) == 1
    assert scene.notes == ("'cloud' left out: PointCloud is no mesh",)


def test_base_colours_come_from_materials():
    def colored(**visual: object) -> ss.Mesh:
        (mesh,) = ss.Scene.from_trimesh(trimesh.Trimesh(FLOOR, SQUARE, process=False, **visual)).meshes
        return mesh

    material = trimesh.visual.material.PBRMaterial(baseColorFactor=[51, 102, 255, 255])
    textured = trimesh.visual.TextureVisuals(uv=np.zeros((4, 2)), material=material)
    assert colored(visual=textured).base_color == (0.2, 0.4, 1.0)
    assert colored(face_colors=[[255, 0, 51, 255]] * 2).base_color == (1.0, 0.0, 0.2)
    plain = ss.Mesh(vertices=FLOOR, faces=SQUARE).base_color
    assert colored().base_color == plain
    assert colored(face_colors=[[255, 0, 0, 255], [0, 255, 0, 255]]).base_color == plain


def test_trimesh_cameras_keep_their_size_and_pose():
    # A wide image: (width, height) and (height, width) differ.
    theirs = trimesh.scene.Camera(resolution=(24, 10), fov=(60, 27))
    pose = theirs.look_at(FLOOR, rotation=ss.look_at((3, 4, 3), (0, 0, 0)))
    before = dict(vars(theirs))
    camera = ss.Camera.from_trimesh(theirs, pose)
    assert vars(theirs).keys() == before.keys()
    assert theirs._focal is before["_focal"]
    assert camera.size == (24, 10)
    np.testing.assert_array_equal(camera.world_from_camera, pose)
    scene = ss.Scene.from_arrays(FLOOR, SQUARE)
    result = visibility(scene, light_above(), camera=camera, receivers=True)
    source = trimesh.Scene(trimesh.Trimesh(FLOOR, SQUARE, process=False), camera=theirs, camera_transform=pose)
    origins, directions, pixels = source.camera_rays()
    t = -origins[:, 1] / directions[:, 1]
    hits = origins + directions * t[:, None]
    # trimesh counts rows from below.
    rows, columns = camera.size[1] - 1 - pixels[:, 1], pixels[:, 0]
    valid = result.valid[rows, columns]
    assert valid.sum() > 40
    np.testing.assert_allclose(result.positions[rows, columns][valid], hits[valid], atol=1e-4)


def test_a_trimesh_scene_hands_its_camera_back():
    theirs = trimesh.scene.Camera(resolution=(24, 10), fov=(60, 27))
    pose = ss.look_at((3, 4, 3), (0, 0, 0))
    floor = trimesh.Trimesh(FLOOR, SQUARE, process=False)
    source = trimesh.Scene(floor, camera=theirs, camera_transform=pose)
    found = ss.from_trimesh(source)
    assert found.camera == ss.Camera.from_trimesh(theirs, pose)
    assert found.scene.meshes == ss.Scene.from_trimesh(source).meshes
    assert (found.lights, found.meters_per_unit) == ((), None)
    assert repr(found) == "<SceneFile: 2 triangles, 0 lights, a camera>"
    source.units = "inches"
    assert ss.from_trimesh(source).meters_per_unit == pytest.approx(0.0254)
    floor.units = "furlongs"
    assert ss.from_trimesh(floor).meters_per_unit is None


def test_a_trimesh_scene_without_a_camera_gets_none():
    source = trimesh.Scene(trimesh.Trimesh(FLOOR, SQUARE, process=False))
    before = source.graph.to_flattened()
    found = ss.from_trimesh(source)
    assert found.camera is None
    assert found.scene.notes == ()
    # trimesh makes cameras and lights when asked for them, and puts them into the graph.
    assert not source.has_camera
    assert getattr(source, "_lights", None) is None
    assert source.graph.to_flattened() == before
    source.camera = trimesh.scene.Camera(resolution=(24, 10), fov=(60, 27), name="eye")
    with pytest.raises(ss.SceneError, match=r"camera 'eye'.*camera_transform"):
        ss.from_trimesh(source)


def test_trimesh_lights_have_no_area_and_are_noted():
    source = trimesh.Scene(trimesh.Trimesh(FLOOR, SQUARE, process=False))
    source.lights = [trimesh.scene.lighting.PointLight()]
    assert ss.from_trimesh(source).lights == ()
    assert ss.Scene.from_trimesh(source).notes == ("1 lights without an area left out",)


def test_intrinsics_that_were_set_on_a_trimesh_camera_decide_its_size():
    theirs = trimesh.scene.Camera(resolution=(24, 10), fov=(60, 27))
    theirs.K = [[30.0, 0, 50], [0, 30, 20], [0, 0, 1]]
    assert theirs.resolution.tolist() == [100, 40], "setting K rewrites the resolution"
    camera = ss.Camera.from_trimesh(theirs, np.eye(4))
    assert camera.size == (100, 40)
    np.testing.assert_array_equal(camera.K, theirs.K)
    np.testing.assert_array_equal(theirs.resolution, [100, 40])


def test_what_look_at_of_trimesh_returns_is_a_pose():
    """Its docstring says the inverse: from world to camera."""
    theirs = trimesh.scene.Camera(resolution=(24, 10), fov=(60, 27))
    pose = theirs.look_at(FLOOR, rotation=ss.look_at((3, 4, 3), (0, 0, 0)))
    camera = ss.Camera.from_trimesh(theirs, pose)
    assert (camera.world_from_camera[:3, 3] > 0).all(), "it stands on the side from which it was asked to look"
    seen = visibility(ss.Scene.from_arrays(FLOOR, SQUARE), light_above(), camera=camera)
    assert seen.valid.any()
    turned = ss.Camera.from_trimesh(theirs, np.linalg.inv(pose))
    assert not visibility(ss.Scene.from_arrays(FLOOR, SQUARE), light_above(), camera=turned).valid.any()


def test_inputs_are_copied_and_never_changed():
    vertices, faces = FLOOR.copy(), SQUARE.copy()
    points = np.array([[0.0, 0.5, 0], [3, 0.5, 0]])
    normals = np.array([[0.0, 2, 0], [0, 3, 0]])
    texture = np.random.default_rng(0).random((3, 2, 3))
    arrays = (vertices, faces, points, normals, texture)
    before = [array.copy() for array in arrays]
    scene, light = ss.Scene.from_arrays(vertices, faces), light_above(texture=texture)
    first = visibility(scene, light, points=points, normals=normals).values
    for array, copied in zip(arrays, before, strict=True):
        np.testing.assert_array_equal(array, copied)
    vertices += 7
    faces[:] = 0
    texture[:] = 0
    np.testing.assert_array_equal(visibility(scene, light, points=before[2], normals=before[3]).values, first)
    with pytest.raises(ValueError, match="read-only"):
        scene.meshes[0].vertices[0] = 1


def test_float32_and_other_memory_orders_are_the_same_numbers(scene):
    single = np.asfortranarray(FLOOR.astype(np.float32))
    strided = np.repeat(SQUARE.astype(np.uint16), 2, axis=0)[::2]
    mesh = ss.Mesh(vertices=single, faces=strided)
    np.testing.assert_array_equal(mesh.vertices, FLOOR)
    np.testing.assert_array_equal(mesh.faces, SQUARE)
    lists = ss.Scene.from_arrays(FLOOR.astype(int).tolist(), SQUARE.tolist())
    np.testing.assert_array_equal(lists.meshes[0].vertices, FLOOR)


def test_an_empty_scene_is_lit():
    for empty in (ss.Scene(), ss.Scene.from_arrays([], []), ss.Scene.from_trimesh(trimesh.Scene())):
        assert empty.triangle_count == 0
        assert visibility(empty, light_above(), points=[[0, 0, 0], [1, 0, 0]]).values.tolist() == [1, 1]
        assert not visibility(empty, light_above(), camera=camera_above()).valid.any()
    assert ss.Scene().bounds is None


def test_zero_area_triangles_are_dropped_and_counted():
    faces = [[0, 1, 2], [0, 2, 3], [1, 1, 2], [0, 0, 0]]
    scene = ss.Scene.from_arrays(CARD, faces)
    assert scene.triangle_count == 4
    result = visibility(scene, light_above(), points=[[0, 0, 0]])
    assert result.values.tolist() == [0]
    assert result.info["zero_area_triangles"] == 2


def test_scenes_describe_themselves(scene):
    np.testing.assert_array_equal(scene.bounds, [[-4, 0, -4], [4, 1, 4]])
    assert repr(scene) == "<Scene: 2 meshes, 4 triangles>"
    assert repr(scene.meshes[1]) == "<Mesh 'card': 4 vertices, 2 triangles>"


def test_descriptions_can_be_pickled(scene):
    light, camera = light_above(texture=np.ones((2, 2, 3))), camera_above()
    expected = visibility(scene, light, camera=camera).values
    for original in (scene, ss.scenes.load("fork").scene):
        again = pickle.loads(pickle.dumps(original))
        assert again.meshes == original.meshes
        assert again.notes == original.notes
        assert again.triangle_count == original.triangle_count
    copies = pickle.loads(pickle.dumps((scene, light, camera)))
    assert copies[1:] == (light, camera)
    np.testing.assert_array_equal(visibility(copies[0], copies[1], camera=copies[2]).values, expected)


def test_lights_and_cameras_compare_by_value():
    assert light_above() == light_above()
    assert light_above() != light_above(side=2)
    assert hash(light_above(texture=np.ones((1, 1, 3)))) == hash(light_above(texture=np.ones((1, 1, 3))))
    assert camera_above() == camera_above()
    assert camera_above() != camera_above((3, 3))
    assert ss.RayTraced(samples=3) == ss.RayTraced(samples=np.int64(3))


@pytest.mark.parametrize("name", ss.scenes.names())
def test_shipped_scenes_render(name):
    shipped = ss.scenes.load(name)
    view = shipped.camera
    camera = ss.Camera(world_from_camera=view.world_from_camera, fov_y_deg=view.fov_y_deg, size=(16, 12))
    picture = render(shipped.scene, shipped.light, camera=camera, technique=ss.RayTraced(samples=4))
    assert shipped.description
    assert picture.linear.max() > 0
