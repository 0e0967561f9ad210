"""Behaviour of all journals, in memory and in files."""

import gc
import sqlite3

import pytest

from beliefnest.errors import BranchError, InputError, TickError
from beliefnest.timeline.chunks import CHUNK_ENTRIES
from beliefnest.timeline.database import Database
from beliefnest.timeline.journal import EntryFilter, ForkPoint, TimelineInfo, TimelineKey, is_found
from beliefnest.world.frames import Frame

MAIN = TimelineKey((), "main")
PLAN = TimelineKey(("observer", "sally"), "plan")


def begin(journal, entries, step=7):
    """Put entries on the main timeline, `step` in each call."""
    journal.create(MAIN, None, 0)
    for at in range(0, len(entries), step):
        part = entries[at : at + step]
        journal.append(MAIN, part, part[-1].tick)


@pytest.mark.parametrize("step", [1, 7, CHUNK_ENTRIES, 1000])
@pytest.mark.parametrize("ticks", [1, CHUNK_ENTRIES, 3 * CHUNK_ENTRIES + 5])
def test_entries_come_back_as_they_were(journal, make_history, ticks, step):
    entries = make_history(ticks)
    begin(journal, entries, step)
    assert list(journal.entries(MAIN, 0, len(entries))) == entries
    assert journal.info(MAIN) == TimelineInfo(MAIN, None, 0, ticks, len(entries))


def test_any_range_of_entries(journal, make_history):
    entries = make_history(400)
    begin(journal, entries, 3)
    for start in range(0, len(entries), 37):
        for length in (0, 1, 30, 300):
            assert (
                list(journal.entries(MAIN, start, start + length))
                == (entries[start : start + length])
            )


def test_entries_appended_meanwhile_are_not_returned(journal, make_history):
    entries = make_history(20)
    begin(journal, entries)
    reading = journal.entries(MAIN, 0, 1000)
    first = next(reading)
    journal.append(MAIN, [Frame(21)], 21)
    assert [first, *reading] == entries


def test_reading_goes_on_while_pieces_are_joined(journal, make_history):
    entries = make_history(100)
    begin(journal, entries, 1)
    reading = journal.entries(MAIN, 0, len(entries))
    first = [next(reading), next(reading)]
    journal.append(MAIN, [Frame(tick) for tick in range(101, 500)], 500)
    assert [*first, *reading] == entries


@pytest.mark.parametrize("step", [1, 50, 1000])
def test_what_is_looked_for_is_found(journal, make_history, step):
    entries = make_history(3 * CHUNK_ENTRIES)
    begin(journal, entries, step)
    with_events = [n for n, e in enumerate(entries) if isinstance(e, Frame) and e.events]
    changing = [n for n, e in enumerate(entries) if e.blocks or e.containers]
    for start, stop in ((0, 10**6), (0, 0), (1, 2), (100, 130), (127, 128), (300, 10**6)):
        for what, numbers in ((EntryFilter.EVENTS, with_events), (EntryFilter.CHANGES, changing)):
            found = list(journal.filtered(MAIN, start, stop, what))
            assert found == [(n, entries[n]) for n in numbers if start <= n < stop]


@pytest.mark.parametrize("step", [1, 50, 1000])
def test_what_a_prefix_comes_to(journal, make_history, step):
    entries = make_history(3 * CHUNK_ENTRIES)
    begin(journal, entries, step)
    agents, events = {}, 0
    for number, entry in enumerate(entries):
        if number % 31 in (0, 1, 4):
            assert journal.agents_after(MAIN, number) == agents
            assert journal.events_until(MAIN, number) == events
        if isinstance(entry, Frame):
            agents |= entry.agents
            events += len(entry.events)
    assert journal.agents_after(MAIN, len(entries)) == agents
    assert journal.events_until(MAIN, len(entries)) == events


