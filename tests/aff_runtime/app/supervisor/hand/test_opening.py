"""When a service has a hand, and what it answers while no control process runs."""

from __future__ import annotations

import logging
import selectors
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.app.hand.audit import NAME
from aff_runtime.app.hand.may import Role
from aff_runtime.app.link.messages import Shadow
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.runtime_directory import runtime_paths
from aff_runtime.app.report.command_counts import CommandTally
from aff_runtime.app.supervisor.hand.desk import HandDesk
from aff_runtime.app.supervisor.hand.opening import ServiceEnd, open_hand
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.base.errors import RefusedError
from tests.doubles.virtual_clock import VirtualClock


class NoProbe:
    """Nothing runs that could probe."""

    is_under_way = False

    def begin_by_hand(self, began: object, *, louder: bool = False) -> None:
        raise RefusedError("not running yet")


NO_PROBE = NoProbe()


def opened(tmp_path: Path, hand: Role | None) -> HandDesk | None:
    options = RunOptions(
        site=tmp_path / "site.yaml",
        paths=runtime_paths(tmp_path / "run"),
        state_directory=tmp_path,
        hand=hand,
    )
    with selectors.DefaultSelector() as selector:
        clock = VirtualClock(1)
        found = open_hand(
            *(options, selector, clock, SimpleNamespace(), Pending(clock), NO_PROBE),  # type: ignore[arg-type]
            CommandTally(),
        )
        if found is not None:
            found.close()
    return found


@pytest.fixture(autouse=True)
def runtime_folder(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir(mode=0o700)


def test_there_is_none_unless_it_is_asked_for(tmp_path: Path) -> None:
    assert opened(tmp_path, None) is None
    assert not (tmp_path / "audit").exists()
    assert opened(tmp_path, Role.VIEW) is not None


def test_a_damaged_audit_closes_the_hand_and_not_the_service(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    opened(tmp_path, Role.OPERATE)
    (path,) = (tmp_path / "audit").glob(f"*/{NAME}")
    path.write_text("{}\n")
    with caplog.at_level(logging.ERROR):
        assert opened(tmp_path, Role.OPERATE) is None
    assert "no screen is heard until the audit can be kept" in caplog.text
    assert not (tmp_path / "run" / "hand.sock").exists()


def test_a_folder_that_others_may_write_in_is_no_place_for_it(tmp_path: Path) -> None:
    (tmp_path / "run").chmod(0o777)
    with pytest.raises(RefusedError, match="--hand-dir"):
        opened(tmp_path, Role.VIEW)


def test_without_a_control_process_arming_is_answered_at_once_and_bypass_is_no_error() -> None:
    bypassed, replies = [], list[Reply]()
    processes = SimpleNamespace(
        control=None,
        fresh=lambda: None,
        blocked="X=0",
        also_blocking=("Y=0",),
        parameters=SimpleNamespace(config_hash="3f9a" * 16),
        bypassed_ns=0,
        bypass=lambda: bypassed.append(1),
    )
    end = ServiceEnd(processes, Pending(VirtualClock(1)), NO_PROBE)  # type: ignore[arg-type]
    end.probe(replies.append, louder=False)
    assert replies.pop() == Reply(id=0, ok=False, message="not running yet")
    assert end.now().state is None
    assert (end.now().blocked, end.now().also_blocking) == ("X=0", ("Y=0",))
    end.arm(replies.append)
    assert "not running" in replies[0].message
    end.shadow(True, replies.append)
    end.forget(replies.append)
    assert [one.ok for one in replies] == [False] * 3
    end.bypass()
    assert bypassed


def test_forgetting_reaches_the_files_once_the_control_process_has_forgotten() -> None:
    sent: list[object] = []
    forgotten: list[object] = []

    def forget(*given: object) -> str:
        forgotten.append(given)
        return "forgotten: unwind"

    pending, replies = Pending(VirtualClock(1)), list[Reply]()
    control = SimpleNamespace(link=SimpleNamespace(send=lambda one: sent.append(one) or True))
    processes = SimpleNamespace(
        control=control, parameters="r", shapes=SimpleNamespace(forget=forget)
    )
    end = ServiceEnd(processes, pending, NO_PROBE)  # type: ignore[arg-type]
    for ok, files in ((False, []), (True, [("r", (), ("unwind",))])):
        end.forget(replies.append)
        pending.resolve(Reply(id=sent[-1].id, ok=ok, rolls=("unwind",)))  # type: ignore[attr-defined]
        assert (replies[-1].ok, forgotten) == (ok, files)
    assert replies[-1].message == "forgotten: unwind"
    end.shadow(True, replies.append)
    last = sent[-1]
    assert isinstance(last, Shadow)
    assert last.on
