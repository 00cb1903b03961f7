"""A script that is named like what it imports: at home it finds itself, because its own folder comes first."""

from __future__ import annotations

import builtins
import sys
from _frozen_importlib import ModuleSpec
from types import CodeType, ModuleType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

_LOADED_BY_PYTHON = frozenset(("_collections_abc", "abc", "codecs", "encodings", "io", "os", "site", "stat"))
"""Modules that Python has imported before it comes to a script; so are those written in C."""


_ENDS = bytes.maketrans(b",.;", b"   ")


def imports_itself(file_name: str, source: bytes) -> str:
    """Return the name under which the script imports itself, empty where it does not."""
    name = file_name.rpartition("/")[2].removesuffix(".py")
    if not name.isidentifier() or name in _LOADED_BY_PYTHON or name in sys.builtin_module_names:
        return ""
    raw_name = name.encode()
    for line in source.splitlines() if raw_name in source else ():
        words = line.translate(_ENDS).split()
        if words[:1] in ([b"import"], [b"from"]) and raw_name in words[1:2]:
            return name
    return ""


def import_itself(module: ModuleType, name: str, code: CodeType) -> None:
    """Let code of `module`, the script, find the script under `name`.

    Only code of the script does: what the shim imports while the script runs is still the shim's.
    """
    modules: dict[str, ModuleType] = {}
    importing = builtins.__import__

    def import_as_at_home(
        wanted: str,
        names: Mapping[str, Any] | None = None,
        local: Mapping[str, Any] | None = None,
        taken: Any = (),
        level: int = 0,
    ) -> Any:
        if level or wanted.partition(".")[0] != name:
            return importing(wanted, names, local, taken, level)
        if wanted != name:
            _load(modules, name, code, own)
            raise ModuleNotFoundError(f"No module named {wanted!r}; {name!r} is not a package", name=wanted)
        return _load(modules, name, code, own)

    own = {**vars(builtins), "__import__": import_as_at_home}
    module.__dict__["__builtins__"] = own


def _load(found: dict[str, ModuleType], name: str, code: CodeType, own: dict[str, Any]) -> ModuleType:
    """Return the script as a module; the first time, run it as that."""
    if name in found:
        return found[name]
    made = found[name] = ModuleType(name)
    spec: Any = ModuleSpec(name, None, origin=code.co_filename)
    spec.has_location, spec._initializing = True, True  # so Python says "partially initialized"
    made.__dict__.update({"__spec__": spec, "__file__": code.co_filename, "__builtins__": own})
    try:
        exec(code, made.__dict__)  # noqa: S102
    except BaseException:
        del found[name]
        raise
    spec._initializing = False
    return made
