'use strict'
/**
 * Start of a program, and dispatch of the host's messages to it.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineMain (env) {
  const { describe, decode } = env
  const { parse } = env

  let scope = []

  // Create the scope of programs, once for all programs that start from this context. The bot is the first game object
  // that the host names.
  function bind (scopeText) {
    const { parameters, skills, data } = parse(scopeText)
    const globals = { ...env.bindSkills(skills), Vec3: env.Vec3, goals: env.goals, Movements: env.Movements, ...env.claims }
    if (data) globals.mcData = env.bindData()
    globals.bot = decode({ $: 'h', id: 0, k: 'bot' })
    scope = parameters.map((name) => globals[name])
  }

  function start (program, marks) {
    return program(new Uint32Array(marks), ...scope)
  }

  const actions = {
    settle: (message) => env.settle(message[1], message[2], message[3]),
    invoke: (message) => env.invoke(message[1], message[2], message[3]),
    fire: (message) => env.fire(message[1])
  }

  function dispatch (text) {
    const message = parse(text)
    try {
      return '{"ok":true,"value":' + (actions[message[0]](message) ?? 'null') + '}'
    } catch (error) {
      return '{"ok":false,"value":' + describe(error) + '}'
    }
  }

  return { bind, start, dispatch, describe }
}
