"""What keeps settings from being taken while a correction goes out."""

from __future__ import annotations

from collections.abc import Iterable

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.response_exchange import exchanged_responses, exchanged_wire_files
from aff_runtime.config.diff import Change


def what_waits(
    processes: Processes, parameters: ParameterRecord, changes: Iterable[Change]
) -> list[str]:
    """Return what would wait for bypass: settings, and files that others have changed meanwhile.

    Parameters
    ----------
    parameters : of the settings that shall run. ``changes`` : what differs from those that do.
    """
    running = processes.parameters
    waits = [str(change) for change in changes if not change.may_change_while_active]
    exchanged = exchanged_responses(running, parameters, processes.probed)
    waits += [f"{one} (changed on the disk as well)" for one in exchanged]
    return waits + [what for what, _ in exchanged_wire_files(running, parameters)]
