"""What a check is given where nothing is wrong."""

from aff_runtime.base.signals import Outcome, Snapshot

GOOD = Snapshot(
    tick=0,
    t_ns=0,
    outcome=Outcome.OK,
    fresh=True,
    age_s=0.0,
    plc_heartbeat=0,
    status=0,
    roll_id=0,
    values=(),
)
