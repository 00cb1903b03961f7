"""What a confined process may use and read besides system calls, and what its supervisor tolerates.

Every number and path of the sandbox stands here. What is not named is refused. Both the zygote and the supervisor
import this module: pure data and arithmetic, standard library only.
"""

import math
import resource
from typing import Final

MIB: Final = 1024 * 1024
CHANNEL_FD: Final = 3

# ---------------------------------------------------------------------------------------------- resources

ADDRESS_SPACE_OVERHEAD_BYTES: Final = 384 * MIB
"""Room for mappings that use no memory of their own: shared libraries, guard areas. It also bounds a script's
shared mappings, which the limit on private memory does not count."""

THREAD_STACK_BYTES: Final = 4 * MIB
CPU_BACKSTOP: Final = 3
"""The kernel's own CPU limit, as a multiple of the one that the supervisor enforces to the millisecond. The kernel
counts by ticks: on a busy host it took 4.3 s for 5, and its kill cannot be told from anybody else's."""


def resource_limits(cpu_s: float, memory_bytes: int, threads: int | None) -> dict[int, int]:
    """Return the rlimits of a confined process, soft = hard.

    `threads`: how many it may have; None where the kernel could not count this process alone.
    """
    limits = {
        resource.RLIMIT_AS: memory_bytes + ADDRESS_SPACE_OVERHEAD_BYTES,
        resource.RLIMIT_DATA: memory_bytes,
        resource.RLIMIT_CPU: CPU_BACKSTOP * math.ceil(cpu_s),
        resource.RLIMIT_FSIZE: 0,
        resource.RLIMIT_NOFILE: 64,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_STACK: 8 * MIB,
        resource.RLIMIT_MEMLOCK: 0,
    }
    if hasattr(resource, "RLIMIT_MSGQUEUE"):
        limits[resource.RLIMIT_MSGQUEUE] = 0
    if threads is not None:
        limits[resource.RLIMIT_NPROC] = threads + 1
    return limits


# ------------------------------------------------------------------------------------------------- files

STDLIB_EXCLUDED: Final = frozenset(
    {"site-packages", "dist-packages", "test", "idlelib", "ensurepip", "turtledemo", "lib2to3"}
)
"""Entries of the standard library's directory that a confined process cannot read."""

SHARED_LIBRARY_DIRECTORIES: Final = (
    "/lib64",
    "/usr/lib64",
    "/lib/x86_64-linux-gnu",
    "/usr/lib/x86_64-linux-gnu",
    "/lib/aarch64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
)

WRITABLE_DEVICES: Final = ("/dev/null",)
READABLE_DEVICES: Final = ("/dev/urandom",)

ALLOWED_PACKAGES: Final = {"numpy": ("numpy", "numpy.libs"), "yaml": ("yaml",)}
"""Third-party packages a script may import, with the directories each needs. Both come with ROS 2 itself."""

PYBULLET_MODELS: Final = (
    "TwoJointRobot_w_fixedJoints.urdf TwoJointRobot_wo_fixedJoints.urdf __init__.py block.urdf cartpole.urdf "
    "checker_blue.png checker_grid.jpg checker_huge.gif cube.obj cube.png cube.urdf cube_no_rotation.urdf "
    "cube_rotate.urdf cube_small.urdf duck.mtl duck.obj duckCM.png duck_vhacd.obj duck_vhacd.urdf franka_panda "
    "kuka_iiwa l_finger.stl l_finger_collision.stl l_finger_tip.stl lego pendulum5.urdf plane.mtl plane.obj "
    "plane.urdf plane100.obj plane100.urdf plane_implicit.urdf plane_transparent.mtl plane_transparent.obj "
    "plane_transparent.urdf r2d2.urdf racecar sphere2.urdf sphere2red.urdf sphere_1cm.urdf sphere_small.urdf "
    "sphere_smooth.mtl sphere_smooth.obj sphere_transparent.urdf sphere_with_restitution.urdf table table_square "
    "tex256.png textured_sphere_smooth.mtl textured_sphere_smooth.obj tray"
)
"""What scripts can load of the 142 MB of models that come with PyBullet: 16 MB."""

