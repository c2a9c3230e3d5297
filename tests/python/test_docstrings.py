"""Every public name says what it takes and gives: shapes, units, errors, and the paper behind it where there is one."""

from __future__ import annotations

import inspect
import re
import types
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass

import pytest

import softshadow as ss
from softshadow import techniques

# What a number or an array may be measured in, by the name of its parameter: the words that its text must have.
UNITS = {
    "world coordinates|world space|receivers": "eye target vertices points positions receivers",
    "world units": "width height radius outline",
    "unit disc": "parameters",
    "degrees": "azimuth elevation diameter_deg fov_y_deg",
    "pixel|texels|square": "size K resolution tile",
    "milliseconds": "max_ms",
    "error": "max_error",
    "bounds": "confidence",
    "linear": "radiance base_color background linear",
    "stops": "exposure",
    "bytes": "memory_limit",
    "share|opacity|visibility": "opacity values standard_error",
    "metres": "meters_per_unit",
    "pose|rotation": "world_from_camera world_from_light transform",
    "penumbra": "reference_standard_error",
    "NaN": "reference_values",
}
# Numbers and arrays that have no unit: directions, counts, indices, ratios.
UNITLESS = {"up", "normals", "faces", "samples", "seed", "passes", "probes", "base", "batches", "repeats"}
UNITLESS |= {"roughness", "specular", "texture", "triangles", "srgb", "valid", "visible_samples", "device"}
UNITLESS |= {"exact_area", "at_infinity", "channels", "slices", "split", "steps", "bias"}
# What raises nothing of its own, though it can be called.
SAFE = {"doctor", "scenes.names", "Comparison.to_json", "Diagnosis.to_dict", "Technique.to_json"}


def public() -> Iterator[tuple[str, object]]:
    """Functions, classes, and methods and properties that classes define themselves."""
    names = [(name, getattr(ss, name)) for name in ss.__all__ if name not in ("scenes", "__version__")]
    own = [(f"scenes.{name}", value) for name, value in vars(ss.scenes).items() if not name.startswith("_")]
    names += [(name, value) for name, value in own if getattr(value, "__module__", "") == "softshadow.scenes"]
    for name, value in names:
        yield name, value
        if inspect.isclass(value) and not issubclass(value, BaseException):
            for member, found in vars(value).items():
                plain = found.__func__ if isinstance(found, classmethod) else found
                if not member.startswith("_") and isinstance(plain, (types.FunctionType, property)):
                    yield f"{name}.{member}", plain


PUBLIC = dict(public())


def sections(text: str) -> dict[str, str]:
    """The sections of a docstring by their titles; what stands before them is called "About"."""
    parts = re.split(r"^(\w+)\n-{3,}$", inspect.cleandoc(text), flags=re.MULTILINE)
    return {"About": parts[0]} | dict(zip(parts[1::2], parts[2::2], strict=True))


def described(section: str) -> dict[str, str]:
    """Parameters or attributes by name: the line that names them, and the lines below."""
    found: dict[str, str] = {}
    for entry in re.split(r"\n(?=\S)", section.strip()):
        names = entry.split("\n")[0].split(":")[0]
        found |= {name.strip(): entry for name in names.split(",")}
    return found


def annotations(value: object) -> dict[str, str]:
    """What a caller gives or finds: parameters of a function, fields of a dataclass."""
    if inspect.isclass(value) and is_dataclass(value):
        return {field.name: str(field.type) for field in fields(value) if field.name != "_"}
    if not callable(value):
        return {}
    signature = inspect.signature(value)
    return {p.name: str(p.annotation) for p in signature.parameters.values() if p.name not in ("self", "cls")}


