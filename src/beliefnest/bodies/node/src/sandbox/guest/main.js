'use strict'
/**
 * Starts a program and takes what the host says to it afterwards.
 * Runs inside QuickJS: the function is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineMain (env) {
  const { describe, decode } = env
  const { parse, stringify } = JSON

  // The bot is the first object of the game that the host names.
  function start (program, scopeText, marks) {
    const { parameters, skills, data } = parse(scopeText)
    const scope = { ...env.bindSkills(skills), Vec3: env.Vec3, goals: env.goals, Movements: env.Movements }
    if (data) scope.mcData = env.bindData()
    scope.bot = decode({ $: 'h', id: 0, k: 'bot' })
    return program(new Uint32Array(marks), ...parameters.map((name) => scope[name]))
  }

  const actions = {
    settle: (id, ok, value) => env.settle(id, ok, value),
    invoke: (id, args, ticket) => env.invoke(id, args, ticket),
    fire: (id) => env.fire(id)
  }

  function dispatch (text) {
    const [action, ...args] = parse(text)
    try {
      return stringify({ ok: true, value: actions[action](...args) ?? null })
    } catch (error) {
      return stringify({ ok: false, value: describe(error) })
    }
  }

  return { start, dispatch, describe: (error) => stringify(describe(error)) }
}
