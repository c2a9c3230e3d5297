"""Bad input is a typed error that names what is wrong, and never a panic."""

from __future__ import annotations

import numpy as np
import pytest

import softshadow as ss
from conftest import CARD, SQUARE, camera_above, compare, light_above, render, visibility

POSE = np.eye(4)
LIGHT = light_above()
CAMERA = camera_above((4, 3))
SCENE = ss.Scene.from_arrays(CARD, SQUARE)
NAN = CARD.copy()
NAN[2, 1] = np.nan


def rect(**settings):
    return ss.RectLight(**{"width": 1, "height": 1, "world_from_light": POSE} | settings)


def camera(**settings):
    return ss.Camera(**{"world_from_camera": POSE, "fov_y_deg": 40, "size": (4, 3)} | settings)


def look(**settings):
    return ss.Camera.look_at(**{"eye": (1, 1, 1), "target": (0, 0, 0), "fov_y_deg": 40, "size": (4, 3)} | settings)


def blended(**settings):
    return ss.DepthComplexity(evaluation="blended", **settings)


SCALED = np.diag([2.0, 2, 2, 1])
MIRROR = np.diag([-1.0, 1, 1, 1])
INF = float("inf")

NONSENSE = [
    # scenes
    (lambda: ss.Scene.from_arrays(NAN, SQUARE, name="bunny"), ss.SceneError, "'bunny' vertices.*2 "),
    (lambda: ss.Scene.from_arrays(CARD * INF, SQUARE), ss.SceneError, "vertices"),
    (lambda: ss.Scene.from_arrays(CARD, [[0, 1, 4]]), ss.SceneError, "triangle 0 refers to vertex 4"),
    (lambda: ss.Scene.from_arrays(CARD, [[0, 1, 2], [0, -1, 2]]), ss.SceneError, "triangle 1 .* vertex -1"),
    (
        lambda: ss.Scene.from_arrays(CARD, np.array([[0, 1, 2**63]], np.uint64)),
        ss.SceneError,
        "vertex 9223372036854775808",
    ),
    (lambda: ss.Scene.from_arrays(CARD, [[0, 1, 2**70]]), ss.SceneError, "faces.*dtype object"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE.astype(float)), ss.SceneError, "faces.*float64"),
    (lambda: ss.Scene.from_arrays(SQUARE, SQUARE), ss.SceneError, "vertices.*int64"),
    (lambda: ss.Scene.from_arrays(CARD.astype(str), SQUARE), ss.SceneError, "vertices.*<U"),
    (lambda: ss.Scene.from_arrays(CARD.astype(object), SQUARE), ss.SceneError, "vertices.*object"),
    (lambda: ss.Scene.from_arrays(CARD + 0j, SQUARE), ss.SceneError, "vertices.*complex128"),
    (lambda: ss.Scene.from_arrays(CARD > 0, SQUARE), ss.SceneError, "vertices.*bool"),
    (lambda: ss.Scene.from_arrays(CARD.astype(np.longdouble), SQUARE), ss.SceneError, "vertices.*float64"),
    (lambda: ss.Scene.from_arrays(np.ma.masked_array(CARD), SQUARE), ss.SceneError, "mask"),
    (lambda: ss.Scene.from_arrays(CARD[:, :2], SQUARE), ss.SceneError, r"\(n, 3\) expected, got \(4, 2\)"),
    (lambda: ss.Scene.from_arrays(CARD.ravel(), SQUARE), ss.SceneError, r"\(n, 3\)"),
    (lambda: ss.Scene.from_arrays([[1, 2, 3], [4]], SQUARE), ss.SceneError, "vertices"),
    (lambda: ss.Scene.from_arrays(None, None), ss.SceneError, "vertices"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE[:, :2]), ss.SceneError, r"faces.*\(m, 3\)"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, base_color="red"), ss.SceneError, "base_color"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, base_color=(-1, 0, 0)), ss.SceneError, "base_color"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=1.5, name="pane"), ss.SceneError, "'pane' opacity: 1.5 is no"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=float("nan")), ss.SceneError, "opacity: NaN is no opacity"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=True), ss.SceneError, "opacity.*bool"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity="0.5"), ss.SceneError, "opacity.*<U"),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=None), ss.SceneError, "opacity.*object"),
    (
        lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=[0.5, -0.1]),
        ss.SceneError,
        "opacities: triangle 1: -0.1 is no",
    ),
    (
        lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=[0.5, 1e300]),
        ss.SceneError,
        "opacities: triangle 1: inf is no",
    ),
    (
        lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=[0.5] * 4),
        ss.SceneError,
        r"opacity.*\(2,\) expected, got \(4,\)",
    ),
    (lambda: ss.Scene.from_arrays(CARD, SQUARE, opacity=[[1], [1, 2]]), ss.SceneError, "opacity"),
    (lambda: ss.Scene.from_trimesh(CARD), ss.SceneError, "trimesh"),
    (lambda: ss.Scene([CARD]), ss.SceneError, "Mesh"),
    (lambda: ss.Scene.load("nowhere.glb"), ss.SceneFileNotFound, "nowhere.glb"),
    (lambda: ss.Scene.load("nowhere.glb"), FileNotFoundError, "nowhere.glb"),
    (lambda: ss.Scene.load("scene.xyz"), ss.SceneError, "unknown format 'xyz'"),
    (lambda: ss.Scene.load(3.5), ss.SceneError, "path"),
    (lambda: ss.Scene.load("a\0b.glb"), ss.SceneError, "a\0b"),
    (lambda: ss.scenes.load("nowhere"), ss.SceneError, "hall"),
    (lambda: ss.scenes.load(None), ss.SceneError, "hall"),
    # lights
    (lambda: rect(width=-1), ss.SceneError, "light width"),
    (lambda: rect(height=float("nan")), ss.SceneError, "light height"),
    (lambda: rect(width="1"), ss.SceneError, "light width.*str"),
    (lambda: rect(width=True), ss.SceneError, "light width.*bool"),
    (lambda: rect(width=1j), ss.SceneError, "light width.*complex"),
    (lambda: rect(width=10**400), ss.SceneError, "light width"),
    (lambda: rect(world_from_light=SCALED), ss.SceneError, "world_from_light.*rotation"),
    (lambda: rect(world_from_light=MIRROR), ss.SceneError, "world_from_light.*mirror"),
    (lambda: rect(world_from_light=POSE * np.nan), ss.SceneError, "world_from_light"),
    (lambda: rect(world_from_light=POSE[:3]), ss.SceneError, r"world_from_light.*\(4, 4\)"),
    (lambda: rect(world_from_light=ss.look_at((1, 2, 3), (0, 0, 0)).T), ss.SceneError, "last row"),
    (lambda: rect(radiance=(1, 2)), ss.SceneError, "radiance"),
    (lambda: rect(radiance=(1, 1, -1)), ss.SceneError, "radiance"),
    (lambda: rect(radiance=(1e300, 1, 1)), ss.SceneError, "radiance"),
    (lambda: rect(texture=np.ones((4, 4))), ss.SceneError, r"texture.*\(h, w, 3\)"),
    (lambda: rect(texture=np.ones((4, 4, 3), np.uint8)), ss.SceneError, "texture.*uint8"),
    (lambda: rect(texture=np.full((1, 2, 3), np.nan)), ss.SceneError, "texture"),
    (lambda: rect(texture=np.full((1, 2, 3), 1e300)), ss.SceneError, "texture"),
    (lambda: rect(texture=np.full((1, 2, 3), -1.0)), ss.SceneError, "texture"),
    (lambda: rect(texture=np.ones((0, 2, 3))), ss.SceneError, "texture"),
    (lambda: ss.DiscLight(radius=-1, world_from_light=POSE), ss.SceneError, "radius"),
    (lambda: ss.SphereLight(radius=INF, world_from_light=POSE), ss.SceneError, "radius"),
    (lambda: ss.PolygonLight(outline=[[0, 0], [1, 1]], world_from_light=POSE), ss.SceneError, "outline"),
    (
        lambda: ss.PolygonLight(outline=[[0, 0], [1, 1], [1, 0], [0, 1.5]], world_from_light=POSE),
        ss.SceneError,
        "crosses itself",
    ),
    (lambda: ss.SunLight(0, float("nan")), ss.SceneError, "sun"),
    (lambda: ss.SunLight(0, 30, diameter_deg=200), ss.SceneError, "180"),
    (lambda: ss.SunLight(0, 30, up="x"), ss.SettingsError, "'y', 'z'"),
    (lambda: ss.SunLight(0, 30, up=["y"]), ss.SettingsError, "'y', 'z'"),
    # cameras
    (lambda: look(eye=(0, 0, 0)), ss.SceneError, "camera.*same point"),
    (lambda: look(up=(1, 1, 1)), ss.SceneError, "parallel"),
    (lambda: look(fov_y_deg=180), ss.SceneError, "fov_y_deg"),
    (lambda: look(eye=(1, 2)), ss.SceneError, "eye"),
    (lambda: look(eye=(1, 2, float("nan"))), ss.SceneError, "finite"),
    (lambda: look(size=(0, 3)), ss.SettingsError, "width"),
    (lambda: look(size=(4.0, 3)), ss.SettingsError, "width"),
    (lambda: look(size=4), ss.SceneError, "size"),
    (lambda: look(size=(4, 2**33)), ss.SettingsError, "height"),
    (lambda: camera(fov_y_deg=None), ss.SceneError, "either"),
    (lambda: camera(K=np.eye(3)), ss.SceneError, "either"),
    (lambda: camera(fov_y_deg=None, K=np.zeros((3, 3))), ss.SceneError, "camera K"),
    (
        lambda: camera(fov_y_deg=None, K=np.array([[1.0, 0.5, 0], [0, 1, 0], [0, 0, 1]])),
        ss.SceneError,
        "skew",
    ),
    (lambda: camera(fov_y_deg=None, K=np.diag([0.0, 1, 1])), ss.SceneError, "focal"),
    (lambda: camera(frame="blender"), ss.SettingsError, "opencv"),
    # techniques
    (lambda: ss.RayTraced(samples=0), ss.SettingsError, "samples"),
    (lambda: ss.RayTraced(samples=10**9), ss.SettingsError, "samples.*32768"),
    (lambda: ss.RayTraced(samples=-1), ss.SettingsError, "samples"),
    (lambda: ss.RayTraced(samples=1.5), ss.SettingsError, "samples"),
    (lambda: ss.RayTraced(samples=True), ss.SettingsError, "samples"),
    (lambda: ss.RayTraced(pattern="random"), ss.SettingsError, "stratified"),
    (lambda: ss.RayTraced(pattern=None), ss.SettingsError, "pattern"),
    (lambda: ss.RayTraced(passes=0), ss.SettingsError, "passes"),
    (lambda: ss.RayTraced(samples=4, probes=4), ss.SettingsError, "probes"),
    (lambda: ss.RayTraced(seed=2**32), ss.SettingsError, "seed"),
    (lambda: ss.DepthComplexity(samples=257), ss.SettingsError, "256"),
    (lambda: ss.DepthComplexity(passes=0), ss.SettingsError, "passes"),
    (lambda: ss.DepthComplexity(exact_area=1), ss.SettingsError, "exact_area.*True or False"),
    (lambda: ss.DepthComplexity(evaluation="rasterised"), ss.SettingsError, "tiled.*blended"),
    (lambda: ss.DepthComplexity(evaluation=2), ss.SettingsError, "evaluation"),
    (lambda: ss.DepthComplexity(counters="float"), ss.SettingsError, "counters.*'blended' alone"),
    (lambda: blended(counters="bytes"), ss.SettingsError, "words.*float"),
    (lambda: blended(initial_counts="stencil"), ss.SettingsError, "rays.*z_fail"),
    (lambda: blended(base=10), ss.SettingsError, "base.*8, 16, 64 or 256"),
    (lambda: blended(batches=3), ss.SettingsError, "batches.*1 or 2"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, technique=blended()), ss.SettingsError, "knows no points.*'tiled'"),
    (lambda: ss.DepthComplexity(unit="leaves"), ss.SettingsError, "auto.*edges.*triangles"),
    (lambda: ss.DepthComplexity(unit=None), ss.SettingsError, "unit"),
    (lambda: ss.HardShadowMap(resolution=0), ss.SettingsError, "resolution"),
    (lambda: ss.HardShadowMap(resolution=2**31), ss.SettingsError, "resolution"),
    (lambda: ss.PenumbraMap(resolution=15), ss.SettingsError, "resolution"),
    (lambda: ss.PenumbraMap(ramp="smooth"), ss.SettingsError, "light.*linear.*paper"),
    (lambda: ss.OcclusionCamera(resolution=4097), ss.SettingsError, "resolution"),
    (lambda: ss.OcclusionCamera(bias=2.0), ss.SettingsError, "bias"),
    (lambda: ss.OcclusionCamera(bias="much"), ss.SettingsError, "bias"),
    (lambda: ss.OcclusionCamera(ramp="straight"), ss.SettingsError, "outline.*bernstein"),
    # calls
    (lambda: visibility(SCENE, LIGHT), ss.SceneError, "either a camera or points"),
    (
        lambda: visibility(SCENE, LIGHT, camera=CAMERA, points=CARD),
        ss.SceneError,
        "either a camera or points",
    ),
    (lambda: visibility(SCENE, LIGHT, camera=CAMERA, normals=CARD), ss.SceneError, "normals"),
    (lambda: visibility(SCENE, LIGHT, camera="front"), ss.SceneError, "camera"),
    (lambda: visibility(SCENE, LIGHT, points=NAN), ss.SceneError, "points.*2 "),
    (lambda: visibility(SCENE, LIGHT, points=CARD, normals=NAN), ss.SceneError, "normals.*2 "),
    (lambda: visibility(SCENE, LIGHT, points=CARD, normals=CARD[:2]), ss.SceneError, "normals"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, normals=CARD * 0), ss.SceneError, "no length"),
    (lambda: visibility(SCENE, LIGHT, points=CARD[0]), ss.SceneError, r"points.*\(n, 3\)"),
    (lambda: visibility(SCENE, LIGHT, points=CARD.astype(int)), ss.SceneError, "points.*int64"),
    (lambda: visibility(SCENE, LIGHT, points=[[1e300, 0, 0]]), ss.SceneError, "points"),
    (lambda: visibility(SCENE, [], points=CARD), ss.SceneError, "at least one"),
    (lambda: visibility(SCENE, "sun", points=CARD), ss.SceneError, "lights"),
    (lambda: visibility(SCENE, [LIGHT, None], points=CARD), ss.SceneError, "lights"),
    (lambda: visibility(CARD, LIGHT, points=CARD), ss.SceneError, "softshadow.Scene"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, technique="ray_traced"), ss.SettingsError, "RayTraced"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, technique=ss.RayTraced), ss.SettingsError, "RayTraced"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, memory_limit=0), ss.SettingsError, "memory_limit"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, memory_limit=1.5), ss.SettingsError, "memory_limit"),
    (lambda: visibility(SCENE, LIGHT, points=CARD, progress=3), ss.SettingsError, "progress"),
    (lambda: ss.visibility(SCENE, LIGHT, points=CARD, device="toaster"), ss.SettingsError, "toaster"),
    (lambda: ss.visibility(SCENE, LIGHT, points=CARD, device=-1), ss.SettingsError, "device"),
    (lambda: ss.visibility(SCENE, LIGHT, points=CARD, device=None), ss.SettingsError, "device"),
    (lambda: ss.visibility(SCENE, LIGHT, points=CARD, device=999), ss.NoAdapterError, "999"),
    (lambda: visibility(SCENE, LIGHT, camera=look(size=(10**6, 3))), ss.TooLargeError, "1000000"),
    (lambda: render(SCENE, LIGHT, camera=None), ss.SceneError, "camera"),
    (lambda: render(SCENE, LIGHT, camera=CAMERA, shading="flat"), ss.SettingsError, "modulated"),
    (lambda: render(SCENE, LIGHT, camera=CAMERA, exposure=INF), ss.SettingsError, "exposure"),
    (lambda: render(SCENE, LIGHT, camera=CAMERA, exposure="1"), ss.SettingsError, "exposure"),
    (lambda: render(SCENE, LIGHT, camera=CAMERA, background=(0, 0)), ss.SceneError, "background"),
    (lambda: compare(SCENE, [LIGHT], camera=CAMERA, techniques=[ss.RayTraced()]), ss.SceneError, "one light"),
    (lambda: compare(SCENE, LIGHT, camera=CAMERA, techniques=[]), ss.SettingsError, "techniques"),
    (lambda: compare(SCENE, LIGHT, camera=CAMERA, techniques=["x"]), ss.SettingsError, r"techniques\[0\]"),
    (
        lambda: compare(SCENE, LIGHT, camera=CAMERA, techniques=[ss.RayTraced()], repeats=0),
        ss.SettingsError,
        "repeats",
    ),
    (lambda: ss.light_points(LIGHT, 0, scene=SCENE), ss.SettingsError, "samples"),
    (lambda: ss.light_points(LIGHT, 10**6, scene=SCENE), ss.SceneError, "samples"),
    (lambda: ss.light_points(LIGHT, 4, scene=SCENE, pattern="x"), ss.SettingsError, "pattern"),
    (lambda: ss.light_points(LIGHT, 4, CARD, scene=SCENE, spread="x"), ss.SettingsError, "spread"),
    (lambda: ss.light_points(LIGHT, 4, scene=SCENE, spread="decorrelated"), ss.SceneError, "receivers"),
    (lambda: ss.light_points(LIGHT, 4, CARD, scene=SCENE, spread="interleaved"), ss.SettingsError, "image's pixels"),
    (
        lambda: ss.light_points(LIGHT, 4, CARD[None], scene=SCENE, spread="interleaved", tile=0),
        ss.SceneError,
        "samples",
    ),
    (lambda: ss.RayTraced(spread="mixed"), ss.SettingsError, "'mixed' is none of 'correlated'"),
    (lambda: ss.RayTraced(tile=9), ss.SettingsError, "between 2 and 8, got 9"),
    (lambda: ss.DepthComplexity(samples=256, spread="interleaved", tile=6), ss.SettingsError, "smaller tile"),
    (
        lambda: visibility(SCENE, LIGHT, points=CARD, technique=ss.RayTraced(spread="interleaved")),
        ss.SettingsError,
        "ray_traced spread: interleaved.*give a camera",
    ),
    (
        lambda: ss.light_points(ss.SphereLight(radius=1, world_from_light=POSE), 4, scene=SCENE),
        ss.SceneError,
        "receivers",
    ),
]


