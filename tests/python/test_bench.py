"""The tables beside other tracers, with a tracer of the tests' own: the real ones are large."""

from __future__ import annotations

import numpy as np
import pytest

import softshadow as ss
from conftest import camera_above, light_above
from softshadow.bench import peers, rays
from softshadow.bench.peers import Beside, Row
from softshadow.bench.rays import Query
from softshadow.bench.scenes import Measured, find


def row(tracer: str, samples: int, ms: float, rmse: float, ours: bool = False) -> Row:
    return Row(tracer, samples, ours, [ms * 3, ms, ms / 2], rmse)


def found(*rows: Row) -> Beside:
    return Beside("card", (8, 8), 64, 9, 0.001, peers.REFERENCE, list(rows), [])


def test_ratios_compare_each_at_its_fastest_for_an_error():
    table = peers.ratio_lines(
        found(
            row("edges", 16, 10, 0.03, ours=True),
            row("edges", 64, 8, 0.009, ours=True),
            row("theirs", 64, 4, 0.04),
            row("theirs", 256, 16, 0.007),
        )
    )
    assert table[0] == "| ms ours : theirs at RMSE | ≤ 0.05 | ≤ 0.02 | ≤ 0.01 | ≤ 0.005 |"
    assert table[2] == (
        "| edges : theirs | 2.00 (64 : 64 samples) | 0.50 (64 : 256 samples) | 0.50 (64 : 256 samples) | – |"
    )


def test_ours_is_held_against_the_fastest_of_the_others():
    rows = row("edges", 64, 8, 0.009, ours=True), row("a", 64, 4, 0.04), row("b", 64, 16, 0.007), row("c", 256, 1, 0.01)
    assert peers.ratio_lines(found(*rows))[-2] == (
        "| edges : fastest other | 8.00 (64 : 256 samples) | 8.00 (64 : 256 samples) | 8.00 (64 : 256 samples) | – |"
    )
    assert "| edges | 64 | 8 | 0.0090 | 2.00 |" in peers.lines(found(*rows))


def test_techniques_are_told_apart_by_their_settings():
    blended = ss.DepthComplexity(samples=16, evaluation="blended", exact_area=False)
    assert peers.named(blended) == "depth_complexity, exact_area=False, evaluation=blended"
    assert peers.named(ss.RayTraced(samples=16, passes=4)) == "ray_traced"


def test_what_is_slow_has_one_turn(scene, monkeypatch):
    monkeypatch.setattr(peers, "PATIENCE_S", 0.004)
    model = Measured("card", scene, light_above(), camera_above((48, 36)))
    result = peers.beside(model, {"brute": (Brute, (16,))}, [], rounds=3, device="software")
    assert result.rows[0].times_ms == [5.0]
    assert "| brute | 16 | 5 (first turn) |" in "\n".join(peers.lines(result))


def test_nobody_is_fast_at_an_error_that_nobody_reaches():
    assert peers.fastest([row("edges", 16, 10, 0.03), row("edges", 64, 8, float("nan"))], 0.02) is None


def test_rays_are_asked_in_blocks_and_stop_at_the_horizon(monkeypatch):
    monkeypatch.setattr(rays, "_RAYS_AT_ONCE", 6)
    origins, normals = np.zeros((5, 3), np.float32), np.tile(np.float32([0, 1, 0]), (5, 1))
    targets = np.float32([[0, 1, 0], [0, -1, 0]])
    sizes = []

    def visible(p: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, float]:
        sizes.append(len(p))
        return np.ones((len(p), len(s)), dtype=bool), 2.0

    values, ms = rays.visibility(visible, Query(origins, normals, targets, targets[:1], np.ones((1, 5), bool)))
    assert (sizes, ms) == ([3, 2], 4.0)
    assert (values == 0.5).all()


