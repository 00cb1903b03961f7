"""docs/reports/fidelity.md is what the tests say."""

from tools import fidelity


def test_the_document_is_up_to_date() -> None:
    assert fidelity.DOCUMENT.read_text("utf-8") == fidelity.generate(), "run: python -m tools.fidelity"


def test_the_tables_hold_what_they_are_made_from() -> None:
    text = fidelity.generate()
    assert "| int in a float field | `msg.linear.x = 1` | `AssertionError` |" in text
    assert "| `turtlesim` | 2 | 5 | 1 |" in text
    assert "| `test_wrong_usage.py` |" in text
    for scripts in fidelity.STYLES.values():
        assert all(f"| `{name}` |" in text for name in scripts)
