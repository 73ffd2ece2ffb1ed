"""The check of a text that somebody asks about: one at a time, in a process of its own."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.request_socket import Asked
from aff_runtime.app.supervisor.validation import Validation
from aff_runtime.base.errors import ConfigError, RefusedError

Checked = Callable[[Asked, CheckResult], None]
BEING_CHECKED = "other settings are being checked; try again"
CHANGES = ("try", "save")


class TextChecks:
    """Runs the check, and answers who asked when it is refused or gives way.

    Parameters
    ----------
    check : begins the check of a text.
    """

    def __init__(self, check: Callable[[str], Validation]) -> None:
        self._make = check
        self._check: tuple[Asked, Validation, Checked] | None = None

    @property
    def is_for_change(self) -> bool:
        """Whether a text is checked to be tried or saved; a look at a difference is neither."""
        request = self._check[0].request.settings if self._check is not None else None
        return request is not None and request.act in CHANGES

    def make_room(self) -> None:
        """End a look at a difference: nobody who looks holds up a try."""
        if self._check is not None and not self.is_for_change:
            self._end(BEING_CHECKED)

    def begin(self, asked: Asked, text: str, then: Checked) -> None:
        """Check a text; ``then`` gets what came of it.

        Raises
        ------
        RefusedError
            Another text is checked, or none can be now.
        """
        if self._check is not None:
            raise RefusedError(BEING_CHECKED)
        try:
            check = self._make(text)
        except OSError as error:
            raise RefusedError(f"cannot be checked now: {error.strerror}; try again") from None
        self._check = (asked, check, then)

    def step(self) -> None:
        """Take the result of a check that has ended."""
        if self._check is None:
            return
        asked, check, then = self._check
        if (result := check.result()) is None:
            return
        self._check = None
        try:
            result.checked()
            then(asked, result)
        except (ConfigError, RefusedError) as error:
            asked.refuse(error)

    def close(self) -> None:
        """End with the service."""
        if self._check is not None:
            self._end("the service stops")

    def _end(self, why: str) -> None:
        assert self._check is not None
        (asked, check, _), self._check = self._check, None
        check.abandon()
        asked.answer(Done(ok=False, message=why))
