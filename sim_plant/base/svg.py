"""A figure as it stands in a page that loads nothing."""

from __future__ import annotations

import io

import matplotlib as mpl
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from aff_runtime.base.printable import printable

# matplotlib takes a matplotlibrc of the working folder first, so of whoever sent what lies there:
# it may have every word set by TeX, a program that reads files.
mpl.rcdefaults()

_LONGEST_WORD = 80
_SALT = "reproduce"  # any fixed text: identities in the figure come from what is drawn


def as_written(text: str) -> str:
    """Return a word from a file as a figure shows it: on one line, and ``$`` starts no formula."""
    return printable(text, _LONGEST_WORD).replace("$", r"\$")


def svg(figure: Figure, *, tight: bool = True, letters: bool = False) -> str:
    """Return a figure as an SVG element without its XML header, the same for the same data.

    Parameters
    ----------
    tight : cut the figure down to what is drawn, else it keeps its size.
    letters : text stays text, in the reader's own font, else it is drawn as outlines.
    """
    text = io.StringIO()
    FigureCanvasSVG(figure)
    kind, box = "none" if letters else "path", "tight" if tight else None
    with mpl.rc_context({"svg.hashsalt": _SALT, "svg.fonttype": kind}):
        figure.savefig(text, format="svg", metadata={"Date": None}, bbox_inches=box)
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]
