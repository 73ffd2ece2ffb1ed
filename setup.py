"""What pyproject.toml cannot say: files of `config` and `deploy/plc` in the wheel, the binaries.

The law's binary and the plant's are built where a compiler is; the install goes on without them,
and numpy and numba do the same. ``AFF_RUNTIME_BUILD`` decides otherwise: ``numpy`` (a wheel for
every machine, without them) or ``compiled`` (a wheel with them, or an error).
"""

from __future__ import annotations

import os
import platform
import shutil
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_py import build_py

CONFIG = Path(__file__).parent / "config"
PLC = Path(__file__).parent / "deploy" / "plc"
SHIPPED = ("*.yaml", "lines/*.yaml", "plc/*.yaml", "*.dbc", "*.eds")


class BuildWithConfig(build_py):
    """Puts the shipped files into what is built, `sim_plant/config` and `sim_plant/plc_code`.

    An editable install needs none.
    """

    def run(self) -> None:
        """Build the packages, then put the files in."""
        super().run()
        if self.editable_mode:
            return
        for pattern in SHIPPED:
            for source in sorted(CONFIG.glob(pattern)):
                self._put(source, Path("config", source.relative_to(CONFIG)))
        for source in sorted(PLC.iterdir()):
            self._put(source, Path("plc_code", source.name))

    def _put(self, source: Path, place: Path) -> None:
        target = Path(self.build_lib, "sim_plant", place)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


INTEL = {
    "avx512": ["-mavx512f", "-mavx512dq", "-mavx512vl", "-mprefer-vector-width=512"],
    "avx2": ["-mavx2"],
}


def binaries(build: str) -> list[Extension]:
    """Return the extensions to build; optional unless they are asked for."""
    if build not in ("", "numpy", "compiled"):
        raise SystemExit(f"AFF_RUNTIME_BUILD={build}: numpy or compiled wanted")
    if build == "numpy":
        return []
    return [law(build != "compiled"), *plant(build != "compiled")]


def plant(optional: bool) -> list[Extension]:
    """Return the plant's kernel for lines side by side, once for each kind of processor."""
    folder = "sim_plant/lanes"
    intel = INTEL if platform.machine() in ("x86_64", "AMD64") else {}
    return [
        Extension(
            f"sim_plant.lanes.lanes_{name}",
            [f"{folder}/lanes_{name}.c"],
            depends=[f"{folder}/kernel_lanes.h"],
            # no contraction: all of them give the same bits
            extra_compile_args=[
                *("-std=gnu11", "-O2", "-ffp-contract=off", "-Wno-psabi", "-g0"),
                *flags,
            ],
            libraries=["m"],
            optional=optional,
            py_limited_api=True,
        )
        for name, flags in ({**intel, "plain": []}).items()
    ]


def law(optional: bool) -> Extension:
    """Return the law's arithmetic."""
    folder = "aff_runtime/core/compiled"
    # no contraction: a product and a sum round twice on every processor, as in numpy
    numbers = ["-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-strict-aliasing"]
    return Extension(
        "aff_runtime.core.compiled._arithmetic",
        [f"{folder}/arithmetic.c", f"{folder}/module.c"],
        depends=[f"{folder}/arithmetic.h", f"{folder}/arrays.h"],
        extra_compile_args=[*numbers, "-fvisibility=hidden", "-g0"],  # -g0: no paths in it
        libraries=["m"],
        optional=optional,
        py_limited_api=True,
    )


EXTENSIONS = binaries(os.environ.get("AFF_RUNTIME_BUILD", ""))

setup(
    cmdclass={"build_py": BuildWithConfig},
    ext_modules=EXTENSIONS,
    # one binary for every Python from 3.11 on
    options={"bdist_wheel": {"py_limited_api": "cp311"}} if EXTENSIONS else {},
)
