"""Geometry of a driven path: pure numpy, no I/O.

`path` turns recorded poses into a driven path and cuts it into straights and turns, `figure` measures the polygon
they make.
"""
