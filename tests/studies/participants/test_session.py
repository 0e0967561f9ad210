"""The page of a study for people in a real browser: from the disk to rows, and as a plugin."""

import json
import shutil
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from queue import SimpleQueue
from urllib.parse import urlencode

import pytest
from tests.studies.sessions import leave, play, say
from tests.studies.transfer import TRANSFER, content_of, transfer_in

import beliefnest as bn

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOT = Path(__file__).parents[3]
AXE = ROOT / "src/beliefnest/viewer/page/web/node_modules/axe-core/axe.min.js"
MARKED = TRANSFER.replace("left box", "<i>left</i> box")
# Keys as WebDriver writes them.
TAB, ENTER, SPACE = "\ue004", "\ue007", "\ue00d"
STAND_IN = Path(__file__).with_name("jspsych_stand_in.js")
CONSENT = "# Consent\n\nYou may stop <b>at any time</b>.\n\n- one\n---\nGo on.\n"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Folder with a study and its page, with texts that look like marks of HTML."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "consent.md").write_text(CONSENT, encoding="utf-8")
    study = bn.Study.load(transfer_in(folder, scenario=MARKED))
    (folder / "end.md").write_text("The code is <b>C4</b>.", encoding="utf-8")
    study.participants(
        folder / "page",
        instructions=folder / "consent.md",
        ending=folder / "end.md",
        title="A <title> of ours",
    )
    return folder


@pytest.fixture
def downloads(browser, tmp_path):
    """Folder into which the browser saves files."""
    folder = tmp_path / "downloads"
    folder.mkdir()
    wanted = {"behavior": "allow", "downloadPath": str(folder)}
    browser.driver.execute_cdp_cmd("Browser.setDownloadBehavior", wanted)
    return folder


def opened(browser, folder, **query):
    address = f"{(folder / 'page' / 'index.html').as_uri()}?{urlencode(query)}"
    browser.open(address)
    return address


def test_a_session_from_the_disk_gives_rows_of_the_study(browser, page, downloads, tmp_path):
    address = opened(browser, page, participant="ann 1", list=2)
    assert browser.driver.title == "A <title> of ours"
    told = browser.one(".bn-screen").text
    assert told.splitlines() == ["Consent", "You may stop <b>at any time</b>.", "one", "Continue"]
    browser.click(".bn-continue")
    browser.click(".bn-continue")
    assert leaving_asks(browser)
    questions = play(browser, "<i>left</i> box", 6)
    assert len(set(questions)) == 5  # "Who is there?" is asked about both items
    browser.until_script("return document.getElementById('page').dataset.ended")
    assert browser.script("return document.querySelector('progress').value") == 6
    assert "The code is <b>C4</b>." in browser.one(".bn-screen").text
    for button in browser.driver.find_elements("css selector", ".bn-controls .bn-button"):
        button.click()
    names = [downloads / f"answers-ann_1.{ending}" for ending in ("csv", "json")]
    browser.until(lambda: all(name.exists() for name in names))
    assert not leaving_asks(browser)
    assert browser.complaints() == []
    loaded = [each for each in browser.requests() if not each.startswith(("data:", "blob:"))]
    assert loaded == [address]
    study = bn.Study.load(page / "study.yaml")
    results = [study.read_participants(tmp_path / name.suffix[1:], [name]) for name in names]
    assert results[0][0].rows == results[1][0].rows
    assert [notes for _, notes in results] == [(), ()]
    rows = results[0][0].rows
    assert {row["participant"] for row in rows} == {"ann 1"}
    assert {row["list"] for row in rows} == {2}
    right = {(row["condition"], row["probe"]): row["ok"] for row in rows}
    assert right == {(1, "belief"): True, (1, "own"): True, (2, "belief"): False, (2, "own"): False}
    answers = json.loads(names[1].read_text(encoding="utf-8"))
    assert all(each["rt"] > 0 and each["film_shown"] <= 1 for each in answers)
    assert sum(each["film_shown"] for each in answers) == 4  # once for each view
    for each in answers:
        if each["options"]:
            assert each["options"][each["position"] - 1] == each["response"]


def leaving_asks(browser):
    """Return True if the page would have the browser ask before it is left."""
    return browser.script(
        "const event = new Event('beforeunload', { cancelable: true });"
        "dispatchEvent(event); return event.defaultPrevented"
    )


