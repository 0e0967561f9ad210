"""The page of a study for people, as files: complete, without right answers, the same again."""

import json

import pytest
from tests.studies.transfer import STUDY, TRANSFER, content_of, transfer_in

import beliefnest as bn
from beliefnest.studies.participants.running import read_instructions

pytestmark = pytest.mark.usefixtures("kept_worlds")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Folder with a study, and what its page contains."""
    folder = tmp_path_factory.mktemp("written")
    page = bn.Study.load(transfer_in(folder)).participants(folder / "page")
    return folder, page, content_of(folder / "page")


def test_items_are_the_cells_without_models_in_the_lists_of_the_design(written):
    _, page, content = written
    assert (page.items, page.questions, page.lists) == (4, 12, (2, 2))
    for numbers in content["lists"]:
        items = [content["items"][number] for number in numbers]
        assert {item["condition"] for item in items} == {1, 2}
        assert len({item["variation"] for item in items}) == 2
    assert len({item["cell"] for item in content["items"]}) == 4
    assert page.notes == (
        "transfer: probe 'act' is left out: it asks for a program, which people do not write",
    )


@pytest.mark.parametrize(
    ("field", "told", "not_told"),
    [("", "all around them", "only what lies"), (", field_of_view: 170", "only what lies", "all")],
)
def test_default_instructions_say_how_people_see_and_whose_view_it_is(
    tmp_path, field, told, not_told
):
    study = transfer_in(tmp_path, STUDY)
    scenario = tmp_path / "transfer.yaml"
    text = scenario.read_text(encoding="utf-8")
    assert "max_visible_distance: 20" in text
    scenario.write_text(
        text.replace("max_visible_distance: 20", f"max_visible_distance: 20{field}"),
        encoding="utf-8",
    )
    bn.Study.load(study).participants(tmp_path / "page", "story")
    words = [block["text"] for block in content_of(tmp_path / "page")["pages"][0]]
    sight = next(each for each in words if each.startswith("People see"))
    assert told in sight
    assert not_told not in sight
    assert any(each.startswith("Sometimes you are told") for each in words)


def test_more_models_templates_and_repeats_give_the_same_items(written, tmp_path):
    _, _, content = written
    more = STUDY.replace("[offline]", "[offline, 'vllm:m']") + "repeats: 3\n"
    bn.Study.load(transfer_in(tmp_path, more)).participants(tmp_path / "page")
    again = content_of(tmp_path / "page")
    assert sorted(item["cell"] for item in again["items"]) == sorted(
        item["cell"] for item in content["items"]
    )


def test_the_film_shows_what_the_asked_mind_perceived(written):
    _, _, content = written
    item = next(each for each in content["items"] if each["condition"] == 1)
    views = {view["owner"]: view for view in item["views"]}
    assert views.keys() == {None, "Sally"}
    captions = {owner: [frame[2] for frame in views[owner]["film"]["frames"]] for owner in views}
    assert any("Anne opened the chest" in each for each in captions[None])
    assert not any("Anne opened" in each for each in captions["Sally"])
    assert captions["Sally"][0].startswith("At first you could see Anne")
    item = "diamond" if "diamond" in captions[None][0] else "apple"
    last = views[None]["film"]["pictures"][views[None]["film"]["frames"][-1][0]]
    assert f"chest: {item}" in last
    assert "left box: empty" in last
    # Sally sees the item when she puts it in. What she remembers is no part of the film.
    film = views["Sally"]["film"]
    shows = {
        caption: f"left box: {item}" in film["pictures"][picture]
        for picture, _, caption in reversed(film["frames"])
    }
    assert [words for words, shown in shows.items() if shown] == [
        words for words in captions["Sally"] if words.startswith("You put")
    ][:1]
    last = film["pictures"][film["frames"][-1][0]]
    assert ">Sally<" in last
    assert ">Anne<" not in last
    assert not any(f"chest: {item}" in picture for picture in film["pictures"])


def test_pictures_have_one_size_and_neither_paths_nor_ticks_nor_positions(written):
    _, _, content = written
    for item in content["items"]:
        for view in item["views"]:
            pictures = view["film"]["pictures"]
            assert len({each.partition("viewBox=")[2][:30] for each in pictures}) == 1
            for picture in pictures:
                texts = [part.partition("<")[0] for part in picture.split(">")]
                told = " ".join(text for text in texts if text)
                assert "tick" not in told
                assert "/" not in told
                assert "(" not in told
                assert "Sally" in told


def test_no_right_answer_is_in_the_folder(written):
    folder, _, content = written
    told = json.dumps([item["views"] for item in content["items"]])
    for word in ("believed", 'right"', "expect", "correct"):
        assert word not in told
    for item in content["items"]:
        for view in item["views"]:
            for asked in view["questions"]:
                assert asked.keys() == {"id", "text", "options", "reason"}
                assert asked["options"] == sorted(asked["options"])
    # The order in the scenario, which may begin with the right answer, is not told.
    assert not any(
        "left box, chest" in file.read_text("utf-8") for file in (folder / "page").iterdir()
    )


def test_the_same_study_gives_the_same_bytes_and_another_seed_another_page(written, tmp_path):
    folder, _, content = written
    again = bn.Study.load(folder / "study.yaml").participants(tmp_path / "again").folder
    for file in (folder / "page").iterdir():
        assert (again / file.name).read_bytes() == file.read_bytes()
    seeded = bn.Study.load(transfer_in(tmp_path, f"{STUDY}seed: 7\n"))
    seeded.participants(tmp_path / "seeded")
    assert content_of(tmp_path / "seeded")["study"] != content["study"]


@pytest.mark.parametrize(("show", "film", "story"), [("film", True, False), ("story", False, True)])
def test_a_page_may_show_the_film_or_the_story_alone(written, tmp_path, show, film, story):
    folder, _, _ = written
    bn.Study.load(folder / "study.yaml").participants(tmp_path / "page", show)
    content = content_of(tmp_path / "page")
    views = [view for item in content["items"] for view in item["views"]]
    assert {view["film"] is not None for view in views} == {film}
    assert {bool(view["story"]) for view in views} == {story}


def test_a_story_is_the_one_that_models_read(written):
    _, _, content = written
    item = content["items"][0]
    assert item["condition"] == 1
    asked = bn.Study.load(written[0] / "study.yaml").plan().cells[0].scenario
    with bn.Nest.open(asked, world="scripted") as nest:
        nest.play()
        prompt = nest["/sally"].render(bn.prompts.built_in_template("story"))
    (view,) = (view for view in item["views"] if view["owner"] == "Sally")
    assert "\n\n".join(view["story"]) in prompt


def test_a_study_without_questions_is_refused_with_file_and_line(tmp_path):
    start = TRANSFER.index("  - label: belief")
    text = TRANSFER[:start] + TRANSFER[TRANSFER.index("  - label: act") :]
    study = bn.Study.load(transfer_in(tmp_path, scenario=text))
    with pytest.raises(bn.ScenarioError, match=r"transfer\.yaml:\d+: probes: no probe asks"):
        study.participants(tmp_path / "page")
    assert not (tmp_path / "page").exists()


def test_wrong_arguments_are_named_before_anything_is_played(tmp_path):
    study = bn.Study.load(transfer_in(tmp_path))
    with pytest.raises(bn.InputError, match="film, story, both"):
        study.participants(tmp_path / "page", "book")
    with pytest.raises(bn.InputError, match=r"--post is 'lab\.example'"):
        study.participants(tmp_path / "page", post="lab.example")
    with pytest.raises(bn.InputError, match=r"study\.yaml is a file"):
        study.participants(tmp_path / "study.yaml")
    with pytest.raises(bn.InputError, match="is not empty"):
        study.participants(tmp_path)
    with pytest.raises(bn.InputError, match=r"none\.md cannot be read"):
        study.participants(tmp_path / "page", instructions=tmp_path / "none.md")
    claims = bn.Study.load(transfer_in(tmp_path), claims_from="offline")
    with pytest.raises(bn.InputError, match="claims_from"):
        claims.participants(tmp_path / "page")
    episodes = bn.Study(tasks="help-find", policies="random")
    with pytest.raises(bn.InputError, match="plays episodes"):
        episodes.participants(tmp_path / "page")


def test_instructions_have_pages_headings_paragraphs_and_lists(tmp_path):
    file = tmp_path / "text.md"
    file.write_text(
        "# Consent\n\nYou may stop\nat any time.\n\n- one\n- two\n  three\n"
        "---\n\n---\nGo <b>on</b>.\n",
        encoding="utf-8",
    )
    assert read_instructions(file) == [
        [
            {"kind": "heading", "text": "Consent"},
            {"kind": "paragraph", "text": "You may stop at any time."},
            {"kind": "list", "items": ["one", "two three"]},
        ],
        [{"kind": "paragraph", "text": "Go <b>on</b>."}],
    ]
    file.write_text("---\n\n", encoding="utf-8")
    with pytest.raises(bn.InputError, match=r"text\.md has no text"):
        read_instructions(file)
