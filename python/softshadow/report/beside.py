"""What was measured beside comparisons: other tracers, and ratios that papers publish."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from .fronts import front
from .judgement import families, full_name
from .markup import figures, note, section, table
from .numbers import Numbers


def peers(runs: Sequence[dict[str, Any]], numbers: Numbers) -> str:
    """Other tracers, each scene in a run of its own in which all took turns."""
    if not runs:
        return ""
    parts = [
        note(
            "Measured in a process of their own, on the same receivers and taking turns. Of ours the time from the "
            "camera to visibility counts, of the others the query alone. Dashed curves are the others’."
        )
    ]
    for index, run in enumerate(runs):
        rows = run["rows"]
        title = "{}, {} × {}".format(run["scene"], *run["size"])
        others = tuple(families([row for row in rows if not row["ours"]]))
        chart = front(f"Front beside other tracers: {title}", rows, run["reference_standard_error"], others)
        lines = []
        for r, row in enumerate(rows):
            at = f"/peers/{index}/rows/{r}"
            once = " <small>first turn alone</small>" if row["is_slow"] else ""
            lines.append(
                [
                    escape(full_name(row["technique"])),
                    numbers(f"{at}/median_ms", "ms") + once,
                    f"{numbers(f'{at}/range_ms/0', 'ms')} … {numbers(f'{at}/range_ms/1', 'ms')}",
                    numbers(f"{at}/penumbra/rmse", "error"),
                ]
            )
        head = ["tracer", "ms", "fastest … slowest", "RMSE in penumbra"]
        drawn = figures([chart], f"peers-{index}") if chart else ""
        parts.append(f"<h3>{escape(title)}</h3>{drawn}{table(f'Tracers on {title}', head, lines)}")
    return section("peers", "Beside other tracers", *parts)


def ratios(measured: Sequence[dict[str, Any]], numbers: Numbers) -> str:
    """Times of two settings over each other, beside what is published and asked."""
    if not measured:
        return ""
    lines = []
    for index, ratio in enumerate(measured):
        at = f"/ratios/{index}"
        scene = "{}, {} × {}".format(ratio["scene"], *ratio["size"])
        settings = f"{escape(ratio['over'])}<br>over {escape(ratio['under'])}"
        lines.append(
            [
                escape(scene),
                f"{escape(ratio['name'])}<br><small>{settings}</small>",
                escape(ratio["published"]),
                escape(ratio["asked"]),
                numbers(f"{at}/median", "ratio"),
                f"{numbers(f'{at}/range/0', 'ratio')} … {numbers(f'{at}/range/1', 'ratio')}",
                numbers(f"{at}/penumbra_rmse/0", "error"),
                numbers(f"{at}/penumbra_rmse/1", "error"),
            ]
        )
    head = ["scene", "times of", "published", "asked", "ours", "from … to", "RMSE of", "over"]
    explained = (
        "Times of two settings over each other, turn by turn in one run of <code>softshadow-bench</code>. Published "
        "are those of Forest, Barthe and Paulin (2008) on the hardware of their day; asked is what this project asks "
        "of itself."
    )
    return section("ratios", "Published ratios beside ours", note(explained), table("Ratios", head, lines, words=4))
