"""What one run may use."""

from grader.contracts.record import record

MIB = 1024 * 1024


@record
class Limits:
    """Budget of one jailed run.

    Attributes:
        cpu_s: CPU seconds of the student's process; exceeding it is the student's ``cpu_limit``.
        wall_s: detects trouble of the host only; exceeding it is an infrastructure fault and a retry.
        memory_bytes: private memory of the student's process.
        output_bytes: bytes on stdout and stderr together before the run is ended.
        threads: most threads at once.
        grace_cpu_s: CPU seconds left to `except KeyboardInterrupt` / `finally` after the horizon.
    """

    cpu_s: float = 10.0
    wall_s: float = 60.0
    memory_bytes: int = 512 * MIB
    output_bytes: int = 4 * MIB
    threads: int = 64
    grace_cpu_s: float = 1.0
