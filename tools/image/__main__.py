"""Build the container image, or build it and run its tests: ``python -m tools.image build FOLDER | test``."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tools.image.build import ROOT, build

_NEEDED = ("buildah", "mmdebstrap", "newuidmap", "runc")
_PACKAGES = "buildah mmdebstrap uidmap runc"


def main(arguments: list[str]) -> int:
    """Do what the command line says; return the exit code."""
    missing = [program for program in _NEEDED if shutil.which(program) is None]
    if missing:
        print(f"image: no {', '.join(missing)} here: apt-get install {_PACKAGES}", file=sys.stderr)
        return 2
    match arguments:
        case ["build", folder]:
            Path(folder).mkdir(parents=True)
            image = build(Path(folder).resolve())
            print(f"image: {image.size_bytes / 1e6:.0f} MB in {folder}")
            return 0
        case ["test", *more]:
            return _test(more)
    print(__doc__, file=sys.stderr)
    return 2


def _test(arguments: list[str]) -> int:
    folder = Path(tempfile.mkdtemp(prefix="grader-image-"))
    folder.chmod(0o755)
    try:
        build(folder)
        return _pytest(folder, arguments)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _pytest(folder: Path, arguments: list[str]) -> int:
    command = [sys.executable, "-m", "pytest", "tests/container", *arguments]
    return subprocess.call(command, cwd=ROOT, env={**os.environ, "GRADER_IMAGE": str(folder)})


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
