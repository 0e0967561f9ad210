"""Programs in the forms in which models write them."""

import time
from importlib.resources import files

import pytest

from beliefnest.llm import read_program
from beliefnest.llm.reading_programs import PLACEHOLDER

DONE = "await think(bot, 'done');"


def fenced(code: str, language: str = "javascript") -> str:
    return f"```{language}\n{code}\n```"


@pytest.mark.parametrize(
    ("answer", "program"),
    [
        (fenced("a();"), "a();"),
        (f"First I think.\n\n{fenced('a();', 'js')}\nDone.", "a();"),
        (f"{fenced('a();')}\nNo, better:\n{fenced('b();')}", "b();"),
        (f"{fenced('a();')}\nor\n{fenced('b();')}", "b();"),
        (f"{fenced('a();')}\n{fenced('{}', 'json')}", "a();"),
        (f"{fenced('a();')}\n{fenced('output', '')}", "a();"),
        (fenced("a();", ""), "a();"),
        (f"{fenced('a();', '')}\nor\n{fenced('b();', '')}", "b();"),
        *((fenced("a();", word), "a();") for word in ("JavaScript", "typescript", "mineflayer")),
        (fenced("a();", '{.javascript title="x"}'), "a();"),
        ("~~~js\na();\n~~~", "a();"),
        ("````js\nconst x = `\n```\n`;\n````", "const x = `\n```\n`;"),
        ("  ```js\n  a();\n  ```", "  a();"),
        ("```js\r\na();\r\n```", "a();"),
        ("await a(bot);", "await a(bot);"),
        ("\nconst p = new Vec3(1, 2, 3);\nawait goToPosition(bot, p);\n", None),
        ("bot.chat('hi')", "bot.chat('hi')"),
        ("async function get(bot) {\n  await a();\n}", None),
        ("// nothing\na(); // end", None),
        (f"Here it is:\n```javascript\nawait a();\n{DONE}```", f"await a();\n{DONE}"),
        (f"Program: ```js\n{DONE}\n```\n", DONE),
        (f"Program: ```js {DONE}```", DONE),
        (f"\u7a0b\u5e8f\uff1a```js\n{DONE}\n```", DONE),
        (f"> ```js\n> if (a) {{\n>   {DONE}\n>\n> }}\n> ```", f"if (a) {{\n  {DONE}\n\n}}"),
        (f"```js {DONE} ```", DONE),
        (f"Call ```a();``` like this:\n{fenced(DONE)}", DONE),
        (f"<think>maybe\n{fenced('draft();')}\nno</think>\n{fenced(DONE, '')}", DONE),
        (f"[THINK]maybe\n{fenced('draft();')}\n[/THINK]{fenced(DONE, '')}", DONE),
        (f"{fenced(DONE)}<|im_end|>", DONE),
        (f"<program>\n{DONE}\n</program>", DONE),
        (f"<answer><code>{DONE}</CODE></answer>", DONE),
        (f"```js\n{DONE}", DONE),
        ("bot.chat('</think>');", None),
        (f"<think>It ends with `</think>`.\n{fenced('a();')}</think>\n{fenced(DONE)}", DONE),
        (fenced("await bot.chat('```');"), "await bot.chat('```');"),
        (fenced("broken(;"), "broken(;"),
        (f"{fenced(PLACEHOLDER)}\n{fenced(DONE)}", DONE),
    ],
)
def test_the_program_of_an_answer(answer: str, program: str | None) -> None:
    found = read_program(answer)
    assert (found.outcome, found.reason) == ("read", "")
    assert found.program == (answer.strip() if program is None else program)


@pytest.mark.parametrize(
    "inside",
    ["```\nhello\n```", "```js\nx\n```", "a ${b}\n~~~", "```"],
)
@pytest.mark.parametrize("language", ["javascript", "", "js"])
def test_a_fence_in_a_text_of_the_program_does_not_end_it(inside: str, language: str) -> None:
    program = f"const t = `\n{inside}\n`;\n{DONE}"
    assert read_program(fenced(program, language)).program == program
    assert read_program(f"Well:\n{fenced(program, language)}\nThat is all.").program == program


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ("", "is empty"),
        (" \n", "is empty"),
        ("<think>hm</think>", "only thinking"),
        ("Let me think (about it).", "no program"),
        ("I would open the chest.", "no program"),
        ("do not go there (he said);", "no program"),
        ("return to the box (now);", "no program"),
        ("<code>a();<program>", "no program"),
        ("Sure! I would go to the chest;", "no program"),
        (fenced("print(1)", "python"), "code in python and none in JavaScript"),
        (fenced("  "), "block is empty"),
        ("```js\nawait goToPosi(", "not closed"),
        (fenced("// I do nothing."), "comments only"),
        (f"<think>maybe\n{fenced('draft();')}\nhmm", "a thought without an end"),
        (f"<think>maybe\n{fenced('draft();')}\n</think>\nI cannot do this.", "no program"),
        (fenced(PLACEHOLDER), "placeholder of the instructions"),
        (PLACEHOLDER, "repeats the prompt"),
        ("Code from the last round:\nnone\n\nTask: Get a diamond.", "repeats the prompt"),
    ],
)
def test_answers_without_a_program(answer: str, reason: str) -> None:
    found = read_program(answer)
    assert (found.program, found.outcome) == (None, "unread")
    assert reason in found.reason


def test_our_own_instructions_are_no_program() -> None:
    text = (files("beliefnest.prompts") / "texts" / "instructions.txt").read_text(encoding="utf-8")
    assert PLACEHOLDER in text
    found = read_program(text)
    assert (found.program, found.outcome) == (None, "unread")
    assert "placeholder of the instructions" in found.reason
    assert read_program(f"{text}\n{fenced(DONE)}").program == DONE


def test_a_refusal_and_a_cut_answer_are_told_apart() -> None:
    refused = read_program("I'm sorry, but I can't help with that.")
    assert (refused.outcome, refused.row_outcome) == ("unread", "refused")
    assert read_program("", "content_filter").row_outcome == "refused"
    for text in (fenced("a();"), "```js\na(", ""):
        assert read_program(text, "length").row_outcome == "cut"


def test_a_long_answer_is_read_at_once_and_not_repeated_whole() -> None:
    assert len(read_program("word " * 100_000).reason) < 500
    for part in ("```\n", "```js\nconst t=`\n```\n", "a();\n", "`", "<code>"):
        started = time.perf_counter()
        read_program(part * (100_000 // len(part)))
        assert time.perf_counter() - started < 5
