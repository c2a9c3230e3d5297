"""Every option of every public call changes something.

Parameters of public callables and fields of public dataclasses are found by introspection; each has an entry below, a
pair of results that differ in nothing else. What has no entry is red, and so is an entry of what is no longer there.
"""

from __future__ import annotations

import inspect
import json
import logging
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import trimesh
from matplotlib.figure import Figure

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, camera_above, compare, light_above, render, visibility

SCENE = ss.Scene([ss.Mesh(vertices=FLOOR, faces=SQUARE, name="floor"), ss.Mesh(vertices=CARD, faces=SQUARE)])
LIGHT, POSE = light_above(), ss.look_at((0, 3, 0), (0, 0, 0))
CAMERA = camera_above((24, 18))
POINTS = np.stack([np.linspace(0.4, 1.1, 40), np.full(40, 1e-3), np.linspace(0, 0.9, 40)], axis=1)
# Three sheets over each other, of which two let light through.
GLASS = ss.Scene(
    [ss.Mesh(vertices=FLOOR, faces=SQUARE)]
    + [ss.Mesh(vertices=CARD + [0.2 * k, 0.3 * k, 0], faces=SQUARE, opacity=0.4) for k in range(3)]
)
BALL = trimesh.creation.icosphere(subdivisions=2, radius=0.6)
BODY = ss.Scene(
    [ss.Mesh(vertices=FLOOR, faces=SQUARE), ss.Mesh(vertices=BALL.vertices + [0, 1, 0], faces=np.array(BALL.faces))]
)


def names_of(owner: str, member: Callable[..., Any]) -> Iterator[str]:
    """The parameters of a callable; several of `*arguments` cannot be enumerated, and there are none."""
    for parameter in inspect.signature(member).parameters.values():
        if parameter.name not in ("self", "cls"):
            yield f"{owner}({parameter.name})"


def options() -> set[str]:
    """Every parameter of every public callable, and every field of every public dataclass."""
    found: set[str] = set()
    public = {name: getattr(ss, name) for name in ss.__all__ if name not in ("scenes", "__version__")}
    public |= {f"scenes.{name}": value for name, value in vars(ss.scenes).items() if is_own(value, "softshadow.scenes")}
    for name, value in public.items():
        if not inspect.isclass(value):
            found |= set(names_of(name, value))
            continue
        if issubclass(value, (Exception, Warning)):
            continue
        if is_dataclass(value):
            found |= {f"{name}.{field.name}" for field in fields(value) if field.name != "_"}
        else:
            found |= set() if inspect.isabstract(value) else set(names_of(name, value))
        for member_name, member in inspect.getmembers(value, lambda m: inspect.isfunction(m) or inspect.ismethod(m)):
            if not member_name.startswith("_"):
                found |= set(names_of(f"{name}.{member_name}", member))
    return found


def is_own(value: object, module: str) -> bool:
    """A public function or class that a module defines."""
    return getattr(value, "__module__", "") == module and not getattr(value, "__name__", "_").startswith("_")


Pair = Callable[[], tuple[Any, Any]]
PAIRS: dict[str, Pair] = {}


def entry(name: str, one: Callable[[], Any], other: Callable[[], Any]) -> None:
    assert name not in PAIRS
    PAIRS[name] = lambda: (one(), other())


# Calls with one option changed.


@cache
def plain(call: Callable[..., Any], **settings: Any) -> Any:
    return call(SCENE, LIGHT, camera=CAMERA, **settings)


def of_visibility(name: str, other: Callable[[], Any], what: Callable[[ss.Visibility], Any]) -> None:
    entry(f"visibility({name})", lambda: what(plain(visibility)), lambda: what(other()))


def with_option(**settings: Any) -> Callable[[], Any]:
    return lambda: visibility(SCENE, LIGHT, **{"camera": CAMERA} | settings)


def values(result: ss.Visibility) -> Any:
    return result.values


