"""The files of a support archive: an allow-list, each within a bound, made from what is shown.

The screen has no site file, key, account, session or record to give away: nothing is opened here.
"""

from __future__ import annotations

import csv
import io
import json
import platform
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from aff_hmi.metrics import answer_of
from aff_hmi.see.alarm_part import AlarmPart, EventLine
from aff_hmi.see.data_routes import harmless
from aff_hmi.timing.timing import TimingPart
from aff_hmi.watch import Observed
from aff_hmi.words import N_
from aff_runtime import __version__
from aff_runtime.base.printable import printable
from aff_runtime.base.release import release_text

MOST_EVENTS = 1000
MOST_BYTES = 1_000_000  # of one file, before it is packed
CUT = "\n[cut here: a file of this archive has at most 1 MB]\n"
# name of a file: what is in it
FILES = {
    "README.txt": N_("what this is, and what it leaves out"),
    "version.json": N_("releases of service, screen and Python; kernel"),
    "status.json": N_("the answer to status: state, reason, every number of the newest tick"),
    "site.json": N_("names, units and limits of the line, as the service tells them"),
    "alarms.json": N_("alarms that stand, and who has seen them"),
    "events.csv": N_("the last 1000 events, times in UTC"),
    "timing.json": N_("times of the ticks, rights, machine"),
    "metrics.txt": N_("the numbers for a monitoring system"),
}
README = """Support archive of the AFF screen, made {utc}.

It has what the screen shows, in English. It has no site file, no keys, no accounts, no passwords
and no records: the screen can see none of them. Names of the line, of its rolls and of people who
pressed something are in it.

Who helps may ask for more; on the gateway:
  sudo cat /etc/aff-runtime/site.yaml     the site file: keys are in files of their own,
                                          but addresses of the plant's network are in it
  aff-runtime export RUN                  ticks of a run, as one file
"""


def files_of(
    seen: Observed,
    *,
    alarms: AlarmPart,
    events: Sequence[EventLine],
    timing: TimingPart,
    metrics: str,
    utc: str,
) -> dict[str, str]:
    """Return every file of the archive by its name: those of ``FILES``.

    Parameters
    ----------
    seen : what the screen has heard of the service, which may have gone quiet.
    utc : of now, as the README shows it.
    """
    answer = answer_of(seen)
    site = seen.site
    meta = seen.meta
    version = {
        "screen": __version__,
        "release": release_text(),
        "python": platform.python_version(),
        "service": dict(meta.versions) if meta is not None else {},
        "kernel": meta.machine if meta is not None else "",
    }
    status = answer.to_json() if answer is not None else {"ok": False, "trouble": seen.trouble}
    status.pop("facts", None)  # they are site.json
    texts = {
        "README.txt": README.format(utc=utc),
        "version.json": _json(version),
        "status.json": _json(status),
        "site.json": _json(asdict(site) if site is not None else {}),
        "alarms.json": _json(asdict(alarms)),
        "events.csv": _events(events),
        "timing.json": _json(asdict(timing)),
        "metrics.txt": metrics,
    }
    return {name: _bounded(texts[name]) for name in FILES}


def zipped(files: Mapping[str, str]) -> bytes:
    """Return the archive; of the same files the same bytes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            entry = zipfile.ZipInfo(f"aff-support/{name}", (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o600 << 16
            archive.writestr(entry, text.encode())
    return packed.getvalue()


def _json(said: Any) -> str:
    return json.dumps(_printing(said), indent=1, ensure_ascii=False) + "\n"


def _printing(said: Any) -> Any:
    """Return the same values with every text made printable."""
    if isinstance(said, str):
        return printable(said, 1000)
    if isinstance(said, Mapping):
        return {printable(str(key), 200): _printing(value) for key, value in said.items()}
    if isinstance(said, list | tuple):
        return [_printing(one) for one in said]
    return said


def _events(events: Sequence[EventLine]) -> str:
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(("utc_s", "tick", "kind", "roll", "name", "text", "who"))
    for one in events:
        cells = (one.kind, one.roll, one.name, one.text, one.who)
        writer.writerow(
            (f"{one.utc_s:.3f}", one.tick, *(harmless(printable(cell, 1000)) for cell in cells))
        )
    return text.getvalue()


def _bounded(text: str) -> str:
    raw = text.encode()
    return text if len(raw) <= MOST_BYTES else raw[:MOST_BYTES].decode("utf-8", "ignore") + CUT
