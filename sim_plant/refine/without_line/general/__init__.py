"""General effects of records without a line: one file each, and what fits and weighs them."""

__all__ = ["catalogue", "effect", "findings", "judging", "least_squares", "search"]