class Brute:
    """A card over a floor, by two comparisons a ray; what the library's receivers and samples must agree with."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        assert (vertices.shape, faces.shape) == ((8, 3), (4, 3))
        self.card_y = vertices[4, 1]

    def visible(self, origins: np.ndarray, targets: np.ndarray) -> tuple[np.ndarray, float]:
        p, way = origins[:, None].astype(float), targets[None].astype(float) - origins[:, None]
        at = (self.card_y - p[..., 1]) / way[..., 1]
        hit = (at > 0) & (at < 1) & (np.abs(p + at[..., None] * way)[..., [0, 2]] < 0.5).all(axis=-1)
        return ~hit, 5.0

    def visibility(self, query: Query) -> tuple[np.ndarray, float]:
        assert query.seen.sum() == len(query.origins)
        assert len(query.probes) == 16
        return rays.visibility(self.visible, query)


def test_others_get_the_same_receivers_and_samples(scene):
    model = Measured("card", scene, light_above(), camera_above((48, 36)))
    result = peers.beside(model, {"brute": (Brute, (64,))}, [ss.RayTraced(samples=64)], rounds=2, device="software")
    ours, theirs = result.rows
    assert result.in_penumbra > 50
    assert ours.rmse == pytest.approx(theirs.rmse, abs=1e-4)
    assert (theirs.ms, len(theirs.times_ms), len(ours.times_ms)) == (5.0, 2, 2)
    said = "\n".join(peers.lines(result))
    assert "| brute | 64 | 5 |" in said
    assert f"| {ours.ms / 5:.2f} |" in said
    assert "48 × 36" in said


def test_lights_without_one_set_of_positions_are_refused(scene):
    sun = ss.SunLight(azimuth=40, elevation=60)
    model = Measured("card", scene, sun, camera_above())
    with pytest.raises(ss.SceneError, match="neither a sphere nor a sun"):
        peers.beside(model, {}, peers.OURS, rounds=1, device="software")


def test_shipped_scenes_are_found_with_all_their_triangles():
    canopy = find("canopy", 16)
    assert canopy.camera.size == (16, 16)
    assert len(canopy.faces) == sum(len(mesh.faces) for mesh in canopy.scene.meshes) > 40_000
    assert canopy.faces.max() == len(canopy.vertices) - 1


@pytest.mark.parametrize("name", ["canopy", "hall"])
def test_positions_are_float32_about_the_center_of_the_bounds(name):
    model = find(name, 48)
    result = ss.visibility(model.scene, model.light, camera=model.camera, receivers=True, device="software")
    positions = result.positions[result.valid]
    about = model.stored(positions)
    assert np.abs(about + model.center - positions).max() < 1e-15 * np.abs(positions).max() * 4
    model.stored(ss.light_points(model.light, 16, scene=model.scene).positions)
    with pytest.raises(ss.SceneError, match="no float32 numbers"):
        model.stored(positions + 1e-10)


def test_a_technique_that_refuses_a_scene_is_named_and_the_others_go_on():
    techniques = [ss.DepthComplexity(samples=16, unit="edges"), ss.RayTraced(samples=4)]
    result = peers.beside(find("canopy", 48), {}, techniques, rounds=1, device="software")
    assert [row.tracer for row in result.rows] == ["ray_traced"]
    assert len(result.refused) == 1
    assert result.refused[0].startswith("canopy, depth_complexity, unit=edges with 16 samples: ")


def test_what_is_missing_is_named_and_counted(monkeypatch, capsys, tmp_path):
    monkeypatch.setenv("SOFTSHADOW_MESHES", str(tmp_path))
    monkeypatch.setattr(peers, "PEERS", {"Nobody": ("nobody", "Nobody", (16,))})
    assert peers.main([]) == 1
    said = capsys.readouterr().out
    assert said.startswith("2 skipped")
    assert "Nobody" in said
    assert "stanford-bunny.obj" in said


def test_models_stand_on_the_ground_in_float32(monkeypatch, tmp_path):
    (tmp_path / "box.obj").write_text("v 5 7 9\nv 7 7 9\nv 7 11 9\nv 5 11 10\nf 1 2 3\nf 1 3 4\n")
    monkeypatch.setenv("SOFTSHADOW_MESHES", str(tmp_path))
    model = find("box.obj", 8)
    # The same numbers as in the tests of `softshadow-bench`.
    expected = [[-0.25, -0.5, -0.125], [0.25, -0.5, -0.125], [0.25, 0.5, -0.125], [-0.25, 0.5, 0.125]]
    assert (model.vertices[:4] == np.float32(expected)).all()
    assert model.camera.size == (8, 8)
