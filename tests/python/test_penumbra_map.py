"""Penumbra maps from Python: soft outside of the hard shadow, by the ramp that was asked for, and with notes."""

from __future__ import annotations

import numpy as np

import softshadow as ss
from softshadow.gallery import props

LIGHT = ss.RectLight(width=1, height=1, world_from_light=ss.look_at((0, 4, 0), (0, 0, 0), up=(0, 0, 1)))
# A plate half way up that ends at x = 0: half of its penumbra is as wide as half of the light.
SCENE = ss.Scene(
    [props.floor(6), props.quads("plate", [[-3, 2, -3], [-3, 2, 3], [0, 2, 3], [0, 2, -3]], (0.5, 0.5, 0.5))]
)
SHARES = np.linspace(-0.95, 0.95, 60)
POINTS = np.stack([0.5 * SHARES, np.zeros(60), np.full(60, 0.01)], axis=1)


def seen(technique: ss.PenumbraMap, points: np.ndarray = POINTS) -> ss.Visibility:
    normals = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    return ss.visibility(SCENE, LIGHT, points=points, normals=normals, technique=technique, device="software")


def test_half_of_the_penumbra_is_there_and_half_is_dark():
    result = seen(ss.PenumbraMap(resolution=2048))
    np.testing.assert_allclose(result.values, np.maximum(SHARES, 0), atol=0.01)
    assert result.info["technique"] == {"name": "penumbra_map", "resolution": 2048, "ramp": "light"}
    assert result.standard_error is None
    assert result.info["notes"] == []
    assert "list silhouettes" in result.info["plan"]


def test_the_paper_s_ramp_is_its_own():
    shares = np.maximum(SHARES, 0)
    intensity = shares / (2 - shares)
    paper = seen(ss.PenumbraMap(resolution=2048, ramp="paper")).values
    np.testing.assert_allclose(paper, intensity**2 * (3 - 2 * intensity), atol=0.01)
    assert np.abs(paper - seen(ss.PenumbraMap(resolution=2048, ramp="linear")).values).max() > 0.2


def test_points_in_mid_air_are_counted():
    result = seen(ss.PenumbraMap(resolution=256), np.array([[1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]))
    assert result.info["notes"] == ["1 receivers are not on what penumbra_map shows there, and lit"]
