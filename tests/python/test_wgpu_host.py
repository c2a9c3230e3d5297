"""The host on wgpu-py: the bits of the library's own engine, on a device that is ours."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import softshadow as ss

wgpu = pytest.importorskip("wgpu", reason="wgpu-py is not installed: its host is not tested")
import softshadow.wgpu as host_package  # noqa: E402
from softshadow.techniques import TECHNIQUES  # noqa: E402
from softshadow.wgpu import Host  # noqa: E402

SIZE = (42, 31)
LAMP = ss.look_at((0.3, 3.5, 0.4), (0, 0, 0))
LIGHTS = {
    "rectangle": ss.RectLight(width=1.0, height=0.6, world_from_light=LAMP),
    "disc": ss.DiscLight(radius=0.5, world_from_light=LAMP),
    "sphere": ss.SphereLight(radius=0.4, world_from_light=LAMP),
    "polygon": ss.PolygonLight(outline=[(0, 0), (1, 0), (1, 1), (0.6, 0.3)], world_from_light=LAMP),
    "sun": ss.SunLight(140, 50, diameter_deg=4),
    "textured": ss.RectLight(
        width=1.0, height=0.6, world_from_light=LAMP, texture=np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    ),
}
BLENDED = ss.DepthComplexity(samples=16, evaluation="blended")
FLOAT = replace(BLENDED, counters="float")
# Every technique there is, by its defaults, and what else asks for other kinds of passes.
VARIANTS = [
    *(kind() for kind in TECHNIQUES.values()),
    ss.RayTraced(samples=16, passes=2, probes=4),
    ss.RayTraced(samples=9, spread="interleaved", tile=3),
    ss.DepthComplexity(samples=16, spread="decorrelated"),
    ss.DepthComplexity(samples=16, unit="triangles"),
    BLENDED,
    FLOAT,
]


def new_device(features: tuple[str, ...] = (), limits: dict[str, int] | None = None):
    """A device of the adapter that the library calls "software"."""
    found = [a for a in wgpu.gpu.enumerate_adapters_sync() if (a.info["backend_type"], a.info["adapter_type"]) == KIND]
    if not found:
        assert "SOFTSHADOW_EXPECT_ADAPTER" not in os.environ, "an adapter is expected, but there is none"
        pytest.skip("no software Vulkan adapter: the wgpu-py host is not tested")
    return found[0].request_device_sync(required_features=list(features), required_limits=limits or {})


KIND = ("Vulkan", "CPU")


@pytest.fixture(scope="module")
def host() -> Host:
    return Host(new_device(("float32-blendable",)))


@pytest.fixture(scope="module")
def hall():
    return ss.scenes.load("toruses")


def ours(scene, lights, technique, standard_error=True, **where):
    return ss.visibility(scene, lights, technique=technique, device="software", standard_error=standard_error, **where)


def same_bits(mine: np.ndarray, theirs: np.ndarray, valid: np.ndarray) -> bool:
    return mine.shape == theirs.shape and np.array_equal(
        mine[..., valid].view(np.uint32), theirs[..., valid].view(np.uint32)
    )


def named(technique: ss.Technique) -> str:
    changed = {k: v for k, v in vars(technique).items() if v != getattr(type(technique), k)}
    return technique.name + "".join(f",{k}={v}" for k, v in changed.items())


@pytest.mark.parametrize("technique", VARIANTS, ids=named)
def test_every_technique_gives_the_bits_of_the_own_engine(host, hall, technique):
    camera = replace(hall.camera, size=SIZE)
    other = ss.DiscLight(radius=0.7, world_from_light=ss.look_at((2.0, 4.0, 2.0), (0, 0, 0)))
    lights = [hall.light, other]
    wanted = ours(hall.scene, lights, technique, camera=camera)
    seen = host.visibility(hall.scene, lights, camera=camera, technique=technique, standard_error=True)
    assert seen.shape == wanted.values.shape == (2, *SIZE[::-1])
    assert same_bits(wanted.values, seen.read(), wanted.valid)
    # A result that is a pixel off is seen.
    assert not same_bits(wanted.values, np.roll(seen.read(), 1, axis=-1), wanted.valid)
    assert (seen.standard_error is None) == (wanted.standard_error is None)
    if seen.standard_error is not None:
        error = np.frombuffer(seen.device.queue.read_buffer(seen.standard_error), np.float32).reshape(seen.shape)
        assert same_bits(wanted.standard_error, error, wanted.valid)
    for name in ("technique", "lights", "receivers", "blocks", "plan", "silhouette_edges", "traced_receivers", "bytes"):
        assert seen.info[name] == wanted.info[name], name
    assert seen.info["adapter"]["backend"] == "vulkan"
    assert seen.info["valid_receivers"] is None


@pytest.mark.parametrize("shape", LIGHTS)
@pytest.mark.parametrize(
    "technique", [ss.RayTraced(samples=16), ss.HardShadowMap(resolution=128), ss.DepthComplexity(samples=16)], ids=named
)
def test_every_shape_of_light_on_points(host, hall, technique, shape):
    random = np.random.default_rng(3)
    low, high = np.array(hall.scene.bounds)
    points = random.uniform(low, high, (700, 3))
    normals = random.normal(size=(700, 3))
    where = {"points": points, "normals": normals}
    wanted = ours(hall.scene, LIGHTS[shape], technique, **where)
    seen = host.visibility(hall.scene, LIGHTS[shape], **where, technique=technique)
    assert np.array_equal(seen.read().view(np.uint32), wanted.values.view(np.uint32))
    assert seen.shape == ((700, 3) if shape == "textured" else (700,))


def test_semi_opaque_scenes_and_blocks(host):
    cards = ss.scenes.load("cards")
    camera = replace(cards.camera, size=SIZE)
    for technique in (ss.RayTraced(samples=16), ss.DepthComplexity(samples=16)):
        wanted = ours(cards.scene, cards.light, technique, camera=camera)
        whole = host.visibility(cards.scene, cards.light, camera=camera, technique=technique)
        blocks = host.visibility(cards.scene, cards.light, camera=camera, technique=technique, memory_limit=50_000)
        assert whole.info["blocks"] == 1
        assert blocks.info["blocks"] > 2
        for seen in (whole, blocks):
            assert same_bits(wanted.values, seen.read(), wanted.valid)


def test_nothing_to_see(host, hall):
    empty = host.visibility(hall.scene, hall.light, points=np.empty((0, 3)))
    assert empty.read().shape == (0,)
    assert host.visibility(ss.Scene(), hall.light, camera=replace(hall.camera, size=(8, 4))).shape == (4, 8)
    assert host.visibility(ss.Scene(), hall.light, points=[[0.0, 0, 0]]).read().tolist() == [1.0]


def test_values_stay_on_the_device(host, hall, monkeypatch):
    read = []
    true_read = wgpu.GPUBuffer.read_mapped

    def counted(self, offset, size, **options):
        read.append(size)
        return true_read(self, offset, size, **options)

    monkeypatch.setattr(wgpu.GPUBuffer, "read_mapped", counted)
    for technique in (ss.RayTraced(), ss.HardShadowMap(), ss.DepthComplexity(), BLENDED):
        read.clear()
        seen = host.visibility(hall.scene, hall.light, camera=replace(hall.camera, size=(64, 48)), technique=technique)
        assert sum(read) <= 256, named(technique)
        assert seen.buffer.size == 4 * 64 * 48


@pytest.mark.parametrize("size", [SIZE, (64, 40)])
def test_textures_hold_images_row_by_row(host, hall, size):
    camera, other = replace(hall.camera, size=size), LIGHTS["sphere"]
    seen = host.visibility(hall.scene, [hall.light, other], camera=camera, technique=ss.HardShadowMap())
    usage = wgpu.TextureUsage.COPY_DST | wgpu.TextureUsage.COPY_SRC

    def texture(texels="r32float", size=size):
        return host.device.create_texture(size=(*size, 1), format=texels, usage=usage)

    for light in range(2):
        made = texture()
        seen.copy_to_texture(made, light)
        stride = -(-4 * size[0] // 256) * 256
        data = host.device.queue.read_texture({"texture": made}, {"bytes_per_row": stride}, (*size, 1))
        rows = np.frombuffer(data, np.float32).reshape(size[1], -1)[:, : size[0]]
        np.testing.assert_array_equal(rows, seen.read()[light])
    assert not np.array_equal(*seen.read())
    for bad, words in ((texture("r32uint"), "r32uint"), (texture(size=size[::-1]), f"{size[0]} × {size[1]} expected")):
        with pytest.raises(ss.SettingsError, match=words):
            seen.copy_to_texture(bad)
    with pytest.raises(ss.SettingsError, match="light: 0 to 1 expected, got 2"):
        seen.copy_to_texture(texture(), light=2)
    coloured = host.visibility(hall.scene, LIGHTS["textured"], camera=camera)
    with pytest.raises(ss.SettingsError, match="coloured"):
        coloured.copy_to_texture(texture())


def test_a_buffer_of_the_callers(host, hall):
    camera = replace(hall.camera, size=SIZE)
    call = {"camera": camera, "technique": ss.HardShadowMap()}
    fresh = host.visibility(hall.scene, hall.light, **call)

    def buffer(size, usage=wgpu.BufferUsage.COPY_DST | wgpu.BufferUsage.COPY_SRC):
        return host.device.create_buffer(size=size, usage=usage)

    mine = buffer(fresh.buffer.size + 100)
    seen = host.visibility(hall.scene, hall.light, **call, into=mine)
    assert seen.buffer is mine
    np.testing.assert_array_equal(seen.read(), fresh.read())
    for bad in (buffer(fresh.buffer.size - 4), buffer(1 << 20, wgpu.BufferUsage.STORAGE), 3):
        with pytest.raises(ss.SettingsError, match="into"):
            host.visibility(hall.scene, hall.light, **call, into=bad)


class Spoilt:
    """A call whose first stage is altered."""

    def __init__(self, call, alter):
        self._call, self._alter = call, alter

    def __getattr__(self, name):
        return getattr(self._call, name)

    def stage(self, index, decision):
        made = self._call.stage(index, decision)
        return made and {**made, "description": self._alter(made["description"])}


def spoil(monkeypatch, host, alter):
    """Alters the next call's stages."""

    class Foreign:
        def __init__(self, true):
            self.true = true

        def visibility(self, *args, **options):
            monkeypatch.undo()
            return Spoilt(self.true.visibility(*args, **options), alter)

    monkeypatch.setattr(host, "_foreign", Foreign(host._foreign))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"binding":1,', '"binding":19,'),
        ('"name":"receivers","binding"', '"name":"receivers","is_array":false,"binding":0,"was"'),
        ('"entry":"look_up"', '"entry":"look_down"'),
    ],
    ids=["binding", "twice", "kernel"],
)
def test_wrong_bindings_are_typed_and_the_next_call_works(host, hall, monkeypatch, old, new):
    call = {"camera": replace(hall.camera, size=SIZE), "technique": ss.HardShadowMap(resolution=64)}
    wanted = host.visibility(hall.scene, hall.light, **call).read()

    def alter(description):
        assert old in description
        return description.replace(old, new)

    spoil(monkeypatch, host, alter)
    with pytest.raises(ss.GpuError, match="the device refuses"):
        host.visibility(hall.scene, hall.light, **call)
    np.testing.assert_array_equal(host.visibility(hall.scene, hall.light, **call).read(), wanted)


