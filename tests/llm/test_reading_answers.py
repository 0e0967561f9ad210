# ruff: noqa: RUF001, E501 - models write these letters and lines
"""Answers in the forms in which models write them."""

import itertools
import json
import re
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from beliefnest.llm import Message, Sampling, read_answer, resolve_model
from beliefnest.llm.reading_answers import named_in_words, read_words
from beliefnest.llm.thinking import separate_thinking

OPTIONS = ("red box", "blue box", "he does not know")
"""Options; the right one is the red box."""

RIGHT = (
    "Answer: “red box”",
    "Answer：A",
    "Answer:\xa0red\xa0box",
    "Answer:\r\nA\r\n",
    "ANSWER - red box",
    "answer is: A",
    "So my answer: **A**",
    "**Answer:** A",
    "**Answer**: red box",
    "__Answer__: _red box_",
    "*Answer: red box*",
    "Answer: 'A'",
    'Answer: "A"',
    "Answer: [A]",
    "Answer: <A>",
    "Answer — A",
    "Answer = A",
    "Answer -> A",
    "Answer → A",
    "=> A",
    "A",
    "A.",
    "(A)",
    "[A]",
    "**A**",
    "a",
    "a)",
    "A)",
    "A:",
    "`A`",
    "$\\boxed{A}$",
    "\\boxed{\\text{red box}}",
    "The answer is $\\boxed{\\text{A}}$.",
    "\\boxed{A) red box}",
    "\\[\\boxed{\\text{(A) red box}}\\]",
    "$$\\boxed{\\mathrm{A}}$$",
    "(A) the red box",
    "A: red box",
    "A - red box",
    "A, red box",
    "A red box",
    "A. The red box.",
    "the red box.",
    "Red box",
    "RED BOX",
    "Red Box!",
    "In the red box.",
    "in a red box",
    "It's in the red box, not the blue one",
    "It is in the red box.",
    "It’s in the red box, not the blue one.",
    "He will look in the red box.",
    "He'll look in the red box",
    "He would look in the red box because he left before it was moved to the blue box.",
    "Option A",
    "Option A.",
    "option (A)",
    "Choice A: red box",
    "Answer: Option A: red box",
    "Answer: option A",
    "The correct option is A.",
    "The correct answer is (A) red box.",
    "The answer is: **A) red box**",
    "The answer is A.",
    "the answer is a",
    '{"answer": "red box"}',
    '{"answer": "(A)"}',
    '```json\n{"answer": "A"}\n```',
    '```json\n{\n  "reasoning": "He left. It was moved to the blue box.",\n  "answer": "red box"\n}\n```',
    '{"result": {"answer": "A"}}',
    '{"answer": {"option": "A", "text": "red box"}}',
    "{'answer': 'A'}",
    '{"final_answer": "A"}',
    '{"Answer": "A"}',
    "{answer: A}",
    '{"answer": ["A"]}',
    '{"answer": "A", "confidence": 0.9}',
    '{"choice": "A", "explanation": "The blue box is wrong"}',
    "```\nA\n```",
    "```\nred box\n```",
    "```text\nAnswer: A\n```",
    "<answer>A</answer>",
    "<answer>red box</answer>",
    "<Answer>\nA\n</Answer>",
    "<answer>A",
    "<final_answer>red box</final_answer>",
    "<reasoning>blue box?</reasoning>\n<answer>A</answer>",
    "<response><thinking>the blue box</thinking><answer>A</answer></response>",
    "Answer: red box</s>",
    "Answer: A<|eot_id|>",
    "<|im_start|>assistant\nAnswer: A<|im_end|>",
    "[INST] Where? A) red box B) blue box [/INST] Answer: A",
    "Answer: A<|im_end|>\n<|im_start|>user\nNext?\nAnswer: B",
    "<s>Answer: A</s>",
    "Answer: A<end_of_turn>",
    "<think>The blue box? Answer: B</think>Answer: A",
    "<think>\nB\n</think>\n\nA",
    "<thinking>Answer: B</thinking>\nAnswer: red box",
    "[THINK]Answer: B[/THINK]Answer: A",
    "Answer: B is what I'd say first\n</think>\nAnswer: A",
    "<|channel|>analysis<|message|>Answer: B<|end|><|start|>assistant<|channel|>final<|message|>Answer: A<|return|>",
    "<|channel|>analysis<|message|>hmm<|end|><|start|>assistant<|channel|>final<|message|>red box",
    "analysisWe need to pick B?assistantfinalAnswer: A",
    "<THINK>B</THINK>A",
    "Answer: B\nWait, he left before.\nAnswer: A",
    "Answer: blue box\n\nNo, wait. He did not see it.\n\nFinal Answer: red box",
    "Answer: B. No, wait, A.",
    "Answer: blue box. Correction: red box.",
    "I think it's the red box.",
    "I'd say the red box.",
    "I would choose A.",
    "I choose red box",
    "My answer is the red box.",
    "I'll go with A",
    "Let me think. Anne moved it to the blue box. Max was out. So he will look in the red box.",
    "Since he left before it was moved to the blue box, he will look in the red box.",
    "He did not see the move to the blue box, so he will look in the red box.",
    "Therefore, he will look in the **red box**.",
    "Anne moved it from the red box to the blue box, but he was away. Therefore the answer is red box.",
    "A is the correct answer.",
    "A is correct.",
    "Option A is right.",
    "The red box is the answer.",
    "red box (A)",
    "red box [A]",
    "the red box (option A)",
    "Answer: red box (Option A)",
    "Answer: **A** — red box",
    "Answer: **(A) red box**.",
    "Answer: A\n\nReason: The ball is really in the blue box, but he does not know that.",
    "Answer: A\nReason: The answer is not B, because he left.",
    "Answer: red box\nExplanation: Actually it is in the blue box.",
    "Reason: he left before it was moved to the blue box.\nAnswer: A",
    "Answer: red box. He did not see that it was moved to the blue box.",
    "Answer: A. He doesn't know it is in the blue box.",
    "Answer: A (he left before it was moved to the blue box)",
    "Answer: red box, not blue box",
    "Answer: not the blue box but the red box",
    "Answer: the red one",
    "Answer: red",
    "red",
    "The red one.",
    "Answer: red boxes",
    "Answer: Red-box",
    "Answer: red_box",
    "# Answer\n\nred box",
    "### Final Answer\nA",
    "**Final Answer**\n\nA) red box",
    "**Final Answer:**\n\n**red box**",
    "Final answer - A",
    "FINAL ANSWER: A",
    "final answer: red box.",
    "> Answer: A",
    "- Answer: A",
    "1. Answer: A",
    "• red box",
    "- red box",
    "Answer to the question: A",
    "The answer to the question is A.",
    "Answer (final): A",
    "Ans: A",
    "Response: red box",
    "Conclusion: red box",
    "Prediction: A",
    "Choice: A",
    "Selected option: A",
    "Correct answer: A",
    "Answer: A) red box\nB) is wrong because he left",
    "Sure! Answer: A",
    "Sure! The answer is A.",
    "Okay, here is my answer: A",
    "Answer A",
    "Q: Where will he look?\nA: red box",
    "Question: Where will he look?\nOptions:\nA) red box\nB) blue box\nC) he does not know\n\nAnswer: A",
    "Answer: A\n\nQuestion: Where will Anne look?\nOptions:\nA) x\nB) y\nAnswer: B",
    "A) red box\nB) blue box\nC) he does not know\n\nAnswer: A",
    "[x] red box\n[ ] blue box",
    "- [x] A\n- [ ] B\n- [ ] C",
    "~~blue box~~ red box",
    "<b>Answer:</b> A",
    "<p>Answer: <strong>red box</strong></p>",
    "Answer: <b>A</b>",
    "Answer: A<br>",
    "Answer: rather than the blue box, the red box",
    "Answer: the red box rather than the blue box",
    "Answer: the red box instead of the blue box",
    "Answer: red box; definitely not blue box",
    "B is wrong, so A.",
    "B is incorrect. The answer is A.",
    "The final answer is \\(\\boxed{A}\\)",
    "Final answer: \\(A\\)",
    "Answer: $\\text{red box}$",
    "Answer: \\textbf{A}",
    "Answer: “A”.",
    "Answer: ‘red box’",
    "Answer:A",
    "Answer :A",
    "Answer : A",
    "answer:red box",
    "Answer: Ａ",
    "Answer: A ✅",
    "✅ red box",
    "👉 A",
    "The answer is\n\nA",
    "The answer is:\n\n**red box**",
    "Answer:\n\n```\nred box\n```",
    "Answer:\n- red box",
    "red box, I think",
    "Probably the red box.",
    "Most likely red box",
    "Definitely A",
    "It must be A",
    "He thinks it is in the red box.",
    "He believes that it's still in the red box",
    "Max will open the red box first.",
    "In Sally's red box",
    "Answer: A\n\nLet me know if you have any other questions!",
    "Answer: A\n\nI hope this helps.",
    "Answer: A\n\n(B would be right if he had seen it.)",
    "Answer: A, since B would need him to see it",
    "Answer: A because B is where it is now",
    "A\n\nB is where it is now, but he didn't see that.",
    "Red box. Blue box is wrong.",
    "The red box, as he did not see Anne put it into the blue box.",
    "The red box — he never saw the blue box being used.",
    "red box: he put it there",
    "Not the blue one; the red one.",
    "not the blue box, but the red box",
    "He will not look in the blue box, he will look in the red box.",
    "Answer: A\nAnswer: A\nAnswer: A",
    "Answer: he looks where he left it, in the red box",
    "Answer: *A*",
    "Answer: ***red box***",
    "**A.** red box",
    "A\\. red box",
    "Answer: A\\)",
    "(A",
    "A) ",
    "Answer is (A)",
    "answer: option a",
    "Answer: letter A",
    "the first option, red box",
    "Answer: {A}",
    "Answer: {red box}",
    '{"answer":"A"}<|im_end|>',
    'json\n{"answer": "A"}',
    'Here is the JSON:\n{"answer": "A"}\nHope this helps!',
    '{"thought": "B?", "answer": "A) red box"}',
    # Hedges about one option, and others that are ruled out or stand in grounds.
    "Probably A, but maybe not",
    "Probably A, certainly not B",
    "Answer: A, and maybe not B",
    "Answer: A, B is not possible",
    "Answer: A (B is impossible)",
    "Answer: A. B is unlikely.",
    "It could be B, but he did not see it, so A.",
    "Could be A or B. Final answer: A",
    "I'm torn between the red box and the blue box, but I'll go with the red box.",
    "Answer: A, because Anne may have moved it to B",
    "Answer: A. It may be in B now, but he did not see that.",
    "Answer: A. B may be where it is now.",
)
RIGHT += (
    "The red box, unless he saw it.",
    "The answer is A unless Sally saw Anne move it.",
    "A, unless he saw it move to B",
    "The red box, unless Anne moved it into the blue box",
    "The red box. If he had seen the move, he would look in the blue box.",
    "Answer: A, because if he had seen it, it would be B.",
    "B -> no, A",
    "B, no wait, A",
    "B. No, A.",
    "The blue box, no, the red box",
)
OTHER = ("(B) the blue box",)
UNKNOWN = (
    "He doesn't know.",
    "Answer: he doesn’t know",
    "Answer: C",
    "Answer: He does not know.",
)
AMBIGUOUS = (
    "Answer: A. Wait, I am not sure.",
    "Answer: red box or blue box",
    "Answer: A or B",
    "Answer: A and B",
    "Answer: A, B",
    "Answer: A/B",
    "A or B",
    "Answer: either the red box or the blue box",
    "red box / blue box",
    "Answer: B) red box",
    "Answer: A (blue box)",
    "Answer: red box and blue box",
    '{"answer": ["A", "B"]}',
    '{"answer": "A or B"}',
    "\\boxed{A, B}",
    "<answer>A or B</answer>",
    "Answer: the red or the blue box",
    "It could be the red box or the blue box.",
    "Answer: red box, or maybe blue box",
    "Answer: A\nB",
    "red box\nblue box",
    "Answer:\nA) red box\nB) blue box",
    # Hedges: two options are named, and none is ruled out.
    "Probably A, but maybe B",
    "Answer: Probably A, but maybe B",
    "Answer: A (or maybe B)",
    "Answer: A, possibly B",
    "Answer: A, though B is possible",
    "Answer: A. It could also be B.",
    "Answer: A. Then again, B is possible.",
    "Answer: A, although it might be B",
    "Answer: A, but B cannot be excluded",
    "Answer: A, but it could be B",
    "Answer: A most likely, B otherwise",
    "Answer: A, otherwise B",
    "Answer: A - but B is a close second",
    "Answer: A (second choice: B)",
    "Answer: first A, then B",
    "Answer: Both A and B are possible.",
    "Answer: red box (blue box is also possible)",
    "Answer: the red box (perhaps also the blue one)",
    "Answer: red box ... or is it the blue box?",
    "Answer: red box, though I could also see blue box",
    "I would say A but I'm not sure; B could be right",
    "It's probably A but B is also plausible",
    "The red box; alternatively, the blue box.",
    "Maybe A, maybe B",
    "Answer: A, but I can't rule out B",
    "Answer: A; runner-up B",
    "Answer: A oder B",
    "Answer: A, vielleicht B",
    "Answer: red box, quizás blue box",
    "Answer: A；也许 B",
    "Probably the red box, but maybe he does not know.",
    # Each option under a condition.
    "A, unless he saw it, then B",
    "Answer: A, unless he saw it, then B",
    "**A**, unless Sally looked; then **B**",
    "The red box unless Anne told him, in which case the blue box.",
    "A - unless he saw, in which case B",
    "The red box (unless she looked, then the blue box)",
    "(A) the red box, unless he saw it, then (B) the blue box",
    '{"answer": "A unless he saw it, then B"}',
    "\\boxed{A, \\text{ unless he saw it, then } B}",
    "<answer>A, or B if he saw it</answer>",
    "If she saw it, the blue box; otherwise, the red box.",
    "Answer: It depends: if she saw the move, B; otherwise A.",
    "If he peeked then B, else A.",
    "A if she did not see, B if she did",
    "Answer: **A** (if he did not see it) / **B** (if he did)",
    "In the red box, provided that she left; otherwise in the blue box.",
    "A... or is it the blue box?",
    "Answer: A, except when he saw it, then B",
    "Answer: A, provided he did not see it, else B",
)
UNREAD = (
    "<think>B",
    "<think>Answer: B",
    "<thinking>The answer is B.",
    "[THINK]Answer: A",
    "<|channel|>analysis<|message|>Answer: B",
    "<think></think>",
    "<think>B</think>",
    "Answer: 1",
    "A) red box\nB) blue box\nC) he does not know",
    "Options:\nA) red box\nB) blue box\nC) he does not know",
    "Answer: both",
    "I cannot know that.",
    "Answer: green box",
    "",
    "   \n",
    "Answer:",
    "Answer: ",
    "Answer: D",
    "Answer: none of the above",
    "I don't know.",
    "I do not know",
    "not in the red box",
    "Answer: not in the red box",
    "Answer: not A",
    "It is not in the blue box.",
    "Not B.",
    "Answer: neither the red box nor the blue box",
    "Neither A nor B",
    "Is it the red box?",
    "The answer would be blue box if he had seen it.",
    "If he had seen it, he would look in the blue box.",
    "Whether it is the red box I cannot tell.",
    "I'm sorry, but I can't help with that.",
    "Answer: the option, as it is written",
    "Answer: the big green box",
    "box",
    "Answer: box",
    "Where will he look?",
    "Answer: blue barrel",
    "Answer: bluebox",
    "The cat sat on the mat.",
    "Sally put the ball in the blue box.",
    "Anne moved the ball to the blue box.",
    "The blue box is where the ball is. I can't tell where he will look.",
    "The blue box is empty.",
    "I considered the blue box.",
    "Answer: anything but the blue box",
    "The ball is no longer in the blue box.",
    '{"answer": null}',
    '{"answer": ""}',
    '{"answer": "unknown"}',
)
NEVER_WRONG = (
    "B... no, A",
    "Answer: A\nWait, he left before.",
    "I'm going with A.",
    "1. red box",
    "Ans. A",
    "Sally put it in the red box. Anne moved it to the blue box.",
    "Let me think about the blue box.",
    "Answer: unlike the blue box",
    "Anne knows that it is in the blue box. He will look in the red box.",
    "He left the blue box",
    "Answer: Anne will look in the blue box, but he will look in the red box.",
    "Answer: 🅰",
    "Answer:\nA) red box\nB) blue box\nC) he does not know",
    "Not the blue box, the red box.",
    "A A A A",
    "Answer: Red box or the blue box? Red box.",
    "Therefore, B is wrong and A is right.",
    '{"answer": "A"',
    '{"A": true, "B": false}',
    "It can't be B. A.",
)


