"""The page: one file of HTML with its style, script, figures and images."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from softshadow.comparison import Comparison

from . import images
from .charts import Chart, svg
from .fronts import front
from .growth import across, with_samples
from .judgement import domination, families, full_name, rmse
from .numbers import Numbers
from .summary import summary

# Nothing is fetched from anywhere, whatever a name or a note may hold.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
_LIMITS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)


def page(document: dict[str, Any], comparisons: Sequence[Comparison]) -> str:
    """The whole page of what ``report.json`` holds; `comparisons` have the images."""
    numbers = Numbers(document)
    here = files(__package__)
    style = here.joinpath("page.css").read_text(encoding="utf-8")
    script = here.joinpath("page.js").read_text(encoding="utf-8")
    title = escape(document["title"])
    body = [
        f'<header><h1>{title}</h1><p class="made">{escape(_made(document))}</p>{_contents(document)}</header><main>',
        summary(document, numbers),
    ]
    for index, comparison in enumerate(comparisons):
        body.append(_section(document, index, comparison, numbers))
    body += [
        _figures("Growth", across([*document["comparisons"], *document["growth"]]), "growth"),
        _peers(document["peers"], numbers),
        _ratios(document["ratios"], numbers),
        f"</main>{_FOOTER}",
    ]
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>\n{style}</style></head><body>{''.join(body)}<script>\n{script}</script></body></html>\n"
    )


def _made(document: dict[str, Any]) -> str:
    system = document["system"]
    adapters = dict.fromkeys(_adapter(c["reference"]["adapter"]) for c in document["comparisons"])
    place = f"{system['system']} {system['machine']}, {system['threads']} threads"
    return "; ".join([f"softshadow {document['version']}", *adapters, place, document["made"]])


def _adapter(adapter: dict[str, Any]) -> str:
    return ", ".join(dict.fromkeys(filter(None, (adapter["name"], adapter["backend"], adapter["driver"]))))


def _contents(document: dict[str, Any]) -> str:
    links = [(c["id"], c["title"]) for c in document["comparisons"]]
    links += [("growth", "growth")] * bool(document["growth"])
    links += [("peers", "other tracers")] * bool(document["peers"])
    links += [("ratios", "published ratios")] * bool(document["ratios"])
    if len(links) < 2:
        return ""
    items = "".join(f'<a href="#{identity}">{escape(title)}</a>' for identity, title in links)
    return f'<nav aria-label="Contents">{items}</nav>'


def _section(document: dict[str, Any], index: int, comparison: Comparison, numbers: Numbers) -> str:
    facts = document["comparisons"][index]
    charts = [front(f"Front: {facts['title']}", facts["rows"], facts["reference_standard_error"]), with_samples(facts)]
    figures = "".join(_figure(chart, f"{facts['id']}-{k}") for k, chart in enumerate(charts) if chart is not None)
    return (
        f'<section id="{facts["id"]}"><h2>{escape(facts["title"])}</h2><p class="facts">{_facts(facts, index, numbers)}</p>'
        f'<div class="figures">{figures}</div>{_table(facts, index, numbers)}{_viewer(facts, comparison)}'
        f"{_bytes(facts, index, numbers)}{_notes(facts)}</section>"
    )


def _facts(facts: dict[str, Any], index: int, numbers: Numbers) -> str:
    at, light, reference = f"/comparisons/{index}", facts["light"], facts["reference"]
    receivers = numbers(f"{at}/reference/receivers", "count")
    where = f"{facts['size'][0]} × {facts['size'][1]} pixels" if facts["size"] else f"{receivers} points"
    unit = " degrees" if light["shape"] == "sun" else ""
    penumbra = next((f"/rows/{r}/penumbra/count" for r, row in enumerate(facts["rows"]) if row["penumbra"]), None)
    within = numbers(at + penumbra, "count") if penumbra else "none"
    error = numbers(f"{at}/reference_standard_error", "error")
    return (
        f"{where}, of which {numbers(f'{at}/reference/valid_receivers', 'count')} see anything and {within} lie in the "
        f"penumbra; {numbers(f'{at}/triangles', 'count')} triangles; light: {light['shape']}, extent {light['extent']:.4g}{unit}. "
        f"Reference: {escape(full_name(reference['technique']))}; its own standard error in the penumbra is {error}."
    )


def _figure(chart: Chart, identity: str) -> str:
    return f"<figure>{svg(chart, identity)}<figcaption>{escape(chart.title)}</figcaption></figure>"


def _figures(title: str, charts: Sequence[Chart], identity: str) -> str:
    if not charts:
        return ""
    figures = "".join(_figure(chart, f"{identity}-{k}") for k, chart in enumerate(charts))
    return f'<section id="{identity}"><h2>{title}</h2><div class="figures">{figures}</div></section>'


_COLUMNS = (
    ("ms", "median_ms", "ms"),
    ("RMSE", "penumbra/rmse", "error"),
    ("p99", "penumbra/p99", "error"),
    ("max", "penumbra/max", "error"),
    ("bias", "penumbra/bias", "signed"),
    ("leaks", "leak_fraction", "share"),
    ("false shadow", "false_shadow_fraction", "share"),
    ("&gt; 0.25", "gross_count", "count"),
    ("MiB", "bytes", "MiB"),
)


def _table(facts: dict[str, Any], index: int, numbers: Numbers) -> str:
    rows = facts["rows"]
    judged = domination(rows, facts["reference_standard_error"])
    head = "".join(f'<th scope="col">{name}</th>{_BESIDE.get(name, "")}' for name, _, _ in _COLUMNS)
    body = []
    for r in (r for members in families(rows).values() for r in members):
        at = f"/comparisons/{index}/rows/{r}"
        spans = {
            "median_ms": f"<td>{numbers(f'{at}/range_ms/0', 'ms')} … {numbers(f'{at}/range_ms/1', 'ms')}</td>",
            "penumbra/rmse": f"<td>{_interval(rows[r], at, numbers)}</td>",
        }
        cells = "".join(f"<td>{numbers(f'{at}/{path}', kind)}</td>{spans.get(path, '')}" for _, path, kind in _COLUMNS)
        by, mark = judged[r], ""
        if by is not None:
            certainty = "" if by.is_certain else " <small>within noise</small>"
            mark = f"{escape(full_name(rows[by.by]['technique']))}{certainty}"
        name = escape(full_name(rows[r]["technique"]))
        dominated = ' class="dominated"' if by is not None else ""
        body.append(f'<tr{dominated}><th scope="row" class="word">{name}</th>{cells}<td class="word">{mark}</td></tr>')
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="Settings of {escape(facts["title"])}"><table>'
        "<caption>Milliseconds of whole calls from plan to values. Errors over the penumbra: against the reference, and where "
        "that against the truth lies, as far as the reference’s own standard error (twice) lets it be said. Leaks are umbra "
        "above 0.05, false shadow is lit ground below 0.95. MiB: on the device, from the plan.</caption>"
        f'<thead><tr><th scope="col" class="word">technique</th>{head}<th scope="col" class="word">dominated by</th></tr></thead>'
        f"<tbody>{''.join(body)}</tbody></table></div>"
    )


_BESIDE = {
    "ms": '<th scope="col">fastest … slowest</th>',
    "RMSE": '<th scope="col">true RMSE within</th>',
}


def _interval(row: dict[str, Any], at: str, numbers: Numbers) -> str:
    if row["penumbra_rmse_interval"] is None:
        return numbers(f"{at}/penumbra_rmse_interval", "error")
    low, high = (numbers(f"{at}/penumbra_rmse_interval/{k}", "error") for k in (0, 1))
    return f"{low} … {high}"


def _viewer(facts: dict[str, Any], comparison: Comparison) -> str:
    """Images of a camera's receivers: a divided picture, and all of them."""
    if facts["size"] is None:
        return '<p class="note">Receivers are points: there are no images.</p>'
    identity, rows, title = facts["id"], facts["rows"], escape(facts["title"])
    limit = _limit(rows)
    order = [r for members in families(rows).values() for r in members]
    truth = images.visibility(comparison.reference_values)
    width, height = truth.size
    sized = f'width="{width}" height="{height}"'
    reference = escape(full_name(facts["reference"]["technique"]))
    figures = [
        f'<figure data-reference><div><img src="{truth.uri}" {sized} alt="Visibility of {title} by the reference, '
        f'{reference}"></div><figcaption>reference: {reference}</figcaption></figure>'
    ]
    options = []
    for place, r in enumerate(order):
        name = escape(full_name(rows[r]["technique"]))
        seen = images.visibility(comparison.values[r])
        wrong = images.error(comparison.values[r], comparison.reference_values, limit)
        words = f"{name}: {_measured(rows[r])}"
        figures.append(
            f'<figure data-setting="{place}"><div><img class="visibility" src="{seen.uri}" {sized} '
            f'alt="Visibility of {title} by {words}"><img class="error" src="{wrong.uri}" {sized} '
            f'alt="Error of {words}; red is too bright, blue too dark"></div><figcaption>{words}</figcaption></figure>'
        )
        options.append(f'<option value="{place}">{name}</option>')
    side = images.reduction(*facts["size"])
    smaller = f" Images are averages over {side} × {side} pixels; numbers are not." if side > 1 else ""
    colors = " Images show the mean of three colours." if comparison.channels > 1 else ""
    return (
        f'<div class="viewer" data-name="{identity}" data-images="{identity}-images" hidden><div class="controls">'
        f"<label>Technique <select>{''.join(options)}</select></label>"
        f'<fieldset><legend>Right side</legend><label><input type="radio" name="{identity}-view" value="visibility" checked> '
        f'visibility</label><label><input type="radio" name="{identity}-view" value="error"> error</label></fieldset></div>'
        '<div class="stage"></div>'
        '<label class="divide">Divide: reference on the left, technique on the right'
        '<input type="range" min="0" max="100" step="1" value="50"></label>'
        f'<p class="shown note" aria-live="polite"></p>{_scale(limit)}</div>'
        f'<details id="{identity}-images"><summary>All images: visibility, and error in false colours</summary>'
        f'<p class="note">White is fully lit, grey-blue is where the camera sees nothing.{smaller}{colors}</p>{_scale(limit)}'
        f'<div class="images">{"".join(figures)}</div></details>'
    )


