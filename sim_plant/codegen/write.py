"""The text of a translation: types, functions, entries."""

from __future__ import annotations

from pathlib import Path
from typing import get_type_hints

from sim_plant.base.kernel_sources import kernel_hash
from sim_plant.codegen.kinds import ArrayOf, Nothing, RecordArray, c_type
from sim_plant.codegen.program import Program
from sim_plant.codegen.target import LANES, SCALAR, EntryPoint, Target
from sim_plant.codegen.translation import Function

_HERE = Path(__file__).parent


def scalar_source() -> str:
    """Return one line's kernel as C99; to be compiled without contraction of products.

    It needs the C library's mathematics alone and allocates nothing. Entries are those of
    ``target.SCALAR``, under their names with ``line_`` before them; named tuples are given as
    pointers to structs of the same fields, arrays as pointers to the first element with their
    lengths: see ``float_1``, ``float_2`` and the ``_array`` types. Records are numpy's, packed.
    """
    return translated(SCALAR, (_HERE / "prelude_scalar.h").read_text())


def lanes_source() -> str:
    """Return the kernel for several lines side by side, as C with vectors (gcc, clang).

    ``LANES`` is their number. Records and arrays are numpy's with one more axis, the lanes, last;
    what is in ``target.LANES.shared`` is one for all. The entry is ``frames_lanes.h``.
    """
    source = f'#define SOURCE "{kernel_hash()}" /* of the files it was made from */'
    return translated(LANES, source + "\n\n" + (_HERE / "prelude_lanes.h").read_text())


def translated(target: Target, prelude: str) -> str:
    """Return the C text of all entries of a target."""
    program = Program(target)
    entries = [(entry, program.entry(entry)) for entry in target.entries]
    if target.lanes:
        last = [(_HERE / "frames_lanes.h").read_text()]
    else:
        last = [_exported(target, entry, made) for entry, made in entries]
    parts = [
        "/* Made from the compiled functions of sim_plant by sim_plant.codegen; not by hand. */",
        prelude,
        *_records(program),
        *_structs(program),
        *_groups(program),
        *(function.text for function in program.functions),
        *last,
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _records(program: Program) -> list[str]:
    lanes, found = program.target.lanes, []
    for name, dtype in program.records.items():
        lines = []
        for field in dtype.names or ():
            kind = program.target.record_field(name, field)
            # a shared field stands in memory once for each lane
            width = "[LANES]" if lanes and not kind.lanes else ""
            lines.append(f"    {c_type(kind)} {field}{width};")
        found.append("\n".join(["typedef struct {", *lines, f"}} {name};"]))
        found.append(f"typedef struct {{ {name} *at; int64_t n; }} {name}_array;")
        if lanes:
            found.append(f"typedef struct {{ {name} *at; integers index; }} {name}_each;")
    return found


def _structs(program: Program) -> list[str]:
    found = []
    for name, made in program.structs.items():
        lines = [
            f"    {c_type(program.target.struct_field(name, field))} {field};"
            for field in get_type_hints(made)
        ]
        found.append("\n".join(["typedef struct {", *lines, f"}} {name};"]))
    return found


def _groups(program: Program) -> list[str]:
    found = []
    for name, group in sorted(program.groups.items()):
        members = " ".join(f"{c_type(part)} part{i};" for i, part in enumerate(group.parts))
        found.append(f"typedef struct {{ {members} }} {name};")
    return found


def _exported(target: Target, entry: EntryPoint, made: Function) -> str:
    """Return the entry as a function with outside linkage: arrays are given by pointer."""
    given, handed = [], []
    for name, kind in target.arguments(entry).items():
        by_pointer = isinstance(kind, ArrayOf | RecordArray)
        given.append(f"const {c_type(kind)} *{name}" if by_pointer else f"{c_type(kind)} {name}")
        handed.append(f"*{name}" if by_pointer else name)
    assert isinstance(made.returns, Nothing), entry.name
    head = f"void line_{entry.name}({', '.join(given)})"
    return f"{head} {{\n    {made.c_name}({', '.join(handed)});\n}}"
