"""Labelled pairs of a second simulator of its own: ``python -m benchmarks.blind``.

A line of the kind of ``shared/data/cases``, written from the physics: the state of a span is the
unstretched length in it, rolls and rollers are bodies with their own centres, four Runge-Kutta
slopes per half millisecond. Of the product only the command line is run.
"""
