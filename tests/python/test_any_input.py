"""Every public call with values of every kind in every place: whatever goes wrong is one of the library's own errors.

A panic would be a ``PanicException``, which is no ``Exception``; any other error is a value that nobody checked.
"""

from __future__ import annotations

import datetime
import decimal
import fractions
import inspect
import random
import warnings

import numpy as np
import pytest
import trimesh

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE

POSE = ss.look_at((0, 3, 0), (0, 0, 0))
LIGHT = ss.RectLight(width=1, height=1, world_from_light=POSE)
CAMERA = ss.Camera.look_at(eye=(3, 4, 3), target=(0, 0, 0), fov_y_deg=50, size=(3, 2))
SCENE = ss.Scene([ss.Mesh(vertices=FLOOR, faces=SQUARE), ss.Mesh(vertices=CARD, faces=SQUARE)])
RAYS = ss.RayTraced(samples=2)
NATIVE = {"device": "native"}


class Odd:
    """Has neither length nor number, and compares with nothing."""

    def __eq__(self, other: object) -> bool:
        return False

    __hash__ = None


NOTHING = [None, True, False, Odd(), object, lambda *_: None, ..., NotImplemented, ValueError("no")]
NUMBERS = [0, -1, 1, 2, 3, 2**31, 2**32, 2**63, 2**64, 2**70, -(2**70), 0.0, -0.0, 0.5, 1e-320, 1e300, -1e300]
NUMBERS += [float("nan"), float("inf"), float("-inf"), 1j, fractions.Fraction(1, 3), decimal.Decimal("0.1")]
NUMBERS += [np.float32(1), np.float64("nan"), np.int8(-1), np.uint64(2**64 - 1), np.bool_(True), np.longdouble(1)]
TEXTS = [
    "",
    "x",
    "auto",
    "stratified",
    "a\0b",
    "\ud800",
    "\U0001f600",
    "../..",
    "x" * 5000,
    b"",
    b"\xff",
    "nan",
    "hall",
]
LISTS = [
    [],
    (),
    {},
    set(),
    [[]],
    [[], []],
    [None],
    [1, 2],
    [1, 2, 3],
    [[1, 2], [3]],
    [1e400],
    ["1", "2", "3"],
    range(3),
]
LISTS += [[[1, 2, 3]] * 3, [[0.0] * 4] * 4, {"a": 1}, [RAYS], [LIGHT], [LIGHT] * 2, [SCENE], iter([1, 2, 3]), [[[[]]]]]
ARRAYS = [np.zeros(shape) for shape in [(), 0, 2, 3, (0, 3), (1, 3), (3, 3), (4, 4), (2, 2, 3), (1, 1, 1, 1), (3, 0)]]
ARRAYS += [
    np.full((4, 4), np.nan),
    np.full((2, 3), np.inf),
    np.full((2, 3), 1e300),
    np.ones((2, 3), ">f8"),
    np.eye(4)[::2],
]
ARRAYS += [
    np.ones((2, 3), dtype) for dtype in ("f2", "f4", "i1", "u8", "?", "c16", "O", "U1", "S1", "M8[s]", "m8[s]", "V8")
]
ARRAYS += [np.ma.masked_array(CARD, CARD > 0), np.array([datetime.date(2000, 1, 1)]), np.zeros(2, [("a", "f4")])]
ARRAYS += [
    CARD,
    SQUARE,
    np.asfortranarray(CARD),
    CARD[::-1],
    np.broadcast_to(np.float64(1), (5, 3)),
    np.array([[0, 1, 9]]),
]
OURS = [LIGHT, CAMERA, SCENE, RAYS, ss.RayTraced, ss.SunLight(0, 45), ss.Mesh(vertices=CARD, faces=SQUARE), ss, np]
VALUES = [*NOTHING, *NUMBERS, *TEXTS, *LISTS, *ARRAYS, *OURS]

RESULT = ss.visibility(SCENE, LIGHT, camera=CAMERA, technique=RAYS, **NATIVE)
PICTURE = ss.render(SCENE, LIGHT, camera=CAMERA, technique=RAYS, **NATIVE)
POSED = {"world_from_light": POSE, "radiance": (1, 1, 1), "name": "key"}
CALL = {"camera": CAMERA, "memory_limit": None, "progress": None, **NATIVE}