def test_the_screen_tells_no_jargon_and_axe_finds_no_fault(browser, page):
    opened(browser, page, participant="7")
    browser.driver.execute_script(AXE.read_text(encoding="utf-8"))
    found = [violations(browser)]
    browser.click(".bn-continue")
    browser.click(".bn-continue")
    for _ in range(3):
        browser.one(".bn-trial")
        while browser.script("return document.querySelector('.bn-form').hidden"):
            browser.click(".bn-next")
        found.append(violations(browser))
        told = browser.one("body").text
        for jargon in ("tick", "reality", "belief", "undefined", "null", "(", "right answer"):
            assert jargon not in told
        assert "<i>left</i> box" in told
        say(browser, "<i>left</i> box")
    assert [each for each in found if each] == []


def violations(browser):
    return browser.ask(
        "const done = arguments[0];"
        "axe.run().then(told => done(told.violations.map(each =>"
        " each.id + ': ' + each.nodes.map(node => node.html).join(' '))))"
    )


def test_a_film_plays_pauses_and_asks_at_its_end_by_keyboard_alone(browser, page):
    opened(browser, page, participant="17")
    for _ in range(2):
        press(browser, TAB, ENTER)
    # Make all pictures short; the film is otherwise as it is.
    browser.one(".bn-play")
    browser.script(
        "const wait = window.setTimeout; window.setTimeout = (call, ms) => wait(call, ms / 200)"
    )
    assert browser.script("return document.querySelector('.bn-form').hidden")
    first = picture(browser)
    press(browser, TAB, SPACE)
    browser.until(lambda: picture(browser) != first)
    browser.until_script("return !document.querySelector('.bn-form').hidden")
    assert browser.script("return document.querySelector('.bn-play').textContent") == "Play again"
    focus = "return document.activeElement.className"
    assert browser.script(focus) == "bn-fields"
    press(browser, TAB)
    if browser.script("return document.activeElement.type") == "radio":
        press(browser, SPACE)
    else:
        press(browser, "left")
    leave(browser, lambda: press(browser, ENTER))
    assert browser.script("return document.querySelector('progress').value") == 1


def picture(browser):
    return browser.script("return document.querySelector('.bn-picture').src")


def press(browser, *keys):
    for key in keys:
        browser.driver.switch_to.active_element.send_keys(key)


def test_an_unanswered_question_is_not_left(browser, page):
    opened(browser, page, participant="27")
    browser.click(".bn-continue")
    browser.click(".bn-continue")
    browser.one(".bn-trial")
    while browser.script("return document.querySelector('.bn-form').hidden"):
        browser.click(".bn-next")
    browser.click(".bn-submit")
    assert browser.script("return document.querySelector('.bn-form :invalid') !== null")
    assert browser.script("return document.querySelector('progress').value") == 0


SESSION = """
const [study, search] = arguments
const { properties, trials } = globalThis.beliefnest.sessionOf(study, search)
const told = trials.map(({ data, seen, options }) => [data.cell, data.question, seen, options])
return [properties.participant, properties.list, told]
"""


def test_orders_come_from_the_participant_and_lists_from_the_number(browser, page):
    opened(browser, page, participant="37")
    content = content_of(page / "page")

    def session(search):
        return browser.script(SESSION, content, search)

    assert session("?participant=7") == session("?PROLIFIC_PID=7")
    orders = [session(f"?participant={number}&list=1")[2] for number in range(40)]
    assert len({json.dumps(order) for order in orders}) > 20
    firsts = {order[0][0] for order in orders}
    assert firsts == {content["items"][at]["cell"] for at in content["lists"][0]}
    asked = {tuple(q[1] for q in order) for order in orders}
    assert len(asked) > 4
    sides = [q[3] for order in orders for q in order if q[1] == "1.1"]
    assert 0.3 < sum(each[0] == "chest" for each in sides) / len(sides) < 0.7
    for order in orders:
        seen = {}
        for cell, question, was_seen, _ in order:
            view = (cell, question[0])
            assert was_seen == (view in seen)
            seen[view] = True
    assert [session(f"?participant={number}")[1] for number in range(1, 6)] == [1, 2, 1, 2, 1]
    assert session("?participant=x9&list=2")[1] == 2
    named = [session(f"?participant=person-{number}")[1] for number in range(60)]
    assert 15 < named.count(1) < 45
    drawn = session("")[0]
    assert drawn.startswith("drawn-")
    assert drawn != session("")[0]


def test_a_list_that_does_not_exist_is_told(browser, page):
    opened(browser, page, participant="47", list=3)
    assert browser.one("[role=alert]").text == (
        "There is no list 3: the address may name list 1 to 2."
    )