of_visibility("scene", lambda: visibility(BODY, LIGHT, camera=CAMERA), values)
of_visibility("lights", lambda: visibility(SCENE, light_above(2.0), camera=CAMERA), values)
of_visibility("camera", with_option(camera=replace(CAMERA, size=(24, 19))), values)
of_visibility("points", with_option(camera=None, points=POINTS), values)
of_visibility("technique", with_option(technique=ss.HardShadowMap()), values)
of_visibility("device", with_option(device="native"), lambda result: result.info["adapter"])
of_visibility("memory_limit", with_option(memory_limit=30_000), lambda result: result.info["blocks"])
of_visibility("standard_error", with_option(standard_error=False), lambda result: result.standard_error)
of_visibility("receivers", with_option(receivers=True), lambda result: result.positions)
of_visibility("sample_masks", with_option(sample_masks=True), lambda result: result.visible_samples)
GOAL: dict[str, Any] = {"technique": None, "max_error": 0.05}
of_visibility("max_error", with_option(**GOAL), lambda result: result.info.get("choice"))
of_visibility("max_ms", with_option(technique=None, max_ms=1e6), lambda result: result.info.get("choice"))
for name, said, other in (("error_norm", "norm", "p99"), ("confidence", "confidence", 0.8)):
    entry(
        f"visibility({name})",
        lambda said=said: with_option(**GOAL)().info["choice"][said],
        lambda name=name, said=said, other=other: with_option(**GOAL, **{name: other})().info["choice"][said],
    )
entry(
    "visibility(normals)",
    lambda: visibility(SCENE, LIGHT, points=POINTS).values,
    lambda: visibility(SCENE, LIGHT, points=POINTS, normals=np.tile([0.0, 0, 1], (40, 1))).values,
)


def calls_of_progress(call: Callable[..., Any]) -> int:
    seen: list[object] = []
    call(progress=lambda *step: seen.append(step))
    return len(seen)


for name, call in (
    ("visibility", lambda **settings: visibility(SCENE, LIGHT, camera=CAMERA, **settings)),
    ("render", lambda **settings: render(SCENE, LIGHT, camera=CAMERA, **settings)),
    ("compare", lambda **settings: comparison(**settings)),
):
    entry(f"{name}(progress)", lambda: 0, lambda call=call: calls_of_progress(call))


def of_render(name: str, other: Callable[[], Any], what: Callable[[ss.Picture], Any] = lambda p: p.linear) -> None:
    entry(f"render({name})", lambda: what(plain(render)), lambda: what(other()))


def drawn(**settings: Any) -> Callable[[], Any]:
    return lambda: render(SCENE, LIGHT, **{"camera": CAMERA} | settings)


of_render("scene", lambda: render(BODY, LIGHT, camera=CAMERA))
of_render("lights", lambda: render(SCENE, [LIGHT, LIGHT], camera=CAMERA))
of_render("camera", drawn(camera=replace(CAMERA, size=(24, 19))))
of_render("technique", drawn(technique=ss.HardShadowMap()))
of_render("shading", drawn(shading="modulated"))
of_render("exposure", drawn(exposure=1))
of_render("background", lambda: render(SCENE, LIGHT, camera=CAMERA, background=(1, 0, 0)))
of_render("device", drawn(device="native"), lambda picture: picture.info["adapter"])
of_render("memory_limit", drawn(memory_limit=30_000), lambda picture: picture.info["blocks"])

FEW, MANY = ss.RayTraced(samples=4), ss.RayTraced(samples=64)


def comparison(scene: ss.Scene = SCENE, light: ss.Light = LIGHT, **settings: Any) -> ss.Comparison:
    defaults = {"points": POINTS, "techniques": [FEW], "reference": MANY, "repeats": 1}
    return compare(scene, light, **defaults | settings)


def errors(result: ss.Comparison) -> Any:
    return [{name: error for name, error in row.items() if "ms" not in name} for row in result.rows]


def of_compare(name: str, what: Callable[[ss.Comparison], Any] = errors, **settings: Any) -> None:
    entry(f"compare({name})", lambda: what(comparison()), lambda: what(comparison(**settings)))


