"""The gallery: what soft shadows and this library's techniques look like, side by side and with measured numbers.

``python -m softshadow.gallery --output gallery`` makes all exhibits, after the figures of Forest, Barthe and Paulin
2008, and of Mo, Popescu and Wyman 2007. An exhibit is a function from a :class:`Studio`, which says how large pictures
are and how good references, to an :class:`Exhibit`.
"""

from .exhibit import Exhibit, Panel
from .lamps import shapes, textures
from .maps import concavities, growing, stairs
from .matter import counters, foliage, glass
from .samples import areas, silhouettes, spreads
from .studio import Studio

EXHIBITS = (silhouettes, spreads, textures, glass, areas, counters, shapes, foliage, growing, concavities, stairs)
"""All exhibits in the order in which they hang."""

__all__ = ["EXHIBITS", "Exhibit", "Panel", "Studio"]
