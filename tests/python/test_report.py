"""Reports: numbers, judgement, figures and the page, without a browser."""

from __future__ import annotations

import functools
import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest

import report_page
import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, camera_above, compare, light_above, read_png
from softshadow.bench import peers
from softshadow.bench.report import divided, scaled, serving
from softshadow.bench.scenes import Measured
from softshadow.cli import main
from softshadow.report import Report, charts, images, judgement, read_lines
from softshadow.report.growth import across

REFERENCE = ss.RayTraced(samples=64, passes=4, pattern="low_discrepancy", seed=9)
TECHNIQUES = [
    ss.RayTraced(samples=4),
    ss.RayTraced(samples=64),
    ss.DepthComplexity(samples=16),
    ss.HardShadowMap(resolution=64),
]
HOSTILE = 'card <script>alert("1")</script> "&\' //x.y/ ../../etc'


def card() -> ss.Scene:
    return ss.Scene(
        [ss.Mesh(vertices=FLOOR, faces=SQUARE, name="floor"), ss.Mesh(vertices=CARD, faces=SQUARE, name="card")]
    )


@functools.cache
def measured(name: str = "card", size: tuple[int, int] = (48, 36), side: float = 1.0) -> ss.Comparison:
    return compare(
        card(),
        light_above(side),
        camera=camera_above(size),
        techniques=TECHNIQUES,
        reference=REFERENCE,
        repeats=2,
        name=name,
    )


def peer(tracer: str, samples: int, ms: float, rmse: float | None, *, ours: bool = False) -> dict[str, object]:
    return {
        "kind": "peer",
        "scene": "card",
        "size": [48, 36],
        "tracer": tracer,
        "samples": samples,
        "ours": ours,
        "times_ms": [ms, 1.1 * ms, 0.9 * ms],
        "rmse": rmse,
        "is_slow": False,
        "reference_standard_error": 0.001,
    }


RATIO = {
    "kind": "ratio",
    "scene": "card",
    "size": [48, 36],
    "name": "64 : 16 samples",
    "over": "depth_complexity:samples=64",
    "under": "depth_complexity:samples=16",
    "asked": "< 2",
    "published": "about 5",
    "median": 1.25,
    "range": [1.1, 1.5],
    "penumbra_rmse": [0.01, None],
}
PEERS = [peer("ours", 16, 10, 0.04, ours=True), peer("ours", 64, 40, 0.015, ours=True), peer("Theirs", 64, 30, 0.012)]


@functools.cache
def full() -> Report:
    return Report(
        [measured(HOSTILE), measured()],
        growth=[measured(size=(96, 72)), measured(side=2.0)],
        lines=[RATIO, *PEERS, {"kind": "measurement"}],
        title="speed <b>against</b> error",
    )


def document(report: Report) -> dict[str, object]:
    return json.loads(json.dumps(report.to_dict(), allow_nan=False))


# --- what a comparison keeps


def test_comparisons_keep_images_and_say_what_the_reference_allows(floor_points):
    result = measured()
    assert result.reference_values.shape == (36, 48)
    assert [values.shape for values in result.values] == [(36, 48)] * 4
    for row, values in zip(result.rows, result.values, strict=True):
        penumbra = (result.reference_values > 0.002) & (result.reference_values < 0.998)
        error = np.sqrt(np.mean(np.square((values - result.reference_values)[penumbra], dtype=float)))
        assert row["penumbra"]["rmse"] == pytest.approx(error, rel=1e-6)
        low, high = row["penumbra_rmse_interval"]
        assert high - row["penumbra"]["rmse"] == pytest.approx(2 * result.reference_standard_error)
        assert low == pytest.approx(max(row["penumbra"]["rmse"] - 2 * result.reference_standard_error, 0))
        assert row["bytes"] == sum(size for _, size in row["bytes_by_resource"]) > 0
        assert row["range_ms"] == [min(row["times_ms"]), max(row["times_ms"])]
        assert row["median_ms"] == pytest.approx(np.median(row["times_ms"]))
    assert (result.triangles, result.light, result.size) == (4, {"shape": "rectangle", "extent": 1.0}, [48, 36])
    assert json.loads(result.to_json()) == result.to_dict()
    points = compare(card(), light_above(), points=floor_points, techniques=[ss.RayTraced()], reference=REFERENCE)
    assert points.size is None
    assert points.values[0].shape == points.reference_values.shape == (13,)


