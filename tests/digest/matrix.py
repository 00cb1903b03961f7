"""``python -m tests.digest.matrix``: the same reports with every arithmetic that this machine can be told to use.

BLAS kernels, numpy's and the C library's variants for processors of other years, and with ``--python`` other
interpreters with their numpy and their build of the simulator. Each setting also holds in the sandbox. Prints one
hash for each, and which scripts differ from the first. Of a replayed PyBullet world only the marks are compared,
and where the C library rounds otherwise not even they: such a report names how (``libm`` in its `simulator`).
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from tests.digest import Line, compared, digest, portable, read
from tests.digest.gradings import gradings, replays, touching

_ROOT = Path(__file__).resolve().parents[2]
_CORE = (getattr(np, "_core", None) or np.core)._multiarray_umath
_OLDER = ("AVX2", "FMA3")
_LIBM = "GLIBC_TUNABLES"
_KERNELS = ("Prescott", "Haswell", "SkylakeX", "Zen")


def settings() -> Iterator[tuple[str, Mapping[str, str]]]:
    """Yield the name and the environment of each setting; numpy refuses names that the processor lacks."""
    yield "as it is", {}
    for kernel in _KERNELS:
        yield f"OpenBLAS {kernel}", {"OPENBLAS_CORETYPE": kernel}
    present = [name for name in _CORE.__cpu_dispatch__ if _CORE.__cpu_features__.get(name)]
    wide = [name for name in present if name.startswith("AVX512")]
    for name, without in (("AVX-512", wide), ("AVX-512, AVX2, FMA", [*wide, *(set(_OLDER) & set(present))])):
        if without:
            yield f"numpy without {name}", {"NPY_DISABLE_CPU_FEATURES": " ".join(without)}
    yield "C library without AVX2, FMA", {_LIBM: "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F"}


def main() -> int:
    """Return 1 when a setting gives other reports than the first."""
    options = _parser().parse_args()
    runs = [(name, sys.executable, env) for name, env in settings()]
    runs += [(python, python, {}) for python in options.python]
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(options.at_once) as threads:
        tables = list(threads.map(partial(_table, Path(folder), options), *zip(*runs, strict=True)))
    first = {line.id: line for line in tables[0]}
    contacts, same = touching(gradings()), True
    for (name, _, environment), table in zip(runs, tables, strict=True):
        print(f"{digest(table)}  {len(table)} reports  {name}")
        differing = [line.id for line in table if first[line.id] != line]
        if differing:
            print("\n".join(differing))
            print("\n".join(compared(first, table)))
        same &= not set(differing).difference(contacts if _LIBM in environment else ())
    return int(not same)


def _table(
    folder: Path, options: argparse.Namespace, name: str, python: str, environment: Mapping[str, str]
) -> list[Line]:
    file = folder / f"{abs(hash(name))}.tsv"
    inside = [word for setting in environment.items() for word in ("--set", "=".join(setting))]
    parts = [word for part in options.only or [] for word in ("--only", part)]
    command = [python, "-m", "tests.digest", "--here", "--every", str(options.every), "--save", str(file)]
    subprocess.run([*command, *inside, *parts], check=True, cwd=_ROOT, env={**os.environ, **environment})
    return portable(read(file).values(), replays(gradings()))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.digest.matrix")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="each Nth report")
    parser.add_argument("--only", action="append", metavar="PART", help="ids with this part (again: or that)")
    parser.add_argument(
        "--python", action="append", default=[], metavar="FILE", help="also with this interpreter"
    )
    parser.add_argument("--at-once", type=int, default=2, metavar="N", help="settings at once")
    return parser


if __name__ == "__main__":
    sys.exit(main())
