"""Build the container image and run it, without a container daemon.

`build` makes a Debian base and builds the Dockerfile on it, as an unprivileged user (`unprivileged`); `runtime`
runs what came of it with the restrictions of an ordinary Docker container, `profile` being its filter of system
calls. ``python -m tools.image test`` does all of it and then runs tests/container.
"""
