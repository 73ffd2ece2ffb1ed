"""Device profiles: what drives and PLCs show on Modbus, as data with their source."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.yaml_marks import read_marked


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class DeviceRegister(_Strict):
    """One register as the manual numbers it."""

    name: str
    register_number: Annotated[int, Field(alias="register", ge=0, le=465536)]
    type: Literal["u16", "i16", "u32", "i32"]
    scale: str
    unit: str
    access: Literal["read", "write"]


class Device(_Strict):
    """One device family.

    ``manual`` says where the numbers come from; ``verified`` whether they were tried on one.
    """

    version: Literal[1]
    device: str
    manual: Annotated[str, Field(min_length=10)]
    verified: bool
    address_base: Literal[0, 1]
    word_order: Literal["high_first", "low_first"]
    function: Literal["fc23", "fc3_fc16"]
    lost_master: str
    injection: str
    registers: tuple[DeviceRegister, ...]

    def wire_address(self, register: DeviceRegister) -> int:
        """Return the address on the wire of one register."""
        number = register.register_number
        if self.address_base == 0:
            return number
        for first, last in ((400001, 465536), (40001, 49999)):
            if first <= number <= last:
                return number - first
        return number - 1

    def lines(self) -> list[str]:
        """Return the profile as text."""
        seen = "tried on the device" if self.verified else "NOT tried on a device"
        rows = [
            f"{self.device} ({seen})",
            f"manual: {self.manual}",
            f"word order {self.word_order}, function {self.function}",
            f"without a master: {self.lost_master}",
            f"correction: {self.injection}",
        ]
        for row in self.registers:
            address = self.wire_address(row)
            rows.append(
                f"wire {address:5}  register {row.register_number:6}  {row.type}  "
                f"{row.access:5}  {row.name}  [{row.scale}] {row.unit}".rstrip()
            )
        return rows


def load_device(path: Path) -> Device:
    """Read one profile.

    Raises
    ------
    ConfigError
        The file cannot be read or is no profile.
    """
    try:
        rows = read_marked(path).values  # bounded, and no pipe
        if "gateway" in rows and "registers" not in rows:
            raise ConfigError(f"{path}: this is a site file; leave --device out")
        return Device.model_validate(rows)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{path}: {where}: {first['msg']}") from error
