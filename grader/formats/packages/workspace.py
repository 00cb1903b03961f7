"""What a kept package holds, as colcon and ``ros2 run`` would find it: modules, executables, shared files.

Nothing of the package is run. Sources of the rules: the templates of ros2pkg (ament_python), setuptools'
``packages``, ``data_files`` and ``console_scripts``, and colcon-ros, which builds what ``package.xml`` calls
ament_python.
"""

import configparser
import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from typing import Final

from grader.contracts.assignment import WantedPackage
from grader.contracts.record import Record, field
from grader.formats.packages.bundle import MANIFEST, SETUP, files_of, package_folders
from grader.formats.packages.setup_file import SetupFile

PYTHON: Final = "ament_python"
_MOST_MANIFEST_BYTES: Final = 64 * 1024
_DEEPEST: Final = 50
"""Parts that a module's name may have and be looked for as ``package_dir`` says; time grows with their square."""
_ENTRY: Final = re.compile(r"\s*([^=\s][^=]*?)\s*=\s*([\w.]+)\s*:\s*([\w.]+)\s*(?:\[.*\])?\s*")
_INDEX: Final = "share/ament_index/resource_index/packages"
_BASE: Final = "$base/"
_DEPENDS: Final = ("depend", "exec_depend", "build_depend", "run_depend", "build_export_depend")


class Executable(Record, kw_only=False):
    """A console script: ``ros2 run PACKAGE NAME`` calls `function` of `module`."""

    package: str
    name: str
    module: str
    function: str


class Manifest(Record):
    """A ``package.xml``.

    Attributes:
        trouble: why it could not be read; empty where it could.
        build_type: empty where none is exported.
    """

    name: str = ""
    build_type: str = ""
    depends: tuple[str, ...] = ()
    trouble: str = ""


class Package(Record):
    """One package of a kept archive. Paths are relative to its folder unless said otherwise.

    Attributes:
        folder: in the archive.
        paths: of all its files.
        manifest: None where there is no ``package.xml``.
        has_setup, has_config: whether there are ``setup.py`` and ``setup.cfg``.
        unread: arguments of ``setup`` that only running ``setup.py`` would tell; ``setup`` itself where it is no
            Python or does not call ``setup``.
        setup_name: as ``setup.py`` says. script_folder: as ``setup.cfg`` says, such as ``lib/my_pkg``, or ``bin``.
        entries: lines of ``console_scripts``. scripts: those that are well-formed.
        modules: names of what is installed, with the paths of their files (empty: a folder without ``__init__``).
        sources: folder of the modules, with a slash behind it, as ``package_dir`` says; mostly empty.
        data: path beside the modules (``my_pkg/data/x.yaml``) to the path of the file, as ``package_data`` says.
        shared: installed path (``share/my_pkg/launch/x.launch.py``) to the path of the file.
    """

    folder: str
    paths: tuple[str, ...]
    manifest: Manifest | None
    has_setup: bool
    has_config: bool
    unread: tuple[str, ...] = ()
    setup_name: str = ""
    script_folder: str = "bin"
    entries: tuple[str, ...] = ()
    scripts: tuple[Executable, ...] = ()
    modules: Mapping[str, str] = field(default_factory=dict)
    sources: str = ""
    data: Mapping[str, str] = field(default_factory=dict)
    shared: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """What colcon calls it."""
        return (self.manifest.name if self.manifest else "") or self.setup_name or self.folder

    @property
    def is_built(self) -> bool:
        """Whether colcon builds it as a package of Python."""
        manifest = self.manifest
        return (
            manifest is not None and not manifest.trouble and manifest.build_type == PYTHON and self.has_setup
        )

    @property
    def marked(self) -> tuple[str, ...]:
        """Names under which it is in the index, where ``ros2 run`` looks."""
        return tuple(path.rpartition("/")[2] for path in self.shared if path.rpartition("/")[0] == _INDEX)

    @property
    def executables(self) -> tuple[Executable, ...]:
        """What ``ros2 run`` finds."""
        owner = self.script_folder.removeprefix("lib/")
        if not self.is_built or not self.script_folder.startswith("lib/") or owner not in self.marked:
            return ()
        return tuple(
            Executable(owner, script.name, script.module, script.function) for script in self.scripts
        )


def read_packages(source: bytes) -> tuple[tuple[Package, ...], dict[str, bytes]]:
    """Return the packages of a kept archive, and its files. Raises RefusedError: it is no kept archive."""
    files = files_of(source)
    return tuple(_package(folder, files) for folder in package_folders(list(files))), files


def choose(packages: Sequence[Package], wanted: WantedPackage) -> Executable | None:
    """Return the executable that is run: the one of the wanted name, or the only one."""
    every = [executable for package in packages for executable in package.executables]
    named = [
        executable
        for executable in every
        if wanted.executable in ("", executable.name) and wanted.name in ("", executable.package)
    ]
    return named[0] if len(named) == 1 or (named and wanted.executable) else None


