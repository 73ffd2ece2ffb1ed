"""What the screen counts of itself; no account, address or word of a person is a label."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from aff_runtime.app.report.metrics.readings import Sample

LOGINS = ("done", "refused", "waits")
RESULTS = ("done", "refused", "failed")


class Counts:
    """Since the screen was started.

    Attributes
    ----------
    sockets : browsers that look on now.
    sent, skipped : frames, and those that a slow browser did without.
    logins : by result. ``presses`` : by action and result.
    """

    def __init__(self) -> None:
        self.sockets = self.sent = self.skipped = 0
        self.logins: Counter[str] = Counter(dict.fromkeys(LOGINS, 0))
        self.presses: Counter[tuple[str, str]] = Counter()

    def samples(self, sessions: Counter[str] | None) -> Iterator[Sample]:
        """Yield every number.

        Parameters
        ----------
        sessions : by role; None on a screen for looking only.
        """
        yield Sample("aff_hmi_sockets", (), self.sockets)
        yield Sample("aff_hmi_frames_total", (), self.sent)
        yield Sample("aff_hmi_frames_skipped_total", (), self.skipped)
        if sessions is None:
            return
        yield from (Sample("aff_hmi_sessions", (role,), n) for role, n in sessions.items())
        yield from (Sample("aff_hmi_logins_total", (how,), n) for how, n in self.logins.items())
        for which, count in self.presses.items():
            yield Sample("aff_hmi_presses_total", which, count)
