"""Cards and evidence for tests."""

from aff_runtime.app.card.book import CardBook
from aff_runtime.app.card.entries import (
    BEGUN,
    MEASURED,
    SIGNED,
    Begun,
    Inputs,
    Measured,
    Signed,
    as_plain,
)
from aff_runtime.app.card.figures import Figure, StepResult

UTC = "2026-01-02T03:04:05.000+00:00"
BEGUN_OF = Begun(
    line="Euclid",
    site="/etc/aff-runtime/site.yaml",
    site_sha256="1" * 64,
    site_hash="2" * 64,
    release="0.0.0 (commit abc)",
    machine="Linux 6 x86_64",
)
INPUTS = Inputs(
    site_hash="2" * 64,
    config_hash="3" * 64,
    plc="7",
    roll_id="4",
    responses={"unwind": "5" * 64},
    machine="Linux 6 x86_64, 4 processors",
)
GOOD = Figure(
    name="wake-up", value=120.0, unit="us", low=110.0, high=130.0, limit="at most 500", good=True
)
BAD = Figure(name="wake-up", value=620.0, unit="us", limit="at most 500", good=False)


def book(folder):
    """Return a card that is begun."""
    found = CardBook(folder, now=lambda: UTC)
    found.begin(BEGUN, as_plain(BEGUN_OF))
    return found


def measured(step=0, figures=(GOOD,), inputs=INPUTS, **result):
    """Return a measurement."""
    what = StepResult(figures=tuple(figures), **result)
    return Measured(step=step, verdict=what.verdict, result=what, inputs=inputs, by="root")


def add(book, said):
    """Put an entry on a card; return its hash."""
    return book.add(MEASURED if isinstance(said, Measured) else SIGNED, as_plain(said))


def signed(step, digest, name="Ada Miller"):
    """Return a signature."""
    return Signed(step=step, measured=digest, name=name, reason="seen on the drive", by="root")
