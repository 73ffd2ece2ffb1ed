"""The engine of setup."""
