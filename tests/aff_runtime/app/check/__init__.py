"""Tests of the check of a site file."""
