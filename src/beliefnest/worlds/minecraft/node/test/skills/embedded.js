'use strict'
/**
 * Worlds for the skills' tests in this process, under virtual time. Both kinds of worlds (the other kind is
 * ../tcp/world.js) offer these members, all to be awaited:
 *
 * `bots` by name; `isVirtual`, true if ticks are exact; `nextTick()`; `ticks(n)` lets sent packets arrive and n ticks
 * pass; `until(condition)`; `during(promise)` returns its outcome once time has passed; `tick()`; `events(...kinds)`
 * so far, without block updates unless named; `player(name)`, the channel's AGENT; `has(name)`, its inventory;
 * `container(x, y, z)`; `block(x, y, z)`, `{name, properties}`; `countBlocks(names)`; `everything()`, counts of all
 * items by name; `drop(position, name, age)`.
 */
const plugins = require('../plugins/harness')
const { agentState } = require('../../src/regions/facts')
const { countBlocks } = require('../tcp/operations')

async function inWorld (setting, body) {
  await plugins.inWorld(setting, world => body({ ...world, ...lookInto(world) }))
}

function lookInto ({ serv, region, frames, players, at, ticks }) {
  return {
    isVirtual: true,
    nextTick: () => ticks(1),
    tick: () => region.tick,
    events: (...kinds) => frames.flatMap(frame => frame.events)
      .filter(({ kind }) => kinds.length === 0 ? kind !== 'block_update' : kinds.includes(kind)),
    player: agent => agentState(region, players[agent]),
    countBlocks: names => countBlocks(serv, region, names),
    drop (position, name, age = 0) {
      serv.dropItem(at(...position), new serv.Item(serv.registry.itemsByName[name].id, 1)).born = region.tick - age
    }
  }
}

module.exports = { inWorld }
