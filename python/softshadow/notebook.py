"""How results show themselves in notebooks: their picture, and below it what made them."""

from __future__ import annotations

import base64
from html import escape
from typing import Any


def page(png: bytes | None, shape: tuple[int, ...], info: dict[str, Any]) -> str:
    """HTML of one result, that stands alone."""
    data = None if png is None else base64.b64encode(png).decode("ascii")
    image = [] if data is None else [f'<img src="data:image/png;base64,{data}" alt="result of softshadow">']
    rows = [f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in facts(shape, info).items()]
    return "\n".join(["<div>", *image, "<table>", *rows, "</table>", "</div>"])


def facts(shape: tuple[int, ...], info: dict[str, Any]) -> dict[str, str]:
    """What a reader wants to know first."""
    technique, adapter, error = dict(info["technique"]), info["adapter"], info["standard_error"]
    settings = ", ".join(f"{name} {value}" for name, value in technique.items() if name != "name")
    seen = f"{info['valid_receivers']:,} of {info['receivers']:,} receivers see a surface"
    known = "" if error is None else f", standard error {error:.2g} in the penumbra"
    table = {
        "shape": " × ".join(map(str, shape)),
        "technique": f"{technique['name']} ({settings})",
        "device": f"{adapter['name']} ({adapter['backend']})",
        "time": f"{info['wall_ms']:.1f} ms, and {info['preparation_ms']:.1f} ms for the scene",
        "memory": f"{sum(size for _, size in info['bytes']) / 2**20:.1f} MiB",
        "receivers": seen,
        "error": f"{info['error_kind']}{known}",
    }
    return table | ({"notes": "; ".join(info["notes"])} if info["notes"] else {})
