"""Worker processes of all benches: one killed or hanging costs its job a repeat, not the run.

The campaign comes here too. Its rule to know the product by the command line alone is about what
is under test there, and a pool of processes says nothing of a line.
"""

from __future__ import annotations

from sim_plant.base.worker_pool import LostJobError, WorkerPool

__all__ = ["LostJobError", "WorkerPool"]
