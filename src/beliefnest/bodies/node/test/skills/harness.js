'use strict'
/** Worlds of the plugins' tests, with the skills of every bot and what they emitted. */
const plugins = require('../plugins/harness')
const { goals } = require('mineflayer-pathfinder')
const { bindSkills } = require('../../../../programs/skills')

async function withSkills ({ signal, ...setting }, body) {
  await plugins.inWorld(setting, async world => {
    const emitted = []
    const skills = Object.fromEntries(Object.entries(world.bots).map(([name, bot]) => [name, bindSkills({
      bot, goals, Vec3: plugins.Vec3, signal, emit: event => emitted.push({ actor: name, ...event })
    })]))
    await body({ ...world, skills, emitted })
  })
}

/** What a promise is rejected with, once time has passed. */
async function failure (world, promise) {
  try {
    await world.during(promise)
  } catch (error) {
    return error
  }
  throw new Error('it did not fail')
}

module.exports = { ...plugins, withSkills, failure }
