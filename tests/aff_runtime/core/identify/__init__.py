"""Tests of the drive's identification."""
