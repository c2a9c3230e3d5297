"""What is wrong with a report's page, found without a browser: addresses, texts of images, names, and numbers."""

from __future__ import annotations

import base64
import io
import re
from html.parser import HTMLParser
from typing import Any

from PIL import Image

_EMPTY = {"meta", "img", "input", "br", "link", "hr", "source"}
_UNITS = {"share": 0.01, "MiB": float(1 << 20)}
_ADDRESS = re.compile(r"https?:|//[a-z]|@import|url\(", re.IGNORECASE)


class Page(HTMLParser):
    """Elements of a page, in the order in which they begin."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.numbers: list[tuple[dict[str, str | None], str]] = []
        self.problems: list[str] = []
        self._open: list[str] = []
        self._texts: list[str] = []
        self.feed(html)
        self.close()
        if self._open:
            self.problems.append(f"never closed: {self._open}")

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag in ("script", "style"):
            self._texts.append("")
        if tag not in _EMPTY:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if not self._open or self._open.pop() != tag:
            self.problems.append(f"</{tag}> closes nothing")

    def handle_data(self, data: str) -> None:
        if self._open and self._open[-1] == "data":
            self.numbers.append((self.elements[-1][1], data))
        if self._open and self._open[-1] in ("script", "style") and _ADDRESS.search(data):
            self.problems.append(f"an address in <{self._open[-1]}>")

    def all(self, tag: str) -> list[dict[str, str | None]]:
        """Attributes of every element of a kind."""
        return [attributes for name, attributes in self.elements if name == tag]


def problems(html: str, document: dict[str, Any]) -> list[str]:
    """Everything that is wrong with a page of a document."""
    page = Page(html)
    found = list(page.problems)
    for tag, attributes in page.elements:
        for name in ("src", "href", "srcset", "action", "data", "poster"):
            address = attributes.get(name)
            if address is not None and not address.startswith(("data:image/png;base64,", "#")):
                found.append(f"<{tag} {name}={address!r:.60}> fetches")
        if tag == "link" or (tag == "script" and "src" in attributes):
            found.append(f"<{tag}> fetches")
        if _ADDRESS.search(attributes.get("style") or ""):
            found.append(f"<{tag} style> fetches")
        if any(name.startswith("on") for name in attributes):
            found.append(f"<{tag}> has a script of its own")
    names = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    found += [f"{name!r} names two elements" for name in set(names) if names.count(name) > 1]
    for _, attributes in page.elements:
        references = (attributes.get("aria-labelledby") or "").split() + [attributes.get("data-images") or ""]
        references.append((attributes.get("href") or "#").removeprefix("#"))
        found += [f"nothing is called {name!r}" for name in references if name and name not in names]
    found += [line for attributes in page.all("img") for line in _image_problems(attributes)]
    found += [
        f"an svg without a name: {a}" for a in page.all("svg") if a.get("role") != "img" or not a.get("aria-labelledby")
    ]
    return found + [line for attributes, text in page.numbers for line in _number_problems(attributes, text, document)]


def _image_problems(attributes: dict[str, str | None]) -> list[str]:
    if not (attributes.get("alt") or "").strip():
        return ["an image without a text"]
    try:
        content = base64.b64decode((attributes["src"] or "").partition(",")[2], validate=True)
        with Image.open(io.BytesIO(content)) as image:
            size = image.size
            image.load()
    except (OSError, ValueError) as error:
        return [f"no image: {error}"]
    said = (int(attributes["width"] or 0), int(attributes["height"] or 0))
    return [] if size == said else [f"an image of {size} says {said}"]


def _number_problems(attributes: dict[str, str | None], text: str, document: dict[str, Any]) -> list[str]:
    pointer = attributes["data-of"] or ""
    value: Any = document
    for step in pointer.split("/")[1:]:
        value = value[int(step)] if isinstance(value, list) else value[step]
    if not isinstance(value, int | float) or float(attributes["value"] or "nan") != value:
        return [f"{pointer}: the page has {attributes['value']}, the numbers {value}"]
    digits = text.replace(",", "").removesuffix(" %")
    unit = _UNITS.get(attributes["data-kind"] or "", 1.0)
    last = 10.0 ** -len(digits.partition(".")[2])
    if abs(float(digits) * unit - value) > 0.5001 * last * unit:
        return [f"{pointer}: '{text}' is not {value}"]
    return []
