"""Forward selection: which effects explain the residual, one after another."""

__all__ = ["forward_selection", "selection", "unexplained"]
