"""Messages to group bots: signed as each vendor documents it, and every refusal noticed."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from grader.contracts.notice import NewWebhook, Outlet, Vendor
from grader.outside.notices import NotSentError
from grader.outside.notices.bots import MOST_BYTES, BotChannel, example_address, is_address
from tests.fakes.bots import KEY, SECRET, FakeBots, bots

NOW_S = 1_772_438_400.25
SIGNING = (Vendor.FEISHU, Vendor.DINGTALK)


@pytest.fixture(scope="module")
def listening() -> Iterator[FakeBots]:
    with bots() as known:
        yield known


@pytest.fixture
def group(listening: FakeBots) -> FakeBots:
    listening.texts, listening.asked, listening.seen, listening.answer = [], [], [], None
    listening.clock_s = lambda: NOW_S
    return listening


@pytest.fixture
def channel() -> BotChannel:
    return BotChannel(lambda: NOW_S, private=True)


def webhook(group: FakeBots, vendor: Vendor) -> NewWebhook:
    secret = "" if vendor is Vendor.WECOM else SECRET
    return NewWebhook(outlet=Outlet.CLASS, vendor=vendor, address=group.of(vendor), secret=secret)


@pytest.mark.parametrize("vendor", Vendor)
def test_each_bot_takes_a_message(channel: BotChannel, group: FakeBots, vendor: Vendor) -> None:
    channel.send(webhook(group, vendor), "快截止了：走正方形\n第二行")
    assert group.texts == ["快截止了：走正方形\n第二行"]


def test_signatures_are_those_of_the_documents_formulas(channel: BotChannel, group: FakeBots) -> None:
    """Computed with openssl: printf '' | openssl dgst -sha256 -hmac "$(printf 'T\\nS')" -binary | base64."""
    for vendor in SIGNING:
        channel.send(webhook(group, vendor), "x")
    feishu = group.seen[0]
    assert (feishu["timestamp"], feishu["sign"]) == (
        "1772438400",
        "rM0kO5RL9B2FGNoT56Ug+HRsORsS7pz7IGaXK9lsESk=",
    )
    assert group.asked[1] == (
        f"/robot/send?access_token={KEY}&timestamp=1772438400250&sign=HlGAx2VyBAGjnn184RNYeb0fakuuluRMRMksNJsDpXI%3D"
    )


@pytest.mark.parametrize("vendor", SIGNING)
def test_a_wrong_secret_and_a_wrong_clock_are_a_failure(group: FakeBots, vendor: Vendor) -> None:
    right = webhook(group, vendor)
    for clock_s, one in ((NOW_S, replace(right, secret="other")), (NOW_S - 3_700, right)):
        with pytest.raises(NotSentError) as told:
            BotChannel(lambda at=clock_s: at, private=True).send(one, "x")
        assert told.value.code == "security"
        assert SECRET not in str(told.value)
    assert group.texts == []


@pytest.mark.parametrize("vendor", Vendor)
def test_a_bot_that_is_gone_is_a_failure(channel: BotChannel, group: FakeBots, vendor: Vendor) -> None:
    gone = replace(webhook(group, vendor), address=group.of(vendor) + "x")
    with pytest.raises(NotSentError) as told:
        channel.send(gone, "x")
    assert told.value.code == "address"


REFUSALS = {
    "feishu too often": (Vendor.FEISHU, 200, {"code": 11232, "msg": "frequency limited"}, "too_often"),
    "feishu 429": (
        Vendor.FEISHU,
        429,
        {"code": 99991400, "msg": "request trigger frequency limit"},
        "too_often",
    ),
    "a status alone": (Vendor.FEISHU, 429, b"slow down", "too_often"),
    "feishu keyword": (Vendor.FEISHU, 200, {"code": 19024, "msg": "Key Words Not Found"}, "security"),
    "feishu bad body": (Vendor.FEISHU, 400, {"code": 9499, "msg": "Bad Request"}, "refused"),
    "dingtalk too often": (
        Vendor.DINGTALK,
        200,
        {"errcode": 130101, "errmsg": "send too fast, exceed 20 times per minute"},
        "too_often",
    ),
    "dingtalk address": (Vendor.DINGTALK, 200, {"errcode": 310000, "errmsg": "not in whitelist"}, "security"),
    "wecom too often": (
        Vendor.WECOM,
        200,
        {"errcode": 45009, "errmsg": "api freq out of limit"},
        "too_often",
    ),
    "an unknown code": (Vendor.WECOM, 200, {"errcode": -1, "errmsg": "system busy"}, "refused"),
    "no code at all": (Vendor.WECOM, 200, {"ok": True}, "refused"),
    "a page": (Vendor.WECOM, 200, b"<html>welcome</html>", "refused"),
    "another place": (Vendor.WECOM, 302, b"", "refused"),
    "a code with an error's status": (Vendor.WECOM, 404, {"errcode": 0}, "refused"),
    "a code that is a text": (Vendor.WECOM, 200, {"errcode": "0"}, "refused"),
    "nested beyond all measure": (Vendor.WECOM, 200, b'{"x":' + b"[" * 100_000, "refused"),
    "down": (Vendor.WECOM, 503, b"", "unreachable"),
    "too long an answer": (Vendor.WECOM, 200, b"x" * 300_000, "unreachable"),
}


@pytest.mark.parametrize("how", REFUSALS)
def test_whatever_is_not_taken_is_a_failure(channel: BotChannel, group: FakeBots, how: str) -> None:
    vendor, status, answer, code = REFUSALS[how]
    group.answer = status, answer
    with pytest.raises(NotSentError) as told:
        channel.send(webhook(group, vendor), "x")
    assert told.value.code == code
    assert KEY not in str(told.value)
    assert SECRET not in str(told.value)


def test_nobody_there_is_a_failure_that_tells_no_key(channel: BotChannel, group: FakeBots) -> None:
    for vendor in Vendor:
        dead = replace(
            webhook(group, vendor), address=group.of(vendor).replace(group.address, "http://127.0.0.1:9")
        )
        with pytest.raises(NotSentError) as told:
            channel.send(dead, "x")
        assert told.value.code == "unreachable"
        assert "127.0.0.1:9" in str(told.value)
        assert KEY not in str(told.value)
        assert "sign=" not in str(told.value)


def test_no_message_goes_into_a_private_network(group: FakeBots) -> None:
    with pytest.raises(NotSentError) as told:
        BotChannel(lambda: NOW_S, private=False).send(webhook(group, Vendor.WECOM), "x")
    assert told.value.code == "unreachable"
    assert "private network" in told.value.detail
    assert group.asked == []


def test_a_long_message_is_cut_between_characters(channel: BotChannel, group: FakeBots) -> None:
    channel.send(webhook(group, Vendor.WECOM), "方" * 2_000)
    (text,) = group.texts
    assert text == "方" * ((MOST_BYTES - 3) // 3) + "…"


@pytest.mark.parametrize("vendor", Vendor)
def test_an_address_looks_as_the_vendor_has_it(vendor: Vendor) -> None:
    good = example_address(vendor).replace("…", "abc-1")
    assert is_address(vendor, good)
    others = [example_address(one).replace("…", "abc-1") for one in Vendor if one is not vendor]
    wrong = [
        *others,
        good.replace("https:", "http:"),
        good.replace("https:", "ftp:"),
        good.replace("https://", "https://user:x@"),
        good.removesuffix("abc-1"),
        good + "#x",
        good + "\n",
        good + "&sign=x",
        good + "/../x",
        "",
        "abc",
        "https://[",
    ]
    accepted = [one for one in wrong if is_address(vendor, one)]
    # within a key's value anything may stand
    assert set(accepted) <= ({good + "/../x"} if vendor is not Vendor.FEISHU else {good + "&sign=x"})
