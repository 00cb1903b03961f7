"""From nothing to a root file system: a Debian base, the Dockerfile on it, both made without privileges."""

import configparser
import json
import os
import shutil
import subprocess
import sys
import tarfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self

from tools.image import unprivileged

ROOT: Final = Path(__file__).resolve().parents[2]
_SUITE: Final = "bookworm"
_BASE: Final = "localhost/debian:bookworm-slim"
_IMAGE: Final = "localhost/grader"
_INDEX_SETTINGS: Final = (
    "cert", "default-timeout", "extra-index-url", "index-url", "no-index", "proxy", "retries", "timeout",
    "trusted-host",
)  # fmt: skip
_SOURCES: Final = Path("/etc/apt/sources.list")
_SOURCES_FOLDER: Final = Path("/etc/apt/sources.list.d")
_CONTEXT: Final = (
    "Dockerfile", ".dockerignore", "README.md", "assignments",
    "docs/exercises.md", "docs/exercises.zh.md", "docs/instructor.md", "docs/instructor.zh.md",
    "docs/student.md", "docs/student.zh.md",
    "grader", "lesson", "pyproject.toml",
    "requirements-build.lock", "requirements.lock", "requirements-extras.lock",
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Image:
    """A built image.

    Attributes:
        archive: its files, with their owners.
        config: the part of its configuration that a container engine obeys (``Cmd``, ``User``, ...).
        size_bytes: of its layers, unpacked.
    """

    archive: Path
    config: dict[str, Any]
    size_bytes: int

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Return what `build` has made in `folder`."""
        about = json.loads((folder / "image.json").read_bytes())
        return cls(archive=folder / "rootfs.tar", config=about["config"], size_bytes=about["size_bytes"])


def build(folder: Path) -> Image:
    """Build the image, with everything that takes, in the empty `folder`; each step says how long it took.

    Raises:
        subprocess.CalledProcessError: a step failed; what it said went to stderr.
    """
    work = folder / "build"
    work.mkdir()
    unprivileged.give(work)
    with _timed("base"):
        _make_base(work)
    with _timed("image"):
        _build_image(work)
    with _timed("export"):
        _export(work)
    about = json.loads(_run(work, *_buildah(work), "inspect", "--type=image", _IMAGE))
    archive = (work / "rootfs.tar").rename(folder / "rootfs.tar")
    image = {"config": about["Docker"]["config"], "size_bytes": _size_bytes(archive)}
    (folder / "image.json").write_text(json.dumps(image), encoding="utf-8")
    _run(work, "rm", "-r", f"{work}/store", f"{work}/run")
    shutil.rmtree(work)
    return Image.load(folder)


@contextmanager
def _timed(what: str) -> Iterator[None]:
    """Say on stderr how long a step took."""
    started = time.monotonic()
    yield
    print(f"image: {what}: {time.monotonic() - started:.0f} s", file=sys.stderr, flush=True)


def _make_base(work: Path) -> None:
    """Make what the published image of the same name holds, from the package sources of this machine."""
    archive = work / "base.tar"
    leave_out = ("man/*", "locale/*/LC_MESSAGES/*", "doc/*")
    options = [
        "--dpkgopt=force-unsafe-io",
        *(f"--dpkgopt=path-exclude=/usr/share/{path}" for path in leave_out),
    ]
    _run(
        work, "mmdebstrap", "--quiet", "--mode=root", "--variant=minbase", *options,
        "--dpkgopt=path-include=/usr/share/doc/*/copyright", _SUITE, str(archive), *_sources(),
    )  # fmt: skip
    container = _run(work, *_buildah(work), "from", "scratch").strip()
    _run(work, *_buildah(work), "add", "--quiet", container, str(archive), "/")
    _run(work, *_buildah(work), "commit", "--quiet", "--rm", container, _BASE)
    archive.unlink()


def _export(work: Path) -> None:
    """Write the image's files, with their owners, to ``rootfs.tar``."""
    container = _run(work, *_buildah(work), "from", _IMAGE).strip()
    # in one go: what is mounted is seen by this process of the namespace alone
    script = 'mounted=$("$@") && tar -C "$mounted" --numeric-owner -cf rootfs.tar .'
    _run(work, "sh", "-c", script, "sh", *_buildah(work), "mount", container)


def _size_bytes(archive: Path) -> int:
    with tarfile.open(archive) as files:
        return sum(member.size for member in files if member.isfile())


def _sources() -> list[str]:
    """Return this machine's lists of package sources; none where it is not a Debian of that suite."""
    files = [file for file in [_SOURCES, *_SOURCES_FOLDER.iterdir()] if file.exists()]
    return [
        str(file) for file in files if file.suffix in (".list", ".sources") and _SUITE in file.read_text()
    ]


def _build_image(work: Path) -> None:
    context = work / "context"
    context.mkdir()
    for name in _CONTEXT:
        source = ROOT / name
        (context / name).parent.mkdir(exist_ok=True)
        copy = shutil.copytree if source.is_dir() else shutil.copy
        copy(source, context / name)
    subprocess.run(["chmod", "-R", "a+rX", context], check=True)
    secrets = [f"--secret=id={name},src={file}" for name, file in _pip_settings(work).items()]
    _run(
        work, *_buildah(work), "build", "--quiet", "--format=docker", f"--build-arg=BASE={_BASE}", *secrets,
        f"--tag={_IMAGE}", str(context),
    )  # fmt: skip


def _pip_settings(work: Path) -> dict[str, Path]:
    """Write how pip reaches its index on this machine into one file, so that the build reaches the same.

    Nothing else is taken over: other settings name files of this machine, and the lock files say what to install.
    """
    listed = subprocess.run(
        [sys.executable, "-m", "pip", "config", "list"], stdout=subprocess.PIPE, text=True, check=True
    )
    settings = configparser.RawConfigParser()
    settings["global"] = {}
    for line in listed.stdout.splitlines():
        key, _, quoted = line.partition("=")
        if (name := key.rpartition(".")[2]) in _INDEX_SETTINGS:
            settings["global"][name] = quoted.strip("'\"")
    given = {"pip.conf": work / "pip.conf"}
    if "cert" in settings["global"]:
        given["ca.crt"] = work / "ca.crt"
        shutil.copy(settings["global"]["cert"], given["ca.crt"])
        settings["global"]["cert"] = "/etc/pip-ca.crt"
    with given["pip.conf"].open("w") as file:
        settings.write(file)
    for path in given.values():
        path.chmod(0o644)
    return given


def _buildah(work: Path) -> list[str]:
    return ["buildah", f"--root={work}/store", f"--runroot={work}/run"]


def _run(work: Path, *command: str) -> str:
    """Run `command` unprivileged and return what it printed; chroot isolation needs no rights at all."""
    environment = {
        **os.environ,
        "BUILDAH_ISOLATION": "chroot",
        "HOME": str(work),
        "TMPDIR": str(work),
        "XDG_RUNTIME_DIR": str(work),
        "_CONTAINERS_USERNS_CONFIGURED": "1",
    }
    done = subprocess.run(
        unprivileged.command(*command),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        cwd=work,
        env=environment,
    )
    return done.stdout
