"""The section of one comparison: facts, front, table, images, bytes and notes."""

from __future__ import annotations

from html import escape
from typing import Any

from softshadow.comparison import Comparison

from .fronts import front
from .growth import with_samples
from .judgement import domination, families, full_name
from .markup import figures, note, section, table
from .numbers import NOTHING, Numbers
from .viewer import viewer

_COLUMNS = (
    ("ms", "median_ms", "ms"),
    ("fastest … slowest", "range_ms", "ms"),
    ("RMSE", "penumbra/rmse", "error"),
    ("true RMSE within", "penumbra_rmse_interval", "error"),
    ("p99", "penumbra/p99", "error"),
    ("max", "penumbra/max", "error"),
    ("bias", "penumbra/bias", "signed"),
    ("leaks", "leak_fraction", "share"),
    ("false shadow", "false_shadow_fraction", "share"),
    ("&gt; 0.25", "gross_count", "count"),
    ("MiB", "bytes", "MiB"),
)
_EXPLAINED = (
    "Milliseconds from plan to values. RMSE, p99, max and bias are errors over the penumbra against the reference; "
    "the true RMSE lies within what twice the reference’s own standard error allows. Leaks are umbra above 0.05, false "
    "shadow is lit ground below 0.95, &gt; 0.25 counts gross errors. MiB are those of the plan on the device. An arrow "
    "names what dominates a setting."
)


def details(document: dict[str, Any], index: int, comparison: Comparison, numbers: Numbers) -> str:
    """Everything about the comparison at an index of the document."""
    facts = document["comparisons"][index]
    charts = [front(f"Front: {facts['title']}", facts["rows"], facts["reference_standard_error"]), with_samples(facts)]
    drawn = [chart for chart in charts if chart is not None]
    return section(
        facts["id"],
        facts["title"],
        f'<p class="facts">{_facts(facts, index, numbers)}</p>',
        figures(drawn, facts["id"]) if drawn else note("There is no penumbra, and no error to draw."),
        _settings(facts, index, numbers),
        note(_EXPLAINED),
        viewer(facts, comparison),
        _bytes(facts, index, numbers),
        _notes(facts),
    )


def _facts(facts: dict[str, Any], index: int, numbers: Numbers) -> str:
    at, light, size = f"/comparisons/{index}", facts["light"], facts["size"]
    points = f"{numbers(f'{at}/reference/receivers', 'count')} points"
    where = f"{size[0]} × {size[1]} pixels" if size else points
    unit = " degrees" if light["shape"] == "sun" else ""
    in_penumbra = next((r for r, row in enumerate(facts["rows"]) if row["penumbra"]), None)
    count = "none" if in_penumbra is None else numbers(f"{at}/rows/{in_penumbra}/penumbra/count", "count")
    return (
        f"{where}, of which {numbers(f'{at}/reference/valid_receivers', 'count')} see anything and {count} lie in the "
        f"penumbra; {numbers(f'{at}/triangles', 'count')} triangles; light: {light['shape']}, extent "
        f"{light['extent']:.4g}{unit}. Reference: {escape(full_name(facts['reference']['technique']))}; its own "
        f"standard error in the penumbra is {numbers(f'{at}/reference_standard_error', 'error')}."
    )


def _settings(facts: dict[str, Any], index: int, numbers: Numbers) -> str:
    rows = facts["rows"]
    judged = domination(rows, facts["reference_standard_error"])
    lines: list[list[str]] = []
    dimmed: list[int] = []
    for r in (r for members in families(rows).values() for r in members):
        at, verdict = f"/comparisons/{index}/rows/{r}", judged[r]
        name = escape(full_name(rows[r]["technique"]))
        if verdict is not None:
            doubt = "" if verdict.is_certain else ", within noise"
            name += f"<br><small>← {escape(full_name(rows[verdict.by]['technique']))}{doubt}</small>"
            dimmed.append(len(lines))
        lines.append([name, *(_number(rows[r], f"{at}/{path}", kind, numbers) for _, path, kind in _COLUMNS)])
    head = ["technique", *(name for name, _, _ in _COLUMNS)]
    return table(f"Settings of {facts['title']}", head, lines, dimmed=dimmed)


def _number(row: dict[str, Any], at: str, kind: str, numbers: Numbers) -> str:
    """A number, or two that are ends of a range."""
    name = at.rpartition("/")[2]
    if not isinstance(row.get(name), list):
        return numbers(at, kind)
    return f"{numbers(f'{at}/0', kind)} … {numbers(f'{at}/1', kind)}"


def _bytes(facts: dict[str, Any], index: int, numbers: Numbers) -> str:
    """A column a setting, a row a resource."""
    rows = facts["rows"]
    order = [r for members in families(rows).values() for r in members]
    places = [{label: k for k, (label, _) in enumerate(rows[r]["bytes_by_resource"])} for r in order]
    labels = list(dict.fromkeys(label for place in places for label in place))
    if not labels:
        return ""

    def cell(column: int, label: str) -> str:
        place = places[column].get(label)
        pointer = f"/comparisons/{index}/rows/{order[column]}/bytes_by_resource/{place}/1"
        return NOTHING if place is None else numbers(pointer, "count")

    lines = [[escape(label), *(cell(column, label) for column in range(len(order)))] for label in labels]
    lines.append(["in all", *(numbers(f"/comparisons/{index}/rows/{r}/bytes", "count") for r in order)])
    head = ["bytes", *(escape(full_name(rows[r]["technique"])) for r in order)]
    inner = table(f"Bytes of {facts['title']}", head, lines)
    return f"<details><summary>Bytes by resource</summary>{inner}</details>"


def _notes(facts: dict[str, Any]) -> str:
    notes = dict.fromkeys(f"{full_name(row['technique'])}: {text}" for row in facts["rows"] for text in row["notes"])
    items = "".join(f"<li>{escape(text)}</li>" for text in notes)
    return f'<h3>Notes</h3><ul class="note">{items}</ul>' if items else ""
