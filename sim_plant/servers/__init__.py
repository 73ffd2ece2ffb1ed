"""The line in real time behind a PLC on a wire."""
