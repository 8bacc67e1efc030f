"""The study in a real browser: raters answer, leave, come back, and lose nothing when the server dies."""

import json
import time
from pathlib import Path

import pytest
from chromium import Tab, found_browser, opened_tab
from study_chaos import Served
from study_toys import served, toy_study

from sag.cli import main
from sag.study.handouts import write_handouts
from sag.study.store import Store

BROWSER = found_browser()

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")


@pytest.fixture(scope="module")
def tabs(tmp_path_factory):
    """A browser for all tests."""
    with opened_tab(BROWSER, tmp_path_factory.mktemp("browser") / "profile") as tab:
        yield tab


@pytest.fixture
def tab(tabs: Tab) -> Tab:
    """An empty page, in which nothing moves by itself."""
    tabs.visit("about:blank")
    tabs.browser.events.clear()
    tabs.media(prefers_reduced_motion="reduce", prefers_color_scheme="light")
    tabs.size(800, 600)
    return tabs


@pytest.fixture
def small(tmp_path):
    """Two scenes with a method and the ground truth, one motion twice: five turns."""
    return toy_study(tmp_path / "study", scenes=2, methods=("mdpc",), repeats=1)


def begin(tab: Tab, port: int) -> str:
    """Reads the instructions and starts; returns the rater's token."""
    tab.visit(f"http://127.0.0.1:{port}/")
    tab.value("document.getElementById('start').click()")
    tab.until("location.search.startsWith('?rater=') && document.readyState === 'complete'")
    shown(tab)
    return tab.value("sagStudy.session.rater")


def shown(tab: Tab, turn: int = 0) -> None:
    """Waits until a motion is there to be scored."""
    # While a scene is on its way the clip before it is still there.
    there = "document.getElementById('loading').hidden"
    tab.until(f"window.sagStudy && sagStudy.turn === {turn} && !sagStudy.saving && {there}")
    tab.until("sagStudy.clip.drawn > 0 && !sagStudy.clip.stale")


def rate(tab: Tab, scene: int, human: int) -> None:
    """Watches the motion to its end and scores it by keys."""
    tab.press("End")
    tab.until("sagStudy.clip.seen")
    for key in (str(scene), str(human), "Enter"):
        tab.press(key)


def scores(study, token: str) -> list[tuple[int, int]]:
    """What the file of answers holds of a rater, by turn."""
    store = Store(study.answers)
    found = [one for one in store.answers() if one.rater == token.partition(".")[0]]
    store.close()
    assert [one.turn for one in found] == list(range(len(found)))
    return [(one.scores["scene"], one.scores["human"]) for one in found]


GIVEN = [(1, 5), (2, 4), (3, 3), (4, 2), (5, 1)]


def test_raters_answer_all_and_the_report_has_them(tab, small):
    with served(small) as server:
        port = server.server_address[1]
        tokens = []
        for number in range(3):
            tokens.append(begin(tab, port))
            for turn, (scene, human) in enumerate(GIVEN):
                shown(tab, turn)
                assert tab.value("document.getElementById('count').textContent") == f"{turn} of 5"
                rate(tab, (scene + number) % 5 + 1, human)
            tab.until("!document.getElementById('done').hidden")
            assert "answered and saved" in tab.value("document.getElementById('farewell').textContent")
        assert tab.complaints() == []
        assert {url.split("/")[2] for url in tab.requests() if url != "about:blank"} == {f"127.0.0.1:{port}"}
    assert len(set(tokens)) == 3
    for number, token in enumerate(tokens):
        assert scores(small, token) == [((scene + number) % 5 + 1, human) for scene, human in GIVEN]
    assert main(["study", "report", str(small.folder)]) == 0
    assert "15 by 3 raters" in (small.folder / "report/table.md").read_text()


def test_a_reload_in_the_middle_goes_on(tab, small):
    with served(small) as server:
        token = begin(tab, server.server_address[1])
        for turn in range(3):
            shown(tab, turn)
            rate(tab, *GIVEN[turn])
        shown(tab, 3)
        tab.press("4")
        tab.visit(tab.value("location.href"))
        shown(tab, 3)
        assert tab.value("document.getElementById('progress').getAttribute('aria-valuenow')") == "3"
        # Who opens the first page again is offered the way back, and may be somebody else.
        tab.visit(f"http://127.0.0.1:{server.server_address[1]}/")
        assert tab.value("document.getElementById('start').textContent") == "Start as somebody else"
        tab.value("document.getElementById('resume').click()")
        tab.until("location.search.startsWith('?rater=')")
        shown(tab, 3)
        rate(tab, *GIVEN[3])
        shown(tab, 4)
    assert scores(small, token) == GIVEN[:4]


def test_a_crash_in_the_middle_loses_nothing(tab, small):
    server = Served(small)
    token = begin(tab, server.port)
    for turn in range(2):
        shown(tab, turn)
        rate(tab, *GIVEN[turn])
    shown(tab, 2)
    server.kill()
    assert scores(small, token) == GIVEN[:2]
    rate(tab, *GIVEN[2])
    tab.until("document.getElementById('said').textContent.startsWith('Not saved yet')")
    assert tab.value("sagStudy.turn") == 2 and tab.value("document.getElementById('next').disabled")
    server.start()
    shown(tab, 3)
    assert scores(small, token) == GIVEN[:3]
    # And once more, with the page closed before the server is back: the browser still has the answer.
    server.kill()
    rate(tab, *GIVEN[3])
    tab.until("document.getElementById('said').textContent.startsWith('Not saved yet')")
    address = tab.value("location.href")
    tab.visit("about:blank")
    server.start()
    tab.visit(address)
    shown(tab, 4)
    assert scores(small, token) == GIVEN[:4]
    rate(tab, *GIVEN[4])
    tab.until("!document.getElementById('done').hidden")
    assert scores(small, token) == GIVEN and server.end() == 0


