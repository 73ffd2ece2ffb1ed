"""Instructions per tick of the control process, part by part: a number that no load changes.

Counted by callgrind in user space; what the kernel does for a system call is not in it. The parts
are C functions, doors that a call goes through: callgrind sums what each call costs inside.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sysconfig
import tempfile
from collections import Counter
from pathlib import Path

from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.python_child import module_command
from aff_runtime.base.signals import State
from aff_runtime.core.compiled.binary import COMPILED, NUMPY, VARIABLE, chosen
from benchmarks.runtime.child import environment
from benchmarks.runtime.facts import FactRow, Section
from benchmarks.runtime.lockstep import (
    COUNTED_TICKS,
    DOORS,
    INSIDE,
    PARAMETERS,
    PARTS,
    SCRIPT,
    STAND_IN,
    TICKS,
    Lockstep,
)
from benchmarks.runtime.parts import respond
from benchmarks.runtime.whole_tick import CONFIG
from sim_plant.demo.wires import SITES, wire_up
from sim_plant.line import open_line
from sim_plant.servers.faults import FaultBoard
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.modbus_answer import answer_to
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc

TITLE = "Instructions per tick, shape law on Modbus TCP"
COUNTS = "callgrind.out"
SEED = 1
_HEAD = """#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <valgrind/callgrind.h>
#define DOOR(part) \\
    PyObject *part##_door(PyObject *module, PyObject *args) \\
    { \\
        PyObject *work, *given, *named; \\
        if (!PyArg_UnpackTuple(args, #part, 3, 3, &work, &given, &named)) return NULL; \\
        PyObject *found = PyObject_Call(work, given, named); \\
        __asm__ volatile("" ::: "memory"); /* no tail call: the door stays on the stack */ \\
        return found; \\
    }
PyObject *begin(PyObject *module, PyObject *none)
{
    CALLGRIND_START_INSTRUMENTATION;
    Py_RETURN_NONE;
}
PyObject *end(PyObject *module, PyObject *none)
{
    CALLGRIND_STOP_INSTRUMENTATION;
    Py_RETURN_NONE;
}
"""
_FOOT = """static PyMethodDef methods[] = {{
    {rows}
    {{"begin", begin, METH_NOARGS, NULL}}, {{"end", end, METH_NOARGS, NULL}}, {{NULL}}}};
static struct PyModuleDef module = {{PyModuleDef_HEAD_INIT, "{name}", NULL, -1, methods}};
PyMODINIT_FUNC PyInit_{name}(void) {{ return PyModule_Create(&module); }}
"""


def keep_script(folder: Path) -> None:
    """Let the plant answer the control process in lockstep; keep record, requests and answers."""
    respond(folder)
    site = wire_up("modbus", CONFIG / SITES["modbus"], folder).site
    parameters = load_parameters(site).checked()
    line = open_line(CONFIG / "lines" / "euclid_ripple.yaml", seed=SEED)
    plant = Plant(line, Plc(load_plc_map(CONFIG / "plc" / "gateway_block.yaml")))
    device, faults = ModbusDevice(plant.registers), FaultBoard()
    samples = max(1, round(parameters.site.cycle_s / plant.sample_time_s))
    script: list[tuple[str, str]] = []

    def answer(frame: bytes) -> bytes:
        for _ in range(samples):
            plant.step()
        (reply,) = answer_to(frame, device, faults).frames
        script.append((frame.hex(), reply.hex()))
        return reply

    lockstep = Lockstep(parameters, answer)
    for _ in range(TICKS):
        lockstep.tick()
    if lockstep.guard.state is not State.ACTIVE:
        raise RuntimeError(f"{lockstep.guard.state.name}: {lockstep.guard.first_blocking()}")
    (folder / PARAMETERS).write_text(json.dumps(parameters.to_json()), encoding="utf-8")
    (folder / SCRIPT).write_text(json.dumps(script), encoding="utf-8")


def make_doors(folder: Path) -> None:
    """Compile the module of the doors: a C function per part."""
    parts = (*PARTS, STAND_IN)
    source = folder / f"{DOORS}.c"
    doors = "".join(f"DOOR({part})\n" for part in parts)
    rows = "\n    ".join(f'{{"{part}", {part}_door, METH_VARARGS, NULL}},' for part in parts)
    source.write_text(_HEAD + doors + _FOOT.format(rows=rows, name=DOORS), encoding="utf-8")
    include = sysconfig.get_paths()["include"]
    command = ["cc", "-O1", "-shared", "-fPIC", f"-I{include}", str(source)]
    subprocess.run([*command, "-o", str(source.with_suffix(".so"))], check=True)


def counted(folder: Path, way: str) -> dict[str, float]:
    """Return instructions per tick of each part, what runs inside another one left out of that."""
    out = folder / COUNTS
    subprocess.run(
        [
            *("valgrind", "--tool=callgrind", "--instr-atstart=no"),
            *(f"--callgrind-out-file={out}", *module_command("benchmarks.runtime.lockstep")),
            str(folder),
        ],
        check=True,
        capture_output=True,
        env={**environment(), VARIABLE: way, "OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0"},
    )
    inclusive = costs_of_calls(out.read_text(encoding="utf-8"))
    return {
        part: (inclusive[part] - sum(inclusive[each] for each in INSIDE.get(part, ())))
        / COUNTED_TICKS
        for part in PARTS
    }


def costs_of_calls(text: str) -> Counter[str]:
    """Return what all calls through the door of each part cost, the part itself included.

    A function's name follows its number where it stands first; the line after ``calls=`` ends
    with the cost of those calls.
    """
    names: dict[str, str] = {}
    found: Counter[str] = Counter()
    called = ""
    lines = iter(text.splitlines())
    for line in lines:
        named = re.fullmatch(r"c?fn=\((\d+)\)(?: (.*))?", line)
        if named is not None:
            if named[2] is not None:
                names[named[1]] = named[2]
            called = names[named[1]]
        elif line.startswith("calls=") and "_door" in called:
            found[called.partition("_door")[0]] += int(next(lines).split()[-1])
    return found


def missing() -> str:
    """Return what the count needs and this machine lacks; empty when it has all."""
    lacks = [name for name in ("valgrind", "cc") if shutil.which(name) is None]
    if lacks:
        return f"{' and '.join(lacks)} not installed (Debian: valgrind, gcc)"
    return ""


def instructions() -> Section:
    """Count a tick with the law by numpy and by the binary."""
    if lacks := missing():
        rows = (FactRow(name="all parts", value="skipped", remark=lacks),)
        return Section(title=TITLE, note="", rows=rows)
    ways = (NUMPY, COMPILED) if chosen() is not None else (NUMPY,)
    rows_of: list[FactRow] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        keep_script(folder)
        make_doors(folder)
        for way in ways:
            found = counted(folder, way)
            rows_of += [
                FactRow(name=f"{part}, by {way}", value=f"{1e-3 * number:.1f} thousand")
                for part, number in (*found.items(), ("all", sum(found.values())))
            ]
    return Section(
        title=TITLE,
        note=f"config/{SITES['modbus']} with the response of the declared line, armed and "
        f"learning, in lockstep with the plant's answers; mean of {COUNTED_TICKS} ticks, user "
        "space only. Wire: without the socket. Rest: ticker, link, advice, what asks the parts.",
        rows=tuple(rows_of),
    )
