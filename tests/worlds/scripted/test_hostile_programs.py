"""Programs that once stopped the scripted world, or forged what left them."""

from collections.abc import Iterator

import pytest
from tests.profiles import few_by_day

import beliefnest as bn

FUEL = "fuel exhausted: the program computed more than its limit of 250000000 units"

ENDLESS = {
    "a loop": "for (;;) {}",
    "the message of an error": "throw {get message () { for (;;) {} }}",
    "reverse": "[].reverse.call({length: 2 ** 53 - 1})",
    "join": "[].join.call({length: 2 ** 53 - 1})",
    "sort": "[].sort.call({length: 2 ** 53 - 1})",
    "copyWithin": "[].copyWithin.call({length: 2 ** 53 - 1}, 0, 1)",
    "unshift": "[].unshift.call({length: 2 ** 53 - 3}, 1, 2)",
    "concat": "[].concat({length: 2 ** 53 - 2, [Symbol.isConcatSpreadable]: true})",
    "a regular expression": "/(a+)+$/.test('a'.repeat(60) + 'b')",
    "the stack of errors": "Object.defineProperty(Error.prototype, 'stack', "
    "{get () { for (;;) {} }}); throw Object.setPrototypeOf({}, Error.prototype)",
    "a proxy of an error": "throw new Proxy(new Error(), {get () { for (;;) {} }})",
    "an argument": "await goToPosition(bot, new Proxy({}, {ownKeys () { for (;;) {} }}))",
    "a then": "return {then () { for (;;) {} }}",
    "a listener": "bot.on('chat', () => { for (;;) {} }); bot.chat('x'); await waitTicks(bot, 5)",
    "jobs": "const again = () => { Promise.resolve().then(again) }; again(); "
    "await new Promise(() => {})",
    "a generator": "for await (const x of (async function * () { for (;;) yield 1 })()) {}",
    "a console": "for (;;) console.log('x'.repeat(1000))",
    "dates": "for (;;) new Date()",
    "reads": "for (;;) bot.players",
    "requests": "for (;;) { try { bot.waitForTicks('x') } catch {} }",
    "utterances": "for (let n = 0; n < 5000; n++) bot.chat('n' + n)",
}
OTHERS = {
    "memory": ("const all = []; for (;;) all.push(new Array(1000).fill(1))", "memory"),
    "a long text": ("'x'.repeat(2 ** 29)", "memory"),
    "recursion": ("(function f () { f() })()", "stack"),
    "calls": ("for (;;) doNothing(bot)", "refused"),
    "a shared buffer": ("new SharedArrayBuffer(2 ** 40)", "error"),
    "an error of a long text": ("throw new Error('x'.repeat(1e7))", "error"),
    "a thrown long text": ("throw 'x'.repeat(1e7)", "error"),
    "a long result of a listener": (
        "bot.on('chat', () => 'x'.repeat(5e6)); bot.chat('x'); await waitTicks(bot, 5)",
        "refused",
    ),
    "nesting": ("(" * 19_000, "syntax"),
    "a value without end": (
        "let a = []; for (let n = 0; n < 1e4; n++) a = [a]; await say(bot, a)",
        "error",
    ),
}
FILLING = {
    "arrays": "const a = []; for (;;) a.push(new Array(1e4).fill(1))",
    "caught": "const a = []; for (;;) try { a.push(Array(1e4).fill(1)) } catch (e) { a.push(e) }",
    "awaited": "async function f () { await null; await f() } await f()",
}
FORGERIES = {
    "toJSON": "Array.prototype.toJSON = Object.prototype.toJSON = () => [[1, 'nope', []]]",
    "JSON": 'JSON.stringify = () => \'["skill", "nope", []]\'; JSON.parse = () => ({ok: true})',
    "collections": "Map.prototype.get = WeakMap.prototype.get = () => ({resolve () {}})",
    "calls of functions": "Function.prototype.call = Function.prototype.apply = () => 7",
    "globals": "globalThis.bot = 3; globalThis.say = 3",
    "members": "for (const key of ['$', 'id', 'c', 'o', 'v', 'calls', 'message', '0']) "
    "Object.defineProperty(Object.prototype, key, {set () {}, get () { return 'forged' }})",
    "iterators": "Array.prototype[Symbol.iterator] = function * () { yield 'forged' }",
}


@pytest.fixture(scope="module")
def nest() -> Iterator[bn.Nest]:
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)), agents={"ann": (1.5, 1, 1.5), "bob": (5.5, 1, 1.5)}
    )
    with bn.Nest(world) as opened:
        yield opened


def _beside(nest: bn.Nest, code: str) -> bn.ProgramResult:
    """Return the result of a program beside which another runs, and after which another does."""
    results = nest["/"].run_all(
        {"ann": code, "bob": "for (let n = 0; n < 3; n++) await doNothing(bot)"}, 60
    )
    assert results["bob"].ok
    assert nest["/"].run("ann", "await say(bot, 'still ' + 'here')").said[0][1] == "still here"
    return results["ann"]


@pytest.mark.parametrize("name", few_by_day(ENDLESS, 3))
def test_what_computes_without_end_ends_by_its_fuel(nest: bn.Nest, name: str) -> None:
    error = _beside(nest, ENDLESS[name]).error
    assert error is not None
    assert (error.kind, error.message.partition(";")[0]) == ("fuel", FUEL)


@pytest.mark.parametrize("name", FILLING)
def test_what_fills_all_memory_says_so(nest: bn.Nest, name: str) -> None:
    error = _beside(nest, FILLING[name]).error
    assert error is not None
    assert (error.kind, error.message) == ("memory", "memory exhausted: the limit is 64 MiB")


def test_a_chain_of_promises_ends_by_a_limit(nest: bn.Nest) -> None:
    error = _beside(nest, "const again = () => Promise.resolve().then(again); await again()").error
    assert error is not None
    # Either limit: the build decides which one is reached first.
    assert error.kind in ("memory", "fuel")


def test_a_thrown_null_is_an_error_as_long_as_there_is_memory(nest: bn.Nest) -> None:
    error = _beside(nest, "throw null").error
    assert error is not None
    assert (error.kind, error.message) == ("error", "the program threw null")


@pytest.mark.parametrize("name", OTHERS)
def test_what_takes_too_much_ends_by_its_limit(nest: bn.Nest, name: str) -> None:
    code, kind = OTHERS[name]
    error = _beside(nest, code).error
    assert error is not None
    assert error.kind == kind


@pytest.mark.parametrize("name", FORGERIES)
def test_what_a_program_does_to_built_ins_changes_no_call(nest: bn.Nest, name: str) -> None:
    code = f"{FORGERIES[name]}\nawait say(bot, 'one'); await waitTicks(bot, 2); bot.chat('two')"
    result = _beside(nest, code)
    assert result.ok, result.error
    assert [text for _, text in result.said] == ["one", "two"]


def test_a_program_ends_at_the_same_point_each_time(nest: bn.Nest) -> None:
    code = "let n = 0; for (;;) { n += 1; if (n % 100000 === 0) console.log(n) }"
    first, second = (nest["/"].run("ann", code).log for _ in range(2))
    assert first == second


def test_what_one_program_leaves_behind_another_does_not_find(nest: bn.Nest) -> None:
    nest["/"].run("ann", "globalThis.leak = Array.prototype.leak = 1; JSON.leak = 1; bot.leak = 1")
    look = "console.log(typeof leak, [].leak, JSON.leak, bot.leak)"
    assert nest["/"].run("ann", look).log == ("undefined undefined undefined undefined",)