def test_a_motion_must_be_seen_before_it_is_scored(tab, small):
    with served(small) as server:
        token = begin(tab, server.server_address[1])
        for key in ("4", "3", "Enter"):
            tab.press(key)
        assert tab.value("sagStudy.scales.scores") == {"scene": 4, "human": 3}
        assert tab.value("document.getElementById('next').disabled")
        assert "Watch the motion to its end" in tab.value("document.getElementById('said').textContent")
        tab.press(" ", "Space")
        tab.until("sagStudy.clip.plays > 0")
        assert not tab.value("document.getElementById('next').disabled")
        tab.press("2")  # both are answered: the last one is changed
        tab.value("document.querySelector('input[name=scene][value=\"1\"]').click()")
        tab.value("document.getElementById('next').click()")
        shown(tab, 1)
        assert tab.value("sagStudy.scales.scores") == {}
    assert scores(small, token) == [(1, 2)]


def test_only_one_body_moves_and_it_is_the_motion_of_the_turn(tab, small):
    with served(small) as server:
        begin(tab, server.server_address[1])
        first = tab.value("[sagStudy.clip.bodies().length, sagStudy.clip.view.motions.indexOf(sagStudy.turns[0][2])]")
        assert first[0] == 1 and first[1] >= 0
        same = f"sagStudy.clip.motion === windowOf(sagStudy.turns[0][1]).rows[0].motions[{first[1]}]"
        assert tab.value(same)
        before = tab.value("[...sagStudy.clip.bodies()[0].joints.slice(36, 39)]")
        tab.press("End")
        assert tab.value("[...sagStudy.clip.bodies()[0].joints.slice(36, 39)]") != before
        colours = "windowOf(sagStudy.turns[0][1]).rows[0].motions.map(motion => motion.colour)"
        assert tab.value("sagStudy.clip.motion.colour") == tab.value("BODY_COLOUR") in tab.value(colours)


def test_every_control_has_a_name_and_questions_are_groups(tab, small):
    with served(small) as server:
        begin(tab, server.server_address[1])
        nodes = tab.call("Accessibility.getFullAXTree")["nodes"]
    named: dict[str, list[str]] = {}
    for node in nodes:
        named.setdefault(node.get("role", {}).get("value"), []).append(node.get("name", {}).get("value", ""))
    assert all(all(named[kind]) for kind in ("button", "radio", "slider", "image", "progressbar"))
    assert named["radio"] == ["1, strongly abnormal", "2", "3", "4", "5, strongly compatible"] * 2
    assert {"Does the motion fit the scene?", "Do the movements of the body fit its path?"} <= set(named["group"])


def test_it_fits_a_phone_without_scrolling(tab, small):
    with served(small) as server:
        tab.size(375, 667, phone=True)
        begin(tab, server.server_address[1])
        assert tab.value("document.documentElement.scrollWidth") <= 375
        assert tab.value("document.getElementById('next').getBoundingClientRect().bottom") <= 667
        assert tab.value("document.getElementById('stage').clientHeight") >= 200
        sides = "[...document.querySelectorAll('.scale label')].flatMap(one => [one.clientWidth, one.clientHeight])"
        assert min(tab.value(sides)) >= 40
    tab.size(800, 600)


def test_a_file_is_answered_without_a_server(tab, small, tmp_path):
    store = Store(small.answers)
    (path,) = write_handouts(small, store, 1, tmp_path / "files")
    store.close()
    tab.open(path)
    tab.value("document.getElementById('start').click()")
    for turn in range(3):
        shown(tab, turn)
        rate(tab, *GIVEN[turn])
    shown(tab, 3)
    tab.open(path)  # a reload in the middle
    for turn in range(3, 5):
        shown(tab, turn)
        rate(tab, *GIVEN[turn])
    tab.until("!document.getElementById('done').hidden")
    tab.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    tab.value("document.getElementById('download').click()")
    (file,) = wait_for(tmp_path, "answers-*.json")
    assert [tuple(answer["scores"].values()) for answer in json.loads(file.read_text())["answers"]] == GIVEN
    assert tab.complaints() == [] and {url.partition(":")[0] for url in tab.requests()} <= {"file", "blob"}
    assert main(["study", "report", str(small.folder), str(file)]) == 0
    assert "5 by 1 raters" in (small.folder / "report/table.md").read_text()


def wait_for(folder: Path, pattern: str) -> list[Path]:
    """Files that a download makes."""
    deadline = time.monotonic() + 30
    while not (found := list(folder.glob(pattern))):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return found


def test_without_webgl_nobody_can_start(small, tmp_path):
    with served(small) as server, opened_tab(BROWSER, tmp_path / "without", "--disable-3d-apis") as tab:
        tab.visit(f"http://127.0.0.1:{server.server_address[1]}/")
        assert "shows no WebGL 2" in tab.value("document.getElementById('missing').innerText")
        assert tab.value("document.getElementById('start').disabled")