def test_coloured_lights_keep_three_channels():
    light = light_above(texture=np.float32([[[1, 0, 0], [0, 1, 0]]]))
    result = compare(card(), light, camera=camera_above(), techniques=[ss.RayTraced()], reference=REFERENCE, repeats=1)
    assert result.values[0].shape == (12, 16, 3)
    html = Report([result]).to_html()
    assert "mean of three colours" in html
    assert report_page.problems(html, document(Report([result]))) == []


@pytest.mark.parametrize("name", ["", "  ", 3, None])
def test_names_are_words(name):
    with pytest.raises(ss.SettingsError, match="name"):
        compare(card(), light_above(), camera=camera_above(), techniques=TECHNIQUES, name=name)


# --- judgement


def row(name: str, samples: int, ms: float, rmse: float | None, spread: float = 0.1) -> judgement.Row:
    return {
        "technique": {"name": name, "samples": samples},
        "median_ms": ms,
        "range_ms": [ms * (1 - spread), ms * (1 + spread)],
        "penumbra": None if rmse is None else {"rmse": rmse},
    }


def test_a_setting_is_dominated_by_what_is_faster_and_better():
    rows = [row("a", 16, 10, 0.05), row("b", 16, 20, 0.06), row("a", 64, 40, 0.02), row("b", 64, 41, 0.02)]
    judged = judgement.domination(rows, 0.001)
    assert [one and (one.by, one.is_certain) for one in judged] == [None, (0, True), None, (2, False)]
    # Errors that the reference cannot tell apart prove nothing; equal ones do.
    assert judgement.domination(rows, 0.006)[1] == judgement.Dominated(0, False)
    apart = [row("a", 64, 10, 0.02), row("b", 64, 20, 0.02)]
    assert judgement.domination(apart, 0.5)[1] == judgement.Dominated(0, True)
    assert judgement.domination([row("a", 1, 5, None), row("b", 1, 9, 0.1)], None) == [None, None]
    assert judgement.domination([row("a", 1, 5, 0.1), row("b", 1, 5, 0.1)], None) == [None, None]


def test_families_are_what_a_knob_sweeps():
    settings = [
        ss.RayTraced(samples=16),
        ss.RayTraced(samples=4, passes=16),
        ss.RayTraced(samples=16, probes=4),
        ss.DepthComplexity(samples=64, exact_area=False),
        ss.HardShadowMap(resolution=512),
    ]
    rows = [{"technique": json.loads(one.to_json())} for one in settings]
    assert judgement.families(rows) == {
        "ray_traced": [0, 1],
        "ray_traced, probes=4": [2],
        "depth_complexity, exact_area=false": [3],
        "hard_shadow_map": [4],
    }
    assert [judgement.knob(one["technique"]) for one in rows] == [
        "16 samples",
        "16 × 4 samples",
        "16 samples",
        "64 samples",
        "resolution 512",
    ]


def test_the_fastest_for_an_error_is_among_those_that_reach_it():
    rows = [row("a", 16, 10, 0.05), row("a", 64, 40, 0.01), row("b", 64, 20, 0.012), row("b", 9, 1, None)]
    assert judgement.fastest(rows, 0.05, range(4)) == 0
    assert judgement.fastest(rows, 0.02, range(4)) == 2
    assert judgement.fastest(rows, 0.001, range(4)) is None


