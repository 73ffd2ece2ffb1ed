"""The response files that a site names: what they hold, or what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.findings import Finding
from aff_runtime.config.loader import Reading
from aff_runtime.config.plain_file import TooLargeError, read_plain
from aff_runtime.core.response import Provenance, Response

MAX_RESPONSE_BYTES = 1 << 22
"""A longer file is not read. It is 16 times what one packet to the control process takes, so a
response that is too long for that packet is read, and refused with how much passes."""
SAME_CYCLE_S = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedResponses:
    """What the response files of a site hold.

    Attributes
    ----------
    texts : by actuator, of the responses that count. Without one: not measured yet, or below.
    measured : the same, read.
    errors : files that the service does not start with.
    closed : by actuator, files that this user may not read; another user may.
    outdated : files that were measured at another cycle, and do not count.
    """

    texts: dict[str, str]
    measured: dict[str, Response]
    errors: tuple[Finding, ...]
    closed: dict[str, Finding]
    outdated: tuple[Finding, ...]


def response_files(reading: Reading, folder: Path) -> dict[str, Path]:
    """Return where the response of every actuator is kept; ``folder`` : of the site file."""
    return {name: folder / one.response for name, one in reading.site.actuators.items()}


def learned_responses(reading: Reading, folder: Path) -> LearnedResponses:
    """Read every response file that a site names; never raises for what is in one.

    Parameters
    ----------
    folder : of the site file.
    """
    texts: dict[str, str] = {}
    measured: dict[str, Response] = {}
    closed: dict[str, Finding] = {}
    errors, outdated = [], []
    for name, file in response_files(reading, folder).items():
        where = ("actuators", name, "response")
        try:
            text, response = _read(file, name, reading)
        except FileNotFoundError:
            continue
        except PermissionError as error:
            closed[name] = reading.tree.finding(where, f"{file}: {error.strerror}")
        except ConfigError as error:
            errors.append(reading.tree.finding(where, f"{file}: {error}"))
        else:
            if _is_outdated(response.provenance, reading.site.cycle_s):
                said = f"{file}: measured at another cycle_ms; run the probe again"
                outdated.append(reading.tree.finding(where, said))
                continue
            texts[name], measured[name] = text, response
    return LearnedResponses(
        texts=texts,
        measured=measured,
        errors=tuple(errors),
        closed=closed,
        outdated=tuple(outdated),
    )


def _read(file: Path, actuator: str, reading: Reading) -> tuple[str, Response]:
    """Return a response file's text and what it says.

    Raises
    ------
    FileNotFoundError, PermissionError
        There is none, or it is not ours to read.
    ConfigError
        It is no response of this actuator and its signal.
    """
    try:
        text = read_plain(file, MAX_RESPONSE_BYTES).decode("utf-8")
        response = Response.from_json(text)
    except (FileNotFoundError, PermissionError):
        raise
    except OSError as error:
        raise ConfigError(f"{error.strerror}") from None
    except UnicodeDecodeError:
        raise ConfigError("not a response file: not text; run the probe again") from None
    except TooLargeError:
        text = "is too long for a response; remove it and run the probe again"
        raise ConfigError(text) from None
    except ValueError as error:
        raise ConfigError(f"{error}; remove it and run the probe again") from None
    _check_ends(response.provenance, actuator, reading.site.actuators[actuator].error.signal)
    return text, response


def _check_ends(provenance: Provenance, actuator: str, signal: str) -> None:
    """Refuse a response that was measured with another actuator or on another signal."""
    if (provenance.actuator, provenance.signal) != (actuator, signal):
        raise ConfigError(
            f"measured from {provenance.actuator} to {provenance.signal}, not from {actuator} "
            f"to {signal}; remove it and run the probe"
        )


def _is_outdated(provenance: Provenance, cycle_s: float) -> bool:
    """Return whether its delays were others; one that names no cycle (NaN) counts."""
    return abs(provenance.cycle_s - cycle_s) > SAME_CYCLE_S
