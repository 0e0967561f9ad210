'use strict'
/**
 * Skills: the functions that a program can call besides Mineflayer's own. Each file holds one manifest, which is the
 * only declaration of its skill; `generate.js` writes manifests.json for Python and docs/skills.md from it:
 *
 * - `name`, `description`, `example`; `fails`: reasons of failure
 * - `scripted`: true if the skill has a twin in the scripted world, in worlds/scripted/skills.py
 * - `listed`: false if lists for models leave it out
 * - `cost`: name of its price in fuel (`COST` of sandbox/policy/kinds.js); `call` if left out
 * - `parameters` in order: `name`, `type`, `description`; `default` as in the signature; `aim` if the argument is the
 *   target of the skill (a position or the name of an agent): `walks` if the agent walks there, `uses` if it uses what is
 *   there; `action`: the parts of a structured action (env/actions.py) from which the argument is made,
 *   or the value that it always has there
 * - `check(context, ...args)` returns the arguments for `run`, or fails; the scripted world reads it as well, so that it
 *   uses no more of the bot than `username`, `players` and `registry`. Left out, `run` gets the arguments as they are
 * - `takesBot`: false if `bot` is no parameter; otherwise `bot` is the first one, unless it is listed elsewhere
 * - `run(context, ...args)`: `args` are what `check` returned, or the arguments without `bot`, which is `context.bot`
 */
const { numbers } = require('./lib/answers')
const { show, shortened } = require('./lib/arguments')
const { SkillError } = require('./lib/errors')
const { byTimer, turns } = require('./lib/waiting')

const LONGEST_MESSAGE = 2000

const MANIFESTS = [
  require('./goToPosition'),
  require('./openContainer'),
  require('./getItemFromChest'),
  require('./depositItemIntoChest'),
  require('./mineBlock'),
  require('./placeItem'),
  require('./craftItem'),
  require('./smeltItem'),
  require('./turnOnLever'),
  require('./turnOffLever'),
  require('./pressButton'),
  require('./openDoor'),
  require('./closeDoor'),
  require('./writeSign'),
  require('./readSign'),
  require('./giveItemToOther'),
  require('./receiveItemFromOther'),
  require('./givePlacedItemBack'),
  require('./exploreUntil'),
  require('./waitForMobRemoved'),
  require('./think'),
  require('./say'),
  require('./whisper'),
  require('./emote'),
  require('./equip'),
  require('./eat'),
  require('./sleep'),
  require('./follow'),
  require('./lookAt'),
  require('./checkValidPosition'),
  require('./waitTicks'),
  require('./waitUntil'),
  require('./waitForChat'),
  require('./doNothing')
]

const BOT = { name: 'bot', type: 'Bot', description: 'your own bot' }

/** Manifests with all their parameters, and their `signature`, as a model reads it. */
const SKILLS = MANIFESTS.map(({ takesBot = true, ...skill }) => {
  const isGiven = !takesBot || skill.parameters.some(({ type }) => type === 'Bot')
  const parameters = isGiven ? skill.parameters : [BOT, ...skill.parameters]
  const listed = parameters.map(({ name, default: value }) => (value === undefined ? name : `${name}=${value}`))
  return { ...skill, parameters, signature: `${skill.name}(${listed.join(', ')})` }
})

/**
 * Return the skills of one bot, as functions of the arguments in their signatures.
 * @param {object} body
 * @param {object} body.bot a Mineflayer bot with pathfinder
 * @param {(event: {kind: string, detail: object}) => void} body.emit receives the events that only the skill knows of;
 *   positions in `detail` are in the bot's coordinates
 * @param {Function} body.Vec3
 * @param {object} body.goals of mineflayer-pathfinder
 * @param {AbortSignal} [body.signal] when it is aborted, running skills fail and do nothing more
 * @param {(number: number, signal?: AbortSignal) => Promise<void>} [body.wait] resolves after `number` ticks of the
 *   world; never once its signal is aborted
 * @param {object | null} [body.memory] memory of a resumed program: its `call(name, args, act)` runs a skill, or
 *   returns the result from before the interruption
 * @returns {Object<string, Function>} skills by name; each rejects with an Error that has a property `skill`
 */
function bindSkills ({ bot, emit, Vec3, goals, signal, wait = byTimer, memory = null }) {
  const body = { bot, emit, Vec3, goals, wait, nextNumber: numbers(), inTurn: turns(wait) }
  return Object.fromEntries(SKILLS.map(skill => [skill.name, bind(skill, body, signal, memory)]))
}

/**
 * Return guarded versions of the bot and `emit`, which fail once the signal is aborted, and `listen(event, listener)`,
 * which returns a function that removes the listener at any time.
 */
function untilAborted ({ bot, emit }, signal, fail) {
  const check = () => { if (signal?.aborted) fail('the program that called it has ended') }
  return {
    bot: new Proxy(bot, {
      get (target, key) {
        check()
        return target[key]?.ofSkills ?? target[key]
      }
    }),
    emit (event) {
      check()
      emit(event)
    },
    listen (event, listener) {
      bot.on(event, listener)
      return () => bot.removeListener(event, listener)
    }
  }
}

function bind (skill, body, signal, memory) {
  const fail = (message, cause) => { throw failure(skill, message, cause) }
  const context = { ...body, ...untilAborted(body, signal, fail), fail }
  const act = async (...own) => {
    try {
      return await skill.run(context, ...(skill.check === undefined ? own : skill.check(context, ...own)))
    } catch (error) {
      if (error instanceof SkillError) throw error
      fail(error instanceof Error ? error.message : show(error), error)
    }
  }
  return async (...args) => {
    const own = ownOf(skill, { bot: body.bot, fail }, args)
    return memory === null ? act(...own) : memory.call(skill.name, own, act)
  }
}

/** Return the arguments of a call without the bot, which must be the caller's own. */
function ownOf (skill, { bot, fail }, args) {
  const place = skill.parameters.findIndex(({ name }) => name === 'bot')
  if (place !== -1 && args[place] !== bot) fail(`argument ${place + 1} of ${skill.signature} must be bot, your own bot`)
  return args.filter((_, index) => index !== place)
}

/**
 * Check a call of a skill without making it, as hosts without bots do.
 * @param {object} skill
 * @param {{bot: object, Vec3: Function}} body `bot` has `username`, `players` and `registry`
 * @param {Array} args arguments of the call
 * @returns {{own: Array, checked: Array}} the arguments without the bot, and what `run` gets
 * @throws {SkillError}
 */
function admitted (skill, body, args) {
  const context = { ...body, fail: message => { throw failure(skill, message) } }
  const own = ownOf(skill, context, args)
  return { own, checked: skill.check(context, ...own) }
}

const failure = (skill, message, cause) => new SkillError(skill.name, shortened(`${skill.name}: ${message}`, LONGEST_MESSAGE), cause)

const BY_NAME = new Map(SKILLS.map(skill => [skill.name, skill]))

module.exports = { BY_NAME, SKILLS, SkillError, admitted, bindSkills }
