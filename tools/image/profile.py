"""Docker's default filter of system calls, resolved for one container as Docker does it.

The profile itself is Docker's own file, taken out of Debian's package of Docker's sources.
"""

import json
import os
import platform
import re
import subprocess
from collections.abc import Set
from pathlib import Path
from typing import Any, Final

_PACKAGE: Final = "golang-github-docker-docker-dev"
_FILE: Final = "./usr/share/gocode/src/github.com/docker/docker/profiles/seccomp/default.json"
_ARCHITECTURES: Final = {"x86_64": ("amd64", "SCMP_ARCH_X86_64"), "aarch64": ("arm64", "SCMP_ARCH_AARCH64")}
_EPERM: Final = 1


def fetch(folder: Path) -> dict[str, Any]:
    """Return Docker's profile, downloaded by ``apt-get`` into `folder` (its signature is checked).

    Raises:
        subprocess.CalledProcessError: there is no such package here.
    """
    subprocess.run(["apt-get", "download", "-qq", _PACKAGE], cwd=folder, check=True)
    package = next(folder.glob(f"{_PACKAGE}_*.deb"))
    contents = subprocess.run(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE, check=True)
    taken = subprocess.run(["tar", "-xO", _FILE], input=contents.stdout, stdout=subprocess.PIPE, check=True)
    profile: dict[str, Any] = json.loads(taken.stdout)
    return profile


def resolve(profile: dict[str, Any], capabilities: Set[str] = frozenset()) -> dict[str, Any]:
    """Return `profile` as the OCI runtime specification wants it, for a process with `capabilities`."""
    name, machine = _ARCHITECTURES[platform.machine()]
    entry = next(one for one in profile["archMap"] if one["architecture"] == machine)
    return {
        "defaultAction": profile["defaultAction"],
        "defaultErrnoRet": profile.get("defaultErrnoRet", _EPERM),
        "architectures": [machine, *(entry["subArchitectures"] or ())],
        "syscalls": [_rule(rule) for rule in profile["syscalls"] if _applies(rule, name, capabilities)],
    }


def _applies(rule: dict[str, Any], architecture: str, capabilities: Set[str]) -> bool:
    """Whether all that `rule` includes holds here, and nothing that it excludes."""
    includes, excludes = rule.get("includes") or {}, rule.get("excludes") or {}
    if includes.get("arches") and architecture not in includes["arches"]:
        return False
    if not set(includes.get("caps") or ()) <= capabilities:
        return False
    if includes.get("minKernel") and _kernel() < _numbers(includes["minKernel"]):
        return False
    return architecture not in (excludes.get("arches") or ()) and not (
        set(excludes.get("caps") or ()) & capabilities
    )


def _rule(rule: dict[str, Any]) -> dict[str, Any]:
    kept = {key: rule[key] for key in ("names", "action", "args", "errnoRet") if rule.get(key) is not None}
    return {key: value for key, value in kept.items() if value != []}


def _kernel() -> tuple[int, ...]:
    return _numbers(os.uname().release)


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"\d+", version)[:2])
