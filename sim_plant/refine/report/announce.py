"""What is said before the work begins: what cannot be claimed, and what is odd about records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from sim_plant.refine.records.recording import Recording


def holdout_caveats(held: Sequence[Recording]) -> list[str]:
    """Return what the number of held-out records keeps from being claimed, as sentences."""
    if not held:
        return ["no held-out record: the error after is that of the record fitted"]
    if len(held) > 1:
        return [f"more than one held-out record: the errors are those of {held[0].path.name}"]
    return []


def shared_angle(fitted: Sequence[Recording]) -> list[str]:
    """Return what several fitted records keep from being claimed, as sentences.

    Every record begins with its rolls elsewhere; the fit has one start angle of an effect for all.
    """
    if len(fitted) < 2:
        return []
    names = " and ".join(record.path.name for record in fitted)
    return [
        f"{names} are fitted with one start angle per effect: what turns with a roller is found "
        "only where it began alike in all; give one of them, and hold another out"
    ]


def announce(
    caveats: Iterable[str], records: Iterable[Recording], progress: Callable[[str], None]
) -> None:
    """Say what cannot be claimed and what was found about every record."""
    for text in caveats:
        progress(f"cannot be claimed: {text}")
    for record in records:
        for text in record.findings:
            progress(f"{record.path.name}: {text}")