of_compare("scene", scene=BODY)
of_compare("light", light=light_above(2.0))
of_compare("camera", points=None, camera=CAMERA)
of_compare("points", points=POINTS[:7])
of_compare("normals", normals=np.tile([0.0, 0.2, 1], (40, 1)))
of_compare("techniques", techniques=[ss.HardShadowMap()])
of_compare("reference", reference=replace(MANY, seed=1))
entry("compare(name)", lambda: comparison().name, lambda: comparison(name="other").name)
of_compare("device", lambda result: result.reference["adapter"], device="native")


def runs(repeats: int) -> int:
    totals: list[int] = []
    comparison(repeats=repeats, progress=lambda done, total, info: totals.append(total))
    return totals[-1]


entry("compare(repeats)", lambda: runs(1), lambda: runs(2))


# Techniques.


def by(technique: ss.Technique, scene: ss.Scene = BODY, **settings: Any) -> Callable[[], Any]:
    return lambda: visibility(scene, LIGHT, camera=CAMERA, technique=technique, **settings).values


def of_technique(kind: type[ss.Technique], name: str, other: Any, scene: ss.Scene = BODY, **common: Any) -> None:
    entry(f"{kind.__name__}.{name}", by(kind(**common), scene), by(kind(**common, **{name: other}), scene))


for kind, common in ((ss.RayTraced, {}), (ss.DepthComplexity, {"exact_area": False})):
    for name, other in {"samples": 16, "pattern": "low_discrepancy", "seed": 1, "passes": 2}.items():
        of_technique(kind, name, other, **common)
    of_technique(kind, "spread", "decorrelated", **common)
    of_technique(kind, "tile", 2, spread="interleaved", **common)
of_technique(ss.HardShadowMap, "resolution", 16)
for name, other in {"slices": 3, "resolution": 64, "filter": "nbuffer", "split": 1, "combine": "maximum"}.items():
    of_technique(ss.OcclusionLayers, name, other)
for name, other in {"projection": "parallel", "near": "fade", "repair_leaks": True}.items():
    of_technique(ss.OcclusionLayers, name, other)
of_technique(ss.PenumbraMap, "resolution", 16)
of_technique(ss.PenumbraMap, "ramp", "paper")
of_technique(ss.OcclusionCamera, "resolution", 16)
# Several silhouettes before a receiver, and a sheet between two others.
of_technique(ss.OcclusionCamera, "steps", 1, GLASS)
of_technique(ss.OcclusionCamera, "bias", 1.0, GLASS)
of_technique(ss.OcclusionCamera, "ramp", "bernstein")
of_technique(ss.DepthComplexity, "exact_area", False, SCENE)
of_technique(ss.DepthComplexity, "silhouettes", "standard")
of_technique(ss.DepthComplexity, "coverage", "table", exact_area=False)
of_technique(ss.DepthComplexity, "attenuation", "sum", GLASS)


def plan_of(kind: type[ss.Technique] = ss.DepthComplexity, **settings: Any) -> Callable[[], Any]:
    return lambda: visibility(BODY, LIGHT, camera=CAMERA, technique=kind(**settings)).info["plan"]


# The same samples on another way: what differs is the plan.
for name, other in {"initial_counts": "z_fail", "counters": "float", "base": 256, "batches": 2}.items():
    entry(f"DepthComplexity.{name}", plan_of(evaluation="blended"), plan_of(evaluation="blended", **{name: other}))
entry("RayTraced.probes", plan_of(ss.RayTraced), plan_of(ss.RayTraced, probes=8))
entry("DepthComplexity.evaluation", plan_of(), plan_of(evaluation="blended"))
entry("DepthComplexity.unit", plan_of(unit="edges"), plan_of(unit="triangles"))
for kind in (
    ss.RayTraced,
    ss.HardShadowMap,
    ss.OcclusionCamera,
    ss.OcclusionLayers,
    ss.PenumbraMap,
    ss.DepthComplexity,
):
    assert not inspect.signature(kind.to_json).parameters.keys() - {"self"}


# Lights: where their samples lie, or what they add to a picture.


