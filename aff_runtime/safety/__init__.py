"""The last word on every output; knows no law."""
