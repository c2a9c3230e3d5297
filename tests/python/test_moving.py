"""Scenes that move: the values are those of a scene made anew, and the last frame's work is used again."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import softshadow as ss
from conftest import CARD, light_above, visibility

PREPARED = ("scene_builds", "scene_refits", "occluder_builds", "occluder_refits")


def prepared(result: ss.Visibility) -> list[int]:
    return [result.info[name] for name in PREPARED]


@pytest.mark.parametrize("technique", [ss.RayTraced(samples=64), ss.DepthComplexity(samples=64)])
def test_frames_have_the_values_of_scenes_made_anew(scene, floor_points, technique):
    by_edges = int(technique == ss.DepthComplexity(samples=64))
    seen = []
    for frame in range(4):
        # A turning card: the order of its corners by position changes, too.
        sine, cosine = np.sin(0.7 * frame), np.cos(0.7 * frame)
        turned = CARD @ [[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]
        moved = scene if frame == 0 else scene.with_vertices([None, turned])
        result = visibility(moved, light_above(), points=floor_points, technique=technique)
        made = [1, 0, by_edges, 0] if frame == 0 else [0, 1, 0, by_edges]
        assert prepared(result) == made
        assert result.info["rebuild_reasons"] == []
        anew = visibility(ss.Scene(moved.meshes), light_above(), points=floor_points, technique=technique)
        np.testing.assert_array_equal(result.values, anew.values)
        seen.append(result.values)
    assert not np.array_equal(seen[0], seen[3])
    assert moved.meshes[0] == scene.meshes[0]
    assert moved.notes == scene.notes
    again = visibility(moved, light_above(), points=floor_points, technique=technique)
    assert prepared(again) == [0, 0, 0, 0]


def test_a_frame_that_cannot_be_refitted_says_why(scene, floor_points):
    visibility(scene, light_above(), points=floor_points)
    line = scene.with_vertices([None, CARD * [1, 1, 0]])
    result = visibility(line, light_above(), points=floor_points)
    assert prepared(result)[:2] == [1, 0]
    assert result.info["rebuild_reasons"] == ["scene: triangles lost or gained their area"]
    assert result.info["zero_area_triangles"] == 2
    assert result.info["preparation_ms"] > 0


def test_a_light_that_moves_before_the_scene_makes_nothing(scene, floor_points):
    def seen(height: float) -> ss.Visibility:
        light = ss.RectLight(width=1, height=1, world_from_light=ss.look_at((0.2, height, 0), (0, 0, 0)))
        return visibility(scene, light, points=floor_points, technique=ss.DepthComplexity(samples=64))

    assert prepared(seen(3)) == [1, 0, 1, 0]
    assert prepared(seen(2.5)) == [0, 0, 0, 0]
    assert not np.array_equal(seen(3).values, seen(2.5).values)


def test_bad_vertices_are_named(scene):
    endless = CARD.copy()
    endless[2, 1] = np.inf
    for vertices, words in (
        (CARD, "one array or None a mesh"),
        (3, "one array or None a mesh"),
        ([None], "1 entries given, but there are 2 meshes"),
        ([None, CARD[:3]], "mesh 'card': 3 moved vertices given"),
        ([None, endless], "mesh 'card' vertices: entry 2 is not finite"),
        ([None, CARD[:, :2]], "vertices of mesh 1"),
        ([CARD.astype(str), None], "vertices of mesh 0"),
    ):
        with pytest.raises(ss.SceneError, match=words):
            scene.with_vertices(vertices)


def test_the_callers_arrays_are_copied_and_frames_can_be_pickled(scene):
    place = CARD + 1.0
    moved = scene.with_vertices(iter([None, place]))
    place[:] = 0.0
    np.testing.assert_array_equal(moved.meshes[1].vertices, CARD + 1.0)
    assert pickle.loads(pickle.dumps(moved)).meshes == moved.meshes
