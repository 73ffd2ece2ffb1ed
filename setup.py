"""What pyproject.toml cannot say: the wheel carries lines and PLC maps of `config` as data."""

from __future__ import annotations

import shutil
from pathlib import Path

from setuptools import setup
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


setup(cmdclass={"build_py": BuildWithConfig})
