"""Appearance of blocks on the page: plain colours of our own, and shapes."""

import zlib
from typing import Any

from beliefnest.belief.context import BeliefContext
from beliefnest.world.signs import plain_state, sign_words
from beliefnest.world.values import Sign

_COLOURS = (
    ("stained_glass", "#c8dbe0"),
    ("glass", "#cfe5ea"),
    ("water", "#7fb0dc"),
    ("lava", "#d9793a"),
    ("ice", "#bcd6ee"),
    ("snow", "#f1f4f6"),
    ("grass_block", "#9aba73"),
    ("leaves", "#7ba468"),
    ("moss", "#86a25a"),
    ("dirt", "#a08363"),
    ("mud", "#7b6f66"),
    ("sandstone", "#dccfa2"),
    ("sand", "#e2d5a8"),
    ("gravel", "#a9a3a0"),
    ("clay", "#a7adb8"),
    ("smooth_stone", "#d4d2cd"),
    ("stone_bricks", "#9b9995"),
    ("cobblestone", "#8f8d8a"),
    ("deepslate", "#6b6b70"),
    ("blackstone", "#55525a"),
    ("obsidian", "#4b4460"),
    ("bricks", "#b07862"),
    ("iron", "#dcdcda"),
    ("gold", "#e5c860"),
    ("diamond", "#86d3d4"),
    ("emerald", "#6cc388"),
    ("redstone", "#b9584a"),
    ("quartz", "#ebe6de"),
    ("bookshelf", "#a98758"),
    ("crafting_table", "#a8794a"),
    ("furnace", "#85827f"),
    ("ender_chest", "#4f6b66"),
    ("chest", "#b98347"),
    ("barrel", "#9c7243"),
    ("lever", "#a58a68"),
    ("button", "#a58a68"),
    ("torch", "#e9c76a"),
    ("door", "#a9814f"),
    ("birch", "#d5c594"),
    ("spruce", "#7d5d3a"),
    ("dark_oak", "#5e4530"),
    ("acacia", "#b26a40"),
    ("jungle", "#a8805b"),
    ("oak", "#b79763"),
    ("planks", "#b79763"),
    ("log", "#8f7048"),
    ("carpet", "#b8b0a8"),
    ("wool", "#cfcac2"),
    ("concrete", "#b9b6b0"),
    ("stone", "#b4b2ad"),
)
"""Colours by part of a name; the first matching part decides."""

_DYES = {
    "white": "#eceae6",
    "orange": "#d98a4b",
    "magenta": "#b978ae",
    "light_blue": "#8fb9d8",
    "yellow": "#e0c65c",
    "lime": "#a3c05c",
    "pink": "#dca3b4",
    "light_gray": "#b5b4b0",
    "gray": "#7c7b7d",
    "cyan": "#5f9ea3",
    "purple": "#8d6ba6",
    "blue": "#5c78b5",
    "brown": "#8c6a4d",
    "green": "#6f8f4e",
    "red": "#b85a50",
    "black": "#46454a",
}


class BlockPalette:
    """Numbers of blocks, in the order in which they first appear.

    Attributes:
        entries: By number: text, name, colour, boxes in 1/32 of a block, and kind.
    """

    def __init__(self, context: BeliefContext) -> None:
        self._context = context
        self._numbers: dict[int, int] = {}
        self.entries: list[dict[str, Any]] = []

    def number(self, state: int) -> int:
        """Return the number of a block with the given state id; -1 for unknown."""
        if state < 0:
            return -1
        if state not in self._numbers:
            self._numbers[state] = len(self.entries)
            self.entries.append(self._entry(state))
        return self._numbers[state]

    def _entry(self, number: int) -> dict[str, Any]:
        registry, block = self._context.registry, self._context.block(number)
        claims = self._context.claims_on(number)
        state = plain_state(block)
        name = registry.name(state)
        boxes = [[round(32 * edge) for edge in box] for box in registry.boxes(state)]
        if not boxes and not name.endswith("air"):
            # Show blocks without a collision shape as a small box.
            boxes = [[12, 0, 12, 20, 20, 20]]
        return {
            "text": registry.text(state),
            "name": name,
            "colour": _colour(name),
            "boxes": boxes,
            "air": name.endswith("air"),
            "container": registry.is_container(name),
            "glassy": bool(registry.default_transparent[state]),
            "open": registry.properties(state).get("open"),
            **({"says": sign_words(block.text)} if isinstance(block, Sign) else {}),
            **({"claims": [str(claim) for claim in claims]} if claims else {}),
        }


def _colour(name: str) -> str:
    for dye, colour in sorted(_DYES.items(), key=lambda each: -len(each[0])):
        if name.startswith(f"{dye}_"):
            return colour
    for part, colour in _COLOURS:
        if part in name:
            return colour
    # Give any other block a quiet colour that is the same in every run.
    tone = zlib.crc32(name.encode()) % 5
    return ("#b3aca4", "#a9aba6", "#b0a9b0", "#a7adb0", "#b5b0a3")[tone]
