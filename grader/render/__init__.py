"""Graded results made readable: terminal tables, plots, documents for other platforms.

Import the module you need, where you need it: this package imports nothing, `terminal`, `timeline`,
`dashboard` and `rubric` cost rich (90 ms), `plot` costs matplotlib, `documents` and `escape` neither.
"""
