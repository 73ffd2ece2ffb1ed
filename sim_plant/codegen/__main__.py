"""``python -m sim_plant.codegen``: write the lanes' C anew after a change of the kernel."""

from __future__ import annotations

from pathlib import Path

from sim_plant.codegen.write import lanes_source

LANES_C = Path(__file__).parent.parent / "lanes" / "kernel_lanes.h"

if __name__ == "__main__":
    LANES_C.write_text(lanes_source())
