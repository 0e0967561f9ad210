'use strict'
/** Events of `bot` that a program can listen to, with the types of the listener's arguments. */

const t = require('./types')

const entity = t.live('entity')
const window = t.live('window')
const player = t.record({ username: t.text, entity: t.maybe(entity) })
const position = t.maybe(t.vector)

/** Events about what an agent perceives otherwise than by sight (`announced` in `world/event_words.py`). */
const announced = {
  chat: [t.text, t.text],
  whisper: [t.text, t.text],
  messagestr: [t.text]
}

const events = {
  ...announced,
  health: [],
  breath: [],
  death: [],
  spawn: [],
  respawn: [],
  rain: [],
  time: [],
  move: [position],
  forcedMove: [],
  physicsTick: [],
  physicTick: [],
  sleep: [],
  wake: [],
  experience: [],
  playerJoined: [player],
  playerLeft: [player],
  playerCollect: [entity, entity],
  entitySpawn: [entity],
  entityGone: [entity],
  entityMoved: [entity],
  entityHurt: [entity],
  entityDead: [entity],
  entitySwingArm: [entity],
  entityCrouch: [entity],
  entityUncrouch: [entity],
  entityEquip: [entity],
  entitySleep: [entity],
  entityWake: [entity],
  itemDrop: [entity],
  blockUpdate: [t.maybe(t.block), t.maybe(t.block)],
  blockBreakProgressEnd: [t.maybe(t.block)],
  signOpen: [t.maybe(t.block)],
  diggingCompleted: [t.block],
  diggingAborted: [t.block],
  windowOpen: [window],
  windowClose: [window],
  heldItemChanged: [t.maybe(t.item)],
  usedFirework: [],
  goal_reached: [],
  goal_updated: [],
  path_stop: [],
  path_reset: [t.text],
  path_update: [t.record({ status: t.text, cost: t.number, visitedNodes: t.number })]
}

module.exports = { announced, events }
