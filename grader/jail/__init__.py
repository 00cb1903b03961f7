"""The parts of the sandbox (`grader.sandbox`).

The zygote imports this folder as the package ``jail``, without the rest of the grader. So the modules on its
side (`zygote`, `confine`, `inside`, `namespaces`, `landlock`, `syscalls`, `bounds`, `libc`) import nothing but the
standard library and each other.
"""
