"""What the check of a site file may take: a file that somebody sent must not cost the service.

A site file names DBC and EDS files, certificates and responses, and their readers are not ours.
Whatever one of them is made to do, it ends here, in a process of its own.
"""

from __future__ import annotations

import resource

from aff_runtime.base.process_bounds import bound_process

# The check of the largest shipped site (CANopen) takes 1.1 s and 420 MB of address space, of which
# it fills 140 MB; the rest is reserved by libraries. One thread each, or a gateway with many
# processors would have the reservations of all of them (`ONE_THREAD`).
MEMORY_BYTES = 1 << 30
PROCESSOR_S = 20
# A name that no server answers for takes its time without taking the processor.
PATIENCE_S = 30.0
"""The longest that a check of a site file may take, by the clock."""
ANSWER_S = 5.0
"""For the answer of who has checked, beside the check that it waits for."""
ONE_THREAD = {
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
}

_WHAT_TO_DO = "A file that it names is too large or too tangled: look at the newest first."
TOO_LARGE = f"the check needs more than {MEMORY_BYTES >> 30} GB of memory. {_WHAT_TO_DO}"
TOO_LONG = f"the check took more than {PROCESSOR_S} s of processor time. {_WHAT_TO_DO}"
TOO_SLOW = (
    f"the check took longer than {PATIENCE_S:g} s and was ended. A file that it names does not "
    "come, or nobody answers for the name of the PLC."
)


def bound_this_process() -> None:
    """Bound memory and processor time; be the first to go when the whole machine has too little.

    A hard limit that is lower already stays.
    """
    limits = {resource.RLIMIT_AS: MEMORY_BYTES, resource.RLIMIT_CPU: PROCESSOR_S}
    bound_process(limits, oom_score=1000)
