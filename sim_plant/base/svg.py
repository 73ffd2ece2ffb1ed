"""A figure as it stands in a page that loads nothing."""

from __future__ import annotations

import io

from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure


def svg(figure: Figure) -> str:
    """Return a figure as an SVG element without its XML header."""
    text = io.StringIO()
    FigureCanvasSVG(figure)
    figure.savefig(text, format="svg", bbox_inches="tight")
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]
