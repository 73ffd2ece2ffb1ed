"""Who runs code as the user aff-hmi, beside a real service of the user aff-runtime.

Both users exist in a mount namespace alone: their names are in a passwd file of the test.
"""

from __future__ import annotations

import json
import os
import pwd
import shutil
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.app.hand import audit
from tests.aff_runtime.app.service_run import ROOT, ServiceRun
from tests.processes import is_running, until
from tests.security import attacks_of_screen

SERVICE, SCREEN, DOOR = 64990, 64991, 64992
PASSWD = f"""root:x:0:0::/root:/bin/sh
aff-runtime:x:{SERVICE}:{SERVICE}::/nonexistent:/bin/sh
aff-hmi:x:{SCREEN}:{SCREEN}::/nonexistent:/bin/sh
"""
GROUP = f"root:x:0:\naff-runtime:x:{SERVICE}:\naff-hmi:x:{SCREEN}:\naff-door:x:{DOOR}:aff-hmi\n"
BASE = Path(sys.base_prefix)


def closed_above(path: Path) -> Path | None:
    """Return the first folder above ``path`` that others may not enter."""
    return next((p for p in reversed(path.parents) if not p.stat().st_mode & stat.S_IXOTH), None)


# an interpreter in the home of root, a checkout in a folder of its owner's alone: they are shown
# to others where they are, and nothing else of those folders
SHOWN = {f"$0/{k}": path for k, path in enumerate((BASE, ROOT)) if closed_above(path)}
SHOW = " && ".join(
    [
        *(f'mount --bind {path} "{at}"' for at, path in SHOWN.items()),
        *(
            f"mount -t tmpfs -o mode=755 none {closed}"
            for closed in sorted({str(closed_above(path)) for path in SHOWN.values()})
        ),
        *(f'mkdir -p {path} && mount --bind "{at}" {path}' for at, path in SHOWN.items()),
        "true",
    ]
)
ENTER = f"""mount --bind "$0/passwd" /etc/passwd && mount --bind "$0/group" /etc/group &&
{SHOW} && user=$1 && shift && exec setpriv --reuid "$user" --regid "$user" \\
--init-groups --inh-caps=-all --bounding-set=-all -- "$@"
"""


def reason_not() -> str:
    """Return why there can be no other users here."""
    if os.geteuid() != 0:
        return "only root can be another user"
    if not (shutil.which("unshare") and shutil.which("setpriv")):
        return "unshare and setpriv are needed"
    done = subprocess.run(["unshare", "--mount", "true"], capture_output=True, check=False)
    return "" if done.returncode == 0 else "no mount namespace can be had here"


pytestmark = [
    pytest.mark.wire,
    pytest.mark.timeout(240),
    pytest.mark.skipif(bool(reason_not()), reason=reason_not()),
]


def as_user(names: Path, user: str) -> list[str]:
    """Return the words before a command of a user."""
    return ["unshare", "--mount", "sh", "-c", ENTER, str(names), user]


@dataclass
class Installed:
    """A service as the installer leaves it: users, folders, modes."""

    root: Path
    service: ServiceRun
    place: dict[str, object]

    def attack(self, user: str, **more: object) -> dict[str, str]:
        """Return what became of every deed of a user."""
        script = attacks_of_screen.__file__
        command = [*as_user(self.root, user), sys.executable, script]
        done = subprocess.run(
            [*command, json.dumps(self.place | more)],
            capture_output=True,
            text=True,
            check=False,
            cwd="/",
            env={"PYTHONPATH": str(ROOT), "PATH": os.environ["PATH"]},
        )
        assert done.returncode == 0, done.stderr
        found: dict[str, str] = json.loads(done.stdout)
        return found


@pytest.fixture(scope="module")
def installed() -> Iterator[Installed]:
    real = pwd.getpwnam

    def named(name: str) -> object:
        uids = {"aff-runtime": SERVICE, "aff-hmi": SCREEN}
        return SimpleNamespace(pw_uid=uids[name]) if name in uids else real(name)

    with pytest.MonkeyPatch.context() as patch, tempfile.TemporaryDirectory() as name:
        patch.setattr(pwd, "getpwnam", named)  # the test asks the service as root does
        root = Path(name)
        root.chmod(0o755)
        (root / "passwd").write_text(PASSWD)
        (root / "group").write_text(GROUP)
        for k in range(2):
            (root / str(k)).mkdir()
        folders = {
            "service": (SERVICE, SERVICE, 0o755),
            "service/state": (SERVICE, SERVICE, 0o750),
            "aff-door": (SERVICE, DOOR, 0o2750),
        }
        for path, (uid, gid, mode) in folders.items():
            (root / path).mkdir()
            os.chown(root / path, uid, gid)
            (root / path).chmod(mode)
        key = root / "service" / "state" / "key.pem"
        key.write_text("a secret of the wire")
        os.chown(key, SERVICE, SERVICE)
        key.chmod(0o600)
        door, state = root / "aff-door", root / "service" / "state"
        run = ServiceRun(
            root / "service",
            *("--door-dir", str(door), "--hand", "view", "--hand-dir", str(door)),
            *("--state-dir", str(state)),
            run_as=as_user(root, "aff-runtime"),
        )
        try:
            status = run.status()
            (file,) = state.glob("audit/*/audit.jsonl")
            place: dict[str, object] = {
                "pids": {"supervisor": run.process.pid, "control": status["control_pid"]},
                "runtime": str(run.runtime_dir),
                "state": str(state),
                "key": str(key),
                "site": str(run.site),
                "door": str(door / "door.sock"),
                "audit": str(file),
            }
            yield Installed(root=root, service=run, place=place)
        finally:
            run.close()


def test_the_service_is_another_users(installed: Installed) -> None:
    for pid in installed.place["pids"].values():  # type: ignore[attr-defined]
        status = Path(f"/proc/{pid}/status").read_text()
        assert f"Uid:\t{SERVICE}\t{SERVICE}" in status
        assert "CapBnd:\t0000000000000000" in status


def test_whoever_runs_code_as_the_screen_does_none_of_all_this(installed: Installed) -> None:
    service = installed.service
    status = service.status()
    control, tick = status["control_pid"], status["signals"]["tick"]
    became = installed.attack("aff-hmi")
    assert len(became) > 60
    assert {name for name, how in became.items() if how == "done"} == set()
    assert not [name for name, how in became.items() if how.startswith("FileNotFound")]
    for pid in installed.place["pids"].values():  # type: ignore[attr-defined]
        assert is_running(pid)
    until("it ticks", lambda: service.status()["signals"]["tick"] > tick + 100)
    status = service.status()
    assert status["control_pid"] == control
    assert status["state"] == "FAULT"
    file = Path(str(installed.place["audit"]))
    assert audit.verify(file).wrong == ""
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    asked = {row["what"] for row in rows if row["result"] == "refused"}
    assert {"arm", "probe", "no command"} <= asked
    assert len(rows) < 300  # of a flood the number is written
    assert all(row["peer"].startswith(f"uid {SCREEN} (aff-hmi") for row in rows if row["peer"])


def test_the_same_is_done_by_who_may_so_that_the_refusals_mean_something(
    installed: Installed,
) -> None:
    harmless = ["signal it", "read its environment", "see its descriptors", "see its maps"]
    became = installed.attack("aff-runtime", deeds=harmless)
    assert len(became) == 2 * len(harmless)
    assert [name for name, how in became.items() if how != "done"] == []