def test_the_first_screen_says_who_is_dominated_and_where_we_are_behind():
    html = full().to_html()
    first = html[html.index('id="summary"') : html.index("<h2>", html.index("<h2>", html.index('id="summary"')) + 1)]
    assert re.search("<b>hard_shadow_map</b> is dominated (at every setting|nowhere) in ", first)
    assert "Where we are behind another tracer" in first
    behind = re.findall(r'<li class="behind">(.*?)</li>', first)
    # At 0.05 ours is three times as fast; at 0.02 theirs is ahead; nobody reaches 0.01.
    assert len(behind) == 1
    assert "RMSE ≤ 0.02" in behind[0]
    assert "1.33 times as long." in behind[0]
    noisy = [*PEERS[:2], peer("Theirs", 64, 38, 0.012)]
    assert "1.05 times as long, within noise." in replace(full(), lines=noisy).to_html()
    ahead = replace(full(), lines=[peer("ours", 16, 10, 0.004, ours=True), peer("Theirs", 64, 30, 0.012)]).to_html()
    assert "Behind no other tracer in card" in ahead
    alone = replace(full(), lines=[peer("ours", 16, 10, 0.04, ours=True), peer("Theirs", 64, 30, 0.012)]).to_html()
    assert "none of ours gets there" in alone
    assert "No other tracers were measured" in replace(full(), lines=[]).to_html()
    assert "is a software adapter" in first


# --- lines


def test_lines_are_read_and_what_is_wrong_is_named(tmp_path):
    path = tmp_path / "lines.jsonl"
    path.write_text(json.dumps(RATIO) + "\n" + json.dumps({"kind": "waving"}) + "\n")
    assert read_lines(path) == [RATIO, {"kind": "waving"}]
    for text, words in (("{", "line 1 is no JSON"), ("[]", "line 1: an object"), ('{"kind": 3}', "line 1: an object")):
        path.write_text(text)
        with pytest.raises(ss.SettingsError, match=words):
            read_lines(path)
    lacking = {name: value for name, value in RATIO.items() if name != "median"}
    with pytest.raises(ss.SettingsError, match="'ratio' lacks median"):
        Report([measured()], lines=[lacking])
    with pytest.raises(ss.SettingsError, match="'peer' lacks tracer"):
        Report([measured()], lines=[{"kind": "peer", "scene": "a", "size": [1, 1]}])


def test_peers_write_the_lines_that_reports_take():
    rows = [
        peers.Row("Theirs", 64, False, [3.0, 5.0, 4.0], 0.01),
        peers.Row("ours", 64, True, [2.0], float("nan"), True),
    ]
    found = peers.Beside("card", (48, 36), 64, 0, float("nan"), peers.REFERENCE, rows, [])
    lines = [json.loads(line) for line in peers.json_lines(found)]
    assert [line["rmse"] for line in lines] == [0.01, None]
    runs = document(Report([measured()], lines=lines))["peers"]
    # A row without an error says nothing of speed against error.
    assert [[one["technique"]["name"] for one in run["rows"]] for run in runs] == [["Theirs"]]
    assert runs[0]["rows"][0]["median_ms"] == 4.0


def test_what_was_not_measured_is_told():
    failure = {"kind": "failure", "scene": "canopy", "size": [8, 8], "case": "edges & <i>", "reason": "too <dense>"}
    html = replace(full(), lines=[failure, failure | {"kind": "skip", "case": None}]).to_html()
    assert "<li>canopy, 8 × 8, edges &amp; &lt;i&gt;: too &lt;dense&gt;</li><li>canopy, 8 × 8: too" in html


# --- figures


def chart(points: list[charts.Point], floor: float | None = None) -> charts.Chart:
    series = [
        charts.Series(name="one", points=points),
        charts.Series(name="two <i>", points=points[:1], is_dashed=True),
    ]
    return charts.Chart(
        title="t", description="d", x_label="x", y_label="y", series=series, floor=floor, floor_label="floor"
    )