def outcomes(forms: Sequence[str]) -> dict[str, str]:
    """Return the option or else the outcome of each form."""
    found = {}
    for form in forms:
        reading = read_answer(form, OPTIONS)
        assert (reading.option is None) == bool(reading.reason) == (reading.outcome != "read")
        found[form] = reading.option or reading.outcome
    return found


@pytest.mark.parametrize(
    ("forms", "wanted"),
    [
        (RIGHT, "red box"),
        (OTHER, "blue box"),
        (UNKNOWN, "he does not know"),
        (AMBIGUOUS, "ambiguous"),
        (UNREAD, "unread"),
    ],
    ids=["right", "other", "unknown", "ambiguous", "unread"],
)
def test_a_form_gives_its_option_or_says_why_not(forms: Sequence[str], wanted: str) -> None:
    assert {form: got for form, got in outcomes(forms).items() if got != wanted} == {}


def test_an_unclear_form_is_never_read_as_another_option() -> None:
    wrong = {form: got for form, got in outcomes(NEVER_WRONG).items() if got in OPTIONS[1:]}
    assert wrong == {}


OTHER_OPTIONS: list[tuple[list[str], list[tuple[str, int | str | None]]]] = [
    (
        ["box", "red box", "blue box"],
        [
            ("Answer: red box", 1),
            ("Answer: box", 0),
            ("the box", 0),
            ("A", 0),
            ("green box", None),
            ("Answer: the big box", None),
            ("It's in the red box, not the box", 1),
        ],
    ),
    (
        ["he does not know", "he knows", "in the kitchen"],
        [
            ("He doesn't know.", 0),
            ("I cannot know that.", None),
            ("He knows", 1),
            ("he does know", None),
            ("Answer: he knows", 1),
            ("kitchen", 2),
            ("Answer: the kitchen table", None),
            ("in the kitchen now", 2),
        ],
    ),
    (
        ["left chest", "right chest"],
        [
            ("He left.", None),
            ("Answer: left", 0),
            ("the right one", 1),
            ("That is right.", None),
            ("Answer: right chest because he left", 1),
            ("The answer is right.", None),
            ("left", 0),
        ],
    ),
    (
        ["location B", "location A"],
        [
            ("location A", 1),
            ("Answer: location A", 1),
            ("A", "X"),
            ("Answer: (A)", "X"),
            ("B", "X"),
            ("Answer: B) location A", 1),
        ],
    ),
    (["B", "A"], [("Answer: A", "X")]),
    (["A", "B"], [("Answer: A", 0), ("A", 0), ("Answer: B because", 1)]),
    (
        ["1. red box", "2. blue box"],
        [
            ("1", 0),
            ("2.", 1),
            ("2)", 1),
            ("Answer: 2", 1),
            ("Answer: 2) blue box", 1),
            ("1) blue box", "X"),
            ("red box", 0),
            ("Answer: number 2", 1),
            ("A", None),
        ],
    ),
    (
        ["0", "1", "2"],
        [
            ("Answer: 1", 1),
            ("2", 2),
            ("Answer: 3", None),
            ("Answer: B", 1),
            ("Answer: 1 or 2", "X"),
            ("Answer: 10", None),
        ],
    ),
    (
        ["yes", "no"],
        [
            ("Answer: Yes", 0),
            ("No.", 1),
            ("No, he doesn't.", 1),
            ("Yes, because there is no key", 0),
            ("yes or no", "X"),
            ("Answer: no", 1),
            ("Answer: A", 0),
            ("NO", 1),
            ("Yes!", 0),
        ],
    ),
    (
        ["open", "shut"],
        [
            ("Answer: It's open.", 0),
            ("The door is shut.", 1),
            ("closed", None),
            ("not open", None),
            ("open", 0),
        ],
    ),
    (["on", "off"], [("Answer: on", 0), ("It is off", 1), ("off", 1), ("The lever is on.", 0)]),
    (
        ["(1, 64, 2)", "(3, 64, -2)"],
        [
            ("Answer: (1, 64, 2)", 0),
            ("(3, 64, -2)", 1),
            ("Answer: (3, 64, 2)", None),
            ("B", 1),
            ("1, 64, 2", 0),
        ],
    ),
    (
        ["the kitchen", "the living room", "the dining room"],
        [
            ("living room", 1),
            ("In the dining room.", 2),
            ("Answer: the kitchen.", 0),
            ("Kitchen or living room", "X"),
            ("room", None),
        ],
    ),
    (
        ["Anne", "Sally", "nobody"],
        [("Answer: Anne", 0), ("Nobody.", 2), ("Answer: Sally, not Anne", 1)],
    ),
    (
        ["red box", "blue box", "green box", "white box", "nobody can know"],
        [
            ("E", 4),
            ("Answer: E) nobody can know", 4),
            ("Nobody can know.", 4),
            ("white", 3),
            ("red, blue", "X"),
        ],
    ),
    (
        ["in the box", "under the box"],
        [
            ("in the box", 0),
            ("under the box", 1),
            ("the box", None),
            ("Answer: it is under the box", 1),
        ],
    ),
    (["apple", "apples"], [("apple", 0), ("apples", 1)]),
    (
        ["the western chest", "the barrel", "Tom"],
        [
            ("western chest", 0),
            ("Answer: The Western Chest", 0),
            ("barrel", 1),
            ("It is in the barrel.", 1),
            ("chest", None),
            ("the eastern chest", None),
        ],
    ),
    (
        ["diamond", "emerald", "diamond and emerald"],
        [
            ("diamond and emerald", 2),
            ("a diamond", 0),
            ("diamond, emerald", "X"),
            ("Answer: an emerald", 1),
            ("diamonds", 0),
        ],
    ),
    (["I do not know", "red box"], [("I don't know", 0), ("I do not know.", 0)]),
    (["red_box", "blue_box"], [("red_box", 0), ("red box", 0), ("**blue_box**", 1)]),
    (["Red Box", "Blue Box"], [("red box", 0)]),
    (["café", "hall"], [("café", 0), ("CAFÉ", 0)]),
    (["箱", "机"], [("箱", 0), ("Answer: 机", 1)]),
    (
        ["chest 1", "chest 2"],
        [("chest 2", 1), ("Answer: chest 1", 0), ("1", None), ("chest", None), ("chest 12", None)],
    ),
    (
        ["the box next to the door", "the box on the table"],
        [("the box next to the door", 0), ("the box on the table", 1)],
    ),
    (["a", "b", "c"], [("b", 1), ("Answer: c", 2)]),
]
"""Options, and forms with the number of their option, or `X` if they are ambiguous."""


