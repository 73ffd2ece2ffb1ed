"""The supervisor's side of learned shapes: files next to the responses, and rows for status."""

from __future__ import annotations

from collections.abc import Callable, Collection

from aff_runtime.app.link.messages import Message, ShapeLearned, ShapeNews
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.wiring.shape_file import WAITS, ShapeFile, read_shapes
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_text

KEPT_SENTENCES = 8  # that ``status`` shows


class ShapeShelf:
    """Reads shapes for a control process that starts, and keeps those that it has learned.

    Parameters
    ----------
    note : takes (name, text) for the log and the record.

    Attributes
    ----------
    sentences : what became of shapes last, newest at the end.
    """

    def __init__(self, note: Callable[[str, str], None]) -> None:
        self._note = note
        self.sentences: list[str] = []

    def load(self, parameters: ParameterRecord) -> dict[str, str]:
        """Return the texts of the shape files of a parameter record."""
        texts, faults = read_shapes(parameters.shape_files)
        for fault in faults:
            self._say(fault)
        return texts

    def hear(self, parameters: ParameterRecord, message: Message) -> None:
        """Take what the control process says of shapes, and nothing else."""
        match message:
            case ShapeNews(actuator=actuator, text=text):
                self._drop_waiting(actuator)
                self._say(f"{actuator}: {text}")
            case ShapeLearned(actuator=actuator, file=file):
                self._keep(parameters, actuator, file)

    def _keep(self, parameters: ParameterRecord, actuator: str, text: str) -> None:
        path = parameters.shape_files.get(actuator)
        if path is None:
            return
        try:
            replace_text(path, text + "\n")
        except OSError as error:
            self._say(f"{actuator}: {path}: {error.strerror}; the shape is not kept")
            return
        self._say(f"{actuator}: what was learned is kept in {path}")

    def forget(
        self, parameters: ParameterRecord, rolls: Collection[str] = (), known: Collection[str] = ()
    ) -> str:
        """Take the shapes of some rolls out of the files; return what is forgotten, in words.

        Parameters
        ----------
        rolls : forgotten; none: those that are exchanged (``resets_on: splice``).
        known : those of which the control process has forgotten something.

        Raises
        ------
        ConfigError
            When a file cannot be written.
        """
        site = parameters.site
        spliced = [name for name, roll in site.rolls.items() if roll.resets_on == "splice"]
        exchanged = frozenset(rolls or spliced)
        in_files = self._forget_in_files(parameters, exchanged)
        return _forgotten_words(tuple(site.rolls), exchanged, {*known, *in_files})

    def _forget_in_files(
        self, parameters: ParameterRecord, exchanged: frozenset[str]
    ) -> frozenset[str]:
        found: set[str] = set()
        for actuator, text in self.load(parameters).items():
            file = ShapeFile.from_json(text)
            forgotten = {roll for roll, _ in file.profile.weight_m if roll in exchanged}
            if not forgotten:
                continue
            path = parameters.shape_files[actuator]
            try:
                replace_text(path, file.without(exchanged).to_json() + "\n")
            except OSError as error:
                raise ConfigError(
                    f"{path}: {error.strerror}; the shape in this file is not forgotten"
                ) from None
            self._say(f"{actuator}: the shape of {', '.join(sorted(forgotten))} is forgotten")
            found |= forgotten
        return frozenset(found)

    def _drop_waiting(self, actuator: str) -> None:
        """Drop the sentence that a shape of this actuator waits: something became of it."""
        self.sentences = [
            s for s in self.sentences if not (s.startswith(actuator + ":") and WAITS in s)
        ]

    def _say(self, text: str) -> None:
        self.sentences = [*self.sentences[-KEPT_SENTENCES + 1 :], text]
        self._note("SHAPE", text)


def _forgotten_words(
    all_rolls: tuple[str, ...], exchanged: Collection[str], known: Collection[str]
) -> str:
    """Return what a wish to forget came to.

    Parameters
    ----------
    all_rolls : of the site file, in its order.
    exchanged : those that were to be forgotten. ``known`` : those of which something was.
    """
    if not exchanged:
        return "nothing is forgotten: no roll has resets_on: splice; name it: forget ROLL"
    said = {
        "forgotten": [roll for roll in all_rolls if roll in exchanged and roll in known],
        "nothing was known of": [r for r in all_rolls if r in exchanged and r not in known],
        "kept": [roll for roll in all_rolls if roll not in exchanged],
    }
    return "; ".join(f"{word}: {', '.join(rolls)}" for word, rolls in said.items() if rolls)
