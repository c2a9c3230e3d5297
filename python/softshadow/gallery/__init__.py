"""The gallery: what soft shadows and this library's techniques look like, side by side and with measured numbers.

``softshadow gallery --output gallery`` makes all exhibits, after the figures of Forest, Barthe and Paulin 2008, of
Wyman and Hansen 2003, and of Mo, Popescu and Wyman 2007. An exhibit is a function from a :class:`Studio`, which says
how large pictures are and how good references, to an :class:`Exhibit`.
"""

from .exhibit import Exhibit, Panel
from .pages import EXHIBITS, make
from .studio import Studio

__all__ = ["EXHIBITS", "Exhibit", "Panel", "Studio", "make"]