@pytest.mark.parametrize(("options", "forms"), OTHER_OPTIONS, ids=lambda each: str(each[0]))
def test_options_of_every_kind_are_told_apart(
    options: list[str], forms: list[tuple[str, int | str | None]]
) -> None:
    for form, wanted in forms:
        reading = read_answer(form, options)
        told: int | str | None = "X" if reading.outcome == "ambiguous" else None
        if reading.option is not None:
            told = options.index(reading.option)
        assert (form, told) == (form, wanted)


STATEMENTS = ("{L}", "({L})", "{L}) {T}", "{L}. {T}", "{T}", "the {T}", "Option {L}", "{T} ({L})")
FRAMES = (
    *("Answer: {S}", "**Answer:** {S}", "ANSWER - {S}", "Final answer: {S}", "The answer is {S}."),
    *("So my answer: **{S}**", "## Answer\n\n{S}", "Answer:\n{S}", "\\boxed{{{S}}}", "`{S}`"),
    *(
        "**{S}**",
        "<answer>{S}</answer>",
        "```\n{S}\n```",
        "> {S}",
        "Answer: \u201c{S}\u201d",
        "{S}",
    ),
    *("I choose {S}", "Answer: {S}, because Anne moved it.", "Answer: {S} (as I saw)"),
)
DECORATIONS = (
    *("{F}", "{F}\r\n", "\n\n{F}  ", "{F}<|im_end|>", "{F}</s>", "<think>No: {N}.</think>\n{F}"),
    *(
        "[THINK]Answer: {N}[/THINK]{F}",
        "Answer: {N}\nWait, that is wrong.\n{F}",
        "Hm.\n</think>{F}",
    ),
    *(
        "{F}\n\nReason: the {N} is where it is now.",
        "Sure!\n\n{F}",
        "<thinking>{N}\n</thinking>{F}",
    ),
    "<|channel|>analysis<|message|>{N}<|end|><|start|>assistant<|channel|>final<|message|>{F}",
)


