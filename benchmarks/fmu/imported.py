"""An FMU as an importer runs it, by FMPy: either version behind the same words."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping, Sequence
from ctypes import byref
from pathlib import Path
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy


class Imported:
    """One instance of an FMU, in step mode after ``start``.

    Attributes
    ----------
    said : messages that came through the logger.
    """

    def __init__(self, fmu: Path) -> None:
        self.description = read_model_description(str(fmu))
        self.said: list[str] = []
        self._folder = Path(tempfile.mkdtemp(prefix="fmu-"))
        extract(str(fmu), unzipdir=str(self._folder))
        self._variables = {v.name: v for v in self.description.modelVariables}
        third = self.description.fmiVersion == "3.0"
        self._slave: Any = (FMU3Slave if third else FMU2Slave)(
            guid=self.description.guid,
            unzipDirectory=str(self._folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="line",
        )
        self._third = third
        if third:
            self._slave.instantiate(logMessage=self._heard)
        else:
            self._slave.instantiate(callbacks=self._callbacks())

    def _heard(self, *given: Any) -> None:
        self.said.append(given[-1].decode())

    def _callbacks(self) -> Any:
        made = fmi2CallbackFunctions()
        made.logger = fmi2CallbackLoggerTYPE(self._heard)
        addLoggerProxy(byref(made))
        return made

    @property
    def sample_time_s(self) -> float:
        """The step that the description asks for, s."""
        return float(self.description.defaultExperiment.stepSize)

    def begin(self, start_s: float = 0.0) -> None:
        """Enter the initialization."""
        if self._third:
            self._slave.enterInitializationMode(startTime=start_s)
        else:
            self._slave.setupExperiment(startTime=start_s)
            self._slave.enterInitializationMode()

    def run(self) -> None:
        """Leave the initialization."""
        self._slave.exitInitializationMode()

    def start(self, values: Mapping[str, float] | None = None, start_s: float = 0.0) -> None:
        """Set values in the initialization and leave it."""
        self.begin(start_s)
        self.set(values or {})
        self.run()

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by their names."""
        for name, value in values.items():
            found = self._variables[name]
            setter = getattr(self._slave, f"set{found.type}")
            setter([found.valueReference], [value])

    def get(self, names: Sequence[str]) -> list[float]:
        """Return real variables."""
        getter = self._slave.getFloat64 if self._third else self._slave.getReal
        return list(getter([self._variables[name].valueReference for name in names]))

    def step(self, now_s: float, step_s: float) -> None:
        """Make a communication step; FMICallException where it is refused."""
        self._slave.doStep(currentCommunicationPoint=now_s, communicationStepSize=step_s)

    def saved(self) -> bytes:
        """Return the state as bytes."""
        slave = self._slave
        state = slave.getFMUState() if self._third else slave.getFMUstate()
        found: bytes = (
            slave.serializeFMUState(state) if self._third else slave.serializeFMUstate(state)
        )
        (slave.freeFMUState if self._third else slave.freeFMUstate)(state)
        return found

    def restore(self, saved: bytes) -> None:
        """Put the line into a saved state."""
        slave = self._slave
        state = (slave.deserializeFMUState if self._third else slave.deSerializeFMUstate)(saved)
        (slave.setFMUState if self._third else slave.setFMUstate)(state)
        (slave.freeFMUState if self._third else slave.freeFMUstate)(state)

    def reset(self) -> None:
        """Go back to before the initialization."""
        self._slave.reset()

    def close(self) -> None:
        """End the instance and remove its files."""
        self._slave.terminate()
        self._slave.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)
