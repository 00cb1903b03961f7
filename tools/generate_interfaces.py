"""Generate the student side's interface data from the definitions in `interfaces/`.

    python tools/generate_interfaces.py [--check]

Reads every ``<package>/{msg,srv,action}/*.{msg,srv,action}`` and writes a text file for Humble, and one for what
is new or different on Jazzy (`interfaces/jazzy/`), from which the shim builds its message classes when a script
first asks for them (`grader.catalog.definitions` translates each). `--check` writes nothing and fails when a file
is out of date. Forms of a line:

    @package/kind/Name module_name     an interface
    =Structure                         a structure of it; its full name is package/kind/Structure
    !NAME type literal                 a constant
    name type [literal]                a field and its default
"""

import argparse
import sys
from pathlib import Path

from grader.catalog.definitions import PARTS, DefinitionError, translated

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "interfaces"
TARGET = ROOT / "grader" / "shim" / "rosidl_data"
SOURCES = {"humble.txt": SOURCE, "jazzy.txt": SOURCE / "jazzy"}


def generate(source: Path) -> str:
    """Return the whole data file.

    Raises:
        ValueError: naming the definition that is not understood.
    """
    lines = ["# Generated from interfaces/ by tools/generate_interfaces.py. Do not edit."]
    for path in sorted(p for kind in PARTS for p in source.glob(f"*/{kind}/*.{kind}")):
        package, kind = path.parts[-3], path.parts[-2]
        try:
            lines.append("@" + translated(package, kind, path.stem, path.read_text("utf-8")))
        except DefinitionError as error:
            raise ValueError(f"{path}: {error}") from error
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the data files, or with --check compare them."""
    parser = argparse.ArgumentParser(description="Generate the shim's interface data.")
    parser.add_argument("--check", action="store_true", help="only fail when a file is out of date")
    arguments = parser.parse_args()
    for name, source in SOURCES.items():
        text, target = generate(source), TARGET / name
        if not arguments.check:
            target.parent.mkdir(exist_ok=True)
            target.write_text(text, "utf-8")
        elif not target.exists() or target.read_text("utf-8") != text:
            sys.stderr.write(f"{target.relative_to(ROOT)} is out of date: run {Path(__file__).name}\n")
            return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
