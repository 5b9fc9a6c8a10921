"""Documents on the desk: changed by several pages, undone, saved with their comments."""

from __future__ import annotations

import json
from importlib.resources import files

import pytest
from served import CallFailedError

from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.scenario_file import load_scenario
from radmpc.io.text.yaml_text import read_yaml
from radmpc.model.scenario import Scenario
from radmpc.serving.documents.content import changed
from radmpc.serving.documents.text import Original, text_of

HARBOR = files("radmpc.data").joinpath("harbor.yaml").read_text(encoding="utf-8")


@pytest.fixture
def harbor(site):
    (site.folder / "harbor.yaml").write_text(HARBOR, encoding="utf-8")
    page = site.page()
    return page, page.call("open", path="harbor.yaml")


def move(page, state, value, path=("vehicles", 0, "start", 0)):
    return page.call(
        "change",
        document=state["document"],
        revision=state["revision"],
        changes=[{"path": list(path), "value": value}],
        label="move",
    )


def test_a_change_is_understood_undone_and_done_again(harbor):
    page, first = harbor
    second = move(page, first, 3.25)
    assert second["revision"] == first["revision"] + 1
    assert second["content"]["vehicles"][0]["start"][0] == 3.25
    assert second["view"]["vehicles"][0]["start"][0] == 3.25
    assert (second["canUndo"], second["canRedo"], second["isSaved"]) == (True, False, False)
    third = page.call("undo", document=first["document"], revision=second["revision"])
    assert third["content"] == first["content"]
    assert (third["canUndo"], third["canRedo"], third["isSaved"]) == (False, True, True)
    fourth = page.call("redo", document=first["document"], revision=third["revision"])
    assert fourth["content"] == second["content"]
    with pytest.raises(CallFailedError, match="nothing to redo"):
        page.call("redo", document=first["document"], revision=fourth["revision"])


def test_two_pages_see_each_other_and_the_later_of_two_changes_is_stale(site, harbor):
    one, state = harbor
    two = site.page()
    assert two.call("hello")["document"] == state["document"]
    move(one, state, 3.0)
    told = two.event("document")["state"]
    assert told["content"]["vehicles"][0]["start"][0] == 3.0
    with pytest.raises(CallFailedError, match="changed elsewhere") as caught:
        move(two, state, 4.0)
    assert caught.value.kind == "stale"
    assert move(two, told, 4.0)["content"]["vehicles"][0]["start"][0] == 4.0


def test_a_page_that_comes_back_finds_everything(site, harbor):
    page, state = harbor
    changed_state = move(page, state, 3.0)
    page.socket.close()
    again = site.page()
    document = again.call("hello")["document"]
    assert again.call("state", document=document) == changed_state


def test_what_is_wrong_is_told_at_its_place_while_the_last_view_stays(harbor):
    page, state = harbor
    wrong = move(page, state, -1.0, ("vehicles", 1, "radius"))
    (remark,) = wrong["remarks"]
    assert remark["severity"] == "error"
    assert remark["path"] == ["vehicles", 1, "radius"]
    assert remark["vehicles"] == ["barge"]
    assert remark["at"] == [22.2, 8.0]
    assert wrong["view"] == state["view"]
    with pytest.raises(CallFailedError, match="radius") as caught:
        page.call(
            "plan", document=state["document"], planner="certified", seconds=5, gap=None,
            riskBound=None,
        )  # fmt: skip
    assert caught.value.path == ["vehicles", 1, "radius"]


def test_paths_of_a_view_lead_to_what_it_shows_when_entries_go_while_something_is_wrong(harbor):
    page, state = harbor
    names = [vehicle["name"] for vehicle in state["content"]["vehicles"]]
    state = move(page, state, "x", ("vehicles", 0, "start"))
    state = page.call(
        "change",
        document=state["document"],
        revision=state["revision"],
        changes=[{"path": ["vehicles", 1]}],
        label="remove",
    )
    told = {vehicle["name"]: vehicle["path"] for vehicle in state["view"]["vehicles"]}
    assert told == {name: ["vehicles", i] for i, name in enumerate(names[2:], 1)}
    state = page.call("undo", document=state["document"], revision=state["revision"])
    told = {vehicle["name"]: vehicle["path"] for vehicle in state["view"]["vehicles"]}
    assert told == {name: ["vehicles", i] for i, name in enumerate(names[1:], 1)}