@pytest.mark.parametrize("right", range(3))
@pytest.mark.parametrize(
    "options", [("red box", "blue box", "green box"), ("hall", "attic", "den")]
)
def test_every_frame_holds_every_statement_in_every_surrounding(
    options: tuple[str, ...], right: int
) -> None:
    text, letter = options[right], "ABC"[right]
    other = options[(right + 1) % 3]
    read = 0
    # Every pair of parts, and all three of some.
    forms = [
        *itertools.product(STATEMENTS[:1], FRAMES, DECORATIONS),
        *itertools.product(STATEMENTS, FRAMES, DECORATIONS[:1]),
        *itertools.product(STATEMENTS, FRAMES[:1], DECORATIONS),
    ]
    for statement, frame, around in forms:
        said = statement.format(L=letter, T=text)
        form = around.format(F=frame.format(S=said), N=other)
        reading = read_answer(form, options)
        assert reading.option in (text, None), form
        read += reading.option == text
    assert read / len(forms) > 0.97


def test_a_structured_answer_may_be_nested() -> None:
    for answer in ("A", "red box", "(A) red box", "The red box."):
        for content in (
            {"answer": answer},
            {"reasoning": "the blue box?", "answer": answer},
            {"response": {"answer": answer, "confidence": 0.9}},
            {"answer": {"choice": answer}},
        ):
            text = json.dumps(content, indent=1)
            for form in (text, f"```json\n{text}\n```", f"Here you are:\n{text}\nBye."):
                assert read_answer(form, OPTIONS).option == "red box", form


