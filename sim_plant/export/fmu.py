"""A line as an FMU: one file that other simulators and real-time targets take."""

from __future__ import annotations

import hashlib
import re
import tempfile
import zipfile
from dataclasses import dataclass
from html import escape
from pathlib import Path

from aff_runtime import __version__
from sim_plant.codegen.some_entries import entries_source
from sim_plant.export.binary import binary_folder, compile_binary, compiler
from sim_plant.export.description import LICENCE, Model, Version, build_description, description
from sim_plant.export.interface import Interface, interface_of
from sim_plant.export.line_data import line_data, line_variables
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.open import make_line
from sim_plant.line.rest.fastest_mode import fastest_mode
from sim_plant.line.running.simulation import LineSimulation

C_FILES = Path(__file__).parent / "c"
SHARED = ("forms.h", "line.h", "stepping.h", "saved.h")
ENTRIES = ("step_frame", "measure", "log_frame")
STAMP = (1980, 1, 1, 0, 0, 0)
"""Of every file in the archive: two exports of one line are the same bytes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """An exported line: the files of its FMU by name, without a binary yet.

    ``main`` : the one source file that is compiled; it takes in the others.
    """

    model: Model
    interface: Interface
    version: Version
    main: str
    files: dict[str, bytes]


def settled_line(
    declaration: Declaration,
    *,
    sample_time_s: float | None = None,
    speed_m_s: float | None = None,
    tension_N: float | None = None,
) -> LineSimulation:
    """Return the line as an export starts it: without noise, settled at its references.

    Raises
    ------
    PlantError
        When the line cannot be made so.
    """
    line = make_line(
        declaration,
        seed=None,
        sample_time_s=sample_time_s,
        speed_m_s=speed_m_s,
        tension_N=tension_N,
    )
    line.settle()
    return line


def export_line(
    line: LineSimulation,
    name: str,
    version: Version = "3.0",
    *,
    speed_m_s: float | None = None,
    tension_N: float | None = None,
) -> Export:
    """Return the files of an FMU.

    Parameters
    ----------
    line : settled at ``speed_m_s`` and ``tension_N``, the declaration's unless given; its effects
        and corrections are in its arrays.
    name : of the model, as an importer shows it.
    """
    point = line.declaration.operating_point
    speed = point.line_speed_m_s if speed_m_s is None else speed_m_s
    tension = point.tension_N if tension_N is None else tension_N
    interface = interface_of(line, speed, tension)
    fastest = fastest_mode(line.declaration, line.arrays, line.lengths_m).rate_rad_s
    identifier = re.sub(r"\W", "_", name, flags=re.ASCII)
    identifier = identifier if identifier[:1].isalpha() else f"line_{identifier}"
    sources = _sources(line, interface, identifier, fastest)
    digest = hashlib.sha256(b"".join(sources.values())).hexdigest()
    token = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    sources["line_data.h"] = line_data(line, interface, token, fastest).encode()
    model = Model(
        name=name,
        identifier=identifier,
        token=token,
        text=f"Web line {name}: rolls, rollers, web, drives and tension loops. "
        f"Communication steps are whole multiples of {line.sample_time_s:g} s",
        version=__version__,
        sample_time_s=line.sample_time_s,
    )
    return _filed(model, interface, version, sources)


def _sources(
    line: LineSimulation, interface: Interface, identifier: str, fastest_rad_s: float
) -> dict[str, bytes]:
    names = "\n".join(f"#define line_{entry} {identifier}_line_{entry}" for entry in ENTRIES)
    made = {
        "names.h": f"/* Names that others could see. */\n{names}\n",
        "kernel.h": entries_source(*ENTRIES),
        "line_data.h": line_data(line, interface, "", fastest_rad_s),
        "line_variables.h": line_variables(interface),
    }
    fixed = {file: (C_FILES / file).read_bytes() for file in SHARED}
    return {file: text.encode() for file, text in made.items()} | fixed


def _filed(
    model: Model, interface: Interface, version: Version, sources: dict[str, bytes]
) -> Export:
    main = f"fmi{version[0]}.c"
    files = {"modelDescription.xml": description(model, interface, version)}
    files |= {f"sources/{name}": text for name, text in sources.items()}
    for name in (main, main.replace(".c", "_unoffered.h")):
        files[f"sources/{name}"] = (C_FILES / name).read_bytes()
    if version == "3.0":
        files["sources/buildDescription.xml"] = build_description(model, main)
    files["documentation/index.html"] = _page(model, interface).encode()
    licence = f"SPDX-License-Identifier: {LICENCE}\nwww.apache.org/licenses/LICENSE-2.0\n"
    files["documentation/licenses/license.txt"] = licence.encode()
    return Export(model=model, interface=interface, version=version, main=main, files=files)


def _page(model: Model, interface: Interface) -> str:
    rows = "\n".join(
        f"<tr><td>{escape(v.name)}</td><td>{v.causality}</td><td>{v.variability}</td>"
        f"<td>{escape(v.unit)}</td><td>{escape(v.description)}</td></tr>"
        for v in interface.variables
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>'
        f"{escape(model.name)}</title></head><body><h1>{escape(model.name)}</h1>\n"
        f"<p>{escape(model.text)}.</p>\n<p>Inputs hold over a communication step. Rising edges "
        "of splice and roll_change act at its beginning.</p>\n<table><tr><th>name</th>"
        "<th>causality</th><th>variability</th><th>unit</th><th>meaning</th></tr>\n"
        f"{rows}\n</table></body></html>\n"
    )


def write_fmu(export: Export, path: Path, *, with_binary: bool = True) -> str | None:
    """Write the FMU and return the folder of the binary in it; None: source alone.

    Raises
    ------
    PlantError
        When the machine's compiler does not take the source.
    """
    files, folder, program = dict(export.files), binary_folder(export.version), compiler()
    found = folder if with_binary and program is not None else None
    if found is not None and program is not None:
        name = f"binaries/{found}/{export.model.identifier}.so"
        files[name] = _compiled(export, program)
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(files, key=lambda name: (name != "modelDescription.xml", name)):
            entry = zipfile.ZipInfo(name, STAMP)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            archive.writestr(entry, files[name])
    return found


def _compiled(export: Export, program: str) -> bytes:
    with tempfile.TemporaryDirectory(prefix="fmu-") as folder:
        sources = Path(folder)
        for name, text in export.files.items():
            if name.startswith("sources/"):
                (sources / name.removeprefix("sources/")).write_bytes(text)
        target = sources / "model.so"
        compile_binary(program, sources, export.main, target)
        return target.read_bytes()
