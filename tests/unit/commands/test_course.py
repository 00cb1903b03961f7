"""`grader course` and `grader token`, as typed."""

import csv
import io
import os
from pathlib import Path

import pytest

from grader.commands import cli
from grader.contracts.identity import Role
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.tokens import Tokens


@pytest.fixture
def typed(capsys: pytest.CaptureFixture[str]):
    def run(*arguments: str, status: int = 0, lang: str = "en") -> tuple[str, str]:
        assert cli.run([*arguments, "--lang", lang]) == status
        return capsys.readouterr()

    return run


@pytest.fixture
def grader(typed, sqlite_url: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("GRADER_DATABASE_URL", sqlite_url)
    return typed


def tokens_of(output: str) -> dict[str, str]:
    assert output[0] == "\ufeff"  # for Excel
    return {row["id"]: row["token"] for row in csv.DictReader(io.StringIO(output[1:]))}


@pytest.fixture
def recognised():
    def who(token: str):
        database = Database(os.environ["GRADER_DATABASE_URL"])
        caller = Tokens(database, utc_now).caller(token)
        database.close()
        return caller

    return who


def test_one_command_makes_a_database_and_a_course_and_prints_its_tokens(
    typed, recognised, blank_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("GRADER_DATABASE_URL", blank_url)
    roster = tmp_path / "class.csv"
    roster.write_text("id,name,role\n1,李雷,\nta,助教,assistant\nwang,王老师,\n")
    output, _ = typed("course", "create", "ros", "--instructor", "wang", "--roster", str(roster))
    assert "wang,王老师,instructor," in output
    tokens = tokens_of(output)
    assert {person: recognised(token).role for person, token in tokens.items()} == {
        "wang": Role.INSTRUCTOR,
        "1": Role.STUDENT,
        "ta": Role.ASSISTANT,
    }
    listed, _ = typed("course", "list")
    assert listed.startswith("ros\tAsia/Shanghai\thumble\t3 members")


def test_a_course_of_jazzy_is_made_and_changed(grader) -> None:
    grader("course", "create", "ros", "--instructor", "w", "--distro", "jazzy")
    assert "\tjazzy\t" in grader("course", "list")[0]
    assert "Humble" in grader("course", "set", "--distro", "humble", "--reason", "the lab's PCs")[1]
    assert "\thumble\t" in grader("course", "list")[0]
    assert "Humble, ros2_run, 12 h" in grader("course", "set", "--runs-as", "ros2_run")[1]
    assert "Humble, ros2_run, 168 h" in grader("course", "set", "--session-hours", "168")[1]
    told = grader("course", "set", "--title", "Robots", "--time-zone", "Europe/Berlin")[1]
    assert "Robots, Europe/Berlin, ROS 2 Humble" in told
    assert "no time zone" in grader("course", "set", "--time-zone", "Mars", status=2)[1]


def test_a_roster_saved_by_excel_in_china_is_read_and_a_name_shown(grader, tmp_path: Path) -> None:
    roster = tmp_path / "class.csv"
    roster.write_bytes("学号,姓名\r\n1,李雷\r\n".encode("gbk"))
    output, told = grader("course", "create", "ros", "--instructor", "w", "--roster", str(roster), lang="zh")
    assert "按 GBK 读取，例如：1 李雷" in told
    assert "李雷" in output


def test_a_wrong_roster_leaves_no_course_behind(grader, tmp_path: Path) -> None:
    roster = tmp_path / "class.csv"
    roster.write_text("id,name\n1,a\n1,b\n")
    _, errors = grader("course", "create", "ros", "--instructor", "w", "--roster", str(roster), status=2)
    assert "line 3: 1 a stands in line 2 already" in errors
    assert grader("course", "list")[0] == ""
    assert grader("course", "costs", lang="zh")[0].split() == [
        "课程",
        "学生",
        "占用槽位",
        "评分",
        "等待",
        "启动",
    ]


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


def test_every_wrong_row_is_named_and_skipped(grader, tmp_path: Path) -> None:
    grader("course", "create", "ros", "--instructor", "wang")
    roster = tmp_path / "class.csv"
    roster.write_text("id,name\n0012345,a\nB7,b\n")
    grader("course", "roster", "import", str(roster))
    roster.write_text("id,name\n12345,z\n9,c\nb7,b\n9,d\n")
    _, errors = grader("course", "roster", "import", str(roster), status=2)
    assert [one.split(":")[0] for one in errors.splitlines() if "line" in one] == [
        "line 2",
        "line 4",
        "line 5",
    ]
    skipped = grader("course", "roster", "import", str(roster), "--skip")[1]
    assert "line 2 is skipped: 12345 differs from the member 0012345" in skipped
    assert "1 added" in skipped


def test_a_dry_run_of_a_part_lists_no_others(grader, tmp_path: Path) -> None:
    grader("course", "create", "ros", "--instructor", "wang")
    roster = tmp_path / "class.csv"
    roster.write_text("id,name,section\n" + "".join(f"{one},s,{'AB'[one % 2]}\n" for one in range(10, 20)))
    grader("course", "roster", "import", str(roster))
    dry = ("course", "roster", "import", str(roster), "--dry-run")
    roster.write_text("id,name,role\nta,t,assistant\n")
    assert grader(*dry)[0] == "new\tta\tt\tassistant\n"
    roster.write_text("id,name,section\n10,s,A\n12,s,A\n14,s,A\n16,s,A\n")
    assert grader(*dry)[0] == "not listed\t18\ts\tstudent\t\tA\n"
    roster.write_text("id,name\n10,s\n")
    output, told = grader(*dry)
    assert (output, "9 other students" in told) == ("", True)


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


def test_tokens_for_everybody_in_a_section(grader, tmp_path: Path) -> None:
    grader("course", "create", "ros", "--instructor", "w")
    roster = tmp_path / "class.csv"
    roster.write_text("id,name,section\n1,a,A\n2,b,B\n3,c,A\n")
    grader("course", "roster", "import", str(roster))
    assert set(tokens_of(grader("token", "issue", "--section", "A")[0])) == {"1", "3"}
    assert "no section 'C'; there are: A, B" in grader("token", "issue", "--section", "C", status=2)[1]


def test_of_several_courses_one_must_be_named(grader) -> None:
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
        ["rules", "show"],
    ],
    ids=" ".join,
)
def test_a_mistyped_folder_is_refused_and_not_made(typed, tmp_path: Path, command: list[str]) -> None:
    command = [*command, "--data", str(tmp_path / "data")]
    _, errors = typed(*command, status=2)
    assert "there is no database; check --data" in errors
    _, errors = typed(*command, status=2, lang="zh")
    assert "没有这个数据库" in errors
    assert list(tmp_path.iterdir()) == []


