"""The demonstration: ``python -m softshadow.demo`` renders a shipped scene, and the bunny where it is at hand.

For each it writes a picture, the visibility map as a 16-bit grey image and as numbers, and what made them, and prints
one line: adapter, technique, milliseconds, and the error against a reference with many more samples.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path

import numpy as np

from . import scenes
from .camera import Camera, look_at
from .comparison import compare
from .device import context, quiet_driver
from .lights import Light, RectLight
from .logs import adapter_words
from .picture import render
from .scene import Mesh, Scene
from .techniques import DepthComplexity, HardShadowMap, RayTraced, Technique
from .visibility import visibility

_TECHNIQUE = DepthComplexity(samples=64)
_BESIDE: list[Technique] = [RayTraced(samples=64), HardShadowMap()]
_REFERENCE = RayTraced(samples=1024, pattern="low_discrepancy", seed=1)


def main() -> int:
    """Renders into the folder given by ``--output``; the exit code is 0."""
    quiet_driver()
    parser = argparse.ArgumentParser(prog="softshadow.demo", description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--output", type=Path, default=Path("demo"))
    parser.add_argument("--device", default="auto")
    chosen = parser.parse_args()
    chosen.output.mkdir(parents=True, exist_ok=True)
    hall = scenes.load("hall")
    _show("hall", hall.scene, hall.light, hall.camera, chosen.output, chosen.device)
    path = bunny_path()
    if path is None:
        print("bunny: not found; set SOFTSHADOW_MESHES to a folder with stanford-bunny.obj to see it too")
    else:
        _show("bunny", *bunny(path), chosen.output, chosen.device)
    return 0


def bunny_path() -> Path | None:
    """The Stanford bunny in ``SOFTSHADOW_MESHES`` or ``../shared/meshes``, or None."""
    folders = (os.environ.get("SOFTSHADOW_MESHES"), "../shared/meshes")
    paths = (Path(folder) / "stanford-bunny.obj" for folder in folders if folder)
    return next((path for path in paths if path.is_file()), None)


def bunny(path: Path, size: tuple[int, int] = (512, 512)) -> tuple[Scene, Light, Camera]:
    """A mesh of height 1 on a ground of 6 by 6 under a light as large as itself."""
    mesh = Scene.load(path).meshes[0]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    ground = np.array([[-3.0, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]])
    scene = Scene(
        [
            Mesh(name="bunny", vertices=(mesh.vertices - foot) / (high[1] - low[1]), faces=mesh.faces),
            Mesh(name="ground", vertices=ground, faces=np.array([[0, 2, 1], [0, 3, 2]])),
        ]
    )
    light = RectLight(
        width=1.0, height=1.0, world_from_light=look_at((1.5, 3.5, 1.0), (0, 0.3, 0)), radiance=(18, 17, 16)
    )
    return scene, light, Camera.look_at(eye=(2.2, 1.9, 3.0), target=(0, 0.4, 0), fov_y_deg=40, size=size)


def _show(name: str, scene: Scene, light: Light, camera: Camera, folder: Path, device: str) -> None:
    picture = render(scene, light, camera=camera, technique=_TECHNIQUE, device=device)
    picture.save(folder / f"{name}.png")
    result = visibility(scene, light, camera=camera, technique=_TECHNIQUE, device=device)
    result.save(folder / f"{name}_visibility.png")
    result.save(folder / f"{name}_visibility.npy")
    table = compare(
        scene,
        light,
        camera=camera,
        techniques=[_TECHNIQUE, *_beside(device)],
        reference=_REFERENCE,
        repeats=3,
        device=device,
    )
    info = {"visibility": result.info, "comparison": json.loads(table.to_json())}
    (folder / f"{name}_info.json").write_text(json.dumps(info, indent=2))
    print(f"{name}: {adapter_words(result.info['adapter'])}")
    for row in table.rows:
        settings, error = row["technique"], row["penumbra"]["rmse"] if row["penumbra"] else float("nan")
        words = settings["name"] + (f" with {settings['samples']} samples" if "samples" in settings else "")
        print(f"  {words}: {row['median_ms']:.0f} ms, RMSE {error:.4f} in the penumbra", end="")
        print(f" against {_REFERENCE.samples} samples")
    print(
        f"  picture {folder / f'{name}.png'}, visibility {folder / f'{name}_visibility.png'} and .npy, "
        f"numbers {folder / f'{name}_info.json'}"
    )


def _beside(device: str) -> list[Technique]:
    """What else is shown: a hard shadow map where the device can draw it."""
    draws = json.loads(context(device).adapter)["device_type"] != "native"
    return [technique for technique in _BESIDE if draws or not isinstance(technique, HardShadowMap)]


if __name__ == "__main__":
    sys.exit(main())
