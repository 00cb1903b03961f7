"""Nothing is missing in either language, and the compiled catalogs are those of the edited ones."""

import ast
import gettext
import io
import string
from pathlib import Path

import pytest

import grader.checks
from grader.checks import KINDS
from grader.contracts.text import LANGUAGES, Language, Text
from grader.messages import DOMAIN, FOLDER, MissingMessageError, join, say, sentence
from grader.messages.compile import compiled
from tests.unit.messages.catalogs import catalog_texts


def fields(template: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(template) if name is not None}


def literal_ids() -> set[str]:
    """Every id that the checks pass to `say` as a plain string."""
    return {
        node.args[0].value
        for path in Path(grader.checks.__file__).parent.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "say"
        and isinstance(node.args[0], ast.Constant)
    }


def measure_ids() -> set[str]:
    """Every id that follows from the table of checks."""
    ids = {f"{kind}.remarks" for kind in KINDS}
    for kind, check in KINDS.items():
        for name, measure in check.measures.items():
            seen = ("yes", "no") if measure.form == "flag" else ("seen",)
            ids |= {f"{kind}.{name}.{part}" for part in ("name", "hint", *seen)}
    return ids


def sentences(binary: bytes, ids: set[str]) -> dict[str, str]:
    catalog = gettext.GNUTranslations(io.BytesIO(binary))
    return {key: catalog.gettext(key) for key in ids}


@pytest.mark.parametrize("language", LANGUAGES)
def test_compiled_catalog_is_in_step(language: Language) -> None:
    """Compared by sentences, because the header of a compiled catalog names the version of Babel."""
    po_path = FOLDER / language / "LC_MESSAGES" / f"{DOMAIN}.po"
    ids = set(catalog_texts(language))
    committed = po_path.with_suffix(".mo").read_bytes()
    assert sentences(committed, ids) == catalog_texts(language), "run: python -m grader.messages.compile"
    assert sentences(compiled(po_path), ids) == catalog_texts(language)


def test_compiling_is_repeatable() -> None:
    po_path = FOLDER / "zh" / "LC_MESSAGES" / f"{DOMAIN}.po"
    assert compiled(po_path) == compiled(po_path)


def test_both_languages_say_the_same_things_with_the_same_values() -> None:
    chinese, english = catalog_texts("zh"), catalog_texts("en")
    assert set(chinese) == set(english)
    assert {key: fields(text) for key, text in chinese.items()} == {
        key: fields(text) for key, text in english.items()
    }


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_sentence_is_empty(language: Language) -> None:
    assert not [key for key, text in catalog_texts(language).items() if not text.strip()]


def test_every_id_in_use_exists() -> None:
    assert literal_ids()
    assert not (literal_ids() | measure_ids()) - set(catalog_texts("zh"))


def test_no_sentence_is_idle() -> None:
    families = (
        "mistake.",
        "figure.",
        "wall.",
        "stall.",
        "detail.",
        "item.yes",
        "item.no",
    )  # chosen at run time; mistakes have a test of their own
    rest = {key for key in catalog_texts("zh") if not key.startswith(families)}
    assert rest == {key for key in literal_ids() | measure_ids() if not key.startswith(families)}


def test_a_value_in_two_languages_is_inserted_in_each() -> None:
    said = say("mistake.wall_hit", time="5 s", wall=Text(zh="右", en="right"))
    assert "右边的墙" in said.zh
    assert "the right wall" in said.en


def test_values_are_not_templates() -> None:
    assert "{rate}" in sentence("en", "mistake.unknown_name", line=3, problem="{rate}")


def test_an_unknown_id_is_refused() -> None:
    with pytest.raises(MissingMessageError):
        say("no.such.message")


def test_join() -> None:
    parts = [Text(zh="边数", en="sides"), Text(zh="转角", en="angles")]
    assert join(parts, Text(zh="、", en=", ")) == Text(zh="边数、转角", en="sides, angles")