def test_a_missing_feature_is_typed_before_anything_is_made(hall):
    plain = Host(new_device())
    call = {"camera": replace(hall.camera, size=SIZE)}
    with pytest.raises(ss.SettingsError, match="'float' needs float32-blendable, which this device lacks; use 'words'"):
        plain.visibility(hall.scene, hall.light, **call, technique=FLOAT)
    wanted = ours(hall.scene, hall.light, BLENDED, **call)
    assert same_bits(
        wanted.values, plain.visibility(hall.scene, hall.light, **call, technique=BLENDED).read(), wanted.valid
    )


def test_low_limits_are_typed_or_served(hall):
    low = Host(new_device((), {"max-storage-buffer-binding-size": 1 << 20, "max-texture-dimension-2d": 256}))
    technique = ss.RayTraced(samples=16)
    with pytest.raises(ss.TooLargeError, match="pixels of the image's longer side: 300 needed, at most 256 possible"):
        low.visibility(hall.scene, hall.light, camera=replace(hall.camera, size=(300, 20)), technique=technique)
    with pytest.raises(ss.TooLargeError, match="512 needed, at most 256"):
        low.visibility(
            hall.scene, hall.light, camera=replace(hall.camera, size=SIZE), technique=ss.HardShadowMap(resolution=512)
        )
    # More receivers than a binding holds are blocks of them.
    camera = replace(hall.camera, size=(250, 250))
    wanted = ours(hall.scene, hall.light, technique, camera=camera)
    seen = low.visibility(hall.scene, hall.light, camera=camera, technique=technique)
    assert seen.info["blocks"] > wanted.info["blocks"]
    assert same_bits(wanted.values, seen.read(), wanted.valid)


