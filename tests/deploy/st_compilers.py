"""The shipped Structured Text made a program of this machine by a real compiler, where one is.

``iec2c`` (of matiec) and ``strucpp`` are looked for on PATH; nothing is fetched or built here.
``IEC2C_LIB`` names matiec's folder ``lib``, ``STRUCPP_INCLUDE`` the folder of ``iec_types.hpp``;
both are also looked for beside the compiler itself.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_DECLARED = re.compile(r"^ +(\w+)(?: AT (%\w+))? : (\w+)(?: := [^;]+)?;", re.MULTILINE)
_FLAGS = ("-O1", "-fPIC", "-shared", "-w")


@dataclass(frozen=True, slots=True, kw_only=True)
class StCompiler:
    """One compiler of Structured Text, and where what its output needs lies."""

    name: str
    program: str
    library: Path

    def build(self, sources: tuple[Path, ...], shim: str, folder: Path) -> Path:
        """Compile sources and a shim of C that includes them; return the shared library.

        Raises
        ------
        RuntimeError
            A compiler refuses; its own words are in the message.
        """
        folder.mkdir(parents=True, exist_ok=True)
        whole = folder / "whole.st"
        whole.write_text("\n".join(path.read_text() for path in sources))
        if self.name == "iec2c":
            _run(self.program, "-I", self.library, "-T", folder, whole)
            includes, driver, suffix = self.library / "C", "gcc", "c"
        else:
            _run(self.program, whole, "-o", folder / "whole.cpp", "--no-default-libs")
            includes, driver, suffix = self.library, "g++", "cpp"
        text = folder / f"shim.{suffix}"
        text.write_text(shim)
        made = folder / "block.so"
        extra = () if driver == "gcc" else ("-std=c++17",)
        _run(driver, *_FLAGS, *extra, "-I", folder, "-I", includes, text, "-o", made, "-lm")
        return made


def found() -> Iterator[StCompiler]:
    """Yield the compilers that are at hand, with the library that their output needs."""
    for name, variable, beside, mark in (
        ("iec2c", "IEC2C_LIB", "lib", "C/iec_std_lib.h"),
        ("strucpp", "STRUCPP_INCLUDE", "src/runtime/include", "iec_types.hpp"),
    ):
        program = shutil.which(name)
        if program is None or shutil.which("gcc") is None or shutil.which("g++") is None:
            continue
        folder = Path(os.environ.get(variable) or Path(program).resolve().parent / beside)
        if (folder / mark).is_file():
            yield StCompiler(name=name, program=program, library=folder)


def why_not() -> str:
    """Return in words why nothing can be compiled here; empty where something can."""
    if any(found()):
        return ""
    return (
        "no compiler of Structured Text: neither iec2c (IEC2C_LIB names its lib folder) "
        "nor strucpp (STRUCPP_INCLUDE) is on PATH with its library, gcc and g++"
    )


def variables(text: str) -> Mapping[str, str]:
    """Return type by name of every variable that a block declares, in its order."""
    return {name: kind for name, _, kind in _DECLARED.findall(text.rpartition("END_VAR\n")[0])}


class Compiled:
    """One POU of a shared library: all its variables go in before a call and come out after it.

    So an instance is its own dictionary ``v``: it can be copied, and a test may write any of them.
    """

    def __init__(self, types: Mapping[str, str], made: Path) -> None:
        self.types = types
        self.v: dict[str, float | bool] = {}
        self._made = made
        values = (ctypes.c_double * len(types))()
        _loaded(made).aff_begin(values)
        self._take(values)

    def call(self, **inputs: float | bool) -> dict[str, float | bool]:
        """Run the body once; what is not given keeps its last value."""
        self.v |= inputs
        values = (ctypes.c_double * len(self.types))(*map(float, self.v.values()))
        _loaded(self._made).aff_scan(values)
        self._take(values)
        return self.v

    def _take(self, values: ctypes.Array[ctypes.c_double]) -> None:
        for (name, kind), value in zip(self.types.items(), values, strict=True):
            self.v[name] = {"BOOL": bool, "REAL": float}.get(kind, int)(value)


class CompiledBlock(Compiled):
    """The compiled AFF_GATEWAY, with the manners of ``StMachine``."""

    def __init__(self, compiler: StCompiler, path: Path, folder: Path) -> None:
        text = path.read_text()
        self.inputs = set(variables(text.partition("VAR_OUTPUT")[0]))
        super().__init__(variables(text), _block(compiler, text, folder))

    def call(self, **inputs: float | bool) -> dict[str, float | bool]:
        """Run the body once; inputs not given keep their last value."""
        assert set(inputs) <= self.inputs
        return super().call(**inputs)


class CompiledExample(Compiled):
    """The program AFF_EXAMPLE, run by its task; located words and the line's own are in ``v``."""

    def __init__(self, compiler: StCompiler, block: Path, example: Path, folder: Path) -> None:
        rows = _DECLARED.findall(example.read_text())
        self.located = {place: name for name, place, _ in rows if place}
        types = {name: kind for name, _, kind in rows if kind != "AFF_GATEWAY"}
        shim = {"iec2c": _matiec_station, "strucpp": _strucpp_station}[compiler.name]
        text = shim(types, set(self.located.values()))
        super().__init__(types, compiler.build((block, example), text, folder))