def test_an_undone_call_leaves_names_and_descriptions_as_they_were(journal, make_history):
    entries = make_history(10)
    begin(journal, entries[:4])
    journal.create(PLAN, ForkPoint(MAIN, 2, 2), 2)
    before = journal.timelines()
    with pytest.raises(ZeroDivisionError), journal.together():
        journal.describe(PLAN, "far away")
        with journal.together():
            journal.append(MAIN, entries[4:], entries[-1].tick)
            journal.rename(MAIN, "trunk")
        assert journal.info(PLAN).base.timeline.branch == "trunk"
        raise ZeroDivisionError
    assert journal.timelines() == before
    assert list(journal.entries(MAIN, 0, 100)) == entries[:4]
    assert [journal.has(TimelineKey((), name)) for name in ("main", "trunk")] == [True, False]


def test_what_is_undone_is_not_found(journal, make_history):
    entries = make_history(60)
    begin(journal, entries[:20])
    last = entries[-1].tick
    with pytest.raises(ZeroDivisionError), journal.together():
        journal.append(MAIN, entries[20:], last)
        journal.create(PLAN, ForkPoint(MAIN, 40, entries[39].tick), entries[39].tick)
        raise ZeroDivisionError
    later = [Frame(entry.tick) for entry in entries[20:25]]
    journal.append(MAIN, later, later[-1].tick)
    kept = TimelineKey((), "kept")
    journal.create(kept, None, 0)
    journal.append(kept, [*entries[:20], *later], later[-1].tick)
    for what in EntryFilter:
        assert list(journal.filtered(MAIN, 0, 25, what)) == list(
            journal.filtered(kept, 0, 25, what)
        )
    for number in range(26):
        assert journal.agents_after(MAIN, number) == journal.agents_after(kept, number)
        assert journal.events_until(MAIN, number) == journal.events_until(kept, number)


def test_entries_until_counts_ticks_included(journal, make_history):
    entries = make_history(300)
    begin(journal, entries, 5)
    for tick in range(-1, 305):
        assert journal.entries_until(MAIN, tick) == sum(e.tick <= tick for e in entries)


def test_entries_of_one_tick_are_counted_across_pieces(journal):
    journal.create(MAIN, None, 0)
    for _ in range(CHUNK_ENTRIES + 10):
        journal.append(MAIN, [Frame(4)], 4)
    journal.append(MAIN, [Frame(5)], 5)
    assert journal.entries_until(MAIN, 3) == 0
    assert journal.entries_until(MAIN, 4) == CHUNK_ENTRIES + 10
    assert journal.entries_until(MAIN, 5) == CHUNK_ENTRIES + 11


def test_quiet_ticks_move_the_head_alone(journal):
    journal.create(MAIN, None, 3)
    journal.append(MAIN, [], 9)
    assert journal.info(MAIN) == TimelineInfo(MAIN, None, 3, 9)


@pytest.mark.parametrize(
    ("ticks", "head"),
    [([4], 10), ([6, 5], 10), ([6], 5), ([11], 10), ([], 4)],
    ids=["before the head", "falling", "head before entry", "after the head", "head falls"],
)
def test_time_does_not_run_backwards(journal, ticks, head):
    journal.create(MAIN, None, 0)
    journal.append(MAIN, [Frame(5)], 5)
    with pytest.raises(TickError, match="main"):
        journal.append(MAIN, [Frame(tick) for tick in ticks], head)
    assert journal.info(MAIN) == TimelineInfo(MAIN, None, 0, 5, 1)


def test_timelines_are_listed_in_order_of_creation(journal):
    keys = [TimelineKey(("b",), "z"), TimelineKey((), "z"), TimelineKey(("b",), "a")]
    for key in keys:
        journal.create(key, None, 0)
    assert [info.key for info in journal.timelines()] == keys


def test_a_fork_knows_its_base(journal, make_history):
    begin(journal, make_history(30))
    base = ForkPoint(MAIN, 12, 11)
    journal.create(PLAN, base, 11)
    assert journal.info(PLAN) == TimelineInfo(PLAN, base, 11, 11)
    assert list(journal.entries(PLAN, 0, 10)) == []
    assert journal.entries_until(PLAN, 99) == 0


