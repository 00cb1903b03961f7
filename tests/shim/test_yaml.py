"""The YAML of parameter files and values: the events that PyYAML's parser gives, or a refusal."""

import importlib.util
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

SOURCE = Path(__file__).resolve().parents[2] / "grader" / "shim" / "rclpy" / "_rcl" / "yaml.py"
_spec = importlib.util.spec_from_file_location("yaml_under_test", SOURCE)
assert _spec is not None
assert _spec.loader is not None
ours: Any = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(ours)

KINDS: dict[type[yaml.Event], int] = {
    yaml.ScalarEvent: ours.SCALAR,
    yaml.SequenceStartEvent: ours.SEQUENCE,
    yaml.SequenceEndEvent: ours.SEQUENCE_END,
    yaml.MappingStartEvent: ours.MAPPING,
    yaml.MappingEndEvent: ours.MAPPING_END,
    yaml.AliasEvent: ours.ALIAS,
}

CHARACTERS = st.characters(exclude_characters="\x85\u2028\u2029", exclude_categories=["Cs"])
"""YAML 1.1 ends lines at the three of Unicode, too; here they are text."""
NAMES = st.text("ab/_ :#-", min_size=1, max_size=6)
TREES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(CHARACTERS, max_size=12)),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(NAMES, inner, max_size=3)),
    max_leaves=8,
)
PIECES = st.sampled_from([*"a1:[]{}'\"\n\t&*", ": ", "- ", ", ", " #c", "\n  "])


def read(text: str) -> list[tuple[Any, ...]]:
    return [
        (e.kind, e.line, e.text, e.quoted) if e.kind == ours.SCALAR else (e.kind,) for e in ours.events(text)
    ]


def expected(text: str) -> list[tuple[Any, ...]]:
    return [
        (kind, e.start_mark.line + 1, e.value, e.style in ("'", '"')) if kind == ours.SCALAR else (kind,)
        for e in yaml.parse(text)
        if (kind := KINDS.get(type(e))) is not None
    ]


@given(TREES, st.sampled_from([None, True, False]), st.integers(20, 120))
def test_what_pyyaml_writes_is_read_as_pyyaml_reads_it(tree, flow, width):
    text = yaml.safe_dump(tree, default_flow_style=flow, width=width, allow_unicode=True)
    if "? " not in text:  # explicit keys are refused, see the module
        assert read(text) == expected(text), text


@given(st.lists(PIECES, max_size=12).map("".join))
def test_any_text_is_read_or_refused(text):
    try:
        read(text)
    except ours.YamlError:
        return


READ = (
    *("", "#c", "a: 1", "a: -1", "a : 1 # c\n# d\n", "a:\nb:", "a:\n- 1\n- 2\nb: 3", "- a: 1\n  b: 2\n- c",),
    *("- - 1\n  - 2", '{"x":1}', "{'a': b}", "a: [1,\n 2,]\nb: {c, d: }",),
    *("a: http://x", "a#b: c #d", "&a", "!!str 1", "a: &x 1\nb: *x"),
    *("a: b c\n  d\n\n  e\ng: 1", 'a: "x\n  y\\n\\u4f60"', "a: 'it''s'", "---\na: 1\n...\n---\nb: 2\n"),
)  # fmt: skip
REFUSED = (
    *("[1, 2", "{a: 1", '"abc', '"\\xzz"', ", a", "@a", "a: }", 'a: "b" c', "'x':1", "a: b: c"),
    *("a: - b", "\ta: 1"),
    *("a: 1\nb", "a: 1\n b: 2", "a:\n    b: 1\n  c: 2", "- a\nb: 1", "a: 1\n...\nb: 2"),
)  # fmt: skip


@pytest.mark.parametrize("text", READ)
def test_examples(text):
    assert read(text) == expected(text)


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_no_yaml_is_refused(text):
    with pytest.raises(yaml.YAMLError):
        expected(text)
    with pytest.raises(ours.YamlError):
        read(text)
