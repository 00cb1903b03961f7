"""What runs one grading.

The parent (service, worker or command line) holds a `Slot` (`slot`). It starts a grading process (`launch`) and
sends it one job after the other over a pipe. That process (`child`) starts a sandbox and a `Pipeline`
(`pipeline`). For each case of the assignment the pipeline runs the script beside the simulated car and merges what
the sandbox and the simulator saw into one account of the run (`outcome`). The checks score it, and the report goes
back. Before a file is accepted, its syntax is checked in a sandbox of the service's own (`preflight`).

This package imports nothing: whoever needs only `launch` must not pay for the physics.
"""