@cache
def _loaded(made: Path) -> ctypes.CDLL:
    return ctypes.CDLL(str(made))


@cache
def _block(compiler: StCompiler, text: str, folder: Path) -> Path:
    at = folder / f"{compiler.name}-{len(list(folder.iterdir()))}"
    at.mkdir()
    source = at / "block.st"
    source.write_text(text)
    shim = {"iec2c": _matiec_block, "strucpp": _strucpp_block}[compiler.name]
    return compiler.build((source,), shim(variables(text)), at)


_MATIEC = """#include "iec_std_lib.h"
#include "accessor.h"
TIME __CURRENT_TIME;
BOOL __DEBUG;
"""


def _matiec_block(types: Mapping[str, str]) -> str:
    fields = [f"block.{name.upper()}.value" for name in types]
    new = "AFF_GATEWAY block = {0}; AFF_GATEWAY_init__(&block, 0);"
    head = f'{_MATIEC}#include "POUS.h"\n#include "POUS.c"\n'
    return head + _functions("void", new, fields, "AFF_GATEWAY_body__(&block);")


def _strucpp_block(types: Mapping[str, str]) -> str:
    fields = [f"block.{name.upper()}" for name in types]
    new = "strucpp::AFF_GATEWAY block;"
    return '#include "whole.cpp"\n' + _functions('extern "C" void', new, fields, "block();")


def _matiec_station(types: Mapping[str, str], located: set[str]) -> str:
    head = f"""{_MATIEC}#define __LOCATED_VAR(type, name, ...) type name##_; type *name = &name##_;
#include "LOCATED_VARIABLES.h"
#include "AFF_STATION.c"
#include "Controller.c"
"""
    plain = {name: f"CONTROLLER__LINE.{name.upper()}.value" for name in types}
    fields = [f"(*{field})" if name in located else field for name, field in plain.items()]
    return head + _functions("void", "", fields, "config_run__(0);", "config_init__();")


def _strucpp_station(types: Mapping[str, str], located: set[str]) -> str:
    head = '#include "whole.cpp"\nstatic strucpp::Configuration_AFF_STATION *station;\n'
    fields = [f"station->LINE.{name.upper()}" for name in types]
    begin = "station = new strucpp::Configuration_AFF_STATION();"
    return head + _functions('extern "C" void', "", fields, "station->LINE.run();", begin)


def _functions(kind: str, new: str, fields: list[str], run: str, begin: str = "") -> str:
    """Return the shim's two functions: initial values out; values in, one scan, values out."""
    into = "".join(f" {field} = v[{at}];\n" for at, field in enumerate(fields))
    out = "".join(f" v[{at}] = (double){field};\n" for at, field in enumerate(fields))
    return (
        f"{kind} aff_begin(double *v) {{\n {new} {begin}\n{out}}}\n"
        f"{kind} aff_scan(double *v) {{\n {new}\n{into} {run}\n{out}}}\n"
    )


def _run(*words: str | Path) -> None:
    done = subprocess.run(
        [str(word) for word in words], capture_output=True, text=True, check=False, timeout=60
    )
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
