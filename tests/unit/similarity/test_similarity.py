"""What is found alike: copies in any disguise, and not those who typed the same listing."""

import io
import random
import subprocess
import sys
import tokenize
from hashlib import sha256

import numpy as np
import pytest

from grader.catalog import Catalog
from grader.contracts.trajectory import Command
from grader.formats.packages.bundle import code_of
from grader.similarity.commands import SentCommands, drive_of
from grader.similarity.fingerprints import Fingerprints, Hashes, fingerprints, grams
from grader.similarity.places import MOST_PLACES
from grader.similarity.ranking import FEWEST_OWN, MOST_PAIRS, Ranking, Script, rank
from grader.similarity.tokens import MOST_TOKENS, tokens_of
from tests.unit.similarity.students import DISGUISES, ROOT, SQUARE, changed_square, own_code, renamed

SOLUTIONS = {path.parent.name: path.read_text() for path in sorted(ROOT.glob("assignments/*/solution.py"))}


def prints(source: str) -> Fingerprints:
    return fingerprints(tokens_of(source))


def script(source: str, drive: SentCommands | None = None) -> Script:
    return Script(sha256(source.encode()).hexdigest(), prints(source), drive)


def alike(first: str, second: str) -> float:
    """Dice's coefficient of two scripts' sets of hashes."""
    hashes, others = np.unique(prints(first).hashes), np.unique(prints(second).hashes)
    together = len(hashes) + len(others)
    return 2 * len(np.intersect1d(hashes, others)) / together if together else 0.0


@pytest.fixture(scope="module")
def given() -> Hashes:
    return np.concatenate([grams(tokens_of(code_of(one))) for one in Catalog().given_code()])


# ---------------------------------------------------------------------------------- two scripts


@pytest.mark.parametrize("disguise", DISGUISES)
def test_a_disguised_script_is_the_same(disguise: str) -> None:
    for name, source in {"lesson": SQUARE, **SOLUTIONS}.items():
        hidden = DISGUISES[disguise](source)
        assert hidden != source
        if disguise == "reordered":  # a cut costs what lies across it, and short scripts are cut often
            assert alike(source, hidden) >= (0.9 if name == "lesson" else 0.8), name
        else:
            assert tokens_of(source).codes == tokens_of(hidden).codes, name


@pytest.mark.parametrize(
    ("lesson", "assignment"), [("square", "square"), ("straight", "spin"), ("square", "feedback_square")]
)
def test_independent_scripts_are_not(lesson: str, assignment: str) -> None:
    listing = (ROOT / "lesson" / f"{lesson}_mover.py").read_text()
    assert alike(listing, SOLUTIONS[assignment]) <= 0.4


def test_likeness_is_symmetric_and_bounded() -> None:
    for first in (SQUARE, "", "x = 1\n", SOLUTIONS["spin"]):
        for second in (SQUARE, "", SOLUTIONS["spin"]):
            assert 0.0 <= alike(first, second) == alike(second, first) <= 1.0
    assert alike(SQUARE, SQUARE) == 1.0
    assert alike("", "") == 0.0


# ---------------------------------------------------------------------------------- tokens


def test_tokens_are_those_of_python() -> None:
    """Python's own tokenizer as the oracle, for scripts without what is read differently on purpose."""
    told = {tokenize.INDENT, tokenize.DEDENT, tokenize.NEWLINE, tokenize.OP}
    told |= {tokenize.NAME, tokenize.NUMBER, tokenize.STRING}
    on_purpose = ('"""', "f'", 'f"', ",\n", ",)")
    catalog, paths = Catalog(), (*ROOT.glob("lesson/*.py"), *ROOT.glob("tests/styles/scripts/*.py"))
    own = [
        source
        for one in catalog.all()
        if one.input == "script"
        for source in catalog.scripts(one.id).values()
    ]
    sources = [source.decode("utf-8-sig") for source in (*own, *(path.read_bytes() for path in paths))]
    compared = [one for one in sources if not any(text in one for text in on_purpose)]
    for source in compared:
        try:
            found = list(tokenize.generate_tokens(io.StringIO(source + "end\n").readline))
        except (tokenize.TokenError, SyntaxError):
            continue
        assert len(tokens_of(source + "end\n").codes) == sum(one.type in told for one in found), source
    assert len(compared) > 30


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("s = 'a' 'b'", "s = f'{x!r:>{width}}'"),
        ("s = rb'\\'", "s = '''a\n'b'\n'''"),
        ("x = 0xFF_FF", "x = 1_0.5e-3j"),
        ("f(a, b)", "f(\n  a,\n  b,\n)"),
        ("if x:\n    y()\nz()", "if x:\n\ty()\n\n# z\nz()  # z"),
        ("x = 1 + \\\n  2", "x = 1 + 2"),
        ("def f():\n    '''doc'''\n    pass", "def f():\n    pass"),
        ("name = string", "other = number"),
    ],
)
def test_what_is_written_differently_is_the_same(one: str, other: str) -> None:
    assert tokens_of(one).codes == tokens_of(other).codes


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("x += 1", "x -= 1"),
        ("if x: y", "while x: y"),
        ("a == b", "a = b"),
        ("if x:\n  a\nb", "if x:\n  a\n  b"),
    ],
)
def test_what_means_something_else_differs(one: str, other: str) -> None:
    assert tokens_of(one).codes != tokens_of(other).codes


