"""The gallery: what soft shadows and this library's techniques look like, side by side and with measured numbers.

``python -m softshadow.gallery --output gallery`` makes all exhibits, after the figures of Forest, Barthe and Paulin
2008. An exhibit is a function from a :class:`Studio`, which says how large pictures are and how good references, to an
:class:`Exhibit`.
"""

from collections.abc import Callable
from importlib.util import find_spec

from .exhibit import Exhibit, Panel
from .lamps import shapes, textures
from .matter import counters, foliage, glass
from .samples import areas, silhouettes, spreads
from .studio import Studio

EXHIBITS: tuple[Callable[[Studio], Exhibit], ...] = (
    silhouettes,
    spreads,
    textures,
    glass,
    areas,
    counters,
    shapes,
    foliage,
)
"""All exhibits in the order in which they hang; `guests` only where pygfx is installed."""

if find_spec("pygfx") is not None:
    from .guests import guests

    EXHIBITS = (*EXHIBITS, guests)

__all__ = ["EXHIBITS", "Exhibit", "Panel", "Studio"]