def test_a_cut_answer_is_cut_whatever_it_names() -> None:
    for text in ("Answer: A", "<think>Answer: A", "", "Answer: red bo"):
        reading = read_answer(text, OPTIONS, "length")
        assert (reading.option, reading.outcome) == (None, "cut")


def test_a_refusal_is_told_from_an_answer_that_names_nothing() -> None:
    for text in (
        "I'm sorry, but I can't help with that.",
        "I cannot assist with this request.",
        "Sorry, I am unable to answer that question.",
        "As an AI language model, I cannot answer this.",
    ):
        assert read_answer(text, OPTIONS).refused, text
    for text in ("I cannot know that.", "Answer: green box", "", "Sorry, I do not know."):
        assert not read_answer(text, OPTIONS).refused, text
    assert read_answer("I'm sorry, but he will look in the red box.", OPTIONS).option == "red box"
    assert read_answer("", OPTIONS, "content_filter").refused


def test_thinking_is_kept_apart() -> None:
    reading = read_answer("<think>Perhaps B?</think>Answer: A", OPTIONS)
    assert (reading.option, reading.thinking) == ("red box", "Perhaps B?")
    assert separate_thinking("no mark").thinking == ""
    nested = "<think>a<think>b</think>c</think>Answer: A"
    assert read_answer(nested, OPTIONS).option == "red box"
    mentions = "<think>I write <think> here</think>Answer: A"
    assert read_answer(mentions, OPTIONS).option == "red box"


