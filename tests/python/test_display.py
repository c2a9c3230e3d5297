"""Results in notebooks, as plots, and what a call says while it works: bars, logs, missing extras."""

from __future__ import annotations

import base64
import io
import logging
import os
import re
import subprocess
import sys
from html.parser import HTMLParser

import matplotlib as mpl
import numpy as np
import pytest

import softshadow as ss
from conftest import camera_above, compare, light_above, read_png, render, visibility
from softshadow import logs

mpl.use("agg")


class Page(HTMLParser):
    """Reads the pictures and the table of a result; every tag has to be closed."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.images: list[bytes] = []
        self.cells: list[str] = []
        self.open: list[str] = []
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "img":
            source = dict(attrs)["src"]
            assert source is not None
            kind, data = source.split(",")
            assert kind == "data:image/png;base64"
            self.images.append(base64.b64decode(data))
        else:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("td", "th"):
            self.cells.append(data)

    @property
    def table(self) -> dict[str, str]:
        return dict(zip(self.cells[::2], self.cells[1::2], strict=True))


def test_notebooks_show_the_picture_and_what_made_it(scene):
    shown = Page(visibility(scene, light_above(), camera=camera_above((31, 17)))._repr_html_())
    assert [read_png(io.BytesIO(png)).shape for png in shown.images] == [(17, 31)]
    assert shown.table["shape"] == "17 × 31"
    assert shown.table["technique"].startswith("ray_traced (samples 64, ")
    assert "llvmpipe" in shown.table["device"]
    assert re.fullmatch(r"statistical, standard error 0\.0\d+ in the penumbra", shown.table["error"])
    assert "notes" not in shown.table
    picture = render(scene, light_above(), camera=camera_above((31, 17)), technique=ss.HardShadowMap())
    shown = Page(picture._repr_html_())
    assert shown.images == [picture._repr_png_()]
    assert shown.table["technique"] == "hard_shadow_map (resolution 2048)"
    assert shown.table["error"] == "none"


def test_results_without_a_picture_are_a_table(scene, floor_points):
    shown = Page(visibility(scene, light_above(), points=floor_points)._repr_html_())
    assert shown.images == []
    assert shown.table["shape"] == "13"
    assert shown.table["receivers"] == "13 of 13 receivers see a surface"


def test_notes_cannot_break_out_of_the_table():
    noted = ss.Scene([], notes=["<script>alert(1)</script> & more"])
    shown = visibility(noted, light_above(), points=np.zeros((1, 3)))._repr_html_()
    assert "<script>" not in shown
    assert Page(shown).table["notes"] == "<script>alert(1)</script> & more"


def test_ipython_finds_what_notebooks_show(scene):
    formatters = pytest.importorskip("IPython.core.formatters")
    result = visibility(scene, light_above(), camera=camera_above())
    data, _ = formatters.DisplayFormatter().format(result)
    assert data["image/png"] == result._repr_png_()
    assert data["text/html"] == result._repr_html_()
    assert data["text/plain"] == repr(result)


def test_images_are_plotted(scene):
    result = visibility(scene, light_above(), camera=camera_above())
    axes = result.plot()
    (image,) = axes.images
    np.testing.assert_array_equal(np.ma.filled(image.get_array(), np.nan), result.values)
    assert image.get_clim() == (0, 1)
    assert axes.figure.axes[1].get_ylabel() == "visibility"
    picture = render(scene, light_above(), camera=camera_above())
    np.testing.assert_array_equal(picture.plot().images[0].get_array(), picture.srgb)
    given = mpl.figure.Figure().subplots()
    assert result.plot(axes=given) is given
    assert picture.plot(axes=given) is given
    assert len(given.images) == 2
    mpl.pyplot.close("all")


def test_several_lights_are_plotted_side_by_side(scene):
    textured = light_above(texture=np.ones((2, 2, 3)), name="window")
    result = visibility(scene, [light_above(), textured], camera=camera_above())
    row = result.plot()
    assert [axes.get_title() for axes in row] == ["light0", "window"]
    for axes, values in zip(row, result.values, strict=True):
        np.testing.assert_array_equal(axes.images[0].get_array(), np.nan_to_num(values))
    with pytest.raises(ss.SettingsError, match="not 2"):
        result.plot(axes=row[0])
    mpl.pyplot.close("all")


def test_points_are_plotted_along_the_axis_in_which_they_spread_least(scene, floor_points):
    for texture in (None, np.ones((2, 2, 3))):
        result = visibility(scene, light_above(texture=texture), points=floor_points + [0, 0, 0.5] * np.eye(13)[:, :3])
        axes = result.plot()
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "z")
        (drawn,) = axes.collections
        np.testing.assert_allclose(drawn.get_offsets(), result.points[:, [0, 2]])
        if texture is None:
            np.testing.assert_array_equal(drawn.get_array(), result.values)
    empty = visibility(scene, light_above(), points=np.empty((0, 3)))
    assert len(empty.plot().collections[0].get_offsets()) == 0
    mpl.pyplot.close("all")


def test_a_bar_is_shown_on_stderr(scene, capsys):
    settings = {"camera": camera_above((64, 64)), "memory_limit": 50_000}
    visibility(scene, light_above(), progress=True, **settings)
    said = capsys.readouterr()
    assert said.out == ""
    done, total = re.search(r"visibility: 100%.* (\d+)/(\d+) ", said.err).groups()
    assert done == total
    assert int(total) > 2
    compare(scene, light_above(), camera=camera_above(), techniques=[ss.RayTraced()], repeats=1, progress=True)
    assert re.search(r"compare: 100%.* 3/3 ", capsys.readouterr().err)
    with pytest.raises(ss.SettingsError, match="exposure"):
        render(scene, light_above(), camera=camera_above(), progress=True, exposure=np.inf)
    visibility(scene, light_above(), progress=False, **settings)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("package", "extra", "call"),
    [
        ("matplotlib", "plot", "result.plot()"),
        ("tqdm", "progress", "ss.visibility(ss.Scene(), ss.SunLight(0, 45), points=[[0, 0, 0]], progress=True)"),
        ("trimesh", "trimesh", "ss.Scene.from_trimesh(None)"),
        ("trimesh", "trimesh", "ss.from_trimesh(None)"),
    ],
)
def test_a_missing_package_is_a_typed_error_that_names_its_extra(package, extra, call):
    script = f"""
