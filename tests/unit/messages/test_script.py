"""What hints look for in a script's text, and how much of a hostile text they look at."""

from grader.messages.script import ScriptText


def test_a_class_without_a_base_is_found_however_it_is_spaced() -> None:
    for text in ("class Mover:", "class  Mover ( object ) :", "    class Mover\t(  )  :"):
        assert ScriptText(text).class_without_base("Mover"), text
    for text in ("class Mover(Node):", "class Movers:", "# class Mover:"):
        assert not ScriptText(text).class_without_base("Mover"), text


def test_a_hostile_line_leaves_patterns_little_to_try() -> None:
    script = ScriptText("class Mover" + " " * 250_000 + "\n" + "x" * 250_000)
    assert [len(line) for line in script.lines] == [len("class Mover "), 500]
    assert not script.class_without_base("Mover")
