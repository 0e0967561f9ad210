"""Separation of a model's thinking from what it says, for the marks of all known models."""

import re

import msgspec

_NAMES = "think|thinking|thought|thoughts|reasoning|reflection|scratchpad|analysis|seed:think"
_TAG = re.compile(
    # In quotes a mark is a text of the program, as in `bot.chat('</think>')`.
    rf"(?P<quote>[\"'`])(?P<text></?\s*(?:{_NAMES})>)(?P=quote)"
    rf"|<(?P<close>/)?\s*(?:{_NAMES})(?:\s[^<>\n]{{0,100}})?>"
    r"|\[(?P<close2>/)?THINK\]"
    r"|<\|(?:begin|(?P<close3>end))_of_(?:thought|thinking)\|>"
    r"|\u25c1(?P<close4>/)?think\u25b7",
    re.IGNORECASE,
)
_CHANNEL = re.compile(r"<\|channel\|>\s*(?P<name>\w+)[^<]{0,100}<\|message\|>", re.IGNORECASE)
_FINAL = "final"
_HARMONY_END = re.compile(r"<\|(?:end|return|call|start|channel)\|>")
_LEAKED = re.compile(
    r"\s*analysis(?=[A-Z\"'(\s])(?P<thinking>.*?)assistant\s*final(?P<text>.*)", re.DOTALL
)
_LEAKED_OPEN = re.compile(r"\s*analysis(?=[A-Z\"'(])")
_PROMPT_ECHO = re.compile(r".*\[/INST\]", re.DOTALL)
_TURN_START = re.compile(
    r"\s*(?:<s>|<bos>|<\|begin_of_text\|>|<\|startoftext\|>"
    r"|<\|im_start\|>\s*assistant\b|<start_of_turn>\s*model\b|<\|assistant\|>"
    r"|<\|start\|>\s*assistant\b|<\|start_header_id\|>\s*assistant\s*<\|end_header_id\|>)"
)
_TURN_END = re.compile(
    r"<\|im_end\|>|<\|im_start\|>|<\|eot_id\|>|<\|end_of_text\|>|<\|endoftext\|>|</s>|<eos>"
    r"|<end_of_turn>|<\|end\|>|<\|return\|>|<\|user\|>|<\|eom_id\|>|<\uff5cend\u2581of\u2581sentence\uff5c>"
    r"|<\|END_OF_TURN_TOKEN\|>|<\|END_RESPONSE\|>|\[INST\]|\[EOS\]"
)


class Said(msgspec.Struct, frozen=True):
    """Text that a model said, without its thinking and without the marks of turns.

    Attributes:
        text: Text for the reader.
        thinking: Thoughts before it; empty: none.
        open: True if a thought has no end, so that nothing was said after it.
    """

    text: str
    thinking: str
    open: bool = False


def separate_thinking(text: str) -> Said:
    """Separate thinking from what is said.

    Thinking is what stands between marks such as `<think>` and `</think>`, `[THINK]` and
    `[/THINK]`, or in channels before `final`; what stands before an end without a beginning; and
    what stands after a beginning without an end. Marks of turns, such as `<|im_end|>`, are
    removed, with the turns that a model makes up after its own.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    channels = _by_channel(text)
    if channels is not None:
        return channels
    leaked = _LEAKED.fullmatch(text)
    if leaked:
        return Said(_own_turn(leaked["text"]), leaked["thinking"].strip())
    if _LEAKED_OPEN.match(text):
        return Said("", text.strip(), open=True)
    return _by_tags(text)


def _by_channel(text: str) -> Said | None:
    """Return the parts of a text with channels; None: it has none."""
    heads = list(_CHANNEL.finditer(text))
    if not heads:
        return None
    said: list[str] = []
    thought: list[str] = []
    for number, head in enumerate(heads):
        last = heads[number + 1].start() if number + 1 < len(heads) else len(text)
        body = _HARMONY_END.split(text[head.end() : last], maxsplit=1)[0].strip()
        (said if head["name"].lower() == _FINAL else thought).append(body)
    thinking = "\n\n".join(thought)
    if not said:
        return Said("", thinking, open=True)
    inner = _by_tags(said[-1])
    return Said(inner.text, "\n\n".join(filter(None, [thinking, inner.thinking])), inner.open)


def _by_tags(text: str) -> Said:
    said: list[str] = []
    thought: list[str] = []
    depth, at = 0, 0
    closed_last = False
    for tag in _TAG.finditer(text):
        if tag["text"]:
            continue
        closes = any(tag[name] for name in ("close", "close2", "close3", "close4"))
        part = text[at : tag.start()]
        if depth or closes:
            # Text before an end without a beginning is thinking as well.
            thought += [*said, part] if closes and not depth else [part]
            said = [] if closes and not depth else said
        else:
            said.append(part)
        depth = max(0, depth - 1) if closes else depth + 1
        at, closed_last = tag.end(), closes
    rest = text[at:]
    # A thought that mentions a beginning has more beginnings than ends.
    is_open = depth > 0 and not closed_last
    (thought if is_open else said).append(rest)
    thinking = "\n\n".join(each for part in thought if (each := part.strip()))
    return Said(_own_turn("".join(said)), thinking, is_open)


def _own_turn(text: str) -> str:
    """Return the text of the model's own turn, without marks of turns."""
    echo = _PROMPT_ECHO.match(text)
    if echo:
        text = text[echo.end() :]
    while start := _TURN_START.match(text):
        text = text[start.end() :]
    for end in _TURN_END.finditer(text):
        if text[: end.start()].strip():
            text = text[: end.start()]
            break
    return _TURN_END.sub("", text)
