"""The declared line under a record, and every effect and declared number that may differ."""