@pytest.mark.parametrize(("call", "error", "words"), NONSENSE)
def test_nonsense_is_a_typed_error(call, error, words):
    # PanicException is no Exception: it would go through here and fail the test.
    with pytest.raises(error, match=words) as caught:
        call()
    assert isinstance(caught.value, ss.SoftShadowError)
    assert "internal error" not in str(caught.value)


@pytest.mark.parametrize("extension", ["glb", "gltf", "obj"])
@pytest.mark.parametrize("content", [b"", b"glTF\2\0\0\0", b"v 0 0\nf 1 2 3\n", bytes(range(256))])
def test_broken_files_are_refused_with_their_name(tmp_path, extension, content):
    path = tmp_path / f"broken.{extension}"
    path.write_bytes(content)
    with pytest.raises(ss.SceneError, match=r"broken\."):
        ss.Scene.load(path)


def test_a_truncated_file_is_refused(tmp_path):
    import trimesh

    path = tmp_path / "cut.glb"
    path.write_bytes(trimesh.creation.icosphere().export(file_type="glb")[:-100])
    with pytest.raises(ss.SceneError, match=r"cut\.glb"):
        ss.Scene.load(path)


def test_only_the_first_two_arguments_are_positional():
    with pytest.raises(TypeError):
        ss.visibility(SCENE, LIGHT, CAMERA)
    with pytest.raises(TypeError):
        ss.render(SCENE, LIGHT, CAMERA)
    with pytest.raises(TypeError):
        ss.RayTraced(64)


def test_exceptions_have_the_bases_that_python_users_catch():
    bases = {
        ss.SceneError: ValueError,
        ss.SceneFileNotFound: FileNotFoundError,
        ss.SettingsError: ValueError,
        ss.TooLargeError: ValueError,
        ss.NoAdapterError: RuntimeError,
        ss.GpuError: RuntimeError,
        ss.GpuOutOfMemory: MemoryError,
        ss.MissingExtra: ImportError,
        ss.OutputError: OSError,
    }
    for error, base in bases.items():
        assert issubclass(error, base)
        assert issubclass(error, ss.SoftShadowError)


def test_a_light_without_a_kind_cannot_be_made():
    with pytest.raises(TypeError, match="abstract"):
        ss.Light()
