"""The gallery: what soft shadows and this library's techniques look like, side by side and with measured numbers.

``python -m softshadow.gallery --output gallery`` makes all exhibits, after the figures of Forest, Barthe and Paulin
2008, and of Wyman and Hansen 2003. An exhibit is a function from a :class:`Studio`, which says how large pictures are
and how good references, to an :class:`Exhibit`.
"""

from .exhibit import Exhibit, Panel
from .lamps import shapes, textures
from .matter import counters, foliage, glass
from .penumbra import concavities, penumbrae
from .samples import areas, silhouettes, spreads
from .studio import Studio

EXHIBITS = (silhouettes, spreads, textures, glass, areas, counters, shapes, foliage, penumbrae, concavities)
"""All exhibits in the order in which they hang."""

__all__ = ["EXHIBITS", "Exhibit", "Panel", "Studio"]
