"""Images of a comparison: one picture divided between reference and technique, and all of them."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from softshadow.comparison import Comparison

from . import images
from .judgement import Row, families, full_name, rmse
from .markup import note

_LIMITS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)


def viewer(facts: dict[str, Any], comparison: Comparison) -> str:
    """What a camera's receivers see; nothing for points."""
    if facts["size"] is None:
        return note("Receivers are points: there are no images.")
    identity, rows = facts["id"], facts["rows"]
    order = [index for members in families(rows).values() for index in members]
    limit = _limit(rows)
    drawn = [_reference(facts, comparison)]
    drawn += [_technique(facts, comparison, index, place, limit) for place, index in enumerate(order)]
    names = [escape(full_name(rows[index]["technique"])) for index in order]
    options = "".join(f'<option value="{place}">{name}</option>' for place, name in enumerate(names))
    return (
        f'<div class="viewer" data-name="{identity}" data-images="{identity}-images" hidden><div class="controls">'
        f"<label>Technique <select>{options}</select></label><fieldset><legend>Right side</legend>"
        f'<label><input type="radio" name="{identity}-view" value="visibility" checked> visibility</label>'
        f'<label><input type="radio" name="{identity}-view" value="error"> error</label></fieldset></div>'
        '<div class="stage"></div>'
        '<label class="divide">Divide: reference on the left, technique on the right'
        '<input type="range" min="0" max="100" step="1" value="50"></label>'
        f'<p class="shown note" aria-live="polite"></p>{_scale(limit)}</div>'
        f'<details id="{identity}-images"><summary>All images: visibility, and error in false colours</summary>'
        f"{_explained(facts, comparison)}{_scale(limit)}"
        f'<div class="images">{"".join(drawn)}</div></details>'
    )


def _reference(facts: dict[str, Any], comparison: Comparison) -> str:
    name = escape(full_name(facts["reference"]["technique"]))
    shown = images.visibility(comparison.reference_values)
    text = f"Visibility of {escape(facts['title'])} by the reference, {name}"
    return f"<figure data-reference><div>{_image(shown, text)}</div><figcaption>reference: {name}</figcaption></figure>"


def _technique(facts: dict[str, Any], comparison: Comparison, index: int, place: int, limit: float) -> str:
    row, values = facts["rows"][index], comparison.values[index]
    words = escape(f"{full_name(row['technique'])}: {_measured(row)}")
    seen = _image(images.visibility(values), f"Visibility of {escape(facts['title'])} by {words}", "visibility")
    wrong = images.error(values, comparison.reference_values, limit)
    error = _image(wrong, f"Error of {words}; red is too bright, blue too dark", "error")
    return f'<figure data-setting="{place}"><div>{seen}{error}</div><figcaption>{words}</figcaption></figure>'


def _image(shown: images.Shown, text: str, kind: str = "") -> str:
    width, height = shown.size
    named = f' class="{kind}"' if kind else ""
    return f'<img{named} src="{shown.uri}" width="{width}" height="{height}" alt="{text}">'


def _measured(row: Row) -> str:
    error, words = rmse(row), f"{row['median_ms']:.1f} ms"
    return words if error is None else f"{words}, RMSE {error:.4f} in the penumbra"


def _explained(facts: dict[str, Any], comparison: Comparison) -> str:
    words = "White is fully lit, grey-blue is where the camera sees nothing."
    side = images.reduction(*facts["size"])
    if side > 1:
        words += f" Images are averages over {side} × {side} pixels; numbers are not."
    if comparison.channels > 1:
        words += " Images show the mean of three colours."
    return note(words)


def _limit(rows: Sequence[Row]) -> float:
    """Where colours saturate: an error that half of the techniques have in a hundredth of their penumbrae."""
    tails = [row["penumbra"]["p99"] for row in rows if row["penumbra"] is not None]
    usual = float(np.median(tails)) if tails else 0.0
    return next((limit for limit in _LIMITS if limit >= usual), _LIMITS[-1])


def _scale(limit: float) -> str:
    return f'<p class="scale">−{limit} too dark <i aria-hidden="true"></i> +{limit} too bright</p>'
