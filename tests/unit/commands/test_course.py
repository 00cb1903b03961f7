"""`grader course` and `grader token`, as typed."""

import csv
import io
from pathlib import Path

import pytest

from grader import cli
from grader.contracts.identity import Role
from grader.store.columns import utc_now
from grader.store.database import Database
from grader.store.tokens import Tokens


@pytest.fixture
def grader(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def run(*arguments: str, status: int = 0, lang: str = "en") -> tuple[str, str]:
        assert cli.run([*arguments, "--data", str(tmp_path / "data"), "--lang", lang]) == status
        return capsys.readouterr()

    return run


def tokens_of(output: str) -> dict[str, str]:
    return {row["id"]: row["token"] for row in csv.DictReader(io.StringIO(output))}


@pytest.fixture
def recognised(tmp_path: Path):
    def who(token: str):
        database = Database(f"sqlite:///{tmp_path / 'data' / 'grader.db'}")
        caller = Tokens(database, utc_now).caller(token)
        database.close()
        return caller

    return who


def test_one_command_makes_a_course_and_prints_its_tokens(grader, recognised, tmp_path: Path) -> None:
    roster = tmp_path / "class.csv"
    roster.write_text("id,name,role\n1,李雷,\nta,助教,assistant\n")
    output, _ = grader("course", "create", "ros", "--instructor", "wang", "--roster", str(roster))
    tokens = tokens_of(output)
    assert {person: recognised(token).role for person, token in tokens.items()} == {
        "wang": Role.INSTRUCTOR,
        "1": Role.STUDENT,
        "ta": Role.ASSISTANT,
    }
    listed, _ = grader("course", "list")
    assert listed.startswith("ros\tAsia/Shanghai\t3 members")


def test_a_wrong_roster_leaves_no_course_behind(grader, tmp_path: Path) -> None:
    roster = tmp_path / "class.csv"
    roster.write_text("id,name\n1,a\n1,b\n")
    _, errors = grader("course", "create", "ros", "--instructor", "w", "--roster", str(roster), status=2)
    assert "line 3: 1 stands in line 2 already" in errors
    assert grader("course", "list")[0] == ""


def test_a_roster_is_imported_whole_or_not_at_all(grader, tmp_path: Path) -> None:
    grader("course", "create", "ros", "--instructor", "wang")
    roster = tmp_path / "class.csv"
    roster.write_text("id,name\n1,a\n,b\n")
    _, errors = grader("course", "roster", "import", str(roster), status=2)
    assert "line 3" in errors
    assert "1 member\t" in grader("course", "list")[0]
    roster.write_text("id,name\n1,a\n2,b\n")
    output, told = grader("course", "roster", "import", str(roster), "--tokens")
    assert set(tokens_of(output)) == {"1", "2"}
    assert "2 added" in told


def test_tokens_are_issued_and_revoked(grader, recognised, tmp_path: Path) -> None:
    grader("course", "create", "ros", "--instructor", "wang")
    roster = tmp_path / "class.csv"
    roster.write_text("id,name\n1,a\n2,b\n")
    grader("course", "roster", "import", str(roster))
    first = tokens_of(grader("token", "issue", "1")[0])["1"]
    assert set(tokens_of(grader("token", "issue", "--missing")[0])) == {"2"}
    assert recognised(first).person == "1"
    grader("token", "revoke", "1")
    assert recognised(first) is None
    assert "revoked" in grader("token", "list")[0]
    assert "no member 9" in grader("token", "issue", "1", "9", status=2)[1]
    assert "no such token" in grader("token", "revoke", "--token", "abc", status=2)[1]


def test_of_several_courses_one_must_be_named(grader, tmp_path: Path) -> None:
    assert cli.run(["db", "migrate", "--data", str(tmp_path / "data")]) == 0
    assert "no course yet" in grader("token", "list", status=2)[1]
    grader("course", "create", "a", "--instructor", "w")
    grader("course", "create", "b", "--instructor", "w")
    assert "--course: a, b" in grader("token", "list", status=2)[1]
    assert len(grader("token", "list", "--course", "b")[0].splitlines()) == 1


def test_mistakes_are_told_in_the_readers_language(grader, tmp_path: Path) -> None:
    roster = tmp_path / "class.csv"
    roster.write_text("id,name,role\n1,a,\n1,b,\n,c,\n4,d,king\n5,e,student,x\n")
    create = ("course", "create", "ros", "--instructor", "w", "--roster", str(roster))
    chinese = grader(*create, status=2, lang="zh")[1].splitlines()
    english = grader(*create, status=2)[1].splitlines()
    assert [line.partition("：")[0] for line in chinese[1:]] == ["第 3 行", "第 4 行", "第 5 行", "第 6 行"]
    assert [line.partition(":")[0] for line in english[1:]] == ["line 3", "line 4", "line 5", "line 6"]
    assert "没有导入任何人" in chinese[0]
    assert "还没有课程" in grader("token", "list", status=2, lang="zh")[1]


@pytest.mark.parametrize(
    "command",
    [
        ["course", "list"],
        ["course", "roster", "import", "class.csv"],
        ["token", "list"],
        ["token", "issue", "--missing"],
        ["policy", "show"],
    ],
    ids=" ".join,
)
def test_a_mistyped_folder_is_refused_and_not_made(grader, tmp_path: Path, command: list[str]) -> None:
    _, errors = grader(*command, status=2)
    assert "there is no database; check --data" in errors
    _, errors = grader(*command, status=2, lang="zh")
    assert "没有这个数据库" in errors
    assert list(tmp_path.iterdir()) == []
