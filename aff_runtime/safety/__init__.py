"""The last word on every output; knows no law."""

__all__ = ["guard", "params", "reasons"]
