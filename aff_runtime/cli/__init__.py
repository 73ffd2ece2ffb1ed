"""The aff-runtime command."""
