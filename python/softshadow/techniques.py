"""Shadow techniques and their settings. Defaults and ranges are the library's own, read at import."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from typing import Any, ClassVar

import numpy as np

from . import _core
from .by_value import set_fields
from .checks import whole
from .errors import SettingsError

_DEFAULTS: dict[str, dict[str, Any]] = {row["name"]: row for row in json.loads(_core.technique_defaults())}
_RAY_TRACED = _DEFAULTS["ray_traced"]
_HARD_SHADOW_MAP = _DEFAULTS["hard_shadow_map"]
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


@dataclass(frozen=True, kw_only=True)
class HardShadowMap(Technique):
    """One depth map from the light's centre (Williams 1978): fast, and without penumbra.

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
class DepthComplexity(Technique):
    """Silhouette edges and counters (Forest, Barthe and Paulin 2008): as accurate as rays to the same samples.

    Where a single layer hides the light, its visible area answers exactly, without sampling noise; not for spheres,
    suns wider than half a degree, polygons of more than 64 corners, nor in a call with a textured light. Foliage is
    folded triangle by triangle: the same samples, and no areas. A scene in which too much lies before one receiver
    raises an error that says so.

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
        Whether the light's visible area answers where the samples show a single layer. Not over triangles.
    unit : {"auto", "edges", "triangles"}
        What is folded: silhouette edges, or triangles one by one. "auto" takes triangles where a scene is a soup of
        them; the result's ``info["occluder_units"]`` says which, for each light.

    Raises
    ------
    SettingsError
        For a setting outside its range.
    """

    name: ClassVar[str] = "depth_complexity"
    samples: int = _DEPTH_COMPLEXITY["samples"]
    pattern: str = _DEPTH_COMPLEXITY["pattern"]
    seed: int = _DEPTH_COMPLEXITY["seed"]
    passes: int = _DEPTH_COMPLEXITY["passes"]
    exact_area: bool = _DEPTH_COMPLEXITY["exact_area"]
    unit: str = _DEPTH_COMPLEXITY["unit"]


TECHNIQUES: dict[str, type[Technique]] = {kind.name: kind for kind in (RayTraced, HardShadowMap, DepthComplexity)}
"""Every technique by its name."""


def technique_json(what: str, technique: object) -> str:
    """A technique as the core reads it."""
    if isinstance(technique, Technique):
        return technique.to_json()
    names = ", ".join(kind.__name__ for kind in TECHNIQUES.values())
    raise SettingsError(f"{what}: an instance of {names} expected, got {technique!r}")
