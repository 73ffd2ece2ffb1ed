"""Does the PLC take our commands, or somebody else's? Judged by the heartbeat it says it took."""

from __future__ import annotations

from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.safety.params import EchoParams

_OK = Outcome.OK
_WORD = 0xFFFF
_SURE = 3  # foreign echoes that prove another writer; a PLC that starts twice in a row shows two
_FORGOTTEN_AFTER_NS = 500_000_000  # since the last foreign echo, so long that none counts any more


class EchoCheck:
    """Finds that the heartbeats which the PLC took are not those that we sent. Never raises.

    A heartbeat is ours when we sent it within the last ``ticks`` ticks. Somebody else writes too
    when the echo turned three times, never half a second apart, to a heartbeat that is not ours;
    our commands do not count when no echo has been ours for ``missing_after_s``. No alarm is an
    echo that is foreign for a moment: what another master left, the zero of a PLC that starts, our
    own last command from before a loss. Only fresh data are judged; between them the last verdict
    stands.

    Attributes
    ----------
    heard : the PLC has taken a command of ours since the start.
    """

    def __init__(self, params: EchoParams) -> None:
        self.params = params
        self.heard = False
        self._is_foreign = False
        self._echo = -1
        self._others = 0
        self._other_ns = 0
        self._judged_ns = 0
        self._missing_ns: int | None = None

    def judge(self, snapshot: Snapshot, now_ns: int) -> bool:
        """Return whether the PLC takes the commands of somebody else, or of nobody."""
        if snapshot.echo_age >= 0 and snapshot.fresh and snapshot.outcome is _OK:
            self._take(snapshot, now_ns)
        return self._is_foreign

    def _take(self, snapshot: Snapshot, now_ns: int) -> None:
        after_ns = self.params.missing_after_s * 1e9
        age = snapshot.echo_age
        echo, before = (snapshot.tick - age) & _WORD, self._echo  # but for a constant
        if now_ns - self._judged_ns > after_ns:  # the first one, or the first after a loss
            self._missing_ns = None
            before = echo
        self._echo = echo
        self._judged_ns = now_ns
        if now_ns - self._other_ns > _FORGOTTEN_AFTER_NS:
            self._others = 0
        if age <= min(self.params.ticks, snapshot.tick):
            self.heard = True
            self._missing_ns = None
        else:
            if self._missing_ns is None:
                self._missing_ns = now_ns
            if echo != before:
                self._others = min(self._others + 1, _SURE)
                self._other_ns = now_ns
        is_missing = self._missing_ns is not None and now_ns - self._missing_ns > after_ns
        self._is_foreign = is_missing or self._others >= _SURE