def test_drawing_begins_from_nothing(site):
    page = site.page()
    state = page.call("new", template=None)
    assert state["view"]["vehicles"] == []
    assert [remark["path"] for remark in state["remarks"]] == [["vehicles"]]
    state = move(page, state, {"name": "rock", "min": [5, 5], "max": [8, 9]}, ("obstacles", 0))
    assert [obstacle["name"] for obstacle in state["view"]["obstacles"]] == ["rock"]
    vehicle = {"name": "tug", "start": [1, 1], "goal": {"center": [30, 20], "half_width": 1}}
    state = move(page, state, vehicle, ("vehicles", 0))
    assert state["remarks"] == []
    assert [one["name"] for one in state["view"]["vehicles"]] == ["tug"]


def test_a_broken_file_shows_what_can_be_drawn_of_it(site):
    broken = HARBOR.replace("start: [22.2, 8.0]", "start: [22.2]")
    (site.folder / "broken.yaml").write_text(broken, encoding="utf-8")
    state = site.page().call("open", path="broken.yaml")
    names = [vehicle["name"] for vehicle in state["view"]["vehicles"]]
    assert names == ["tug", "ferry", "pilot", "survey"]
    assert state["view"]["vehicles"][1]["startHandle"]["x"] == [["vehicles", 2, "start", 0]]
    assert state["remarks"][0]["path"][:2] == ["vehicles", 1]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ('name: "\\ud83d"', "name: must be text that UTF-8 can encode"),
        ('"\\ud83d": 1', "keys must be text that UTF-8 can encode"),
        ("dt: .nan", "dt: must be a finite number, got nan"),
    ],
)
def test_a_file_that_no_page_can_be_told_is_refused_at_its_line(site, line, reason):
    (site.folder / "half.yaml").write_text(f"format: radmpc/scenario/1\n{line}\n", "utf-8")
    page = site.page()
    with pytest.raises(CallFailedError, match=f"half.yaml:[12]: {reason}"):
        page.call("open", path="half.yaml")
    assert site.page().call("hello")["documents"] == []


@pytest.mark.parametrize(
    ("path", "value"), [(["name"], "\ud83d"), (["\ud83d"], 1), (["source"], {"\ud83d": 1})]
)
def test_half_a_character_is_no_change(harbor, path, value):
    page, state = harbor
    with pytest.raises(CallFailedError, match="text that UTF-8 can encode"):
        page.call(
            "change", document=state["document"], revision=state["revision"],
            changes=[{"path": path, "value": value}],
        )  # fmt: skip
    assert page.call("state", document=state["document"])["revision"] == state["revision"]


def test_saving_keeps_comments_and_reads_back_equal(site, harbor):
    page, state = harbor
    state = move(page, state, 2.5)
    state = move(page, state, 20, ("horizon",))
    saved = page.call("save", document=state["document"], path="harbor.yaml", overwrite=False)
    assert saved["isSaved"]
    text = (site.folder / "harbor.yaml").read_text(encoding="utf-8")
    changed_lines = [
        (a, b) for a, b in zip(HARBOR.splitlines(), text.splitlines(), strict=True) if a != b
    ]
    assert [b.strip()[:33] for _, b in changed_lines] == [
        "horizon: 20             # steps",
        "- {name: tug, start: [2.5, 5.5], ",
    ]
    assert isinstance(load_scenario(site.folder / "harbor.yaml"), Scenario)
    (site.folder / "other.yaml").write_text("{}", encoding="utf-8")
    with pytest.raises(CallFailedError, match="it is there already"):
        page.call("save", document=state["document"], path="other.yaml", overwrite=False)


def test_a_file_that_somebody_else_has_changed_is_not_replaced_in_silence(site, harbor):
    page, state = harbor
    state = move(page, state, 2.5)
    theirs = HARBOR.replace("dt: 1.0", "dt: 2.0")
    (site.folder / "harbor.yaml").write_text(theirs, encoding="utf-8")
    where = {"document": state["document"], "path": "harbor.yaml"}
    with pytest.raises(CallFailedError, match="has changed since it was read"):
        page.call("save", **where, overwrite=False)
    assert (site.folder / "harbor.yaml").read_text(encoding="utf-8") == theirs
    assert page.call("save", **where, overwrite=True)["isSaved"]
    assert page.call("save", **where, overwrite=False)["isSaved"]