@contextmanager
def receiving(status):
    """Serve an address that keeps what is posted, from pages of any origin."""
    posted = SimpleQueue()

    class Handler(BaseHTTPRequestHandler):
        def do_OPTIONS(self):
            self.answer(204)

        def do_POST(self):
            posted.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.answer(status)

        def answer(self, code):
            self.send_response(code)
            self.send_header("Access-Control-Allow-Origin", "*")
            self.send_header("Access-Control-Allow-Headers", "Content-Type")
            self.end_headers()

        def log_message(self, *_):
            """Print nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/data", posted
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.parametrize(
    ("status", "told"), [(200, "have been sent"), (500, "could not be sent. Please save")]
)
def test_answers_are_sent_where_the_study_says(browser, tmp_path, status, told):
    with receiving(status) as (address, posted):
        study = bn.Study.load(transfer_in(tmp_path))
        study.participants(tmp_path / "page", "story", post=address)
        opened(browser, tmp_path, participant="7")
        browser.click(".bn-continue")
        play(browser, "chest", 6)
        browser.until_script("return document.getElementById('page').dataset.ended")
        assert told in browser.one("[role=status]").text
        ending = browser.one("h1").is_displayed()
        assert ending is (status == 200)
        batches = [posted.get(timeout=60) for _ in range(posted.qsize())]
        if status == 500:
            browser.script("document.querySelectorAll('.bn-controls button')[1].click()")
            assert browser.one("h1").is_displayed()
    # Each answer is sent as it is given; what a server refuses is sent again.
    assert len(batches) > 1
    assert len([row for batch in batches for row in batch] if status == 200 else batches[-1]) == 7
    folder = tmp_path / "sent"
    folder.mkdir()
    for number, batch in enumerate(batches if status == 200 else batches[-1:]):
        (folder / f"{number}.json").write_text(json.dumps(batch), encoding="utf-8")
    result, notes = study.read_participants(tmp_path / "out", [folder])
    assert (len(result.rows), notes) == (4, ())
    assert "Of 1 participant who began, 1 answered all questions" in result.methods()


def test_a_session_goes_on_after_a_reload_and_keeps_the_address(browser, tmp_path):
    with receiving(200) as (address, posted):
        study = bn.Study.load(transfer_in(tmp_path))
        study.participants(tmp_path / "page", "story", post=address)
        opened(browser, tmp_path, id="sona 5", session="b2", list=1)
        browser.click(".bn-continue")
        play(browser, "chest", 2)
        browser.driver.refresh()
        browser.until_script("return document.documentElement.dataset.ready")
        told = "You have answered 2 of 6 questions. Your answers are kept."
        assert told in browser.one(".bn-screen").text
        browser.click(".bn-continue")
        assert browser.script("return document.querySelector('progress').value") == 2
        play(browser, "chest", 3)
        rows = []
        while len(rows) < 6:
            rows += posted.get(timeout=60)
    assert [row.get("trial_index") for row in rows] == [None, 0, 1, 2, 3, 4]
    assert {row["participant"] for row in rows} == {"sona 5"}
    assert {json.dumps(row["address"]) for row in rows} == {'{"session": "b2"}'}
    assert len({row["started"] for row in rows}) == 1
    other = {**rows[0], "participant": "8", "address": {}}
    (tmp_path / "sent.json").write_text(json.dumps([*rows, other]), encoding="utf-8")
    result, notes = study.read_participants(tmp_path / "out", [tmp_path / "sent.json"])
    assert notes == (
        "participant sona 5 answered 5 of 6 questions",
        "1 participant began and gave no answer",
    )
    told = result.methods()
    assert "Of 2 participants who began, 0 answered all questions, 1 stopped in the middle" in told
    assert "Nothing was excluded" not in told


def test_the_plugin_keeps_the_conventions_of_jspsych(browser, page, tmp_path):
    stand_in = page / "page" / "jspsych"
    stand_in.mkdir()
    shutil.copyfile(STAND_IN, stand_in / "index.browser.min.js")
    (stand_in / "jspsych.css").write_text("", encoding="utf-8")
    browser.driver.get(f"{(page / 'page' / 'jspsych.html').as_uri()}?participant=9")
    play(browser, "<i>left</i> box", 6)
    saved = browser.until_script("return globalThis.saved")
    assert browser.script("return faults") == []
    assert (saved["form"], saved["name"]) == ("csv", "answers-9.csv")
    (tmp_path / "rows.json").write_text(json.dumps(saved["rows"]), encoding="utf-8")
    study = bn.Study.load(page / "study.yaml")
    result, notes = study.read_participants(tmp_path / "out", [tmp_path / "rows.json"])
    assert ({row["participant"] for row in result.rows}, notes) == ({"9"}, ())
    assert len(result.rows) == 4
