"""Programs of the offline model, in the form in which language models answer."""

import json
from collections.abc import Mapping, Sequence

from beliefnest.world.values import Point

_SEARCH_DISTANCE = 20


def fenced(program: str) -> str:
    """Return a program as the answer of a chat model."""
    return f"```javascript\n{program}\n```"


def vector(point: Point) -> str:
    """Return a position as `new Vec3(-2, -51, -4)`."""
    return f"new Vec3({', '.join(_number(part) for part in point)})"


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) else repr(value)


def go_to(point: Point) -> str:
    """Return code that goes to a position."""
    return f"await goToPosition(bot, {vector(point)});"


def take_items(takings: Sequence[tuple[Point, Mapping[str, int]]]) -> str:
    """Return code that takes items out of chests, one chest after the other."""
    return "\n".join(
        f"await goToPosition(bot, {vector(chest)});\n"
        f"await getItemFromChest(bot, {vector(chest)}, {json.dumps(dict(items))});"
        for chest, items in takings
    )


def give_item(player: str, item: str, count: int) -> str:
    """Return code that hands items to a player."""
    return f"await giveItemToOther(bot, {json.dumps(player)}, {json.dumps(item)}, {count});"


def search_chests(chests: Sequence[Point], names: Sequence[str], count: int) -> str:
    """Return code that opens chests in order until one holds an item of one of the names."""
    return f"""\
const names = {json.dumps(list(names))};
for (const position of [{", ".join(vector(chest) for chest in chests)}]) {{
  await goToPosition(bot, position);
  const container = await bot.openContainer(bot.blockAt(position));
  const found = container.containerItems().find((item) => names.includes(item.name));
  await container.close();
  if (found) {{
    await getItemFromChest(bot, position, {{ [found.name]: Math.min({count}, found.count) }});
    return;
  }}
}}
{wonder(f"No chest that I know of holds {names[0]}.")}"""


def look_for_player(name: str, places: Sequence[Point]) -> str:
    """Return code that searches places, then the four directions, for a player."""
    return f"""\
const seen = () => bot.players[{json.dumps(name)}]?.entity;
for (const position of [{", ".join(vector(place) for place in places)}]) {{
  if (seen()) break;
  await goToPosition(bot, position);
}}
for (const [x, z] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) {{
  if (seen()) break;
  await exploreUntil(bot, new Vec3(x, 0, z), {_SEARCH_DISTANCE}, seen);
}}
const found = seen();
if (found) await goToPosition(bot, found.position);
else {wonder(f"I cannot find {name}.")}"""


def wonder(thought: str) -> str:
    """Return code that thinks a thought and does nothing else."""
    return f"await think(bot, {json.dumps(thought)});"