def test_figures_place_points_on_logarithmic_axes():
    points = [charts.Point(x=x, y=y) for x, y in ((1, 0.1), (10, 0.01), (100, 0.001))]
    text = charts.svg(chart(points), "f")
    places = [tuple(map(float, pair)) for pair in re.findall(r'<circle class="mark" cx="([\d.]+)" cy="([\d.]+)"', text)]
    (x0, y0), (x1, y1), (x2, y2) = places[:3]
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.15)
    assert y1 - y0 == pytest.approx(y2 - y1, abs=0.15)
    assert x1 > x0
    assert y1 > y0, "less error lies lower"
    assert "two &lt;i&gt;" in text
    assert text.count("dashed") == 2
    assert "floor" not in text
    assert 'class="floor"' in charts.svg(chart(points, 0.005), "f")


def test_labels_stand_where_there_is_room():
    def labels(*points: charts.Point) -> list[str]:
        return re.findall(r'<text class="small"[^>]*>(\d+)</text>', charts.svg(chart(list(points)), "f"))

    far = charts.Point(x=100, y=0.1)
    assert labels(charts.Point(x=1, y=0.1, label="64"), far) == ["64", "64"]
    # Both series have this point: one place is left for neither of the third and fourth.
    crowd = [charts.Point(x=1 + k / 1000, y=0.1, label=str(k)) for k in range(9)]
    assert 2 <= len(labels(*crowd, far)) <= 4


def test_a_technique_that_refuses_a_scene_does_not_end_the_comparison():
    model = Measured("card", card(), light_above(), camera_above((8, 8)))
    wrong = ss.DepthComplexity(evaluation="blended")
    spheres = replace(model, light=ss.SphereLight(radius=0.1, world_from_light=ss.look_at((0, 3, 0), (0, 0, 0))))
    z_fail = ss.DepthComplexity(evaluation="blended", initial_counts="z_fail")
    able, refused = serving(spheres, [ss.RayTraced(), z_fail], "software")
    assert able == [ss.RayTraced()]
    assert refused[0]["case"].startswith("depth_complexity, ")
    assert "sphere" in refused[0]["reason"]
    assert serving(model, [wrong], "software") == ([wrong], [])


@pytest.mark.parametrize(
    "point", [charts.Point(x=3, y=0.5), charts.Point(x=1e-9, y=1e12, x_range=(1e-10, 1e-8), y_range=(0, 2e12))]
)
def test_figures_of_one_point_and_of_any_size_are_drawn(point):
    from softshadow import _core  # noqa: TID251 - what reports draw with

    text = charts.alone(chart([point], 0.1))
    assert "nan" not in text
    assert "inf" not in text
    drawn = read_png(io.BytesIO(_core.svg_png(text, 2.0)))
    assert drawn.shape[1] == 960
    assert (drawn[:, :, 0].astype(int) - drawn[:, :, 2] < -60).any(), "the first curve is blue"


def test_growth_is_drawn_over_what_alone_differs():
    pairs = {
        one.title for one in across([c.to_dict() for c in (measured(), measured(size=(96, 72)), measured(side=2.0))])
    }
    assert pairs == {
        "Growth with receivers: card",
        "Growth with receivers: card, error",
        "Growth with light size: card",
        "Growth with light size: card, error",
    }
    receivers = next(one for one in across([measured().to_dict(), measured(size=(96, 72)).to_dict()]))
    assert [point.x for point in receivers.series[0].points] == [48 * 36, 96 * 72]
    assert across([measured().to_dict(), measured("other", (96, 72)).to_dict()]) == []
    assert across([measured(size=(96, 72)).to_dict(), measured(side=2.0).to_dict()]) == []


def test_the_same_scene_in_more_triangles_and_under_another_light():
    more = divided(divided(card()))
    assert more.triangle_count == 16 * card().triangle_count
    assert len(more.meshes[0].vertices) == 25
    np.testing.assert_array_equal(more.bounds, card().bounds)
    techniques = [ss.RayTraced(samples=16)]
    settings = {"camera": camera_above(), "techniques": techniques, "reference": REFERENCE, "repeats": 1}
    once, fine = (compare(scene, light_above(), **settings) for scene in (card(), more))
    np.testing.assert_allclose(once.values[0], fine.values[0], atol=1 / 16)
    assert scaled(light_above(), 2.0) == light_above(2.0)
    assert scaled(ss.SunLight(10, 40), 2.0).diameter_deg == 2 * ss.SunLight(10, 40).diameter_deg


