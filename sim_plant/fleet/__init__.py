"""Many lines, many cases: spread over a Dask cluster, one row each."""

__all__ = ["example", "job_child", "pipeline"]
