"""The report in a real browser, where there is a Chromium: what it shows, and that slider and keys work."""

from __future__ import annotations

import functools
import os

import numpy as np
import pytest

import browser
from test_report import full

PROGRAM = browser.chromium()
IS_EXPECTED = "SOFTSHADOW_EXPECT_BROWSER" in os.environ
pytestmark = pytest.mark.skipif(
    PROGRAM is None and not IS_EXPECTED, reason=f"none of {', '.join(browser.PROGRAMS)} is installed"
)


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    assert PROGRAM is not None, "SOFTSHADOW_EXPECT_BROWSER is set, and there is no browser"
    with browser.opened(PROGRAM, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@functools.cache
def html() -> str:
    return full().to_html()


@pytest.fixture
def page(tmp_path):
    path = tmp_path / "index.html"
    path.write_text(html(), encoding="utf-8")
    return path


def state(tab: browser.Browser, name: str = "card") -> dict[str, object]:
    return tab.evaluate(
        f"""(() => {{
          const box = document.querySelector('.viewer[data-name={name}]');
          const [left, right] = box.querySelectorAll('.stage img');
          return {{
            split: getComputedStyle(right).clipPath, slider: box.querySelector('[type=range]').value,
            says: box.querySelector('[type=range]').getAttribute('aria-valuetext'),
            left: left.alt, right: right.alt, shown: box.querySelector('.shown').textContent,
            wide: right.naturalWidth, scale: !box.querySelector('.scale').hidden, hash: location.hash,
          }};
        }})()"""
    )


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [1280, 390])
def test_it_is_drawn_without_a_complaint_and_fetches_nothing(tab, page, width, dark):
    tab.resize(width, 900, dark=dark)
    tab.open(page)
    assert tab.complaints() == []
    assert tab.fetched() == []
    seen = tab.screenshot()
    assert seen.shape == (900, width, 3)
    assert len(np.unique(seen.reshape(-1, 3), axis=0)) > 50
    assert (np.median(seen) < 60) == dark
    # Wide things scroll within themselves.
    assert tab.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    assert tab.evaluate("[...document.images].every(image => image.complete && image.naturalWidth > 0)")


def test_curves_have_the_colours_of_their_series(tab, page):
    tab.resize(1280, 900)
    tab.open(page)
    strokes = tab.evaluate(
        "[...document.querySelectorAll('#card .s0 .curve, #card .s1 .curve')].map(c => getComputedStyle(c).stroke)"
    )
    assert set(strokes) == {"rgb(0, 114, 178)", "rgb(213, 94, 0)"}
    fill = tab.evaluate("getComputedStyle(document.querySelector('.chart .dominated .mark')).fill")
    assert fill == "rgb(255, 255, 255)"


def test_what_the_address_says_is_shown(tab, page):
    tab.resize(1280, 900)
    tab.open(page, "#viewer=card&setting=2&view=error&split=30")
    shown = state(tab)
    assert (shown["slider"], shown["split"], shown["scale"]) == ("30", "inset(0px 0px 0px 30%)", True)
    assert shown["says"] == "30 % reference, 70 % error"
    assert shown["left"].startswith("Visibility of card by the reference")
    assert shown["right"].startswith("Error of ")
    assert shown["shown"].split(":")[0] in shown["right"]
    assert shown["wide"] == 48
    # What makes no sense changes nothing, and breaks nothing.
    tab.open(page, "#viewer=card&setting=99&view=none&split=abc")
    assert state(tab)["slider"] == "50"
    assert tab.complaints() == []


def test_the_slider_works_with_keys_and_with_the_pointer(tab, page):
    tab.resize(1280, 900)
    tab.open(page)
    tab.evaluate("document.querySelector('.viewer[data-name=card] [type=range]').focus()")
    for _ in range(3):
        tab.press("ArrowRight", 39)
    moved = state(tab)
    assert (moved["slider"], moved["split"]) == ("53", "inset(0px 0px 0px 53%)")
    assert "split=53" in moved["hash"]
    tab.press("Home", 36)
    assert state(tab)["split"] == "inset(0px 0px 0px 0%)"
    x, y, width = tab.evaluate(
        """(() => {
          const stage = document.querySelector('.viewer[data-name=card] .stage');
          stage.scrollIntoView();
          const b = stage.getBoundingClientRect();
          return [b.left, b.top + 20, b.width];
        })()"""
    )
    for kind, at in (("mousePressed", 0.25), ("mouseMoved", 0.75), ("mouseReleased", 0.75)):
        tab.ask("Input.dispatchMouseEvent", type=kind, x=x + at * width, y=y, button="left", buttons=1, clickCount=1)
    assert state(tab)["slider"] == "75"


def test_the_divided_picture_shows_both_images(tab, page):
    tab.resize(1280, 900)
    tab.open(page, "#viewer=card&setting=0&view=error&split=50")
    left, top, width, height = tab.evaluate(
        """(() => {
          const b = document.querySelector('.viewer[data-name=card] .stage').getBoundingClientRect();
          return [b.left, b.top, b.width, b.height].map(Math.round);
        })()"""
    )
    stage = tab.screenshot()[max(top, 0) : top + height, left : left + width].astype(int)
    assert tab.evaluate(
        """(() => {
          const [left, right] = [...document.querySelectorAll('.viewer[data-name=card] .stage img')];
          const [a, b] = [left, right].map(image => JSON.stringify(image.getBoundingClientRect()));
          return a === b;
        })()"""
    ), "they lie over each other"
    half = width // 2
    colored = (np.abs(stage[..., 0] - stage[..., 2]) > 40).mean(axis=0)
    assert colored[: half - 8].max() == 0, "the reference is grey"
    assert colored[half + 8 :].max() > 0.01, "errors are red and blue"


def test_a_technique_is_chosen_and_its_keyboard_order_is_that_of_the_page(tab, page):
    tab.resize(1280, 900)
    tab.open(page)
    tab.evaluate(
        """(() => {
          const select = document.querySelector('.viewer[data-name=card] select');
          select.value = '1';
          select.dispatchEvent(new Event('input'));
          select.focus();
        })()"""
    )
    assert "setting=1" in state(tab)["hash"]
    reached = []
    for _ in range(2):
        tab.press("Tab", 9)
        reached.append(tab.evaluate("document.activeElement.type"))
    assert reached == ["radio", "range"]


def test_without_scripts_all_images_are_there(tab, page):
    text = page.read_text()
    page.write_text(text[: text.index("<script>\n")] + text[text.index("</script></body>") + len("</script>") :])
    tab.open(page)
    assert tab.evaluate(
        "[...document.querySelectorAll('.viewer')].every(box => getComputedStyle(box).display === 'none')"
    )
    tab.evaluate("document.querySelectorAll('details').forEach(box => { box.open = true })")
    assert tab.evaluate("[...document.images].every(image => image.getBoundingClientRect().width > 0)")


def test_complaints_and_fetches_are_noticed(tab, tmp_path):
    path = tmp_path / "bad.html"
    inline = "<script>console.error('bad'); missing()</script>"
    path.write_text(html().replace("</main>", f'<img src="nowhere.png" alt="x">{inline}</main>'), encoding="utf-8")
    tab.open(path)
    found = " ".join(tab.complaints())
    assert "bad" in found
    assert "missing is not defined" in found
    assert "Content Security Policy" in found
    allowed = path.with_name("open.html")
    allowed.write_text(path.read_text().replace("default-src 'none'; img-src data:", "img-src *"), encoding="utf-8")
    tab.open(allowed)
    assert [url.rpartition("/")[2] for url in tab.fetched()] == ["nowhere.png"]