NO_GOAL = {"max_error": None, "max_ms": None, "error_norm": "rmse", "confidence": None}
COMPARED = ss.compare(SCENE, LIGHT, camera=CAMERA, techniques=[RAYS], reference=RAYS, repeats=1, **NATIVE)

# A call and good arguments for all of its parameters.
CALLS = {
    "Camera": (ss.Camera, {"world_from_camera": POSE, "size": (3, 2), "fov_y_deg": 40.0, "K": None, "frame": "opengl"}),
    "Camera, K": (
        ss.Camera,
        {"world_from_camera": POSE, "size": (3, 2), "fov_y_deg": None, "K": np.diag([9.0, 9, 1]), "frame": "opencv"},
    ),
    "Camera.look_at": (
        ss.Camera.look_at,
        {"eye": (1, 1, 1), "target": (0, 0, 0), "up": (0, 1, 0), "fov_y_deg": 40, "size": (3, 2)},
    ),
    "Camera.from_trimesh": (
        ss.Camera.from_trimesh,
        {"camera": trimesh.scene.Camera(resolution=(3, 2), fov=(40, 30)), "transform": POSE},
    ),
    "DepthComplexity": (ss.DepthComplexity, vars(ss.DepthComplexity())),
    "DiscLight": (ss.DiscLight, {"radius": 1.0, **POSED}),
    "HardShadowMap": (ss.HardShadowMap, vars(ss.HardShadowMap())),
    "Mesh": (ss.Mesh, vars(ss.Mesh(vertices=CARD, faces=SQUARE))),
    "OcclusionCamera": (ss.OcclusionCamera, vars(ss.OcclusionCamera())),
    "OcclusionLayers": (ss.OcclusionLayers, vars(ss.OcclusionLayers())),
    "PenumbraMap": (ss.PenumbraMap, vars(ss.PenumbraMap())),
    "PolygonLight": (ss.PolygonLight, {"outline": [[0, 0], [1, 0], [0, 1]], **POSED}),
    "RayTraced": (ss.RayTraced, vars(RAYS)),
    "RectLight": (ss.RectLight, {"width": 1, "height": 1, "texture": np.ones((2, 2, 3)), **POSED}),
    "Scene": (ss.Scene, {"meshes": SCENE.meshes, "notes": ["a"]}),
    "Scene.from_arrays": (
        ss.Scene.from_arrays,
        {"vertices": CARD, "faces": SQUARE, "name": "a", "base_color": (1, 1, 1), "opacity": 1.0},
    ),
    "Scene.from_trimesh": (ss.Scene.from_trimesh, {"source": trimesh.creation.box()}),
    "Scene.load": (ss.Scene.load, {"path": "nowhere.obj"}),
    "Scene.with_vertices": (SCENE.with_vertices, {"vertices": [None, CARD]}),
    "SphereLight": (ss.SphereLight, {"radius": 1.0, **POSED}),
    "SunLight": (
        ss.SunLight,
        {"azimuth": 0, "elevation": 45, "diameter_deg": 0.5, "up": "y", "radiance": (1, 1, 1), "name": ""},
    ),
    "compare": (
        ss.compare,
        {"scene": SCENE, "light": LIGHT, "points": None, "normals": None, "techniques": [RAYS], "reference": RAYS}
        | {"name": "a", "repeats": 1, "camera": CAMERA, "progress": None, **NATIVE},
    ),
    "Comparison.save": (COMPARED.save, {"folder": "report"}),
    "doctor": (ss.doctor, {"measure": False}),
    "from_trimesh": (ss.from_trimesh, {"source": trimesh.creation.box()}),
    "light_points": (
        ss.light_points,
        {"light": LIGHT, "samples": 4, "receivers": CARD, "scene": SCENE, "pattern": "stratified", "seed": 1}
        | {"spread": "decorrelated", "tile": 2},
    ),
    "load": (ss.load, {"path": "nowhere.json"}),
    "look_at": (ss.look_at, {"eye": (1, 1, 1), "target": (0, 0, 0), "up": (0, 1, 0)}),
    "render": (
        ss.render,
        {"scene": SCENE, "lights": [LIGHT], "technique": RAYS, "shading": "integrated", "exposure": 0.0}
        | {"background": (0, 0, 0), **CALL},
    ),
    "scenes.load": (ss.scenes.load, {"name": "fork"}),
    "scenes.names": (ss.scenes.names, {}),
    "visibility": (
        ss.visibility,
        {"scene": SCENE, "lights": LIGHT, "points": None, "normals": None, "technique": RAYS, **CALL}
        | {"standard_error": True, "receivers": True, "sample_masks": True, **NO_GOAL},
    ),
    "visibility, points": (
        ss.visibility,
        {"scene": SCENE, "lights": [LIGHT], "points": CARD, "normals": FLOOR + 1.0, "technique": RAYS, **CALL}
        | {"camera": None, "standard_error": True, "receivers": True, "sample_masks": True, **NO_GOAL},
    ),
    "Visibility.plot": (RESULT.plot, {"axes": None}),
    "Picture.plot": (PICTURE.plot, {"axes": None}),
    "Visibility.save": (RESULT.save, {"path": "seen.png"}),
    "Picture.save": (PICTURE.save, {"path": "seen.exr"}),
}
# Made by the library alone.
RESULTS = {"Comparison", "Diagnosis", "LightPoints", "Picture", "SceneFile", "Visibility"}