def problems(name: str, value: object) -> list[str]:
    text = value.__doc__ or ""
    parts = sections(text)
    first = parts["About"].strip().split("\n\n")[0]
    found = [] if first and first[-1] in ".;:" else ["no first sentence"]
    if inspect.isclass(value) and issubclass(value, BaseException):
        return found
    wanted = {} if inspect.isabstract(value) or value is ss.Technique else annotations(value)
    told = described(parts.get("Parameters", "")) | described(parts.get("Attributes", ""))
    for parameter, annotation in wanted.items():
        if parameter not in told:
            found.append(f"'{parameter}' is not described")
            continue
        words = told[parameter]
        if re.search(r"\b[Aa]s in :", words):
            continue  # Another page describes it.
        if re.search("NDArray|ArrayLike", annotation) and not re.search(r"\([\w, ]+\)|like `|shape", words):
            found.append(f"'{parameter}' has no shape")
        if re.search("NDArray|ArrayLike|int|float", annotation):
            units = [unit for unit, names in UNITS.items() if parameter in names.split()]
            if not units and parameter not in UNITLESS and "dict" not in annotation:
                found.append(f"'{parameter}' is in no list of units")
            found += [f"'{parameter}' has no unit" for unit in units if not re.search(unit, words, re.IGNORECASE)]
    takes_input = bool(wanted) and "Attributes" not in parts
    if takes_input and name not in SAFE and "Raises" not in parts:
        found.append("no errors")
    if takes_input and isinstance(value, types.FunctionType) and value.__annotations__.get("return") != "None":
        found += [] if "Returns" in parts or "." in name else ["no result"]
    for error in re.findall(r"\b[A-Z]\w*(?:Error|NotFound|OutOfMemory|Interrupted|Extra)\b", parts.get("Raises", "")):
        found += [] if hasattr(ss, error) or error in ("OSError", "FileNotFoundError") else [f"unknown error {error}"]
    return found


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_is_described(name):
    assert problems(name, PUBLIC[name]) == []


@pytest.mark.parametrize("name", techniques.TECHNIQUES)
def test_techniques_name_their_sources(name):
    assert re.search(r"[A-Z]\w+ (?:et al\. )?(?:19|20)\d\d\b", techniques.TECHNIQUES[name].__doc__)


def test_papers_that_are_spoken_of_are_named():
    for name, value in PUBLIC.items():
        text = " ".join((value.__doc__ or "").split())
        if re.search(r"\b(?:the paper|as published)\b", text):
            assert re.search(r"\b(?:19|20)\d\d\b", text), name


def good(points: ss.Scene, radius: float) -> None:
    """Takes something.

    Parameters
    ----------
    points : (n, 3) float
        World coordinates.
    radius : float
        In world units.

    Raises
    ------
    SceneError
        For nonsense.
    """


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("Takes something.", "", "no first sentence"),
        ("World coordinates.", "Somewhere.", "'points' has no unit"),
        ("(n, 3) float", "array", "'points' has no shape"),
        ("radius : float\n        In world units.\n", "", "'radius' is not described"),
        ("In world units.", "Long.", "'radius' has no unit"),
        ("Raises\n    ------", "", "no errors"),
        ("SceneError", "SceneryError", "unknown error SceneryError"),
    ],
)
def test_a_spoilt_docstring_is_red(old, new, problem):
    def spoilt(points: NDArray, radius: float) -> None: ...  # noqa: F821 - read as text

    spoilt.__doc__ = good.__doc__
    assert problems("spoilt", spoilt) == []
    assert old in good.__doc__
    spoilt.__doc__ = good.__doc__.replace(old, new)
    assert problem in problems("spoilt", spoilt)


def test_modules_describe_themselves():
    modules: list[Callable[..., object] | types.ModuleType] = [ss, ss.scenes]
    modules += [value for value in vars(ss).values() if isinstance(value, types.ModuleType)]
    described_ones = [module for module in modules if module.__name__ != "softshadow._core"]
    assert len(described_ones) > 10
    for module in described_ones:
        assert (module.__doc__ or "").strip().split("\n\n")[0][-1:] in (".", ":"), module.__name__