# --- images


def test_images_show_values_and_signed_errors():
    values = np.float32([[0, 0.5, 1, np.nan]])
    grey = read_png_bytes(images.visibility(values).png)
    assert (grey[0, 0] == 0).all()
    assert (grey[0, 2] == 255).all()
    # Half of the light is displayed as half of the light.
    assert abs(int(grey[0, 1, 0]) - 188) <= 1
    assert len(set(grey[0, 3].tolist())) > 1, "nothing is no grey"
    wrong = read_png_bytes(images.error(values, np.float32([[0.1, 0.5, 0.9, np.nan]]), 0.1).png).astype(int)
    assert wrong[0, 0, 2] - wrong[0, 0, 0] > 100, "too dark is blue"
    assert wrong[0, 2, 0] - wrong[0, 2, 2] > 100, "too bright is red"
    assert (wrong[0, 1] > 240).all(), "right is white"
    np.testing.assert_array_equal(wrong[0, 3], grey[0, 3])


def test_large_images_are_averaged_over_squares():
    values = np.zeros((6, 2050), np.float32)
    values[:, 0], values[0:3, 3:6] = 1, np.nan
    shown = images.visibility(values)
    assert shown.size == (683, 2)
    pixels = read_png_bytes(shown.png)
    assert abs(int(pixels[1, 0, 0]) - 156) <= 2, "a third of the light"
    assert len(set(pixels[0, 1].tolist())) > 1


def read_png_bytes(content: bytes) -> np.ndarray:
    from PIL import Image

    with Image.open(io.BytesIO(content)) as image:
        return np.array(image.convert("RGB"))


# --- the page


def test_the_page_stands_alone_and_has_the_numbers():
    html, numbers = full().to_html(), document(full())
    assert report_page.problems(html, numbers) == []
    page = report_page.Page(html)
    assert len(page.all("img")) == 2 * (1 + 2 * len(TECHNIQUES))
    assert len(page.numbers) > 150
    shown = {attributes["data-of"] for attributes, _ in page.numbers}
    for c in range(2):
        for r in range(len(TECHNIQUES)):
            for path in ("median_ms", "range_ms/0", "penumbra/rmse", "penumbra_rmse_interval/1", "bytes"):
                assert f"/comparisons/{c}/rows/{r}/{path}" in shown
    assert "/ratios/0/median" in shown
    assert "/ratios/0/penumbra_rmse/1" not in shown, "a number that is not there is a dash"
    assert "/peers/0/rows/2/median_ms" in shown
    assert "<script>alert" not in html
    assert "<b>against</b>" not in html
    assert html.count('class="curve dashed"') == 2, "the other tracer and its place in the legend"
    for word in ("about 5", "Growth with receivers: card", "Bytes by resource", "grey-blue"):
        assert word in html


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda html: html.replace("</main>", '<img src="https://a.b/c.png" alt="x"></main>'), "fetches"),
        (lambda html: html.replace("</style>", "body { background: url(x) }</style>"), "an address in <style>"),
        (lambda html: html.replace("<script>", '<script src="x.js"></script><script>'), "fetches"),
        (lambda html: re.sub(r' alt="[^"]+"', ' alt=""', html, count=1), "without a text"),
        (lambda html: html.replace("base64,iVBOR", "base64,iVBOS", 1), "no image"),
        (lambda html: html.replace(' height="36"', ' height="35"', 1), "says"),
        (lambda html: html.replace("</table>", "", 1), "closes nothing"),
        (lambda html: html.replace('id="card"', 'id="card-2"'), "nothing is called 'card'"),
        (lambda html: html.replace('id="summary"', 'id="card"'), "names two"),
        (lambda html: re.sub(r'(data-kind="ms">)(\d)', r"\g<1>9\2", html, count=1), "is not"),
        (lambda html: re.sub(r'<data value="(\d)', r'<data value="9\1', html, count=1), "the page has"),
    ],
)
def test_a_spoilt_page_is_noticed(spoil, words):
    html = full().to_html()
    spoilt = spoil(html)
    assert spoilt != html
    assert any(words in problem for problem in report_page.problems(spoilt, document(full())))