def samples_of(light: ss.Light) -> Any:
    return ss.light_points(light, 16, POINTS[:3], scene=SCENE).positions


def lit(light: ss.Light) -> Any:
    return render(SCENE, light, camera=CAMERA).linear


def called(light: ss.Light) -> Any:
    return visibility(SCENE, light, points=POINTS).light_names


ELSEWHERE, DIM = ss.look_at((1, 3, 0), (0, 0, 0)), (0.5, 0.2, 0.1)
PLACED = {"world_from_light": ELSEWHERE}
LIGHTS: dict[ss.Light, dict[str, Any]] = {
    ss.RectLight(width=1, height=1, world_from_light=POSE): PLACED
    | {"width": 2, "height": 2, "texture": np.eye(3)[None]},
    ss.DiscLight(radius=1, world_from_light=POSE): PLACED | {"radius": 2},
    ss.SphereLight(radius=1, world_from_light=POSE): PLACED | {"radius": 2},
    ss.PolygonLight(outline=[[0, 0], [1, 0], [0, 1]], world_from_light=POSE): PLACED
    | {"outline": np.array([[0.0, 0], [2, 0], [0, 1]])},
    ss.SunLight(30, 40): {"azimuth": 60, "elevation": 60, "diameter_deg": 5, "up": "z"},
}
for light, changes in LIGHTS.items():
    for name, other in (changes | {"radiance": DIM, "name": "key"}).items():
        what = {"radiance": lit, "texture": lit, "name": called}.get(name, samples_of)
        changed = replace(light, **{name: other})
        entry(
            f"{type(light).__name__}.{name}",
            lambda what=what, light=light: what(light),
            lambda what=what, changed=changed: what(changed),
        )


# Cameras, meshes, scenes.


def seen(camera: ss.Camera) -> Any:
    return visibility(SCENE, LIGHT, camera=camera, receivers=True).positions


INTRINSICS = np.array([[20.0, 0, 12], [0, 20, 9], [0, 0, 1]])
BY_K = ss.Camera(world_from_camera=CAMERA.world_from_camera, K=INTRINSICS, size=CAMERA.size)
for name, one, other in (
    ("world_from_camera", CAMERA, replace(CAMERA, world_from_camera=ss.look_at((3, 5, 3), (0, 0, 0)))),
    ("size", CAMERA, replace(CAMERA, size=(12, 18))),
    ("fov_y_deg", CAMERA, replace(CAMERA, fov_y_deg=30)),
    ("K", BY_K, replace(BY_K, K=INTRINSICS + np.eye(3) * [1, 0, 0])),
    ("frame", CAMERA, replace(CAMERA, frame="opencv")),
):
    entry(f"Camera.{name}", lambda one=one: seen(one), lambda other=other: seen(other))
LOOKING: dict[str, Any] = {"eye": (3, 4, 3), "target": (0, 0, 0), "fov_y_deg": 50, "size": (24, 18)}
for name, other in {"eye": (3, 5, 3), "target": (0, 1, 0), "up": (1, 0, 0), "fov_y_deg": 30, "size": (9, 9)}.items():
    entry(
        f"Camera.look_at({name})",
        lambda: ss.Camera.look_at(**LOOKING),
        lambda name=name, other=other: ss.Camera.look_at(**LOOKING | {name: other}),
    )
    if name in ("eye", "target", "up"):
        entry(
            f"look_at({name})",
            lambda: ss.look_at((3, 4, 3), (0, 0, 0)),
            lambda name=name, other=other: ss.look_at(**{"eye": (3, 4, 3), "target": (0, 0, 0), name: other}),
        )
THEIRS = trimesh.scene.Camera(resolution=(24, 10), fov=(60, 27))
entry(
    "Camera.from_trimesh(camera)",
    lambda: ss.Camera.from_trimesh(THEIRS, POSE),
    lambda: ss.Camera.from_trimesh(trimesh.scene.Camera(resolution=(24, 10), fov=(50, 27)), POSE),
)
entry(
    "Camera.from_trimesh(transform)",
    lambda: ss.Camera.from_trimesh(THEIRS, POSE),
    lambda: ss.Camera.from_trimesh(THEIRS, ELSEWHERE),
)


