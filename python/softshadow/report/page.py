"""The page: one file of HTML with its style, script, figures and images."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from importlib.resources import files
from typing import Any

from softshadow.comparison import Comparison

from .beside import peers, ratios
from .details import details
from .growth import across
from .markup import figures, section
from .numbers import Numbers
from .summary import summary

# Nothing is fetched from anywhere, whatever a name or a note may hold.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
_FOOTER = (
    '<footer><p class="note">All numbers, with all digits, are in <code>report.json</code>'
    " beside this page; fronts are there as PNG. Times hold for the machine and the run that made them: compare "
    "ratios.</p></footer>"
)


def page(document: dict[str, Any], comparisons: Sequence[Comparison]) -> str:
    """The whole page of what ``report.json`` holds; `comparisons` have the images."""
    numbers = Numbers(document)
    here = files(__package__)
    style = here.joinpath("page.css").read_text(encoding="utf-8")
    script = here.joinpath("page.js").read_text(encoding="utf-8")
    title = escape(document["title"])
    growth = across([*document["comparisons"], *document["growth"]])
    links = {one["id"]: one["title"] for one in document["comparisons"]}
    parts = [details(document, index, one, numbers) for index, one in enumerate(comparisons)]
    if growth:
        links["growth"] = "growth"
        parts.append(section("growth", "Growth", figures(growth, "growth")))
    if document["peers"]:
        links["peers"] = "other tracers"
    if document["ratios"]:
        links["ratios"] = "published ratios"
    parts += [peers(document["peers"], numbers), ratios(document["ratios"], numbers)]
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>\n{style}</style></head><body>"
        f'<header><h1>{title}</h1><p class="made">{escape(_made(document))}</p>{_contents(links)}</header>'
        f"<main>{summary(document, numbers)}{''.join(parts)}</main>{_FOOTER}"
        f"<script>\n{script}</script></body></html>\n"
    )


def _made(document: dict[str, Any]) -> str:
    system = document["system"]
    adapters = dict.fromkeys(_adapter(one["reference"]["adapter"]) for one in document["comparisons"])
    place = f"{system['system']} {system['machine']}, {system['threads']} threads"
    return "; ".join([f"softshadow {document['version']}", *adapters, place, document["made"]])


def _adapter(adapter: dict[str, Any]) -> str:
    return ", ".join(dict.fromkeys(filter(None, (adapter["name"], adapter["backend"], adapter["driver"]))))


def _contents(links: dict[str, str]) -> str:
    items = "".join(f'<a href="#{identity}">{escape(title)}</a>' for identity, title in links.items())
    return f'<nav aria-label="Contents">{items}</nav>' if len(links) > 1 else ""