def test_a_spoilt_row_is_noticed():
    numbers = document(full())
    numbers["comparisons"][1]["rows"][2]["penumbra"]["rmse"] *= 1.001
    found = report_page.problems(full().to_html(), numbers)
    assert found
    assert all(problem.startswith("/comparisons/1/rows/2/penumbra/rmse") for problem in found)


def test_files_of_a_report(tmp_path):
    folder = tmp_path / "deep" / "report"
    full().save(folder)
    names = sorted(path.name for path in folder.iterdir())
    hostile = next(name for name in names if "script" in name)
    assert names == sorted(["front-card.png", hostile, "index.html", "report.json"])
    assert re.fullmatch(r"front-[a-z0-9-]+\.png", hostile)
    saved = json.loads((folder / "report.json").read_text())
    assert report_page.problems((folder / "index.html").read_text(), saved) == []
    front = read_png(folder / "front-card.png")
    assert front.shape[1:] == (1200, 3)
    colors = {tuple(color) for color in front.reshape(-1, 3)[::7].tolist()}
    for color in charts.PALETTE[:2]:
        assert tuple(bytes.fromhex(color[1:])) in colors
    # Again over the same files, and by itself.
    full().save(folder)
    measured().save(tmp_path / "one")
    assert "Speed against error: card" in (tmp_path / "one" / "index.html").read_text()


def test_what_cannot_be_written_or_reported_is_refused(tmp_path):
    occupied = tmp_path / "file"
    occupied.write_text("")
    for folder in (occupied, occupied / "deeper"):
        with pytest.raises(ss.OutputError, match="file"):
            measured().save(folder)
    for wrong in ([], [3], measured(), None):
        with pytest.raises(ss.SettingsError, match="comparisons"):
            Report(wrong)
    with pytest.raises(ss.SettingsError, match="growth"):
        Report([measured()], growth=[3])


# --- the command line


def test_the_command_writes_a_report(tmp_path, capsys):
    lines = tmp_path / "lines.jsonl"
    lines.write_text(json.dumps(RATIO) + "\n")
    arguments = ["compare", "fork", "-o", str(tmp_path / "out"), "--size", "32x24", "--device", "software", "--json"]
    arguments += ["--technique", "ray-traced:samples=4", "--technique", "depth-complexity:samples=16", "--repeats", "1"]
    arguments += ["--reference", "ray-traced:samples=64", "--lines", str(lines)]
    assert main(arguments) == 0
    said = capsys.readouterr()
    assert json.loads(said.out) == json.loads((tmp_path / "out" / "report.json").read_text()) | {
        "made": json.loads(said.out)["made"]
    }
    assert "ray_traced(samples=4" in said.err
    page = (tmp_path / "out" / "index.html").read_text()
    assert "Speed against error: fork" in page
    assert "about 5" in page


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--repeats", "0"], "repeats"),
        (["--lines", "nowhere.jsonl"], "nowhere.jsonl"),
        (["-o", "occupied"], "a folder expected"),
        (["--light", "sun:azimuth=1,elevation=40", "--light", "sun:azimuth=9,elevation=40"], "one light"),
        (["--technique", "ray-traced:samples=0"], "32768"),
    ],
)
def test_mistakes_of_the_command_end_with_two(more, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "occupied").write_text("")
    try:
        code = main(["compare", "fork", "-o", "out", "--size", "8x8", "--device", "software", *more])
    except SystemExit as end:
        code = end.code
    assert code == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
