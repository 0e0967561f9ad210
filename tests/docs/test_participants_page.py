"""The page about participants: its scenario, study and code do as it says."""

import json
import re
import shutil
from pathlib import Path

import pytest
from tests.studies.sessions import play
from tests.studies.transfer import answers_of, content_of

import beliefnest as bn
from beliefnest_benchmarks.browser import Browser

pytestmark = pytest.mark.usefixtures("kept_worlds")

PAGE = (Path(__file__).parents[2] / "docs" / "participants.md").read_text(encoding="utf-8")
SCENARIO, STUDY = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
(TIMELINE,) = re.findall(r"```javascript\n(.*?)```", PAGE, re.DOTALL)
STAND_IN = Path(__file__).parents[1] / "studies" / "participants" / "jspsych_stand_in.js"
(EXAMPLE,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_from_the_scenario_to_a_table_of_people_and_models(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("transfer.yaml").write_text(SCENARIO, encoding="utf-8")
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    names: dict[str, object] = {"__name__": "example"}
    exec(compile(EXAMPLE, "example", "exec"), names)
    assert capsys.readouterr().out.splitlines() == re.findall(r"print\(.*\)  # (.*)", EXAMPLE)
    answers = list(answers_of(content_of(Path("page")), "17", 1, place="right box"))
    Path("answers").mkdir()
    Path("answers", "17.json").write_text(json.dumps(answers), encoding="utf-8")
    study = bn.Study.load("study.yaml")
    result, notes = study.read_participants("transfer-study", ["answers"])
    assert (notes, [row["ok"] for row in result.rows]) == ((), [True, True])
    study.run("transfer-study", jobs=1)
    both = bn.StudyResult.read("transfer-study").counted(["model"])
    assert {each["model"]: each["judged"] for each in both} == {"people": 2, "offline": 4}


# Stand-ins for the names that the block uses: jsPsych, and trials of another plugin around.
AROUND = """<!doctype html><meta charset="utf-8"><body>
<script src="jspsych.js"></script>
<script src="plugin-beliefnest-question.js"></script>
<script src="session.js"></script>
<script src="stimuli.js"></script>
<script>
class Note {{
  static info = {{ name: 'note', version: '1', parameters: {{}}, data: {{}} }}
  constructor (jsPsych) {{ this.jsPsych = jsPsych }}
  trial () {{ this.jsPsych.finishTrial({{}}) }}
}}
const [consent, debriefing] = [{{ type: Note }}, {{ type: Note }}]
const jsPsych = initJsPsych({{ on_finish: () => jsPsych.data.get().localSave('json', 'x.json') }})
;(async () => {{
{}
}})()
</script>
"""


def test_the_timeline_runs_between_trials_of_others(tmp_path: Path, browser: Browser) -> None:
    (tmp_path / "transfer.yaml").write_text(SCENARIO, encoding="utf-8")
    (tmp_path / "study.yaml").write_text(STUDY, encoding="utf-8")
    study = bn.Study.load(tmp_path / "study.yaml")
    page = study.participants(tmp_path / "page").folder
    shutil.copyfile(STAND_IN, page / "jspsych.js")
    (page / "own.html").write_text(AROUND.format(TIMELINE), encoding="utf-8")
    browser.driver.get(f"{(page / 'own.html').as_uri()}?participant=5")
    play(browser, "left box", 2)
    saved = browser.until_script("return globalThis.saved")
    assert browser.script("return faults") == []
    assert [row["trial_type"] for row in saved["rows"]] == [
        *("note", "beliefnest-question", "beliefnest-question", "note"),
    ]
    (tmp_path / "x.json").write_text(json.dumps(saved["rows"]), encoding="utf-8")
    result, _ = study.read_participants(tmp_path / "out", [tmp_path / "x.json"])
    assert {row["participant"]: row["answered"] for row in result.rows} == {"5": "left box"}


def test_every_column_of_the_data_is_told(tmp_path: Path) -> None:
    told = set(re.findall(r"`(\w+)`", PAGE.partition("## The data")[2].partition("## Read")[0]))
    web = Path(__file__).parents[2] / "src" / "beliefnest" / "studies" / "participants" / "web"
    plugin = (web / "plugin.js").read_text(encoding="utf-8")
    own = set(re.findall(r"^      (\w+): \{ type", plugin.partition("data: {")[2], re.MULTILINE))
    session = (web / "session.js").read_text(encoding="utf-8")
    (data,) = re.findall(r"data: \{ (.*?) \}", session)
    (properties,) = re.findall(r"const properties = \{ (.*?) \}", session)
    (address,) = re.findall(r"\? \{ (\w+): Object", session)
    own |= {part.partition(":")[0].strip() for part in f"{data}, {properties}".split(",")}
    own = own - {"...addressOf(query)"} | {address}
    assert own <= told
    assert len(own) > 12


def test_the_picture_is_small() -> None:
    picture = Path(__file__).parents[2] / "docs" / "img" / "participants.png"
    assert picture.stat().st_size < 200_000
