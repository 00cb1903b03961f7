"""Each of the mistakes that beginners make with a package is recognised by itself, in both languages."""

import pytest

from grader.checks.measure import mistake
from grader.contracts.assignment import WantedPackage
from grader.contracts.text import LANGUAGES
from grader.formats.packages import problems as package_problems
from grader.formats.packages.bundle import bundled
from grader.formats.packages.mounting import mounted
from grader.formats.packages.setup_file import parsed
from tests.fakes.packages import DRIVE, MANIFEST, NAME, SETUP, package_files, zipped

MODULE = f"{NAME}/drive.py"
RIGHT = SETUP.format(name=NAME)
XML = MANIFEST.format(name=NAME)
LINE = f"'drive = {NAME}.drive:main',"
LAUNCH = {"launch/drive.launch.py": "x = 1\n"}


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new)


MISTAKES: dict[str, tuple[dict[str, str | None], tuple[str, ...]]] = {
    "no package.xml": ({"package.xml": None}, ("package_manifest_missing",)),
    "package.xml broken": ({"package.xml": XML[:-8]}, ("package_manifest_broken",)),
    "document type": (
        {"package.xml": '<!DOCTYPE p [<!ENTITY a "b">]>' + XML.partition("?>")[2]},
        ("package_manifest_broken",),
    ),
    "no build type": (
        {"package.xml": changed(XML, "<build_type>ament_python</build_type>", "")},
        ("package_build_type",),
    ),
    "build type of C++": (
        {"package.xml": changed(XML, "ament_python", "ament_cmake")},
        ("package_build_type",),
    ),
    "no dependency": (
        {"package.xml": changed(XML, "<depend>geometry_msgs</depend>", "")},
        ("package_depend",),
    ),
    "no setup.py": ({"setup.py": None}, ("package_setup_missing",)),
    "setup.py computes": (
        {"setup.py": changed(RIGHT, "entry_points={", "entry_points=points() or {")},
        ("package_setup_unread",),
    ),
    "setup.py is no Python": ({"setup.py": "setup(:"}, ("package_setup_unread",)),
    "other name in setup.py": (
        {"setup.py": changed(RIGHT, "name=package_name", "name='other'")},
        ("package_name_differs",),
    ),
    "other name in package.xml": (
        {"package.xml": changed(XML, f"<name>{NAME}<", "<name>other<")},
        ("package_name_differs",),
    ),
    "no marker": ({f"resource/{NAME}": None}, ("package_marker",)),
    "no __init__": ({f"{NAME}/__init__.py": None}, ("package_no_init",)),
    "not among packages": (
        {"setup.py": changed(RIGHT, "find_packages(exclude=['test'])", "[]")},
        ("package_module_not_installed",),
    ),
    "no setup.cfg": ({"setup.cfg": None}, ("package_config_missing",)),
    "other folder in setup.cfg": (
        {"setup.cfg": f"[install]\ninstall_scripts=$base/{NAME}\n"},
        ("package_config_wrong",),
    ),
    "no entry": ({"setup.py": changed(RIGHT, LINE, "")}, ("package_entry_missing",)),
    "comma missing": (
        {"setup.py": changed(RIGHT, LINE, f"'drive = {NAME}.drive:main' 'go = {NAME}.drive:main'")},
        ("package_entry_joined",),
    ),
    "no function in the entry": (
        {"setup.py": changed(RIGHT, ".drive:main", ".drive")},
        ("package_entry_malformed",),
    ),
    "wrong module": ({"setup.py": changed(RIGHT, ".drive:main", ".drvie:main")}, ("package_entry_module",)),
    "main misspelt": (
        {MODULE: changed(DRIVE.format(name=NAME), "def main", "def mian")},
        ("package_entry_function",),
    ),
    "launch not installed": (
        {**LAUNCH, "setup.py": changed(RIGHT, "glob('launch/*.launch.py')", "[]")},
        ("package_share_missing",),
    ),
    "package.xml not installed": (
        {"setup.py": changed(RIGHT, "['package.xml']", "[]")},
        ("package_share_missing",),
    ),
    "another executable": (
        {"setup.py": changed(RIGHT, "'drive = ", "'driver = ")},
        ("package_entry_other",),
    ),
}


