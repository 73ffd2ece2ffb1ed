"""A learned shape as a file: what a refinement may start from and what arms the next start."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from aff_runtime.base.errors import ConfigError

FORMAT = "aff-shape-1"


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeProfile:
    """Shapes of rolls: W by (roll, order), m, at the roll angle's zero; d likewise, a number.

    ``weight_m`` is the complex deviation of the moment arm, arm = R + Re sum W e^{j n theta};
    ``correction`` is the learned d of P (true P = (1 + d) P), which may be missing.
    ``imbalance_m`` is the weight of a roll's imbalance column, 100 N m per m, where there is one.
    """

    weight_m: Mapping[tuple[str, int], complex]
    correction: Mapping[tuple[str, int], complex]
    imbalance_m: Mapping[str, complex] = field(default_factory=dict)

    def to_json(self) -> str:
        """Return text that ``from_json`` reads back."""
        rows = [
            {
                "roll": roll, "order": order, "re_m": w.real, "im_m": w.imag,
                "d_re": self.correction.get((roll, order), 0j).real,
                "d_im": self.correction.get((roll, order), 0j).imag,
            }
            for (roll, order), w in self.weight_m.items()
        ]  # fmt: skip
        heavy = [
            {"roll": roll, "re_m": w.real, "im_m": w.imag} for roll, w in self.imbalance_m.items()
        ]
        found = {"format": FORMAT, "columns": rows, "imbalance": heavy}
        return json.dumps(found, indent=1, allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> ShapeProfile:
        """Read ``to_json``'s text; ConfigError says what is wrong with any other."""
        try:
            data = json.loads(text)
            if data["format"] != FORMAT:
                raise ConfigError(f"shape format {data['format']!r}, need {FORMAT!r}")
            weight: dict[tuple[str, int], complex] = {}
            correction: dict[tuple[str, int], complex] = {}
            for row in data["columns"]:
                key = (str(row["roll"]), int(row["order"]))
                weight[key] = complex(float(row["re_m"]), float(row["im_m"]))
                correction[key] = complex(float(row["d_re"]), float(row["d_im"]))
            heavy = {
                str(row["roll"]): complex(float(row["re_m"]), float(row["im_m"]))
                for row in data.get("imbalance", ())
            }
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise ConfigError(f"not a shape file: {error}; learn the roll again") from error
        for w in (*weight.values(), *correction.values(), *heavy.values()):
            if not (math.isfinite(w.real) and math.isfinite(w.imag)):
                raise ConfigError("a shape file holds a number that is not finite")
        return cls(weight_m=weight, correction=correction, imbalance_m=heavy)