HOSTILE = [
    "(" * 262_144,
    "a\n" * 131_072,
    "x+" * 131_072,
    "'''" * 87_381,
    '"""\\' * 65_536,
    '\\"' * 131_072,
    "#\n" * 131_072,
    " " * 262_144,
    "1" * 262_144,
    'f"{' * 87_381,
    "\0" * 262_144,
    "“" * 87_381,
    "if x:" * 52_428,
    "".join(" " * i + "if x:\n" for i in range(720)),
    "'" + "ab" * 131_071,
]


@pytest.mark.parametrize("source", HOSTILE, ids=[repr(one[:6]) for one in HOSTILE])
def test_hostile_files_are_read_in_bounds(source: str) -> None:
    found = prints(source)
    assert len(found) <= MOST_TOKENS
    twice = Script("one", found), Script("other", found)
    ranking = rank([*twice, script(SQUARE)], np.zeros(0, dtype=np.uint64))
    assert all(len(pair.places) <= MOST_PLACES for pair in ranking.pairs)


def test_random_files_raise_nothing() -> None:
    dice = random.Random(5)
    for _ in range(500):
        prints(dice.randbytes(dice.randrange(300)).decode("utf-8", "replace"))
        prints("".join(dice.choices("'\"\\\n\t ([{}])#,.:=f1xif", k=dice.randrange(200))))