def pictured(mesh: ss.Mesh) -> Any:
    return render(ss.Scene([mesh]), light_above(radiance=(9, 9, 9)), camera=CAMERA).linear


SHEET, GLOSSY = (ss.Mesh(vertices=CARD, faces=SQUARE, specular=specular) for specular in (0.0, 0.9))
for name, sheet, other in (
    ("vertices", SHEET, CARD + [0.2, 0, 0]),
    ("faces", SHEET, SQUARE[:1]),
    ("base_color", SHEET, (0.1, 0.2, 0.3)),
    ("roughness", GLOSSY, 0.2),
    ("specular", SHEET, 0.9),
):
    changed = replace(sheet, **{name: other})
    entry(f"Mesh.{name}", lambda sheet=sheet: pictured(sheet), lambda changed=changed: pictured(changed))


def refused(scene: Callable[[], ss.Scene]) -> str:
    with pytest.raises(ss.SceneError) as error:
        scene()
    return str(error.value)


NAN = CARD * np.nan
entry(
    "Mesh.name",
    lambda: refused(lambda: ss.Scene([ss.Mesh(vertices=NAN, faces=SQUARE)])),
    lambda: refused(lambda: ss.Scene([ss.Mesh(vertices=NAN, faces=SQUARE, name="bunny")])),
)


def shadow(scene: ss.Scene) -> Any:
    return visibility(scene, LIGHT, points=POINTS).values


entry(
    "Mesh.opacity",
    lambda: shadow(ss.Scene([SHEET])),
    lambda: shadow(ss.Scene([replace(SHEET, opacity=0.5)])),
)
entry("Scene(meshes)", lambda: shadow(ss.Scene()), lambda: shadow(ss.Scene([SHEET])))
entry(
    "Scene(notes)",
    lambda: visibility(ss.Scene(), LIGHT, points=POINTS).info["notes"],
    lambda: visibility(ss.Scene(notes=["a note"]), LIGHT, points=POINTS).info["notes"],
)
entry(
    "Scene.with_vertices(vertices)",
    lambda: shadow(SCENE.with_vertices([None, None])),
    lambda: shadow(SCENE.with_vertices([None, CARD + [0.3, 0, 0]])),
)
ARRAYS: dict[str, Any] = {"vertices": CARD, "faces": SQUARE}
for name, other in {
    "vertices": CARD + [0.2, 0, 0],
    "faces": SQUARE[:1],
    "name": "bunny",
    "base_color": (0.1, 0.2, 0.3),
    "opacity": 0.5,
}.items():
    entry(
        f"Scene.from_arrays({name})",
        lambda: ss.Scene.from_arrays(**ARRAYS).meshes,
        lambda name=name, other=other: ss.Scene.from_arrays(**ARRAYS | {name: other}).meshes,
    )
OTHER = trimesh.Trimesh(CARD, SQUARE, process=False)
entry(
    "Scene.from_trimesh(source)",
    lambda: ss.Scene.from_trimesh(BALL).meshes,
    lambda: ss.Scene.from_trimesh(OTHER).meshes,
)
entry(
    "from_trimesh(source)",
    lambda: ss.from_trimesh(BALL).scene.meshes,
    lambda: ss.from_trimesh(OTHER).scene.meshes,
)


# Files.

DESCRIPTION: dict[str, Any] = {
    "softshadow": 1,
    "meters_per_unit": 1,
    "meshes": [{"path": "card.ply"}],
    "lights": [{"type": "RectLight", "translate": [0, 3, 0], "target": [0, 0, 0]}],
    "camera": {"eye": [3, 4, 3], "target": [0, 0, 0], "fov_y_deg": 40, "size": [4, 3]},
}