def test_a_fork_needs_a_base_of_that_length(journal, make_history):
    with pytest.raises(BranchError, match="no branch 'main'"):
        journal.create(PLAN, ForkPoint(MAIN, 0, 0), 0)
    begin(journal, make_history(5))
    too_far = journal.info(MAIN).entries + 1
    with pytest.raises(BranchError, match="cannot begin"):
        journal.create(PLAN, ForkPoint(MAIN, too_far, 5), 5)
    assert [info.key for info in journal.timelines()] == [MAIN]


def test_a_name_is_taken_once_for_each_path(journal):
    journal.create(MAIN, None, 0)
    with pytest.raises(BranchError, match="already has a branch 'main'"):
        journal.create(MAIN, None, 0)
    journal.create(TimelineKey(("sally",), "main"), None, 0)


def test_unknown_timelines_are_refused_with_those_there_are(journal):
    journal.create(TimelineKey((), "a"), None, 0)
    calls = [
        lambda: journal.info(MAIN),
        lambda: journal.append(MAIN, [], 1),
        lambda: journal.entries(MAIN, 0, 1),
        lambda: journal.entries_until(MAIN, 1),
        lambda: journal.rename(MAIN, "b"),
        lambda: journal.delete(MAIN),
        lambda: journal.describe(MAIN, "x"),
        lambda: journal.put_checkpoint(MAIN, "a", 0, b""),
        lambda: journal.nearest_checkpoint(MAIN, "a", 0),
    ]
    for call in calls:
        with pytest.raises(BranchError, match="no branch 'main'; it has 'a'"):
            call()


def test_renaming_takes_forks_along(journal, make_history):
    entries = make_history(10)
    begin(journal, entries)
    journal.create(PLAN, ForkPoint(MAIN, 2, 2), 2)
    journal.rename(MAIN, "trunk")
    trunk = TimelineKey((), "trunk")
    assert [info.key for info in journal.timelines()] == [trunk, PLAN]
    assert journal.info(PLAN).base == ForkPoint(trunk, 2, 2)
    assert list(journal.entries(trunk, 0, 100)) == entries
    journal.create(MAIN, None, 0)
    assert journal.info(MAIN).entries == 0


def test_renaming_to_a_taken_name_changes_nothing(journal):
    journal.create(MAIN, None, 0)
    journal.create(TimelineKey((), "b"), None, 0)
    for name in ("b", "main"):
        with pytest.raises(BranchError, match="already"):
            journal.rename(MAIN, name)
    assert [info.key.branch for info in journal.timelines()] == ["main", "b"]


def test_only_leaves_are_deleted(journal, make_history):
    begin(journal, make_history(10))
    journal.create(PLAN, ForkPoint(MAIN, 2, 2), 2)
    with pytest.raises(BranchError, match="/observer/sally 'plan'"):
        journal.delete(MAIN)
    journal.delete(PLAN)
    journal.delete(MAIN)
    assert list(journal.timelines()) == []


def test_a_deleted_name_begins_anew(journal, make_history):
    begin(journal, make_history(200))
    journal.describe(MAIN, "old")
    journal.delete(MAIN)
    journal.create(MAIN, None, 0)
    assert journal.info(MAIN) == TimelineInfo(MAIN, None, 0, 0)
    assert list(journal.entries(MAIN, 0, 500)) == []


def test_descriptions_are_kept(journal):
    journal.create(MAIN, None, 0)
    journal.describe(MAIN, "Sally goes left — 試し")
    assert journal.info(MAIN).description == "Sally goes left — 試し"


def test_the_nearest_checkpoint_lies_at_or_before(journal, make_history):
    begin(journal, make_history(30))
    assert journal.nearest_checkpoint(MAIN, "a", 30) is None
    for name, place in (("a", 0), ("a", 10), ("a", 20), ("b", 15)):
        journal.put_checkpoint(MAIN, name, place, f"{name}{place}".encode())
    journal.put_checkpoint(MAIN, "a", 20, b"new")
    assert journal.nearest_checkpoint(MAIN, "a", 9) == (0, b"a0")
    assert journal.nearest_checkpoint(MAIN, "a", 10) == (10, b"a10")
    assert journal.nearest_checkpoint(MAIN, "a", 19) == (10, b"a10")
    assert journal.nearest_checkpoint(MAIN, "a", 999) == (20, b"new")
    assert journal.nearest_checkpoint(MAIN, "b", 14) is None
    assert journal.nearest_checkpoint(MAIN, "b", 16) == (15, b"b15")
    for place in (-1, journal.info(MAIN).entries + 1):
        with pytest.raises(InputError, match="nothing can be stored after"):
            journal.put_checkpoint(MAIN, "a", place, b"")


