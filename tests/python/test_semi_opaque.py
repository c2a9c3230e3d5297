"""Opacity from arrays, meshes, trimesh and glTF, and what passes of the light."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import trimesh

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, light_above, visibility

UNDER = np.array([[0.0, 0.2, 0.0]])
SHEET = CARD * [8, 1, 8]
SAMPLED = [ss.RayTraced(samples=16), ss.DepthComplexity(samples=16)]


def passed(scene: ss.Scene, technique: ss.Technique) -> float:
    return float(visibility(scene, light_above(), points=UNDER, technique=technique).values[0])


def sheets(*opacities: float) -> ss.Scene:
    above = [SHEET + [0, 0.1 * index, 0] for index in range(len(opacities))]
    pairs = zip(above, opacities, strict=True)
    return ss.Scene([ss.Mesh(vertices=v, faces=SQUARE, opacity=o) for v, o in pairs])


@pytest.mark.parametrize("technique", SAMPLED)
def test_sheets_multiply(technique):
    assert passed(sheets(0.5), technique) == 0.5
    assert passed(sheets(0.5, 0.5), technique) == 0.25
    assert passed(sheets(0.5, 0.2, 0.75), technique) == pytest.approx(0.1, rel=1e-4)
    assert passed(sheets(0.5, 1.0), technique) == 0
    assert passed(sheets(0.0), technique) == 1


def test_the_sum_of_the_paper_is_right_for_one_sheet():
    plain = ss.DepthComplexity(samples=16, attenuation="sum")
    assert plain != ss.DepthComplexity(samples=16)
    assert passed(sheets(0.3), plain) == pytest.approx(0.7, abs=1e-4)
    assert passed(sheets(0.5, 0.5), plain) == 0
    with pytest.raises(ss.SettingsError, match="logarithmic"):
        ss.DepthComplexity(attenuation="product")


@pytest.mark.parametrize("technique", SAMPLED)
def test_every_triangle_may_have_its_own(technique):
    # Two halves of a sheet along its diagonal, and points under each.
    scene = ss.Scene.from_arrays(SHEET, SQUARE, opacity=[0.25, 0.75])
    points = np.array([[1.5, 0.2, -1.5], [-1.5, 0.2, 1.5]])
    values = visibility(scene, light_above(), points=points, technique=technique).values
    np.testing.assert_allclose(values, [0.75, 0.25], rtol=1e-4)
    assert scene.meshes[0].opacity.tolist() == [0.25, 0.75]
    (mesh,) = scene.meshes
    assert not mesh.opacity.flags.writeable
    again = pickle.loads(pickle.dumps(scene))
    np.testing.assert_array_equal(visibility(again, light_above(), points=points, technique=technique).values, values)


def test_masks_notes_and_counts_say_what_became_of_it():
    scene = sheets(0.5)
    for technique in SAMPLED:
        result = visibility(scene, light_above(), points=UNDER, technique=technique, sample_masks=True)
        assert result.visible_samples.all()
        assert result.info["notes"] == []
    mapped = visibility(scene, light_above(), points=UNDER, technique=ss.HardShadowMap())
    assert mapped.values == [0]
    assert "2 semi-opaque triangles taken for opaque" in mapped.info["notes"][0]
    hidden = visibility(sheets(0.0, 1.0), light_above(), points=UNDER)
    assert hidden.info["invisible_triangles"] == 2


def test_opacity_is_read_from_what_blends(tmp_path):
    def mesh(**settings: object) -> trimesh.Trimesh:
        material = trimesh.visual.material.PBRMaterial(baseColorFactor=[51, 102, 255, 51], **settings)
        visual = trimesh.visual.TextureVisuals(uv=np.zeros((4, 2)), material=material)
        return trimesh.Trimesh(FLOOR, SQUARE, process=False, visual=visual)

    for settings, opacity in ({"alphaMode": "BLEND"}, 0.2), ({"alphaMode": "OPAQUE"}, 1.0), ({}, 1.0):
        source = mesh(**settings)
        source.export(tmp_path / "scene.glb")
        for scene in ss.Scene.from_trimesh(source), ss.Scene.load(tmp_path / "scene.glb"):
            assert scene.meshes[0].opacity == pytest.approx(opacity)
            assert not any("alpha" in note for note in scene.notes)
    source = mesh(alphaMode="MASK")
    source.export(tmp_path / "scene.glb")
    for scene in ss.Scene.from_trimesh(source), ss.Scene.load(tmp_path / "scene.glb"):
        assert scene.meshes[0].opacity == 1
    assert any("alpha masks left out" in note for note in scene.notes)
