"""What bounds the grader from outside, read from the kernel's files as hosts and containers show them."""

from pathlib import Path

import pytest

from grader.jail.cgroups import Bound, own_bound

MIB = 1 << 20
NO_LIMIT_V1 = "9223372036854771712"


def host(folder: Path, mountinfo: str, cgroup: str, files: dict[str, str]) -> Bound:
    """Lay out a host below `folder`; in `mountinfo`, @ stands for the folder."""
    proc = folder / "proc"
    proc.mkdir()
    (proc / "mountinfo").write_text(mountinfo.replace("@", str(folder)))
    (proc / "cgroup").write_text(cgroup)
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n")
    return own_bound(proc)


V2 = "30 23 0:26 / @/cg rw,nosuid - cgroup2 cgroup2 rw\n22 1 0:5 / /proc rw - proc proc rw\n"
V1 = (
    "35 31 0:32 / @/cg/memory rw,relatime - cgroup cgroup rw,memory\n"
    "39 31 0:36 / @/cg/pids rw,relatime - cgroup cgroup rw,pids\n"
    "41 31 0:38 / @/cg/unified rw,relatime - cgroup2 cgroup2 rw\n"
)


def test_a_service_unit_with_limits(tmp_path: Path) -> None:
    files = {
        "cg/system.slice/grader.service/memory.max": str(2048 * MIB),
        "cg/system.slice/grader.service/pids.max": "512",
        "cg/system.slice/memory.max": "max",
    }
    bound = host(tmp_path, V2, "0::/system.slice/grader.service\n", files)
    assert bound == Bound(version=2, memory_bytes=2048 * MIB, tasks=512)


def test_the_smallest_limit_on_the_way_up_holds(tmp_path: Path) -> None:
    files = {"cg/a/memory.max": str(64 * MIB), "cg/a/b/memory.max": str(128 * MIB), "cg/a/b/pids.max": "max"}
    assert host(tmp_path, V2, "0::/a/b\n", files).memory_bytes == 64 * MIB


def test_a_container_sees_its_own_group_as_the_root(tmp_path: Path) -> None:
    files = {"cg/memory.max": str(512 * MIB), "cg/pids.max": "100"}
    bound = host(tmp_path, V2, "0::/\n", files)
    assert (bound.version, bound.memory_bytes, bound.tasks) == (2, 512 * MIB, 100)


def test_a_path_of_another_namespace_falls_back_to_what_is_mounted(tmp_path: Path) -> None:
    files = {"cg/memory.max": str(512 * MIB)}
    assert host(tmp_path, V2, "0::/../other\n", files).memory_bytes == 512 * MIB


def test_version_1_beside_an_empty_version_2(tmp_path: Path) -> None:
    files = {
        "cg/memory/docker/x/memory.limit_in_bytes": str(256 * MIB),
        "cg/memory/docker/memory.limit_in_bytes": NO_LIMIT_V1,
        "cg/pids/docker/x/pids.max": "64",
        "cg/unified/cgroup.procs": "",
    }
    bound = host(tmp_path, V1, "8:pids:/docker/x\n4:memory:/docker/x\n0::/\n", files)
    assert (bound.version, bound.memory_bytes, bound.tasks) == (1, 256 * MIB, 64)


def test_a_bind_mounted_group_of_version_1(tmp_path: Path) -> None:
    mountinfo = "35 31 0:32 /docker/x @/cg/memory ro - cgroup cgroup rw,memory\n"
    files = {"cg/memory/memory.limit_in_bytes": str(256 * MIB)}
    assert host(tmp_path, mountinfo, "4:memory:/docker/x\n", files).memory_bytes == 256 * MIB


@pytest.mark.parametrize(
    ("mountinfo", "cgroup", "files", "version"),
    [
        ("", "", {}, 0),
        ("22 1 0:5 / /proc rw - proc proc rw\n", "0::/\n", {}, 0),
        (V1, "8:pids:/\n4:memory:/\n", {"cg/memory/memory.limit_in_bytes": NO_LIMIT_V1}, 1),
        (V2, "0::/a\n", {"cg/a/memory.max": "max", "cg/a/pids.max": "max"}, 2),
        (V2, "0::/a\n", {"cg/a/memory.max": "nonsense"}, 2),
    ],
)
def test_without_limits(
    tmp_path: Path, mountinfo: str, cgroup: str, files: dict[str, str], version: int
) -> None:
    bound = host(tmp_path, mountinfo, cgroup, files)
    assert (bound.version, bound.memory_bytes, bound.tasks) == (version, None, None)


def test_a_host_without_the_files(tmp_path: Path) -> None:
    assert own_bound(tmp_path / "none") == Bound()


def test_this_host_is_readable() -> None:
    assert own_bound().version in (0, 1, 2)