def _package(folder: str, files: Mapping[str, bytes]) -> Package:
    own = {
        path[len(folder) + 1 :]: content for path, content in files.items() if path.startswith(f"{folder}/")
    }
    manifest = _manifest(own[MANIFEST]) if MANIFEST in own else None
    setup = SetupFile(own.get(SETUP, b""), own)
    scripts, data = setup.console_scripts(), setup.data_files()
    packages, modules = setup.strings("packages"), setup.strings("py_modules")
    constants: dict[str, object] = {
        "entry_points": scripts, "data_files": data, "packages": packages, "py_modules": modules,
    }  # fmt: skip
    constants["package_dir"] = placed = setup.package_dir()
    sources = (placed or {}).get("", "")
    names = _folders(own, f"{sources}/".removeprefix("/")) if packages is None else packages
    folders = {name: _folder(name, placed or {}) for name in names}
    constants["package_data"] = beside = setup.package_data(folders)
    unread = [name for name, value in constants.items() if value is None]
    if SETUP in own and not (setup.is_python and setup.calls_setup):
        unread = ["setup"]
    entries = [match for match in map(_ENTRY.fullmatch, scripts or ()) if match is not None]
    return Package(
        folder=folder,
        paths=tuple(sorted(own)),
        manifest=manifest,
        has_setup=SETUP in own,
        has_config="setup.cfg" in own,
        unread=tuple(unread),
        setup_name=setup.text("name"),
        script_folder=_script_folder(own.get("setup.cfg", b"")),
        entries=tuple(scripts or ()),
        scripts=tuple(Executable(setup.text("name"), entry[1], entry[2], entry[3]) for entry in entries),
        modules=_modules(folders, {name: _folder(name, placed or {}) for name in modules or ()}, own),
        sources=f"{sources}/".removeprefix("/"),
        data=_data(folders, beside or {}),
        shared=_all_shared(setup.text("name"), own) if data is None else _shared(data, own),
    )


def _manifest(content: bytes) -> Manifest:
    """Read a ``package.xml``; it may declare no entities: they can stand for gigabytes."""
    if len(content) > _MOST_MANIFEST_BYTES:
        return Manifest(trouble="too large")
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content or b"\0" in content:
        return Manifest(trouble="<!DOCTYPE")
    try:
        root = ET.fromstring(content)  # noqa: S314 - without a document type there are no entities
    except (ET.ParseError, ValueError, LookupError) as error:
        return Manifest(trouble=str(error)[:200])
    if root.tag != "package":
        return Manifest(trouble=f"<{root.tag[:50]}>")
    kind = root.find("export/build_type")
    return Manifest(
        name=_text(root.find("name")),
        build_type=_text(kind),
        depends=tuple(_text(element) for tag in _DEPENDS for element in root.findall(tag)),
    )


def _text(element: "ET.Element | None") -> str:
    return "" if element is None else (element.text or "").strip()[:200]


def _script_folder(content: bytes) -> str:
    """Return where executables go, below the package's own prefix: ``bin`` unless ``setup.cfg`` says otherwise."""
    parser = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        parser.read_string(content[:_MOST_MANIFEST_BYTES].decode("utf-8", "replace"))
    except (configparser.Error, ValueError):
        return "bin"
    older = parser.get("install", "install-scripts", fallback="")  # setuptools takes dashes, with a warning
    folder = parser.get("install", "install_scripts", fallback=older).strip()
    return folder.removeprefix(_BASE).strip("/") if folder.startswith(_BASE) else "bin"


def _folder(name: str, placed: Mapping[str, str]) -> str:
    """Return where a package, or a module without its ending, is, as setuptools' ``build_py`` looks for it."""
    parts = name.split(".")
    if len(parts) > _DEEPEST:
        return "/".join(parts)
    for end in range(len(parts), -1, -1):
        start = placed.get(".".join(parts[:end]))
        if start is not None:
            return "/".join((*([start] if start else []), *parts[end:]))
    return "/".join(parts)


def _modules(
    packages: Mapping[str, str], singles: Mapping[str, str], own: Mapping[str, bytes]
) -> dict[str, str]:
    """Return the modules that setuptools installs: of each package those in its own folder, not in subfolders.

    Args:
        packages: their names and folders.
        singles: names of other modules, and their files without the ending.
        own: the package's files.
    """
    found: dict[str, str] = {}
    for name, folder in packages.items():
        inside = [path for path in own if path.rpartition("/")[0] == folder and path.endswith(".py")]
        for path in inside:
            stem = path.rpartition("/")[2][:-3]
            found[name if stem == "__init__" else f"{name}.{stem}"] = path
        if inside:
            found.setdefault(name, "")
    for name, place in singles.items():
        if f"{place}.py" in own:
            found[name] = f"{place}.py"
    return dict(sorted(found.items()))


def _data(folders: Mapping[str, str], beside: Mapping[str, list[str]]) -> dict[str, str]:
    """Return what is installed beside the modules; these are installed anyway."""
    found: dict[str, str] = {}
    for name, paths in beside.items():
        inside = name.replace(".", "/")
        for path in paths:
            if not path.endswith(".py"):
                folder = folders[name]
                found[f"{inside}/" + path.removeprefix(f"{folder}/" if folder else "")] = path
    return found


def _folders(own: Mapping[str, bytes], start: str) -> list[str]:
    """Return all packages of Python: what ``setup`` probably installs where it does not say so readably."""
    inside = (path.removeprefix(start) for path in own if path.startswith(start))
    return sorted(
        path.rpartition("/")[0].replace("/", ".") for path in inside if path.endswith("/__init__.py")
    )


def _all_shared(name: str, own: Mapping[str, bytes]) -> dict[str, str]:
    """Return what ``setup`` probably shares where it does not say so readably: all that is no module."""
    entries = {
        f"share/{name}/{path}": path
        for path in own
        if not path.startswith((f"{name}/", "resource/", "test/"))
    }
    marker = f"resource/{name}"
    return {**entries, f"{_INDEX}/{name}": marker} if marker in own else entries


def _shared(data: list[tuple[str, list[str]]], own: Mapping[str, bytes]) -> dict[str, str]:
    found: dict[str, str] = {}
    for target, paths in data:
        for path in paths:
            plain = path.removeprefix("./")
            if plain in own:
                found[f"{target.strip('/')}/{plain.rpartition('/')[2]}"] = plain
    return found