def test_fingerprints_do_not_depend_on_the_process() -> None:
    code = (
        "import sys; from grader.similarity.fingerprints import fingerprints; "
        "from grader.similarity.tokens import tokens_of; "
        "print(fingerprints(tokens_of(sys.stdin.read())).hashes.tolist())"
    )
    said = subprocess.run(
        [sys.executable, "-c", code],
        input=SQUARE,
        env={"PYTHONHASHSEED": "7", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert said.strip() == str(prints(SQUARE).hashes.tolist())


# ---------------------------------------------------------------------------------- a class


def test_nobody_is_ranked_who_handed_in_the_listing(given: Hashes) -> None:
    ranking = rank([script(f"# student {i}\n{SQUARE}") for i in range(50)], given)
    assert ranking == Ranking(few=12, too_little=tuple(range(50)), pairs=(), left_out=0, same_drives=())


def test_who_copied_a_changed_script_is_first(given: Hashes) -> None:
    listings = [SQUARE] * 50
    honest = [changed_square(i) for i in range(20)]
    copied = renamed(changed_square(7))
    ranking = rank([script(one) for one in (*listings, *honest, copied)], given)
    first = ranking.pairs[0]
    assert (first.first, first.second) == (57, 70)
    assert first.first_share == first.second_share == 1.0
    assert not first.same_file
    assert len(ranking.too_little) == 50
    assert first.weight > max((one.weight for one in ranking.pairs[1:]), default=0.0)


def test_places_are_the_lines_of_what_is_shared(given: Hashes) -> None:
    first, second = changed_square(3), "# a\n" * 5 + renamed(changed_square(3))
    ranking = rank([script(first), script(second), *(script(changed_square(i)) for i in (4, 5))], given)
    begins = first[: first.index("def own")].count("\n") + 1
    ends = begins + own_code(3).strip().count("\n")
    (pair,) = (one for one in ranking.pairs if (one.first, one.second) == (0, 1))
    (place,) = pair.places
    assert begins - 3 <= place.first.first_line <= begins + 3
    assert ends - 3 <= place.first.last_line <= ends + 4
    further = second[: second.index("def 变量_own")].count("\n") + 1 - begins
    assert further != 0
    assert place.second.first_line == place.first.first_line + further
    assert place.second.last_line == place.first.last_line + further


def test_equal_files_are_first(given: Hashes) -> None:
    long = changed_square(1) + "\n\nclass More:" + own_code(11) + own_code(12)
    scripts = [changed_square(2), changed_square(2), long, renamed(long)]
    ranking = rank([script(one) for one in scripts], given)
    assert [(one.first, one.second, one.same_file) for one in ranking.pairs[:2]] == [
        (0, 1, True),
        (2, 3, False),
    ]


def test_what_many_have_counts_for_nobody(given: Hashes) -> None:
    everybody = [changed_square(1) + f"\nx = {i}\n" for i in range(40)]
    ranking = rank([script(one) for one in everybody], given)
    assert (ranking.few, ranking.pairs) == (10, ())
    assert len(ranking.too_little) == 40


def test_too_little_of_ones_own_is_not_compared(given: Hashes) -> None:
    small = SQUARE + "\nprint([x for x in range(3) if x not in (1, 2)])\n"
    ranking = rank([script(small), script(small)], given)
    assert ranking.too_little == (0, 1)
    assert 0 < len(np.setdiff1d(prints(small).hashes, given)) < FEWEST_OWN


def test_a_ranking_is_bounded(given: Hashes) -> None:
    twice = [script(f"class Own{i}:{own_code(i // 2)}") for i in range(2 * MOST_PAIRS + 8)]
    ranking = rank(twice, given)
    assert len(ranking.pairs) == MOST_PAIRS
    assert ranking.left_out == 4


def test_nobody_and_one_are_no_class(given: Hashes) -> None:
    assert rank([], given).pairs == rank([script(changed_square(1))], given).pairs == ()


# ---------------------------------------------------------------------------------- commands


def square_commands(start_ns: int = 0, v_mps: float = 1.0) -> tuple[Command, ...]:
    tick_ns = 16_000_000
    sides = [(v_mps, 0.0), (0.0, 1.57)] * 4
    return tuple(
        Command(start_ns + (i * 10 + k) * tick_ns, *velocity)
        for i, velocity in enumerate(sides)
        for k in range(10)
    )


def test_a_drive_is_what_was_commanded_and_when() -> None:
    drive = drive_of([square_commands()])
    assert drive.changes == 8
    assert drive == drive_of([square_commands(start_ns=123)])
    assert drive.digest != drive_of([square_commands(v_mps=1.01)]).digest
    assert drive.digest != drive_of([square_commands(), square_commands()]).digest
    later = square_commands()
    assert drive.digest != drive_of([(*later[:-1], later[-1]._replace(t_ns=later[-1].t_ns + 1))]).digest


def test_equal_drives_of_different_texts_are_told(given: Hashes) -> None:
    drive, other = drive_of([square_commands()]), drive_of([square_commands(v_mps=0.5)])
    scripts = [
        script(changed_square(i), drive if i in (2, 5) else other if i == 6 else None) for i in range(8)
    ]
    ranking = rank(scripts, given)
    (pair,) = ranking.same_drives
    assert (pair.first, pair.second, pair.same_drive) == (2, 5, True)
    known = rank(scripts, given, known_drives=frozenset({drive.digest}))
    assert known.same_drives == ()


def test_the_drive_of_given_code_says_nothing(given: Hashes) -> None:
    drive = drive_of([square_commands()])
    scripts = [script(SQUARE, drive), script(changed_square(1), drive), script(changed_square(2), drive)]
    assert rank(scripts, given).same_drives == ()
    straight = drive_of([square_commands()[:10]])
    assert rank([script(changed_square(i), straight) for i in (1, 2)], given).same_drives == ()


def test_similar_texts_that_drove_alike_are_told_once(given: Hashes) -> None:
    drive = drive_of([square_commands()])
    ranking = rank([script(changed_square(1), drive), script(renamed(changed_square(1)), drive)], given)
    assert [one.same_drive for one in ranking.pairs] == [True]
    assert ranking.same_drives == ()