def _measured(row: dict[str, Any]) -> str:
    error = rmse(row)
    words = f"{row['median_ms']:.1f} ms"
    return words if error is None else f"{words}, RMSE {error:.4f} in the penumbra"


def _limit(rows: Sequence[dict[str, Any]]) -> float:
    """Where colours saturate: an error that half of the techniques have in a hundredth of their penumbrae."""
    tails = [row["penumbra"]["p99"] for row in rows if row["penumbra"] is not None]
    usual = float(np.median(tails)) if tails else 0.0
    return next((limit for limit in _LIMITS if limit >= usual), _LIMITS[-1])


def _scale(limit: float) -> str:
    return f'<p class="scale">−{limit} too dark <i aria-hidden="true"></i> +{limit} too bright</p>'


def _bytes(facts: dict[str, Any], index: int, numbers: Numbers) -> str:
    """A column a setting, a row a resource."""
    rows = facts["rows"]
    order = [r for members in families(rows).values() for r in members]
    labels = list(dict.fromkeys(label for r in order for label, _ in rows[r]["bytes_by_resource"]))
    if not labels:
        return ""
    head = "".join(f'<th scope="col">{escape(full_name(rows[r]["technique"]))}</th>' for r in order)
    body = []
    for label in labels:
        cells = []
        for r in order:
            at = next((k for k, (known, _) in enumerate(rows[r]["bytes_by_resource"]) if known == label), None)
            pointer = f"/comparisons/{index}/rows/{r}/bytes_by_resource/{at}/1"
            cells.append("<td></td>" if at is None else f"<td>{numbers(pointer, 'count')}</td>")
        body.append(f'<tr><th scope="row" class="word">{escape(label)}</th>{"".join(cells)}</tr>')
    total = "".join(f"<td>{numbers(f'/comparisons/{index}/rows/{r}/bytes', 'count')}</td>" for r in order)
    return (
        f"<details><summary>Bytes by resource</summary>"
        f'<div class="scroll" tabindex="0" role="region" aria-label="Bytes of {escape(facts["title"])}"><table>'
        f'<thead><tr><th scope="col" class="word">bytes</th>{head}</tr></thead><tbody>{"".join(body)}'
        f'<tr><th scope="row" class="word">in all</th>{total}</tr></tbody></table></div></details>'
    )


