"""Visibility on a device of your own: a ``wgpu.GPUDevice`` of wgpu-py, and so of whatever draws with it.

>>> import wgpu
>>> import softshadow as ss
>>> from softshadow.wgpu import Host
>>> device = wgpu.gpu.request_adapter_sync().request_device_sync()  # doctest: +SKIP
>>> hall = ss.scenes.load("hall")
>>> result = Host(device).visibility(hall.scene, hall.light, camera=hall.camera)  # doctest: +SKIP
>>> result.buffer  # doctest: +SKIP
<wgpu.backends.wgpu_native.GPUBuffer ...>

Techniques write plans and this host runs them: it knows no technique, as the library's own engine knows none. Needs
``pip install softshadow[wgpu]``.
"""

from .host import DeviceVisibility, Host

__all__ = ["DeviceVisibility", "Host"]