def test_a_lost_device_is_typed_and_another_one_works(host, hall):
    call = {"camera": replace(hall.camera, size=SIZE), "technique": ss.HardShadowMap(resolution=64)}
    lost = Host(new_device())
    seen = lost.visibility(hall.scene, hall.light, **call)
    lost.device.destroy()
    for _ in range(2):
        with pytest.raises(ss.GpuError, match="the device was lost while running 'visibility'"):
            lost.visibility(hall.scene, hall.light, **call)
    with pytest.raises(ss.GpuError, match="lost while running 'read'"):
        seen.read()
    assert host.visibility(hall.scene, hall.light, **call).read().shape == SIZE[::-1]


def test_what_a_technique_cannot_finish_is_an_error_here_too(host):
    # Foliage is too dense for silhouette edges.
    canopy = ss.scenes.load("canopy")
    call = {"camera": replace(canopy.camera, size=(32, 32)), "technique": ss.DepthComplexity(samples=16, unit="edges")}
    with pytest.raises(ss.GpuError) as ours_said:
        ours(canopy.scene, canopy.light, call["technique"], camera=call["camera"])
    with pytest.raises(ss.GpuError) as theirs:
        host.visibility(canopy.scene, canopy.light, **call)
    # How many find no room depends on who comes first.
    assert str(ours_said.value).partition(" ")[2] == str(theirs.value).partition(" ")[2]
    assert "use depth_complexity with unit triangles" in str(theirs.value)