def _notes(facts: dict[str, Any]) -> str:
    notes = dict.fromkeys(
        f"{full_name(row['technique'])}: {note}" for row in facts["rows"] for note in row["notes"]
    )
    items = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return f'<h3>Notes</h3><ul class="note">{items}</ul>' if items else ""


def _peers(peers: Sequence[dict[str, Any]], numbers: Numbers) -> str:
    """Other tracers, each scene in a run of its own in which all took turns."""
    if not peers:
        return ""
    parts = [
        '<section id="peers"><h2>Beside other tracers</h2><p class="note">Measured in a process of their own, on the same '
        "receivers and taking turns. Of ours the time from the camera to visibility counts, of the others the query alone.</p>"
    ]
    for p, run in enumerate(peers):
        rows = run["rows"]
        dashed = {full_family for full_family in families([row for row in rows if not row["ours"]])}
        chart = front(f"Front beside other tracers: {run['scene']}", rows, run["reference_standard_error"], tuple(dashed))
        body = []
        for r, row in enumerate(rows):
            at = f"/peers/{p}/rows/{r}"
            once = " <small>first turn alone</small>" if row["is_slow"] else ""
            body.append(
                f'<tr><th scope="row" class="word">{escape(full_name(row["technique"]))}</th>'
                f"<td>{numbers(f'{at}/median_ms', 'ms')}{once}</td>"
                f"<td>{numbers(f'{at}/range_ms/0', 'ms')} … {numbers(f'{at}/range_ms/1', 'ms')}</td>"
                f"<td>{numbers(f'{at}/penumbra/rmse', 'error')}</td></tr>"
            )
        width, height = run["size"]
        parts.append(
            f"<h3>{escape(run['scene'])}, {width} × {height}</h3>"
            f'<div class="figures">{_figure(chart, f"peers-{p}") if chart else ""}'
            f'<div class="scroll" tabindex="0" role="region" aria-label="Tracers on {escape(run["scene"])}"><table>'
            '<thead><tr><th scope="col" class="word">tracer</th><th scope="col">ms</th><th scope="col">fastest … slowest</th>'
            f'<th scope="col">RMSE in penumbra</th></tr></thead><tbody>{"".join(body)}</tbody></table></div></div>'
        )
    return "".join([*parts, "</section>"])


