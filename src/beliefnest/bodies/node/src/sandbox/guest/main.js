'use strict'
/**
 * Starts a program and takes what the host says to it afterwards.
 * Runs inside QuickJS: the function is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineMain (env) {
  const { config, describe, decode } = env
  const { parse, stringify } = JSON

  function start (program) {
    const scope = { ...env.skills, ...(env.data && { mcData: env.data }), Vec3: env.Vec3, goals: env.goals, Movements: env.Movements }
    scope.bot = decode({ $: 'h', id: config.bot, k: 'bot' })
    const parameters = config.parameters.map((name) => scope[name])
    return program(env.marks, ...parameters)
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
