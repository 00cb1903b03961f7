"""Attack: system calls that are rarely thought of.

Expected: finished
"""

import ctypes
import platform

libc = ctypes.CDLL(None, use_errno=True)
X86 = {"keyctl": 250, "add_key": 248, "bpf": 321, "perf_event_open": 298, "userfaultfd": 323, "io_uring_setup": 425,
       "name_to_handle_at": 303, "open_by_handle_at": 304, "kcmp": 312, "process_madvise": 440, "pidfd_getfd": 438,
       "memfd_secret": 447, "shmget": 29, "semget": 64, "msgget": 68, "mq_open": 240, "quotactl": 179, "acct": 163,
       "swapon": 167, "reboot": 169, "sethostname": 170, "init_module": 175, "kexec_load": 246, "ioperm": 173, "iopl": 172,
       "modify_ldt": 154, "sysfs": 139, "ustat": 136, "syslog": 103, "vhangup": 153, "fanotify_init": 300,
       "inotify_init1": 294, "timer_create": 222, "timerfd_create": 283, "setitimer": 38, "alarm": 37, "signalfd4": 289,
       "rt_sigqueueinfo": 129, "rt_tgsigqueueinfo": 297, "tkill": 200, "sendmsg": 46, "recvmsg": 47, "sendmmsg": 307,
       "accept4": 288, "listen": 50, "connect": 42, "bind": 49, "socket": 41, "splice": 275, "vmsplice": 278,
       "sendfile": 40, "copy_file_range": 326, "process_vm_readv": 310, "clock_settime": 227, "settimeofday": 164,
       "adjtimex": 159, "landlock_create_ruleset": 444, "seccomp": 317, "mount_setattr": 442, "fsopen": 430,
       "open_tree": 428, "move_mount": 429, "pivot_root": 155, "capset": 126, "arch_prctl": 158, "set_mempolicy": 238,
       "mbind": 237, "move_pages": 279, "migrate_pages": 256, "remap_file_pages": 216, "ioprio_set": 251,
       "sched_setaffinity": 203, "sched_setattr": 314, "futex_waitv": 449, "setsockopt": 54, "openat2": 437}
if platform.machine() == "x86_64":
    for name, number in X86.items():
        ctypes.set_errno(0)
        result = libc.syscall(ctypes.c_long(number), *(ctypes.c_long(0) for _ in range(6)))
        print("held:" if result < 0 and ctypes.get_errno() == 1 else f"BREACH: {result} {ctypes.get_errno()}", name)
    # The same numbers in the table of the 32-bit ABI on 64 bits are refused by the filter as well.
else:
    print("held: numbers of another machine")