def _ratios(ratios: Sequence[dict[str, Any]], numbers: Numbers) -> str:
    if not ratios:
        return ""
    body = []
    for r, ratio in enumerate(ratios):
        at = f"/ratios/{r}"
        width, height = ratio["size"]
        words = (f"{ratio['scene']}, {width} × {height}", ratio["name"], ratio["over"], ratio["under"])
        cells = "".join(f'<td class="word">{escape(word)}</td>' for word in words[1:])
        body.append(
            f'<tr><th scope="row" class="word">{escape(words[0])}</th>{cells}'
            f"<td>{escape(ratio['published'])}</td><td>{escape(ratio['asked'])}</td><td>{numbers(f'{at}/median', 'ratio')}</td>"
            f"<td>{numbers(f'{at}/range/0', 'ratio')} … {numbers(f'{at}/range/1', 'ratio')}</td>"
            f"<td>{numbers(f'{at}/penumbra_rmse/0', 'error')}</td><td>{numbers(f'{at}/penumbra_rmse/1', 'error')}</td></tr>"
        )
    head = "".join(
        f'<th scope="col"{" class=word" if k < 4 else ""}>{name}</th>'
        for k, name in enumerate(
            ("scene", "ratio", "time of", "over that of", "published", "asked", "ours", "from … to", "RMSE of", "over")
        )
    )
    return (
        '<section id="ratios"><h2>Published ratios beside ours</h2>'
        '<p class="note">Times of two settings over each other, turn by turn in one run of <code>softshadow-bench</code>. '
        "Published are those of Forest, Barthe and Paulin (2008) on the hardware of their day; asked is what this project "
        "asks of itself.</p>"
        f'<div class="scroll" tabindex="0" role="region" aria-label="Ratios"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(body)}</tbody></table></div></section>"
    )


_FOOTER = (
    '<footer><p class="note">All numbers, with all digits and the plans that made them, are in <code>report.json</code> beside this '
    "page; fronts are there as PNG. Times hold for the machine and the run that made them: compare ratios.</p></footer>"
)
