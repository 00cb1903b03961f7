"""What runs one grading.

The parent (service, worker or command line) holds a `Slot` (`slot`). It starts a grading process (`launch`), and
sends it one job after the other over a pipe. That process (`child`) builds the sandbox (`bootstrap`) and a
`Pipeline` (`pipeline`), which for each case of the assignment runs the script beside the simulated car, merges
what the two saw into one account of the run (`outcome`), has it scored by the checks and returns the report.
Before a file is accepted, its syntax is checked in a sandbox of the service's own (`preflight`).

This package imports nothing: whoever needs only `launch` must not pay for the physics.
"""
