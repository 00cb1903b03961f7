"""YAML as events: what libyaml gives rcl, here from PyYAML, which is libyaml's twin."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

SCALAR, SEQUENCE, SEQUENCE_END, MAPPING, MAPPING_END, ALIAS = range(6)


class YamlError(ValueError):
    """The text is not YAML."""


class YamlEvent:
    """One event of the stream; `text` and `quoted` are a scalar's, `line` counts from 1."""

    __slots__ = ("kind", "line", "quoted", "text")

    def __init__(self, kind: int, line: int, text: str = "", quoted: bool = False) -> None:
        self.kind = kind
        self.line = line
        self.text = text
        self.quoted = quoted


def events(text: str) -> Iterator[YamlEvent]:
    """Yield the events of a text.

    Raises YamlError: where the text is no YAML; the events before it are yielded.
    """
    word = text.replace(".", "").replace("-", "").replace("+", "")
    if word.isascii() and word.isalnum() and not text.startswith("-"):  # what most values are: without PyYAML
        yield YamlEvent(SCALAR, 1, text)
        return
    import yaml

    kinds = {
        yaml.SequenceStartEvent: SEQUENCE,
        yaml.SequenceEndEvent: SEQUENCE_END,
        yaml.MappingStartEvent: MAPPING,
        yaml.MappingEndEvent: MAPPING_END,
        yaml.AliasEvent: ALIAS,
    }
    try:
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            line = event.start_mark.line + 1 if event.start_mark else 0
            if isinstance(event, yaml.ScalarEvent):
                yield YamlEvent(SCALAR, line, event.value, event.style in ("'", '"'))
            elif type(event) in kinds:
                yield YamlEvent(kinds[type(event)], line)
    except (yaml.YAMLError, UnicodeError) as error:
        raise YamlError(str(error)) from None
