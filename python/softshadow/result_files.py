"""What files hold of a result, under which names."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .lights import Light
    from .visibility import Visibility

_RGB = ("R", "G", "B")


def names_of(lights: Sequence[Light]) -> tuple[str, ...]:
    """A name for each light that no other has: its own, else ``light0``, ``light1``… by its place."""
    names: list[str] = []
    for index, light in enumerate(lights):
        name = own = light.name or f"light{index}"
        while name in names:
            name = f"{own}_{index}"
            index += 1
        names.append(name)
    return tuple(names)


def arrays_of(result: Visibility) -> dict[str, NDArray[Any]]:
    """The arrays of an ``.npz``; those that a result lacks are left out."""
    fields = ("values", "valid", "standard_error", "points", "positions", "normals", "triangles", "visible_samples")
    arrays = {name: getattr(result, name) for name in fields}
    present = {name: array for name, array in arrays.items() if array is not None}
    return present | {"light_names": np.array(result.light_names), "info": np.array(json.dumps(result.info))}


def columns_of(result: Visibility) -> dict[str, NDArray[Any]]:
    """The columns of a ``.csv``: a row for each receiver."""
    columns = places_of(result) | layers_of(result)
    return columns | {"valid": result.valid.ravel()}


def places_of(result: Visibility) -> dict[str, NDArray[Any]]:
    """Which receiver a row is: a pixel of the camera's image, a point, or both where positions were asked for."""
    columns: dict[str, NDArray[Any]] = {}
    if result.points is None:
        rows, row_columns = np.indices(result.valid.shape)
        columns |= {"column": row_columns.ravel(), "row": rows.ravel()}
    where = result.positions if result.points is None else result.points
    if where is not None:
        columns |= dict(zip("xyz", where.reshape(-1, 3).T, strict=True))
    return columns


def channels_of(result: Visibility) -> dict[str, NDArray[np.float32]]:
    """The channels of an ``.exr``: float32, a value for each pixel."""
    channels = layers_of(result)
    placed: dict[str, NDArray[Any] | None] = {"position": result.positions, "normal": result.normals}
    for name, vectors in placed.items():
        if vectors is not None:
            channels |= {f"{name}.{axis}": vectors[..., k].ravel() for k, axis in enumerate("XYZ")}
    channels["valid"] = result.valid.ravel()
    return {name: np.ascontiguousarray(values, dtype=np.float32) for name, values in plain(channels).items()}


def layers_of(result: Visibility) -> dict[str, NDArray[Any]]:
    """Values and standard errors by light and channel, flat.

    A single light without a name is called ``visibility``, others ``visibility.NAME``; colours follow as ``.R``.
    """
    layers: dict[str, NDArray[Any]] = {}
    for word, array in (("visibility", result.values), ("standard_error", result.standard_error)):
        if array is None:
            continue
        for name, values in zip(result.light_names, by_light(result, array), strict=True):
            full = word if result.light_names == ("light0",) else f"{word}.{name}"
            if values.shape[1] == 1:
                layers[full] = values[:, 0]
            else:
                layers |= {f"{full}.{channel}": values[:, k] for k, channel in enumerate(_RGB)}
    return layers


def by_light(result: Visibility, array: NDArray[np.float32]) -> NDArray[np.float32]:
    """Values or standard errors as (lights, receivers, channels), of which there may be none."""
    lights, receivers = len(result.light_names), result.valid.size
    return array.reshape(lights, receivers, array.size // (lights * receivers) if receivers else 1)


def rgb(linear: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
    """The channels of a picture, flat."""
    return {name: np.ascontiguousarray(linear[..., k]).ravel() for k, name in enumerate(_RGB)}


def plain(channels: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """The same under names that OpenEXR can hold: printable ASCII, 255 bytes, each once."""
    renamed: dict[str, NDArray[Any]] = {}
    for name, values in channels.items():
        ascii_name = own = "".join(c if " " <= c <= "~" else "_" for c in name)[:200]
        count = 1
        while ascii_name in renamed:
            count += 1
            ascii_name = f"{own}_{count}"
        renamed[ascii_name] = values
    return renamed
