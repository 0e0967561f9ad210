'use strict'

/** Return how many of an item the bot carries. */
const countOf = (bot, item) => bot.inventory.count(item.id, null)

/** Return the stack to take an item from; fail with a list of the inventory if there is none. */
function stackOf ({ bot, fail }, item) {
  const stack = bot.inventory.findInventoryItem(item.id, null, false)
  if (!stack) fail(`the inventory holds no ${item.name}; it holds: ${contents(bot)}. Get some first.`)
  return stack
}

function contents (bot) {
  const counts = new Map()
  for (const { name, count } of bot.inventory.items()) counts.set(name, (counts.get(name) ?? 0) + count)
  return [...counts].map(([name, count]) => `${count} ${name}`).join(', ') || 'nothing'
}

async function hold (context, item) {
  const { bot } = context
  if (bot.heldItem?.type === item.id) return
  await bot.equip(stackOf(context, item), 'hand')
}

module.exports = { countOf, stackOf, contents, hold }