def test_checkpoints_go_with_their_timeline(journal, make_history):
    begin(journal, make_history(30))
    journal.put_checkpoint(MAIN, "a", 10, b"x")
    journal.rename(MAIN, "trunk")
    trunk = TimelineKey((), "trunk")
    assert journal.nearest_checkpoint(trunk, "a", 10) == (10, b"x")
    journal.delete(trunk)
    journal.create(trunk, None, 0)
    assert journal.nearest_checkpoint(trunk, "a", 10) is None


@pytest.mark.parametrize("step", [1, 100, 2000])
def test_a_long_record_is_read_as_it_was_written(journal, make_history, step):
    entries = make_history(1500)
    begin(journal, entries, step)
    for start, stop in ((0, 10**6), (100, 140), (600, 1000), (len(entries) - 3, len(entries))):
        assert list(journal.entries(MAIN, start, stop)) == entries[start:stop]
        for what in EntryFilter:
            found = list(journal.filtered(MAIN, start, stop, what))
            assert found == [
                (n, e) for n, e in enumerate(entries) if start <= n < stop and is_found(e, what)
            ]
    for number in (0, 1, 128, 639, 641, 900, 1279, 1281, len(entries)):
        part = [entry for entry in entries[:number] if isinstance(entry, Frame)]
        assert journal.events_until(MAIN, number) == sum(len(each.events) for each in part)
        agents = {name: state for each in part for name, state in each.agents.items()}
        assert journal.agents_after(MAIN, number) == agents
    for tick in range(0, 1502, 50):
        assert journal.entries_until(MAIN, tick) == sum(e.tick <= tick for e in entries)


@pytest.mark.parametrize("known", [10, 700, 2000])
def test_a_long_call_that_is_undone_leaves_the_record_as_it_was(journal, make_history, known):
    entries = make_history(4000)
    begin(journal, entries[:known], 50)
    journal.put_checkpoint(MAIN, "a", 5, b"old")
    before = journal.info(MAIN)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError), journal.together():
            for at in range(known, len(entries), 99):
                part = entries[at : at + 99]
                with journal.together():
                    journal.append(MAIN, part, part[-1].tick)
                journal.put_checkpoint(MAIN, "a", at, b"undone")
            journal.put_body_state(MAIN, known, before.head, b"undone")
            raise ZeroDivisionError
        assert journal.info(MAIN) == before
        assert list(journal.entries(MAIN, 0, 10**6)) == entries[:known]
        assert journal.nearest_checkpoint(MAIN, "a", known) == (5, b"old")
        assert journal.body_state(MAIN, known, before.head) is None
    journal.append(MAIN, entries[known:], entries[-1].tick)
    assert list(journal.entries(MAIN, 0, 10**6)) == entries


def test_a_long_record_that_is_deleted_while_it_is_read_ends_with_an_error(journal, make_history):
    entries = make_history(2000)
    begin(journal, entries, 100)
    reading = journal.entries(MAIN, 0, len(entries))
    assert next(reading) == entries[0]
    journal.delete(MAIN)
    with pytest.raises(BranchError, match="no branch 'main'"):
        list(reading)
    journal.create(MAIN, None, 0)
    assert list(journal.entries(MAIN, 0, 10)) == []


def test_a_journal_without_a_file_that_nobody_closes_ends_with_its_object():
    database = Database.temporary(["CREATE TABLE a (b)"])
    connection = database._connection
    del database
    gc.collect()
    with pytest.raises(sqlite3.ProgrammingError, match="closed"):
        connection.execute("SELECT * FROM a")