PYBULLET_PACKAGES: Final = {
    "pybullet_data": tuple(f"pybullet_data/{name}" for name in PYBULLET_MODELS.split()),
    "pybullet_utils": ("pybullet_utils",),
    "pybullet_robots": ("pybullet_robots",),
}
"""What a script of the world ``pybullet`` may import besides; the extension is loaded before it is confined."""

# ------------------------------------------------------------------------------------------- environment

ENVIRONMENT: Final = {
    "PYTHONHASHSEED": "0",  # sets and dicts of strings iterate in the same order in every run
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",  # 64 MiB of address space per thread otherwise
    "MALLOC_MMAP_THRESHOLD_": str(32 * MIB),  # a picture's megabyte is used again, not mapped anew each time
    "MALLOC_TRIM_THRESHOLD_": str(64 * MIB),
    "TZ": "UTC0",
}
"""All of the zygote's environment, and so of every confined process."""

# ------------------------------------------------------------------------------------------------ own uid

BOX_UID_BASE: Final = 0x7000_0000
"""First of the ids that systemd's allocation table leaves unused; the slot's process id is added."""
BOX_UID_BASE_MAPPED: Final = 60706
BOX_UID_COUNT_MAPPED: Final = 478
"""Unused range within 16 bits, for containers that map no more ids."""

# ------------------------------------------------------------------------------------------- supervision

FRAME_MAX_BYTES: Final = 65_536
"""Largest frame body accepted from a confined process."""
FRAMES_MAX: Final = 500_000
CHANNEL_MAX_BYTES: Final = 128 * MIB
"""What one run may send; a busy loop that publishes for a minute of virtual time stays far below."""
STREAM_HEAD_BYTES: Final = 64 * 1024
STREAM_TAIL_BYTES: Final = 64 * 1024
IDLE_LIMIT_NS: Final = 3_000_000_000
"""A process whose every thread sleeps in the kernel that long in all, while it owes a frame, is stalled.

The shim sleeps in real time only for a moment, while the host has no thread to spare. A thread that an overloaded
host keeps waiting is not asleep but ready."""
WALL_STRETCH: Final = 15
"""So many times its wall limit a run may last on a busy host."""
WALL_STRETCH_S: Final = 480.0
"""And so much longer than its wall limit, so that nothing holds a slot for half an hour. Beside eight busy
processes on two cores a run of the service, which gives way to them, gets a fortieth of a core: 10 s of CPU time,
which all the steps that are granted take, are 400 s there."""
ENOUGH_CPU: Final = 0.4
"""Of the CPU time granted: a run that is past its wall limit and has used so much is the script's excess. All the
steps that are granted take a third, so only what cannot be counted takes more."""
ENOUGH_SILENT_CPU: Final = 0.2
"""The same for a run that has sent and printed nothing for half of the CPU time it has used: it hangs. Where it
gets a seventieth of a core, as beside eight busy processes and others, it would hardly come to more."""
STARVED_NS: Final = 10_000_000_000
"""Beyond its wall limit a run must use some CPU time as often as this, or the host is at fault."""
WORK_PER_CPU: Final = 3.0
"""CPU time that the grader spends on a run's messages, per second granted to the script, before it counts as the
script's excess. The longest honest runs of the course need a tenth of what is granted."""
DRAIN_LIMIT_NS: Final = 50_000_000
"""How long output is read after the end: a pipe that another process still holds must not delay the report."""


def longest_run_s(wall_s: float) -> float:
    """Return how long a run whose wall limit is `wall_s` may last on a busy host."""
    return min(WALL_STRETCH * wall_s, wall_s + WALL_STRETCH_S)
