"""From a site file to the parts that the control process runs."""

__all__ = [
    "assemble",
    "impulse_responses",
    "law_slot",
    "shape_file",
    "site_to_guard",
    "site_to_law",
    "site_to_wire",
    "wires",
]
