"""Reports of comparisons: a page that stands alone, all numbers as JSON, and the fronts as PNG."""

from .lines import read_lines
from .report import Report

__all__ = ["Report", "read_lines"]
