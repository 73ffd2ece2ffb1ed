"""Balances only: span, roller, material roll, drive, load cell."""
