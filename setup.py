"""What pyproject.toml cannot say: files of `config` as data of the wheel, the law's binary.

The binary is built where a compiler is; the install goes on without it, and numpy does the same.
``AFF_RUNTIME_BUILD`` decides otherwise: ``numpy`` (a wheel for every machine, without it) or
``compiled`` (a wheel with it, or an error).
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_py import build_py

CONFIG = Path(__file__).parent / "config"
SHIPPED = ("lines/*.yaml", "plc/*.yaml", "*.dbc", "*.eds")


class BuildWithConfig(build_py):
    """Puts the shipped files into `sim_plant/config` of what is built; editable needs none."""

    def run(self) -> None:
        """Build the packages, then put the files in."""
        super().run()
        if self.editable_mode:
            return
        for pattern in SHIPPED:
            for source in sorted(CONFIG.glob(pattern)):
                target = Path(self.build_lib, "sim_plant", "config", source.relative_to(CONFIG))
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)


def binary(build: str) -> list[Extension]:
    """Return the extension to build; optional unless it is asked for."""
    if build not in ("", "numpy", "compiled"):
        raise SystemExit(f"AFF_RUNTIME_BUILD={build}: numpy or compiled wanted")
    if build == "numpy":
        return []
    folder = "aff_runtime/core/compiled"
    # no contraction: a product and a sum round twice on every processor, as in numpy
    numbers = ["-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-strict-aliasing"]
    found = Extension(
        "aff_runtime.core.compiled._arithmetic",
        [f"{folder}/arithmetic.c", f"{folder}/module.c"],
        depends=[f"{folder}/arithmetic.h", f"{folder}/arrays.h"],
        extra_compile_args=[*numbers, "-fvisibility=hidden", "-g0"],  # -g0: no paths in it
        libraries=["m"],
        optional=build != "compiled",
        py_limited_api=True,
    )
    return [found]


EXTENSIONS = binary(os.environ.get("AFF_RUNTIME_BUILD", ""))

setup(
    cmdclass={"build_py": BuildWithConfig},
    ext_modules=EXTENSIONS,
    # one binary for every Python from 3.11 on
    options={"bdist_wheel": {"py_limited_api": "cp311"}} if EXTENSIONS else {},
)
