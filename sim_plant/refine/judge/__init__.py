"""Error before and after on a record that took no part in the fit."""

__all__ = ["holdout", "refutation", "rest_shown"]
