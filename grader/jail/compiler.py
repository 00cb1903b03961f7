"""Build the seccomp filters of `policy.SYSCALLS` with libseccomp, for shipping.

Run as ``python -m grader.jail.compiler`` after a change of the policy. libseccomp (through `pyseccomp`) is
needed here only: a confined process loads the shipped bytes, so that a start costs no compilation and a
host without libseccomp can grade.
"""

import tempfile

import pyseccomp  # type: ignore[import-untyped]

from grader.jail import policy
from grader.jail.libc import SUPPORTED_MACHINES
from grader.jail.supervisor import FILTER_DIRECTORY


def compile_filter(machine: str) -> bytes:
    """Return the BPF program of the policy for `machine` (``x86_64`` or ``aarch64``).

    Raises:
        OSError: libseccomp refused a rule.
    """
    arch = {"x86_64": pyseccomp.Arch.X86_64, "aarch64": pyseccomp.Arch.AARCH64}[machine]
    program = pyseccomp.SyscallFilter(pyseccomp.ERRNO(policy.REFUSED_ERRNO))
    program.set_attr(pyseccomp.Attr.ACT_BADARCH, pyseccomp.KILL_PROCESS)
    if arch != pyseccomp.system_arch():
        program.add_arch(arch)
        program.remove_arch(pyseccomp.system_arch())
    for name, rules in policy.SYSCALLS.items():
        if pyseccomp.resolve_syscall(arch, name) < 0:
            continue  # this architecture never had the call
        for rule in rules:
            program.add_rule(pyseccomp.ALLOW, name, *(_condition(part) for part in rule))
    for name in policy.REFUSED_AS_MISSING:
        program.add_rule(pyseccomp.ERRNO(38), name)  # ENOSYS
    with tempfile.TemporaryFile() as file:
        program.export_bpf(file)
        file.seek(0)
        return file.read()


def _condition(part: policy.Arg) -> pyseccomp.Arg:
    index, value, mask = part
    if mask:
        return pyseccomp.Arg(index, pyseccomp.MASKED_EQ, mask, value)
    return pyseccomp.Arg(index, pyseccomp.EQ, value)


def main() -> None:
    """Write the filter of every supported architecture."""
    FILTER_DIRECTORY.mkdir(exist_ok=True)
    for machine in SUPPORTED_MACHINES:
        (FILTER_DIRECTORY / f"{machine}.bpf").write_bytes(compile_filter(machine))


if __name__ == "__main__":
    main()