import sys
import softshadow as ss
sys.modules[{package!r}] = None  # as if it were not installed
result = ss.visibility(ss.Scene(), ss.SunLight(0, 45), points=[[0, 0, 0]], device="native")
try:
    {call}
except ss.MissingExtra as error:
    print(isinstance(error, ImportError), error)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.startswith("True ")
    assert f"`python -m pip install {package}`" in done.stdout
    assert f"[{extra}]" in done.stdout


def test_a_broken_package_is_not_called_missing(tmp_path):
    (tmp_path / "tqdm.py").write_text("import no_such_module_at_all")
    script = """
import softshadow as ss
ss.visibility(ss.Scene(), ss.SunLight(0, 45), points=[[0, 0, 0]], device="native", progress=True)
"""
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, env=environment)
    assert done.stderr.rstrip().endswith("ModuleNotFoundError: No module named 'no_such_module_at_all'")


def test_logs_say_what_was_built_refitted_and_how_long_it_took(scene, floor_points, caplog):
    technique = ss.DepthComplexity(samples=16)
    fresh = ss.Scene(scene.meshes)
    moved = fresh.with_vertices([None, fresh.meshes[1].vertices + [0.1, 0, 0]])
    other = fresh.with_vertices([None, fresh.meshes[1].vertices * 0])
    said = []
    for frame in (fresh, fresh, moved, other):
        caplog.clear()
        with caplog.at_level(logging.DEBUG, logger="softshadow"):
            visibility(frame, light_above(), points=floor_points, technique=technique)
        assert {record.name for record in caplog.records} == {"softshadow"}
        said.append([record.getMessage() for record in caplog.records])
    assert "1 scene builds, 1 occluder builds" in said[0][0]
    assert "everything kept" in said[1][0]
    assert "1 scene refits, 1 occluder refits" in said[2][0]
    assert "made anew, scene: " in said[3][1]
    assert re.fullmatch(
        r"visibility: depth_complexity, 13 receivers in 1 blocks, \d+\.\d ms on llvmpipe.*", said[0][-1]
    )


def test_logs_give_a_pictures_notes_and_nothing_is_printed(scene, caplog, capsys):
    glass = ss.Scene(
        [*scene.meshes, ss.Mesh(vertices=[[0.0, 2, 0], [1, 2, 0], [0, 2, 1]], faces=[[0, 1, 2]], opacity=0.5)]
    )
    with caplog.at_level(logging.INFO, logger="softshadow"):
        render(glass, light_above(), camera=camera_above(), technique=ss.HardShadowMap())
    assert [record.levelname for record in caplog.records] == ["INFO", "INFO"]
    assert "render: 1 semi-opaque triangles taken for opaque" in caplog.messages[1]
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("asked", "variable", "kind", "why"),
    [
        ("auto", None, "native", ", because no graphics card answered"),
        ("auto", "native", "native", ", as SOFTSHADOW_DEVICE=native says"),
        ("auto", None, "gpu", ""),
        ("native", "software", "native", ""),
    ],
)
def test_logs_say_which_device_was_chosen_and_why(asked, variable, kind, why, caplog, monkeypatch):
    monkeypatch.delenv("SOFTSHADOW_DEVICE", raising=False)
    if variable:
        monkeypatch.setenv("SOFTSHADOW_DEVICE", variable)
    adapter = {"name": "card", "backend": "vulkan", "driver": "v1", "device_type": kind}
    with caplog.at_level(logging.INFO, logger="softshadow"):
        logs.device_chosen(asked, adapter)
    assert caplog.messages == [f"device '{asked}': card (vulkan, v1){why}"]


def test_a_device_is_logged_once_when_it_is_opened():
    script = """
import logging, sys
import softshadow as ss
logging.basicConfig(level=logging.INFO, stream=sys.stdout, format="%(message)s")
for _ in range(2):
    ss.visibility(ss.Scene(), ss.SunLight(0, 45), points=[[0, 0, 0]], device="native")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
    said = done.stdout.splitlines()
    assert [line.split(":")[0] for line in said] == ["device 'native'", "visibility", "visibility"]
    assert done.stderr == ""