def loaded(what: Callable[[Path], Any], **changes: Any) -> Callable[[], Any]:
    def load() -> Any:
        with TemporaryDirectory() as name:
            folder = Path(name)
            OTHER.export(folder / "card.ply")
            BALL.export(folder / "ball.ply")
            (folder / "scene.json").write_text(json.dumps(DESCRIPTION | changes))
            return what(folder)

    return load


def described(field: str) -> Callable[[Path], Any]:
    def read(folder: Path) -> Any:
        value = getattr(ss.load(folder / "scene.json"), field)
        return value.meshes if isinstance(value, ss.Scene) else value

    return read


for name, field, other in (
    ("scene", "meshes", [{"path": "ball.ply"}]),
    ("lights", "lights", []),
    ("camera", "camera", DESCRIPTION["camera"] | {"fov_y_deg": 50}),
    ("meters_per_unit", "meters_per_unit", 2),
):
    entry(f"SceneFile.{name}", loaded(described(name)), loaded(described(name), **{field: other}))
for name, read in (
    ("load(path)", lambda path: ss.load(path).scene.meshes),
    ("Scene.load(path)", lambda path: ss.Scene.load(path).meshes),
):
    entry(
        name,
        loaded(lambda folder, read=read: read(folder / "card.ply")),
        loaded(lambda folder, read=read: read(folder / "ball.ply")),
    )
entry(
    "scenes.load(name)",
    lambda: ss.scenes.load("hall").scene.meshes,
    lambda: ss.scenes.load("fork").scene.meshes,
)
for field in fields(ss.scenes.ShippedScene):
    entry(
        f"scenes.ShippedScene.{field.name}",
        lambda field=field: described_by(ss.scenes.load("hall"), field.name),
        lambda field=field: described_by(ss.scenes.load("fork"), field.name),
    )


def described_by(shipped: ss.scenes.ShippedScene, field: str) -> Any:
    value = getattr(shipped, field)
    return value.meshes if isinstance(value, ss.Scene) else value


def saved(result: Callable[[], Any], name: str) -> Callable[[], Any]:
    def save() -> Any:
        with TemporaryDirectory() as folder:
            result().save(Path(folder) / name)
            return [(path.name, path.read_bytes()) for path in Path(folder).iterdir()]

    return save


for name, result in (("Visibility", lambda: plain(visibility)), ("Picture", lambda: plain(render))):
    entry(f"{name}.save(path)", saved(result, "a.png"), saved(result, "a.csv"))
    entry(
        f"{name}.plot(axes)",
        lambda: len(Figure().subplots().images),
        lambda result=result: len(result().plot(axes=Figure().subplots()).images),
    )


# Samples of a light.

for name, other in {
    "light": ss.DiscLight(radius=1, world_from_light=POSE),
    "samples": 9,
    "scene": ss.Scene.from_arrays(FLOOR * 1e6 + 0.123, SQUARE),
    "pattern": "low_discrepancy",
    "seed": 1,
    "spread": "decorrelated",
    "receivers": POINTS[:2],
}.items():
    base: dict[str, Any] = {"light": LIGHT, "samples": 16, "scene": SCENE, "receivers": POINTS[:3]}
    base |= {"spread": "decorrelated"} if name == "receivers" else {}
    entry(
        f"light_points({name})",
        lambda base=base: ss.light_points(**base).positions,
        lambda base=base, name=name, other=other: ss.light_points(**base | {name: other}).positions,
    )
entry(
    "light_points(tile)",
    lambda: ss.light_points(LIGHT, 16, POINTS.reshape(5, 8, 3), scene=SCENE, spread="interleaved").positions,
    lambda: ss.light_points(LIGHT, 16, POINTS.reshape(5, 8, 3), scene=SCENE, spread="interleaved", tile=2).positions,
)


# What results hold depends on what was asked.


def of_result(kind: type, one: Callable[[], Any], other: Callable[[], Any], *names: str) -> None:
    for name in names:
        entry(
            f"{kind.__name__}.{name}",
            lambda name=name: getattr(one(), name),
            lambda name=name: getattr(other(), name),
        )