def test_the_echo_of_our_own_instructions_is_no_answer() -> None:
    echo = (
        "You answer a question. You know only what is written here.\n\nAnswer in this form:\n\n"
        "Answer: the option, as it is written\n\nQuestion: Where will he look?\n\nOptions:\n"
        "A) red box\nB) blue box\nC) he does not know\n"
    )
    assert read_answer(echo, OPTIONS).outcome == "unread"
    assert read_answer(f"{echo}\nAnswer: B", OPTIONS).option == "blue box"


def test_a_further_question_that_a_model_makes_up_is_not_answered() -> None:
    text = "Answer: red box\n\nQuestion: Where will Anne look?\nAnswer: blue box"
    assert read_answer(text, OPTIONS).option == "red box"


def test_long_answers_are_read_at_once() -> None:
    for part in (
        "(",
        "{",
        "Answer: ",
        "so he ",
        "wait, no, ",
        "red box ",
        "<think>",
        "```\n",
        "\n",
        "\\boxed{",
        "Answer: A\n",
        "Answer:\n",
        "Question: where?\n",
        "---\nhe is out\n",
    ):
        started = time.process_time()
        read_answer(part * (50_000 // len(part)), OPTIONS)
        assert time.process_time() - started < 5


@pytest.mark.parametrize("gap", [" ", "\n", "\u00a0", " \n"])
def test_a_gap_of_any_length_is_no_part_of_an_answer(gap: str) -> None:
    started = time.process_time()
    reading = read_answer(f"I see.{gap * 20_000}Answer:{gap * 20_000}the red box", OPTIONS)
    assert reading.option == "red box"
    assert read_words(f"Answer:{gap * 20_000}the red box").said == "the red box"
    assert time.process_time() - started < 5


@pytest.mark.parametrize(
    ("answer", "named", "ruled_out"),
    [
        ("in the blue box", {"blue box"}, set()),
        ("not in the red box", set(), {"red box"}),
        ("in the blue box or the red box", {"blue box", "red box"}, set()),
        ("blue", {"blue box"}, set()),
        ("the blue one, not the red one", {"blue box"}, {"red box"}),
        ("It isn\u2019t in the red box; it\u2019s in the blue box.", {"blue box"}, {"red box"}),
        ("in the attic", set(), set()),
    ],
)
def test_names_in_words(answer: str, named: set[str], ruled_out: set[str]) -> None:
    known = ["red box", "blue box", "garden"]
    found = named_in_words(answer, known)
    assert ({known[n] for n in found.yes}, {known[n] for n in found.no}) == (named, ruled_out)


def test_an_answer_in_words_is_the_last_statement_or_a_single_line() -> None:
    assert read_words("Answer: the blue box.\nReason: I saw it.").said == "the blue box"
    assert read_words("<think>red</think>blue box").said == "blue box"
    assert read_words("I think\nthat it is there.").outcome == "unread"
    assert read_words("Answer: the blue", "length").outcome == "cut"


def test_the_models_of_this_package_are_read() -> None:
    prompt = "Question: Where?\n\nOptions:\nA) red box\nB) blue box\n"
    for name in ("first-option", "chance"):
        answer = resolve_model(name, {}).answer([Message("user", prompt)], Sampling(seed=1))
        assert read_answer(answer.text, OPTIONS[:2]).outcome == "read"


def test_the_table_of_the_docs_is_true() -> None:
    page = (Path(__file__).parents[2] / "docs" / "models.md").read_text(encoding="utf-8")
    table = page.partition("| form | gives |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| `(.*)` \| `?(.*?)`? \|$", table, re.MULTILINE)
    assert len(rows) > 20
    forms = [form.replace("⏎", "\n").replace("\\|", "|") for form, _ in rows]
    told = [
        reading.option or reading.outcome for reading in (read_answer(f, OPTIONS) for f in forms)
    ]
    assert dict(zip(forms, told, strict=True)) == dict(
        zip(forms, (gives for _, gives in rows), strict=True)
    )