def test_scenes_that_move_leave_nothing_behind(host, hall):
    call = {"camera": replace(hall.camera, size=(16, 12)), "technique": ss.DepthComplexity(samples=16)}
    scene = hall.scene
    sizes = []
    for frame in range(12):
        scene = scene.with_vertices([mesh.vertices + [0, 0.001 * (frame + 1), 0] for mesh in scene.meshes])
        seen = host.visibility(scene, hall.light, **call)
        sizes.append(len(host._interpreter.pool._slots))
        assert seen.info["scene_refits"] + seen.info["scene_builds"] == 1
    assert len(set(sizes[3:])) == 1


def test_arguments(host, hall):
    with pytest.raises(ss.SettingsError, match=r"device: a wgpu\.GPUDevice expected, got str"):
        Host("gpu")
    with pytest.raises(ss.SceneError, match="receivers: give either a camera or points"):
        host.visibility(hall.scene, hall.light)
    with pytest.raises(ss.SettingsError, match="technique: an instance of"):
        host.visibility(hall.scene, hall.light, points=[[0, 0, 0]], technique="ray_traced")


def test_the_interpreter_names_no_technique():
    words = [word for name, kind in TECHNIQUES.items() for word in (name, kind.__name__)]
    folder = Path(host_package.__file__).parent
    sources = {path.name: path.read_text() for path in folder.glob("*.py")}
    assert {"encode.py", "pipelines.py", "pool.py", "run.py"} < set(sources)
    for name, text in sources.items():
        # The default of the public function is the library's.
        if name != "host.py":
            assert not [word for word in words if word in text], name
    assert "hard_shadow_map" in words
