"""Shadow techniques and their settings. Defaults and ranges are the library's own, read at import."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from typing import Any, ClassVar

import numpy as np

from . import _core
from .by_value import set_fields
from .checks import real, whole
from .errors import SettingsError

_DEFAULTS: dict[str, dict[str, Any]] = {row["name"]: row for row in json.loads(_core.technique_defaults())}
_RAY_TRACED = _DEFAULTS["ray_traced"]
_HARD_SHADOW_MAP = _DEFAULTS["hard_shadow_map"]
_OCCLUSION_LAYERS = _DEFAULTS["occlusion_layers"]
_PENUMBRA_MAP = _DEFAULTS["penumbra_map"]
_OCCLUSION_CAMERA = _DEFAULTS["occlusion_camera"]
_DEPTH_COMPLEXITY = _DEFAULTS["depth_complexity"]


@dataclass(frozen=True)
class Technique:
    """Base of all techniques: settings without behaviour."""

    name: ClassVar[str]

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.type == "int":
                set_fields(self, **{field.name: whole(f"{self.name} {field.name}", value)})
            elif field.type == "float":
                set_fields(self, **{field.name: real(f"{self.name} {field.name}", value, SettingsError)})
            elif field.type == "bool":
                if not isinstance(value, (bool, np.bool_)):
                    raise SettingsError(f"{self.name} {field.name}: True or False expected, got {value!r}")
                set_fields(self, **{field.name: bool(value)})
            elif not isinstance(value, str):
                raise SettingsError(f"{self.name} {field.name}: a name expected, got {value!r}")
        _core.check_technique(self.to_json())

    def to_json(self) -> str:
        """Name and settings as one JSON object."""
        return json.dumps({"name": self.name, **asdict(self)})


@dataclass(frozen=True, kw_only=True)
class RayTraced(Technique):
    """Shadow rays to samples of the light: unbiased, with a standard error.

    The hidden share of an area light as in Cook, Porter and Carpenter 1984; interleaved samples as in Keller and
    Heidrich 2001.

    Parameters
    ----------
    samples : int
        Light samples a receiver.
    pattern : {"stratified", "low_discrepancy"}
        How the light is sampled.
    seed : int
        Another seed, another set of samples; the same seed, the same result.
    passes : int
        Sets of samples that are averaged, each with a seed of its own.
    probes : int
        Samples that are traced first; all others follow only where the neighbourhood disagrees. 0 traces all.
    spread : {"correlated", "decorrelated", "interleaved"}
        Who shares samples. Correlated: all receivers have one set, and penumbrae show its steps. Decorrelated: every
        receiver takes one of many stratified sets, and steps become noise. Interleaved, for cameras: the pixels of a
        square have sets that together are one stratified set, and pixels side by side are averaged where they see one
        surface; less noise for the same samples, and shadows blurred by half of `tile`, of which
        the standard error knows nothing.
    tile : int
        Side of that square, 2 to 8.

    Raises
    ------
    SettingsError
        For a setting outside its range.
    """

    name: ClassVar[str] = "ray_traced"
    samples: int = _RAY_TRACED["samples"]
    pattern: str = _RAY_TRACED["pattern"]
    seed: int = _RAY_TRACED["seed"]
    passes: int = _RAY_TRACED["passes"]
    probes: int = _RAY_TRACED["probes"]
    spread: str = _RAY_TRACED["spread"]
    tile: int = _RAY_TRACED["tile"]


@dataclass(frozen=True, kw_only=True)
class HardShadowMap(Technique):
    """One depth map from the light's centre (Williams 1978): fast, and without penumbra.

    Semi-opaque triangles are taken for opaque; ``info["notes"]`` says so.

    Parameters
    ----------
    resolution : int
        Width and height of the depth map in texels.

    Raises
    ------
    SettingsError
        For a setting outside its range.
    """

    name: ClassVar[str] = "hard_shadow_map"
    resolution: int = _HARD_SHADOW_MAP["resolution"]


@dataclass(frozen=True, kw_only=True)
class OcclusionLayers(Technique):
    """The scene as layers of bits, prefiltered (Eisemann and Décoret 2008, "occlusion textures").

    Plausible soft shadows whose cost does not depend on the light's size and hardly on the scene: for foliage and for
    tight budgets. What lies between the light and the receivers is cut into slices parallel to the light; the share of
    each that hides the light is exact, and shares are multiplied as if slices knew nothing of each other. Shadows on
    casters miss what is nearer than a slice, and surfaces that the light sees from the side vanish;
    ``info["notes"]`` says so where it happens. Semi-opaque triangles are taken for opaque. Sphere lights among
    the receivers are refused.

    Parameters
    ----------
    slices : int
        Slices of the scene, 1 to 128.
    resolution : int
        Texels a side of every slice: a power of two from 64 to 2048.
    filter : {"summed_area", "nbuffer", "mipmap"}
        How the share of a slice is found: exactly, or as published, for comparison.
    split : int
        Parts of the light a side, 1 to 8, in each of which slices are multiplied for themselves. 1 is the paper; more
        are slower, and closer to the truth where slices hide the same part of the light.
    combine : {"product", "maximum", "sum"}
        How slices are put together; the maximum is never too dark, the sum never too bright.
    projection : {"perspective", "parallel"}
        From where the scene is projected onto its slices: a point behind the light, or straight along its emission.
    near : {"fade", "rays"}
        What lies between a receiver and the first slice before it: ignored, that slice fading in with depth, as
        published; or found by a short ray to the middle of every part of the light.
    repair_leaks : bool
        Whether every slice is also written into the next one: closes gaps in thin surfaces, and thickens shadows.

    Raises
    ------
    SettingsError
        For a setting outside its range, and for slices that a device cannot hold.
    """

    name: ClassVar[str] = "occlusion_layers"
    slices: int = _OCCLUSION_LAYERS["slices"]
    resolution: int = _OCCLUSION_LAYERS["resolution"]
    filter: str = _OCCLUSION_LAYERS["filter"]
    split: int = _OCCLUSION_LAYERS["split"]
    combine: str = _OCCLUSION_LAYERS["combine"]
    projection: str = _OCCLUSION_LAYERS["projection"]
    near: str = _OCCLUSION_LAYERS["near"]
    repair_leaks: bool = _OCCLUSION_LAYERS["repair_leaks"]


@dataclass(frozen=True, kw_only=True)
class PenumbraMap(Technique):
    """A shadow map, and beside it the penumbra of what it shows (Wyman and Hansen 2003): fast, and too dark.

    The umbra is the hard shadow and never shrinks: the inner half of every penumbra is missing, which is 0.5 at the
    hard edge and 0.25 on average. An isolated penumbra is as far off as that of a hard shadow map, 0.289 in root mean
    square, but without its step. Where penumbrae overlap the darkest stands for all. Points that the map does not
    show, in mid-air, are lit, and counted in ``info["notes"]``; so are semi-opaque triangles, which are taken for
    opaque, textures, concave outlines, and triangles that touch a ball of light. For shadows of a simplified model, as
    published, give that model as the scene, and points on the full one.

    Parameters
    ----------
    resolution : int
        Width and height of both maps in texels.
    ramp : {"light", "linear", "paper"}
        How the place in the penumbra becomes light: by the share of the light's outline on one side of a line, in
        proportion, or as published.

    Raises
    ------
    SettingsError
        For a setting outside its range, for a polygon light whose origin lies outside its outline, and for one with
        more than 64 corners.
    """

    name: ClassVar[str] = "penumbra_map"
    resolution: int = _PENUMBRA_MAP["resolution"]
    ramp: str = _PENUMBRA_MAP["ramp"]


@dataclass(frozen=True, kw_only=True)
class OcclusionCamera(Technique):
    """One camera at the light's centre whose rays bend around silhouettes (Mo, Popescu and Wyman 2007).

    Both halves of the penumbra and an umbra that shrinks as the light grows, from a depth map and a distortion map.
    Past one straight edge the visible share of a rectangle, disc, polygon or sun is exact; a map tells two or three
    silhouettes before a receiver apart, and ``info["colliding_receivers"]`` counts those with more. Semi-opaque
    triangles are taken for opaque; ``info["notes"]`` says so.

    Parameters
    ----------
    resolution : int
        Width and height of the depth map in texels, 16 to 4096, a multiple of 4; the distortion maps have a quarter.
    steps : {1, 2, 3}
        How often a receiver is moved past a silhouette.
    bias : float
        What hides a receiver where it was moved is nearer to the light by this share (0 to 1) of the distance from
        silhouette to receiver. ``info["camera_bias"]`` is the largest in world units.
    ramp : {"outline", "bernstein"}
        The share of the light's own outline beyond a silhouette, or 3x² − 2x³, as published, for all lights.

    Raises
    ------
    SettingsError
        For a setting outside its range, polygons of more than 64 corners, and triangles that touch a sphere light.
    """

    name: ClassVar[str] = "occlusion_camera"
    resolution: int = _OCCLUSION_CAMERA["resolution"]
    steps: int = _OCCLUSION_CAMERA["steps"]
    bias: float = _OCCLUSION_CAMERA["bias"]
    ramp: str = _OCCLUSION_CAMERA["ramp"]


@dataclass(frozen=True, kw_only=True)
class DepthComplexity(Technique):
    """Silhouette edges and counters (Forest, Barthe and Paulin 2008): as accurate as rays to the same samples.

    Where a single layer hides the light, its visible area answers exactly, without sampling noise; not for spheres,
    suns wider than half a degree, polygons of more than 64 corners, receivers whose horizon cuts the light, nor in a
    call with a textured light. Foliage is folded triangle by triangle: the same samples, and no areas. A scene in which
    too much lies before one receiver raises an error that says so.

    Parameters
    ----------
    samples : int
        Light samples a receiver, up to 256.
    pattern : {"stratified", "low_discrepancy"}
        How the light is sampled.
    seed : int
        Another seed, another set of samples; the same seed, the same result.
    passes : int
        Sets of samples that are averaged, each with a seed of its own.
    exact_area : bool
        Whether the light's visible area answers where the samples show a single layer; never where something
        semi-opaque hides the light. With evaluation "blended" samples alone answer, and the result's `info["notes"]`
        say so. Not over triangles.
    silhouettes : {"accurate", "standard"}
        Which edges count: all that are silhouettes for any part of the light, as rays see them, or those of one point
        near its middle: fewer, and a body casts the shadow of the flat one within their loop.
    coverage : {"exact", "table"}
        How samples beyond an edge are found: looked up and tested next to the edge, or looked up alone, as published.
    spread, tile
        As in :class:`RayTraced`, and with the same samples; interleaved, at most 8192 in all sets together. Evaluation
        "blended" knows "correlated" alone.
    attenuation : {"logarithmic", "sum"}
        How several semi-opaque layers add up: ``"logarithmic"`` is right for any number of them, the product of what
        passes each. ``"sum"`` adds opacities, as the paper does: right for one layer, too dark for more. Tiled only.
    evaluation : {"tiled", "blended"}
        How edges find their receivers: listed for tiles of them, for points and cameras; or drawn over a camera's image
        as penumbra wedges, as published, in scenes without semi-opaque triangles. The samples are the same.
    initial_counts : {"rays", "z_fail"}
        Blended only: how layers over the light's reference point are counted: by a ray a receiver, or by shadow volumes
        as published, which is wrong for a few receivers next to edges, and not for sphere lights.
    counters : {"words", "float"}
        Blended only: where samples are counted: in 32-bit words, or in float32 colour targets as published, which not
        every device can blend.
    base : {8, 16, 64, 256}
        Blended only: the smallest base of a counter's digit. Larger ones are taken where counts ask for them.
    batches : {1, 2}
        Blended only: whether changes are counted as they come, or all that add before all that take away.
    unit : {"auto", "edges", "triangles"}
        What is folded: silhouette edges, or triangles one by one. "auto" takes triangles where a scene is a soup of
        them; the result's ``info["occluder_units"]`` says which, for each light.

    Raises
    ------
    SettingsError
        For a setting outside its range, and for receivers or devices that an evaluation does not serve.
    """

    name: ClassVar[str] = "depth_complexity"
    samples: int = _DEPTH_COMPLEXITY["samples"]
    pattern: str = _DEPTH_COMPLEXITY["pattern"]
    seed: int = _DEPTH_COMPLEXITY["seed"]
    passes: int = _DEPTH_COMPLEXITY["passes"]
    exact_area: bool = _DEPTH_COMPLEXITY["exact_area"]
    silhouettes: str = _DEPTH_COMPLEXITY["silhouettes"]
    coverage: str = _DEPTH_COMPLEXITY["coverage"]
    spread: str = _DEPTH_COMPLEXITY["spread"]
    tile: int = _DEPTH_COMPLEXITY["tile"]
    attenuation: str = _DEPTH_COMPLEXITY["attenuation"]
    evaluation: str = _DEPTH_COMPLEXITY["evaluation"]
    initial_counts: str = _DEPTH_COMPLEXITY["initial_counts"]
    counters: str = _DEPTH_COMPLEXITY["counters"]
    base: int = _DEPTH_COMPLEXITY["base"]
    batches: int = _DEPTH_COMPLEXITY["batches"]
    unit: str = _DEPTH_COMPLEXITY["unit"]


TECHNIQUES: dict[str, type[Technique]] = {
    kind.name: kind
    for kind in (RayTraced, HardShadowMap, OcclusionCamera, OcclusionLayers, PenumbraMap, DepthComplexity)
}
"""Every technique by its name."""


def technique_json(what: str, technique: object) -> str:
    """A technique as the core reads it."""
    if isinstance(technique, Technique):
        return technique.to_json()
    names = ", ".join(kind.__name__ for kind in TECHNIQUES.values())
    raise SettingsError(f"{what}: an instance of {names} expected, got {technique!r}")
