"""Files that mostly wait: one after the other, in one worker of ``pytest -n``.

Where two workers wait at once, a core has nothing to do. So one waits while the others compute.
"""

from __future__ import annotations

from xdist.scheduler import LoadFileScheduling

WAITING = (
    "aff_runtime/cli/test_setup.py",
    "aff_runtime/app/test_commissioning_kills.py",
    "aff_runtime/app/test_service.py",
    "aff_runtime/app/setup/test_bus_at_work.py",
    "aff_runtime/app/test_last_zero.py",
    "aff_runtime/app/commission/test_words.py",
    "hil/test_faults.py",
)
"""What takes more than ten seconds in real time, most of them without work for a processor."""


class OneWaits(LoadFileScheduling):
    """Gives a file to one worker whole, and all that wait to the same one."""

    def _split_scope(self, nodeid: str) -> str:
        file = super()._split_scope(nodeid)
        return "what waits" if file.removeprefix("tests/") in WAITING else file

    def _pending_of(self, workload: dict[str, dict[str, bool]]) -> int:
        """Return how many tests of a worker are left.

        It takes its files in their order, so those before a finished one are finished: to count
        them all after each test took the controller longer the more were done.
        """
        left = 0
        for file in reversed(workload.values()):
            waiting = list(file.values()).count(False)
            if not waiting:
                break
            left += waiting
        return left