@pytest.mark.parametrize(("files", "codes"), MISTAKES.values(), ids=MISTAKES.keys())
def test_a_mistake_is_recognised(files: dict[str, str | None], codes: tuple[str, ...]) -> None:
    source = bundled(zipped(package_files(**files)))
    found = mounted(source, WantedPackage(executable="drive"), "humble")
    assert tuple(each.code for each in found.problems) == codes
    for each in found.problems:
        text = mistake(each.code, **each.values).text
        assert all(text.get(language) for language in LANGUAGES)
    assert (found.chosen is None) >= (codes[0] in ("package_manifest_missing", "package_config_wrong"))


@pytest.mark.parametrize(
    "setup",
    [
        RIGHT,
        changed(RIGHT, "find_packages(exclude=['test'])", "[package_name]"),
        changed(RIGHT, f"'drive = {NAME}.drive:main'", "f'drive = {package_name}.drive:main'"),
        changed(RIGHT, f"'drive = {NAME}.drive:main'", "'drive=' + package_name + '.drive:main'"),
        changed(
            RIGHT, "entry_points={", "entry_points='[console_scripts]\\ndrive = my_turtle.drive:main' or {"
        ).replace(" or {", ", x={"),
        "import setuptools\n" + changed(RIGHT, "\nsetup(", "\nsetuptools.setup("),
        changed(RIGHT, "glob('launch/*.launch.py')", "glob(os.path.join('launch', '*launch.[pxy][yma]*'))"),
        changed(
            RIGHT,
            "data_files=[",
            "data_files=[(os.path.join('share', package_name, f), [f]) for f in ()] or [",
        ),
    ],
)
def test_a_right_package_has_no_problem(setup: str) -> None:
    files = package_files(**LAUNCH, **{"setup.py": setup, "config/a.yaml": "x: 1\n"})
    found = mounted(bundled(zipped(files)), WantedPackage(executable="drive"), "humble")
    assert (found.problems, found.file_name) == ((), f"{NAME}/{MODULE}")


def in_src(**more: str | None) -> dict[str, str]:
    files = package_files(**more)
    return {
        path.replace(f"{NAME}/{NAME}/", f"{NAME}/src/{NAME}/"): content for path, content in files.items()
    }


@pytest.mark.parametrize(
    ("packages", "place"),
    [
        ("find_packages('src')", "{'': 'src'}"),
        ("find_packages(where='./src/', include=['my_*'])", "{'': './src/'}"),
        ("[package_name]", "{package_name: 'src/' + package_name}"),
        ("computed()", "{'': 'src'}"),
    ],
)
def test_modules_may_be_in_a_folder_of_their_own(packages: str, place: str) -> None:
    setup = changed(RIGHT, "find_packages(exclude=['test'])", f"{packages}, package_dir={place}")
    found = mounted(
        bundled(zipped(in_src(**{"setup.py": setup}))), WantedPackage(executable="drive"), "humble"
    )
    assert (found.problems, found.file_name) == ((), f"{NAME}/src/{MODULE}")
    names = {name: path for name, path, _, _ in found.fields["modules"]}
    assert names[f"{NAME}.drive"] == f"{NAME}/src/{MODULE}"
    assert set(names) == {NAME, f"{NAME}.drive", f"{NAME}.helper"}


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"packages": "find_packages('src')"}, "package_entry_module"),
        ({"packages": "[]", "place": "{'': 'src'}"}, "package_module_not_installed"),
    ],
)
def test_a_folder_of_modules_that_setup_does_not_name_is_recognised(
    changes: dict[str, str], code: str
) -> None:
    place = f", package_dir={changes['place']}" if "place" in changes else ""
    setup = changed(RIGHT, "find_packages(exclude=['test'])", changes["packages"] + place)
    found = mounted(bundled(zipped(in_src(**{"setup.py": setup}))), None, "humble")
    assert [each.code for each in found.problems][:1] == [code]


