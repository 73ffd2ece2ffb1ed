"""Error before and after on a record that took no part in the fit."""

__all__ = ["apart", "holdout", "refutation", "rest_shown"]
