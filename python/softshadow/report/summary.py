"""The first screen: who is fastest at an error, who is dominated where, and where a peer is ahead."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from .judgement import LEVELS, Dominated, Row, domination, families, fastest, full_name, knob, rmse
from .markup import note, table
from .numbers import NOTHING, Numbers

_BUSY = 1.3
"""Where the slowest run takes so many times the fastest, small ratios mean nothing."""


def summary(document: dict[str, Any], numbers: Numbers) -> str:
    """The section that opens the page."""
    comparisons = document["comparisons"]
    judged = [domination(one["rows"], one["reference_standard_error"]) for one in comparisons]
    return "".join(
        [
            '<section id="summary"><h2>Who is fastest, and who is beaten</h2>',
            *_warnings(document),
            _statements(comparisons, judged),
            _behind(document["peers"], numbers),
            _levels(comparisons, numbers),
            _beaten(comparisons, judged),
            *_noise(document),
            _absent(document["absent"]),
            "</section>",
        ]
    )


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
    lines = []
    for c, comparison in enumerate(comparisons):
        rows, error = comparison["rows"], comparison["reference_standard_error"]
        name = f'<a href="#{comparison["id"]}">{escape(comparison["title"])}</a>'
        lines.append([name, *(_fastest(rows, level, error, c, numbers) for level in LEVELS)])
    explained = note(
        "The fastest setting whose root mean square error in the penumbra is at most so large, its milliseconds, and "
        "the fastest of the next technique."
    )
    head = ["scene", *(f"≤ {level}" for level in LEVELS)]
    return f"<h3>Fastest for an error</h3>{explained}{table('Fastest settings', head, lines, words=None)}"


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


def _statements(comparisons: list[dict[str, Any]], judged: list[list[Dominated | None]]) -> str:
    """A sentence a family: in which scenes it is dominated at every setting, at some, nowhere."""
    found: dict[str, dict[str, list[str]]] = {}
    counts: dict[str, list[bool]] = {}
    for comparison, verdicts in zip(comparisons, judged, strict=True):
        rows = comparison["rows"]
        for name, members in families(rows).items():
            able = [index for index in members if rmse(rows[index]) is not None]
            beaten = [verdict.is_certain for index in able if (verdict := verdicts[index]) is not None]
            counts.setdefault(name, []).extend(beaten)
            if able:
                where = "at every setting" if len(beaten) == len(able) else "at some settings" if beaten else "nowhere"
                found.setdefault(name, {}).setdefault(where, []).append(comparison["title"])
    sentences = []
    for name, places in found.items():
        clauses = [f"{where} in {_listed(titles)}" for where, titles in sorted(places.items())]
        sure, judged_so = sum(counts[name]), len(counts[name])
        doubt = f" ({sure} of {judged_so} surely, the others within noise)" if sure < judged_so else ""
        doubt = " (all within noise)" if judged_so and not sure else doubt
        sentences.append(f"<li><b>{escape(name)}</b> is dominated {escape('; '.join(clauses))}{doubt}.</li>")
    return f"<ul>{''.join(sentences)}</ul>" if sentences else "<p>No scene has a penumbra: nothing to judge.</p>"


def _beaten(comparisons: list[dict[str, Any]], judged: list[list[Dominated | None]]) -> str:
    """A row a scene, a column a family: which settings are dominated, and by what."""
    names = list(dict.fromkeys(name for one in comparisons for name in families(one["rows"])))
    lines = []
    for comparison, verdicts in zip(comparisons, judged, strict=True):
        members = families(comparison["rows"])
        cells = [_verdict(members.get(name, []), comparison["rows"], verdicts) for name in names]
        lines.append([escape(comparison["title"]), *cells])
    explained = note(
        "Another setting takes no more time (median) and errs no more: it stands at the arrow. “Within noise” where "
        "their times overlap in any run, or their errors differ by less than twice the reference’s own standard error."
    )
    head = ["scene", *map(escape, names)]
    return f"<h3>Dominated settings</h3>{explained}{table('Dominated settings', head, lines, words=None)}"


def _verdict(members: Sequence[int], rows: list[Row], verdicts: list[Dominated | None]) -> str:
    able = [index for index in members if rmse(rows[index]) is not None]
    if not able:
        return NOTHING
    parts = []
    for index in able:
        verdict = verdicts[index]
        if verdict is not None:
            own = knob(rows[index]["technique"]) or "its only setting"
            by, doubt = full_name(rows[verdict.by]["technique"]), "" if verdict.is_certain else ", within noise"
            parts.append(f"{escape(own)} <small>← {escape(by)}{doubt}</small>")
    return "<br>".join(parts) or "none"


def _listed(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _behind(peers: list[dict[str, Any]], numbers: Numbers) -> str:
    """Where the fastest of other tracers is faster than ours at an error."""
    if not peers:
        command = "<code>python -m softshadow.bench.peers --json FILE</code>"
        return note(f"No other tracers were measured beside these: {command} does that.")
    items = []
    for index, run in enumerate(peers):
        found = (_lost(run, level, f"/peers/{index}/rows", numbers) for level in LEVELS)
        items += [f'<li class="behind">{words}</li>' for words in found if words]
    if not items:
        scenes = escape(_listed(list(dict.fromkeys(run["scene"] for run in peers))))
        return f"<p>Behind no other tracer in {scenes}, at an RMSE of {_listed([str(level) for level in LEVELS])}.</p>"
    return f"<h3>Where we are behind another tracer</h3><ul>{''.join(items)}</ul>"


def _lost(run: dict[str, Any], level: float, at: str, numbers: Numbers) -> str:
    rows = run["rows"]
    ours, theirs = (
        fastest(rows, level, [index for index, row in enumerate(rows) if row["ours"] is side]) for side in (True, False)
    )

    def words(index: int) -> str:
        return f"{escape(full_name(rows[index]['technique']))} takes {numbers(f'{at}/{index}/median_ms', 'ms')} ms"

    if theirs is None:
        return ""
    place = f"{escape(run['scene'])}, RMSE ≤ {level}"
    if ours is None:
        return f"{place}: {words(theirs)}; none of ours gets there."
    ratio = rows[ours]["median_ms"] / rows[theirs]["median_ms"]
    if ratio <= 1:
        return ""
    doubt = "" if rows[theirs]["range_ms"][1] < rows[ours]["range_ms"][0] else ", within noise"
    return f"{place}: {words(theirs)}, our {words(ours)}: {ratio:.2f} times as long{doubt}."


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
            f"In {busy} of {len(rows)} rows the slowest run took more than {_BUSY} times the fastest: the machine was "
            "busy, and small ratios mean nothing."
        )
    return [f'<p class="{"warning" if 3 * busy > len(rows) else "note"}">{words}</p>']


def _absent(lines: list[dict[str, Any]]) -> str:
    """Nothing that was not measured goes without a word."""
    if not lines:
        return ""
    items = []
    for line in lines:
        what = ", ".join(filter(None, ("{}, {} × {}".format(line["scene"], *line["size"]), line["case"])))
        items.append(f"<li>{escape(what)}: {escape(line['reason'])}</li>")
    return f"<h3>Not measured</h3><ul>{''.join(items)}</ul>"