def misbehaves(call, arguments) -> str | None:
    """What a call raises that is none of the library's errors, in words."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            call(**arguments)
    except ss.SoftShadowError as error:
        return f"{error}"[:200] if "internal error" in str(error) or type(error) is ss.SoftShadowError else None
    except BaseException as error:
        return f"{type(error).__name__}: {error}"[:200]
    return None


def is_callback(parameter: str, value: object) -> bool:
    """Whether errors would be those of the caller's own function, which go through."""
    return parameter == "progress" and callable(value)


def shown(value: object) -> str:
    return f"{value!r:.60}" if not isinstance(value, np.ndarray) else f"{value.dtype} {value.shape}"


def test_every_public_call_is_here_with_all_of_its_parameters():
    public = {name for name in ss.__all__ if callable(getattr(ss, name))}
    errors = {
        name for name in public if isinstance(getattr(ss, name), type) and issubclass(getattr(ss, name), Exception)
    }
    assert public - errors - RESULTS - {"Light", "Technique"} <= set(CALLS)
    for name in RESULTS | {"Camera", "Scene"}:
        kind = getattr(ss, name)
        methods = [m for m, of in vars(kind).items() if not m.startswith("_") and callable(getattr(kind, m))]
        parameters = {m: [p for p in inspect.signature(getattr(kind, m)).parameters if p != "self"] for m in methods}
        assert {f"{name}.{m}" for m in methods if parameters[m]} <= set(CALLS)
    for name, (call, good) in CALLS.items():
        assert set(good) == set(inspect.signature(call).parameters), name


@pytest.mark.parametrize("name", CALLS)
def test_one_odd_value_is_a_typed_error(name, tmp_path, monkeypatch):
    # Some odd values are good names of files.
    monkeypatch.chdir(tmp_path)
    call, good = CALLS[name]
    wrong = {}
    for parameter in good:
        for value in VALUES:
            if is_callback(parameter, value):
                continue
            words = misbehaves(call, good | {parameter: value})
            if words is not None:
                wrong.setdefault((parameter, words[:40]), f"{parameter}={shown(value)}: {words}")
    assert not wrong, "\n".join(wrong.values())


@pytest.mark.parametrize("name", CALLS)
def test_several_odd_values_are_typed_errors(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, good = CALLS[name]
    choose, wrong = random.Random(name), []
    for _ in range(100 if len(good) > 1 else 0):
        odd = {
            parameter: choose.choice(VALUES) for parameter in choose.sample(list(good), choose.randint(2, len(good)))
        }
        odd = {parameter: value for parameter, value in odd.items() if not is_callback(parameter, value)}
        words = misbehaves(call, good | odd)
        if words is not None:
            wrong.append(", ".join(f"{k}={shown(v)}" for k, v in odd.items()) + f": {words}")
    assert not wrong, "\n".join(wrong)


def test_what_is_no_typed_error_is_seen():
    def raises(error):
        def call(value):
            raise error

        return misbehaves(call, {"value": 1})

    assert raises(ss.SettingsError("no")) is None
    assert "ValueError" in raises(ValueError("no"))
    assert "internal" in raises(ss.SoftShadowError("internal error, please report it: index out of bounds"))

    class PanicException(BaseException):
        pass

    assert "PanicException" in raises(PanicException("index out of bounds"))