def test_package_data_is_installed_beside_the_modules() -> None:
    data = "package_data={'': ['*.txt'], package_name: ['config/*.yaml', '*.py']}"
    files = {f"{NAME}/config/a.yaml": "x: 1\n", f"{NAME}/a.txt": "a", f"{NAME}/config/b.txt": "b"}
    setup = changed(RIGHT, "find_packages(exclude=['test'])", f"find_packages(), {data}")
    found = mounted(bundled(zipped(package_files(**{"setup.py": setup}, **files))), None, "jazzy")
    site = f"install/{NAME}/lib/python3.12/site-packages/{NAME}"
    placed = dict(found.fields["shared"])
    assert placed[f"{site}/config/a.yaml"] == f"{NAME}/{NAME}/config/a.yaml"
    assert placed[f"{site}/a.txt"] == f"{NAME}/{NAME}/a.txt"
    assert [path for path in placed if path.startswith(site)] == [f"{site}/a.txt", f"{site}/config/a.yaml"]
    assert found.problems == ()


def test_several_executables_need_a_choice() -> None:
    setup = changed(RIGHT, LINE, LINE + f" 'stop = {NAME}.drive:main',")
    source = bundled(zipped(package_files(**{"setup.py": setup})))
    assert [each.code for each in mounted(source, None, "humble").problems] == ["package_entry_several"]
    assert mounted(source, WantedPackage(executable="stop"), "humble").problems == ()


def test_the_wanted_name_counts() -> None:
    source = bundled(zipped(package_files()))
    found = mounted(source, WantedPackage(name="turtle_walk"), "humble")
    assert ([each.code for each in found.problems], found.chosen) == (["package_other_name"], None)


@pytest.mark.parametrize(
    "setup",
    [
        "a = 'x'\n" + "a = a + a\n" * 60 + "setup(name=a)\n",
        "a = ['x']\n" + "a = [*a, *a]\n" * 60 + "setup(packages=a)\n",
        "setup(name=" + "(" * 3000 + ")" * 3000 + ")\n",
        "setup(name=" + "+".join(["'x'"] * 9000) + ")\n",
        "from glob import glob\nsetup(data_files=[('x', glob('" + "**/*/" * 30 + "x'))])\n",
        "setup(name=" + "-" * 3000 + "1)\n",
        f"a = ['{'a.' * 1900}a']\n" + "a = a + a\n" * 11 + "setup(packages=a, package_dir={'': 'b'})\n",
        "a = ['x']\n" + "a = a + a\n" * 11 + "setup(packages=a, package_data={'': ['**/*']})\n",
    ],
)
def test_a_setup_that_would_take_for_ever_is_read_at_once(setup: str) -> None:
    files = package_files(**{"setup.py": setup, "/".join(["a"] * 14) + "/b": ""})
    found = mounted(bundled(zipped(files)), None, "humble")
    assert found.chosen is None
    assert found.problems


def test_each_module_is_read_once_however_many_entries_name_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """200 entries of one long module took a minute, and each had a problem of its own in the report."""
    read = []
    monkeypatch.setattr(package_problems, "parsed", lambda source: read.append(source) or parsed(source))
    entries = "".join(f"\n'e{number} = {NAME}.drive:nothing'," for number in range(1_000))
    source = bundled(zipped(package_files(**{"setup.py": changed(RIGHT, LINE, entries)})))
    found = mounted(source, None, "humble").problems
    assert {each.code for each in found} == {"package_entry_function"}
    assert (len(read), len(found)) == (1, 20)


def test_a_package_of_cpp_beside_it_is_no_mistake() -> None:
    cpp = {
        "other/package.xml": XML.replace("ament_python", "ament_cmake"),
        "other/CMakeLists.txt": "project(x)\n",
    }
    source = bundled(zipped({**package_files(), **cpp}))
    found = mounted(source, WantedPackage(executable="drive"), "humble")
    assert (found.problems, found.file_name) == ((), f"{NAME}/{MODULE}")


def test_dashes_in_setup_cfg_are_taken_as_setuptools_takes_them() -> None:
    dashes = f"[develop]\nscript-dir=$base/lib/{NAME}\n[install]\ninstall-scripts=$base/lib/{NAME}\n"
    source = bundled(zipped(package_files(**{"setup.cfg": dashes})))
    assert mounted(source, WantedPackage(executable="drive"), "humble").problems == ()
