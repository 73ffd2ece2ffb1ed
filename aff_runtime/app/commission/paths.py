"""Where the files and sockets of a line lie, and what is asked of them first."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import own_process, user_name
from aff_runtime.app.link.request_client import ServiceClient, login_behind
from aff_runtime.app.report.status_answer import StatusAnswer, read_answer
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.errors import WireError


@dataclass(frozen=True, slots=True, kw_only=True)
class Paths:
    """Paths of what a job reads and writes.

    Attributes
    ----------
    site : of the site file. ``state`` : folder of what the service learns.
    socket : of the running service. ``card`` : folder of the card.
    line : declaration of the line, for `sim-plant refine`; None: none was named.
    runs : folder of the records; None: the one that the site file names.
    watch : store of `aff-runtime watch`; None: in the service's state.
    """

    site: Path
    state: Path
    socket: Path
    card: Path
    line: Path | None = None
    runs: Path | None = None
    watch: Path | None = None


def parameters_of(site: Path, state: Path) -> ParameterRecord:
    """Return what a site file says, checked.

    Raises
    ------
    ConfigError
        It is not good.
    """
    return load_parameters(site, state).checked()


def status_of(socket: Path) -> StatusAnswer | None:
    """Return how the service stands, None where none listens."""
    try:
        client = ServiceClient(socket)
    except WireError:
        return None
    try:
        return read_answer(client.ask("status"))
    finally:
        client.close()


def by_whom() -> str:
    """Return who runs this process, as the kernel has it: user, and login where there is one."""
    me = own_process()
    login = login_behind(me)
    return f"{user_name(me.uid)}{f', {login}' if login else ''}"