def test_a_new_course_makes_its_folder(typed, tmp_path: Path) -> None:
    typed("course", "create", "ros", "--instructor", "wang", "--data", str(tmp_path / "new"))
    assert (tmp_path / "new" / "grader.db").is_file()


def test_a_course_is_copied_and_archived(grader, recognised) -> None:
    grader("course", "create", "ros", "--instructor", "wang")
    grader("rules", "set", "square", "due=2026-03-20T23:59:59")
    output, _ = grader(
        "course", "copy", "next", "--instructor", "chen", "--move-days", "364", "--course", "ros"
    )
    assert recognised(tokens_of(output)["chen"]).course == "next"
    assert '"due": "2027-03-19T23:59:59+08:00"' in grader("rules", "show", "--json", "--course", "next")[0]
    grader("course", "archive", "--course", "ros")
    assert "archived" in grader("course", "list")[0]
    refused = grader("rules", "set", "square", "attempts=1", "--course", "ros", status=2)[1]
    assert "archived and can only be read" in refused
    grader("course", "reopen", "--course", "ros")
    grader("rules", "set", "square", "attempts=1", "--course", "ros")


def test_space_retention_and_forgetting_are_typed(grader) -> None:
    grader("course", "create", "ros", "--instructor", "wang")
    assert grader("course", "space")[0].startswith("course\tsubmissions")
    assert "nothing was erased" in grader("course", "retention", "--older-than", "400d", "--dry-run")[1]
    assert "no member nobody" in grader("course", "forget", "nobody", status=2)[1]


def test_nobody_is_forgotten_unasked(grader, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    roster = tmp_path / "class.csv"
    roster.write_text("id,name,section\n7,a,A\n")
    grader("course", "create", "ros", "--instructor", "wang", "--roster", str(roster))
    assert "nothing was erased" in grader("course", "forget", "7", "--dry-run")[1]
    for typed, status in (("8\n", 2), ("", 2), ("7\n", 0)):
        monkeypatch.setattr("sys.stdin", io.StringIO(typed))
        told = grader("course", "forget", "7", status=status)[1]
        assert "7 has 0 submissions" in told
        assert ("--yes" in told) == bool(status)
    grader("course", "roster", "import", str(roster))
    assert "the audit log says forgotten-" in grader("course", "forget", "7", "--yes")[1]