@pytest.mark.parametrize("kind", ["boats", "drones", "warehouse"])
def test_a_template_that_is_changed_everywhere_keeps_its_comments(kind):
    path = files("radmpc.data").joinpath("templates", f"{kind}.yaml")
    text = path.read_text(encoding="utf-8")
    content, _ = read_yaml(text, kind)
    changes = [
        {"path": ["risk_bound"], "value": 0.031},
        {"path": ["obstacles", 0]},
        {"path": ["vehicles", 0, "cost_weight"], "value": 2.0},
        {"path": ["vehicles", len(content["vehicles"])], "value": {
            **content["vehicles"][0], "name": "another"}},
    ]  # fmt: skip
    after = changed(content, changes)
    written = text_of(after, ".yaml", Original(text))
    assert read_yaml(written, kind)[0] == after
    comments = [line.split("#", 1)[1] for line in text.splitlines() if "#" in line]
    kept = sum(comment in written for comment in comments)
    assert kept >= len(comments) - 3
    assert json.loads(text_of(after, ".json", Original(text))) == after


def test_an_alias_is_written_out_where_its_two_places_differ():
    text = "a: &one [1, 2]\nb: *one\n"
    after = {"a": [1, 2], "b": [1, 3]}
    assert read_yaml(text_of(after, ".yaml", Original(text)), "text")[0] == after


@pytest.mark.parametrize(
    "path", [[], ["vehicles", 99, "start"], ["name", "x"], ["vehicles", "tug"], [True], [1.5], "x"]
)
def test_a_change_that_leads_nowhere_changes_nothing(harbor, path):
    page, state = harbor
    with pytest.raises(CallFailedError) as caught:
        page.call(
            "change", document=state["document"], revision=0,
            changes=[{"path": path, "value": 1}], label="",
        )  # fmt: skip
    assert caught.value.kind == "refused"
    assert page.call("state", document=state["document"]) == state


def test_entries_are_added_and_taken_away():
    content = {"a": [1, 2, 3]}
    assert changed(content, [{"path": ["a", 1]}]) == {"a": [1, 3]}
    assert changed(content, [{"path": ["a", 3], "value": 4}]) == {"a": [1, 2, 3, 4]}
    assert changed(content, [{"path": ["b", "c"], "value": 1}]) == {"a": [1, 2, 3], "b": {"c": 1}}
    assert content == {"a": [1, 2, 3]}


def test_a_file_dropped_on_the_page_is_opened_or_added(site, harbor):
    page, state = harbor
    dropped = page.call("drop", name="C:\\x\\other.yaml", content=HARBOR, into=None)
    assert dropped["file"] is None
    assert decode_scenario(dropped["content"]).name == "harbor"
    both = page.call("drop", name="other.yaml", content=HARBOR, into=state["document"])
    names = [obstacle["name"] for obstacle in both["content"]["obstacles"]]
    assert names == ["breakwater", "islet", "pier", "breakwater 2", "islet 2", "pier 2"]
    assert len(both["view"]["obstacles"]) == 6


@pytest.mark.parametrize("obstacles", ["[a, b]", "{name: a}", "3", "[null]"])
def test_dropped_obstacles_that_are_none_are_refused_and_nothing_changes(site, harbor, obstacles):
    page, state = harbor
    content = f"format: radmpc/scenario/1\nobstacles: {obstacles}"
    with pytest.raises(CallFailedError, match=r"o\.yaml: obstacles must be a list of mappings"):
        page.call("drop", name="o.yaml", content=content, into=state["document"])
    assert page.call("state", document=state["document"])["revision"] == state["revision"]


def test_saving_keeps_the_ends_of_lines_that_a_file_has():
    text = HARBOR.replace("\n", "\r\n")
    content, _ = read_yaml(text, "harbor")
    after = changed(content, [{"path": ["risk_bound"], "value": 0.031}])
    saved = text_of(after, ".yaml", Original(text))
    assert read_yaml(saved, "harbor")[0] == after
    assert saved.count("\n") == saved.count("\r\n") == text.count("\r\n")
