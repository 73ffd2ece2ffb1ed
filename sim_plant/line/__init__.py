"""Declared lines: loader, compiled kernel, frequency model, simulation."""
