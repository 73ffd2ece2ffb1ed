"""A test that fails harms no other one, and one that is tried again says why.

The traceback of a failed try keeps what the test had open. Python drops it at some later moment,
and the warnings of that moment would be counted as the failure of the test that runs then.
"""

from __future__ import annotations

import contextlib
import gc
import sys
import warnings

import pytest

_FAILED = pytest.StashKey[bool]()
_LAST = ("last_type", "last_value", "last_traceback", "last_exc")
REASON_LENGTH = 300


def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> None:
    """Remember that a traceback is left over."""
    if call.excinfo is not None and not call.excinfo.errisinstance(pytest.skip.Exception):
        item.config.stash[_FAILED] = True


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Before the next test begins, drop what a failed one still holds, in silence."""
    if not item.config.stash.get(_FAILED, False):
        return
    item.config.stash[_FAILED] = False
    for name in _LAST:
        with contextlib.suppress(AttributeError):
            delattr(sys, name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        gc.collect()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say of each try that failed, and was repeated, in one line why."""
    for report in terminalreporter.getreports("rerun"):
        crash = getattr(report.longrepr, "reprcrash", None)
        said = crash.message if crash is not None else str(report.longrepr)
        reason = " ".join(said.split())[:REASON_LENGTH]
        terminalreporter.write_line(f"tried again: {report.nodeid} ({report.when}): {reason}")
