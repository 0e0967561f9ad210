'use strict'
const { count: checkCount, item: checkItem, otherAgent } = require('./lib/arguments')
const { walkNear } = require('./lib/walking')
const { bodyOf } = require('./lib/others')
const { countOf, contents } = require('./lib/inventory')
const { ticks, until } = require('./lib/waiting')

const NEAR = 3
const TOO_NEAR = 1.5
const PICKUP_TICKS = 200
const CHEST_HEIGHT = 1

/**
 * Watch for items of one kind that drop nearby from now on, and count how many of them each player picks up.
 * @returns {{takenBy: Function, over: Function, stop: Function}} `takenBy(name)`: number of items that a player picked
 *   up; `over(number)`: true if at least so many were picked up; `stop()`: end the watch
 */
function watch ({ bot, listen }, item) {
  const { entity: own } = bot
  const lying = new Map()
  const taken = []
  const onDrop = entity => {
    const dropped = entity.getDroppedItem()
    if (dropped?.type === item.id && entity.position.distanceTo(own.position) < NEAR * 2) lying.set(entity.id, dropped.count)
  }
  const onCollect = (collector, { id }) => {
    if (!lying.has(id)) return
    taken.push({ by: collector.username, count: lying.get(id) })
    lying.delete(id)
  }
  const ends = [listen('itemDrop', onDrop), listen('playerCollect', onCollect)]
  const takenBy = name => taken.filter(({ by }) => by === name).reduce((sum, { count }) => sum + count, 0)
  const stop = () => ends.forEach(end => end())
  return { takenBy, stop, over: number => taken.reduce((sum, { count }) => sum + count, 0) >= number }
}

module.exports = {
  name: 'giveItemToOther',
  scripted: true,
  description: 'Go to another agent, toss the items to it, and wait until it has picked them up.',
  fails: 'you carry fewer items; the other agent is absent or not visible; there is no path to them; they picked up fewer items within 10 seconds',
  parameters: [
    { name: 'otherName', type: 'string', description: 'name of the agent that gets the items', aim: 'uses', action: ['agent'] },
    { name: 'item', type: 'string', description: 'name of the item', action: ['item'] },
    { name: 'num', type: 'number', description: 'how many; 1 if left out', action: ['count'] }
  ],
  example: 'await giveItemToOther(bot, "anne", "diamond", 1)',
  check: (context, otherName, item, num = 1) =>
    [otherAgent(context, 'otherName', otherName), checkItem(context, 'item', item), checkCount(context, 'num', num)],
  async run (context, otherName, item, wanted) {
    const { bot, fail } = context
    const body = bodyOf(context, 'otherName', otherName)
    if (countOf(bot, item) < wanted) fail(`cannot give ${wanted} ${item.name}: the inventory holds ${countOf(bot, item)} of them. It holds: ${contents(bot)}.`)
    await walkNear(context, body.position.clone(), NEAR, otherName)
    if (bot.entity.position.distanceTo(body.position) < TOO_NEAR) await stepBack(context, body)
    await bot.lookAt(body.position.offset(0, CHEST_HEIGHT, 0), true)
    // The server receives the new view direction one tick later. Wait for that, because it decides where the items fly.
    await ticks(context, 2)
    const watcher = watch(context, item)
    try {
      await bot.toss(item.id, null, wanted)
      await until(context, () => watcher.over(wanted), PICKUP_TICKS)
    } finally {
      watcher.stop()
    }
    const taken = watcher.takenBy(otherName)
    if (taken < wanted) fail(`${otherName} picked up ${taken} of the ${wanted} ${item.name} that were tossed. The rest lies on the ground, was taken by somebody else, or came back.`)
  }
}

/** Step back, so that the bot does not pick up the items that it tossed. */
async function stepBack (context, body) {
  const { bot } = context
  await bot.lookAt(body.position.offset(0, CHEST_HEIGHT, 0), true)
  bot.setControlState('back', true)
  await until(context, () => bot.entity.position.distanceTo(body.position) >= TOO_NEAR, 20)
  bot.setControlState('back', false)
}
