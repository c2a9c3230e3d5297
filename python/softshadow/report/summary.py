"""The first screen: who is fastest at an error, who is dominated where, and where a peer is ahead."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from .judgement import LEVELS, Row, domination, families, fastest, full_name, knob, rmse
from .numbers import NOTHING, Numbers

_BUSY = 1.3
"""Where the slowest run takes so many times the fastest, small ratios mean nothing."""


def summary(document: dict[str, Any], numbers: Numbers) -> str:
    """The section that opens the page."""
    parts = ['<section id="summary"><h2>Who is fastest, and who is beaten</h2>', *_warnings(document)]
    if document["comparisons"]:
        parts += [_levels(document["comparisons"], numbers), _beaten(document["comparisons"])]
    parts += [_behind(document["peers"], numbers), *_noise(document), "</section>"]
    return "".join(parts)


def _warnings(document: dict[str, Any]) -> list[str]:
    names = {
        comparison["reference"]["adapter"]["name"]
        for comparison in document["comparisons"]
        if comparison["reference"]["adapter"]["device_type"] == "software"
    }
    return [
        f'<p class="warning">{escape(name)} is a software adapter: a graphics driver that computes on the processor. '
        "These times say nothing about a graphics card.</p>"
        for name in sorted(names)
    ]


def _levels(comparisons: list[dict[str, Any]], numbers: Numbers) -> str:
    head = "".join(f'<th scope="col">≤ {level}</th>' for level in LEVELS)
    body = []
    for c, comparison in enumerate(comparisons):
        rows, error = comparison["rows"], comparison["reference_standard_error"]
        cells = "".join(f"<td>{_fastest(rows, level, error, c, numbers)}</td>" for level in LEVELS)
        body.append(f'<tr><th scope="row"><a href="#{comparison["id"]}">{escape(comparison["title"])}</a></th>{cells}</tr>')
    return (
        '<div class="scroll" tabindex="0" role="region" aria-label="Fastest settings"><table class="words">'
        "<caption>The fastest setting whose root mean square error in the penumbra is at most so large, its milliseconds, "
        "and the fastest of the next technique.</caption>"
        f'<thead><tr><th scope="col">scene</th>{head}</tr></thead><tbody>{"".join(body)}</tbody></table></div>'
    )


def _fastest(rows: list[Row], level: float, standard_error: float | None, c: int, numbers: Numbers) -> str:
    if standard_error is not None and level < 2 * standard_error:
        return "<small>the reference is too coarse to tell</small>"
    best = [i for members in families(rows).values() if (i := fastest(rows, level, members)) is not None]
    best.sort(key=lambda index: rows[index]["median_ms"])
    words = [
        f"{escape(full_name(rows[i]['technique']))}: {numbers(f'/comparisons/{c}/rows/{i}/median_ms', 'ms')}&nbsp;ms"
        for i in best[:2]
    ]
    if not words:
        return NOTHING
    return f"<b>{words[0]}</b>" + "".join(f"<br><small>{next_}</small>" for next_ in words[1:])


def _beaten(comparisons: list[dict[str, Any]]) -> str:
    """A sentence a family: in which scenes it is dominated, and by whom."""
    found: dict[str, list[tuple[str, Sequence[int], list[Any], list[Row]]]] = {}
    for comparison in comparisons:
        rows = comparison["rows"]
        judged = domination(rows, comparison["reference_standard_error"])
        for name, members in families(rows).items():
            able = [i for i in members if rmse(rows[i]) is not None]
            if able:
                found.setdefault(name, []).append((comparison["title"], able, judged, rows))
    sentences = []
    for name, places in found.items():
        clauses = [_clause(name, *place) for place in places]
        sentences.append(f"<li><b>{escape(name)}</b> is {escape('; '.join(clauses))}.</li>")
    return (
        "<h3>Dominated</h3><p>A setting is dominated where another takes no more time (median) and errs no more. It is "
        "<em>surely</em> so where their times lie apart in all runs and their errors by more than twice the reference’s own "
        f"standard error, or not at all; else within noise.</p><ul>{''.join(sentences)}</ul>"
    )


def _clause(name: str, scene: str, members: Sequence[int], judged: list[Any], rows: list[Row]) -> str:
    beaten = [i for i in members if judged[i] is not None]
    if not beaten:
        return f"nowhere dominated in {scene}"
    others = [rows[judged[i].by]["technique"] for i in beaten]
    by = ", ".join(dict.fromkeys("its own other settings" if families([rows[judged[i].by]]).keys() == {name} else full_name(o)
                                 for i, o in zip(beaten, others, strict=True)))
    surely = sum(judged[i].is_certain for i in beaten)
    certainty = "surely" if surely == len(beaten) else "within noise" if surely == 0 else f"{surely} of them surely"
    if len(beaten) == len(members):
        where = "at every setting"
    else:
        where = "at " + ", ".join(knob(rows[i]["technique"]) or "its only setting" for i in beaten)
    return f"dominated {where} in {scene} by {by} ({certainty})"


def _behind(peers: list[dict[str, Any]], numbers: Numbers) -> str:
    if not peers:
        return (
            "<p class='note'>No other tracers were measured beside these: "
            "<code>python -m softshadow.bench.peers --json FILE</code> does that.</p>"
        )
    items = []
    for p, run in enumerate(peers):
        rows = run["rows"]
        sides = [[i for i, row in enumerate(rows) if row["ours"] is ours] for ours in (True, False)]
        for level in LEVELS:
            ours, theirs = (fastest(rows, level, side) for side in sides)
            if theirs is None:
                continue
            place = f"{escape(run['scene'])}, RMSE ≤ {level}"
            their_words = f"{escape(full_name(rows[theirs]['technique']))} takes {numbers(f'/peers/{p}/rows/{theirs}/median_ms', 'ms')} ms"
            if ours is None:
                items.append(f'<li class="behind">{place}: {their_words}; none of ours gets there.</li>')
            elif rows[ours]["median_ms"] > rows[theirs]["median_ms"]:
                ratio = rows[ours]["median_ms"] / rows[theirs]["median_ms"]
                own = f"{escape(full_name(rows[ours]['technique']))} {numbers(f'/peers/{p}/rows/{ours}/median_ms', 'ms')} ms"
                items.append(f'<li class="behind">{place}: {their_words}, our {own}: {ratio:.2f} times as long.</li>')
    scenes = ", ".join(dict.fromkeys(run["scene"] for run in peers))
    if not items:
        levels = ", ".join(str(level) for level in LEVELS)
        return f"<h3>Beside other tracers</h3><p>Behind none of them in {escape(scenes)}, at an RMSE of {levels}.</p>"
    return f"<h3>Where we are behind another tracer</h3><ul>{''.join(items)}</ul>"


def _noise(document: dict[str, Any]) -> list[str]:
    rows = [row for comparison in document["comparisons"] for row in comparison["rows"]]
    if not rows:
        return []
    runs = sorted({len(row["times_ms"]) for row in rows})
    busy = sum(row["range_ms"][1] > _BUSY * row["range_ms"][0] for row in rows)
    counts = str(runs[0]) if len(runs) == 1 else f"{runs[0]} to {runs[-1]}"
    words = f"Times are medians of {counts} runs that took turns after a warm-up. "
    if busy:
        words += (
            f"In {busy} of {len(rows)} rows the slowest run took more than {_BUSY} times the fastest: the machine was busy, "
            "and small ratios mean nothing."
        )
    return [f'<p class="{"warning" if 3 * busy > len(rows) else "note"}">{words}</p>']