of_result(
    ss.Visibility,
    lambda: plain(visibility, receivers=True, sample_masks=True),
    lambda: visibility(BODY, light_above(2.0), camera=CAMERA, receivers=True, sample_masks=True),
    *("values", "standard_error", "positions", "normals", "triangles", "visible_samples", "info"),
)
of_result(
    ss.Visibility,
    lambda: visibility(SCENE, LIGHT, camera=replace(CAMERA, fov_y_deg=120)),
    lambda: visibility(ss.Scene([SHEET]), [LIGHT, LIGHT], camera=replace(CAMERA, fov_y_deg=120)),
    *("valid", "light_names"),
)
of_result(
    ss.Visibility,
    lambda: visibility(SCENE, LIGHT, points=POINTS),
    lambda: visibility(SCENE, LIGHT, points=POINTS + 1),
    "points",
)
of_result(ss.Picture, lambda: plain(render), drawn(exposure=1), "linear", "srgb")
entry(
    "Picture.visibility",
    lambda: plain(render).visibility.values,
    lambda: render(BODY, LIGHT, camera=CAMERA).visibility.values,
)
of_result(ss.Comparison, comparison, lambda: comparison(light=light_above(2.0)), "rows", "reference_standard_error")
of_result(ss.Comparison, comparison, lambda: comparison(reference=replace(MANY, seed=2)), "reference")
of_result(
    ss.LightPoints,
    lambda: ss.light_points(LIGHT, 16, scene=SCENE),
    lambda: ss.light_points(ss.SunLight(0, 45), 16, scene=SCENE, seed=1),
    *("positions", "parameters", "at_infinity"),
)


of_result(ss.Comparison, comparison, lambda: comparison(name="other"), "name")
of_result(ss.Comparison, comparison, lambda: comparison(scene=BODY), "triangles", "values", "reference_values")
of_result(ss.Comparison, comparison, lambda: comparison(light=light_above(2.0)), "light")
of_result(ss.Comparison, comparison, lambda: comparison(points=None, camera=CAMERA), "size")
of_result(
    ss.Comparison,
    comparison,
    lambda: comparison(light=replace(light_above(), texture=np.ones((2, 2, 3)))),
    "channels",
)
entry("Diagnosis.trials", lambda: ss.doctor().trials, lambda: ss.doctor(measure=True).trials)
entry("doctor(measure)", lambda: len(ss.doctor().trials), lambda: len(ss.doctor(measure=True).trials))
entry("Comparison.save(folder)", lambda: written("one"), lambda: written("other"))


def written(folder: str) -> list[str]:
    """What a comparison leaves where it is told to."""
    with TemporaryDirectory() as place:
        comparison().save(Path(place) / folder)
        return sorted(str(path.relative_to(place)) for path in Path(place).rglob("*.*"))


# What a machine has depends on the machine: tests of `doctor` change it.
OF_THE_MACHINE = {f"Diagnosis.{name}" for name in ("version", "adapters", "native", "chosen", "extras", "advice")}


def test_every_option_has_an_entry_and_every_entry_an_option():
    found = options()
    assert {"visibility(technique)", "RectLight.width", "Camera.look_at(up)", "Scene(notes)"} <= found
    assert sorted(found - PAIRS.keys() - OF_THE_MACHINE) == []
    assert sorted((PAIRS.keys() | OF_THE_MACHINE) - found) == []


def same(one: Any, other: Any) -> bool:
    """Equal values; arrays by shape and bits, NaN like NaN."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and bool(one == other)


@pytest.mark.parametrize("name", sorted(PAIRS))
def test_it_changes_something(name, caplog):
    caplog.set_level(logging.WARNING)
    one, other = PAIRS[name]()
    assert not same(one, other)


def test_what_does_not_differ_is_seen():
    again = [visibility(SCENE, LIGHT, camera=CAMERA).values for _ in range(2)]
    assert np.isnan(visibility(ss.Scene([SHEET]), LIGHT, camera=CAMERA).values).any()
    assert same(*again)
    assert same([1, (again[0], None)], [1, (again[1], None)])
    assert not same(again[0], again[0][:1])
    assert not same(None, again[0])
