"""Site files: strict YAML, pydantic models, check."""

__all__ = [
    "can_wire",
    "check",
    "crossings",
    "devices",
    "diff",
    "facts",
    "findings",
    "identified_drive",
    "loader",
    "models",
    "plain_file",
    "probe_bound",
    "reference",
    "revision",
    "site_paths",
    "wire_table",
    "x509",
    "yaml_marks",
]
