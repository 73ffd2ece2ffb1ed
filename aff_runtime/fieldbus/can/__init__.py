"""CAN by DBC."""
