'use strict'
const { show } = require('./arguments')
const { walkToUse } = require('./walking')
const { isUnseen, nameOf } = require('./known')
const { answered } = require('./answers')
const { until } = require('./waiting')

// A wooden button stays pressed for 30 ticks.
const PRESSED_TICKS = 40

const LEVER = { called: 'lever', is: name => name === 'lever' }
const DOOR = { called: 'door', is: name => /(_door|_trapdoor|_fence_gate)$/.test(name) }
const BUTTON = { called: 'button', is: name => name.endsWith('_button') }

/** Go to a lever and switch it on or off; do nothing if it is in that state already. */
async function switchLever (context, position, powered) {
  const { bot, fail } = context
  const block = await goTo(context, position, LEVER)
  if (block().getProperties().powered === powered) return
  await bot.activateBlock(block())
  await answered(context)
  if (block().getProperties().powered !== powered) fail(`the lever at ${show(position)} did not move. Go nearer and try again.`)
}

/** Go to a button and press it; if it is pressed already, first wait until it comes out. */
async function pressButton (context, position) {
  const { bot, fail } = context
  const block = await goTo(context, position, BUTTON)
  const pressed = () => block().getProperties().powered
  if (!await until(context, () => !pressed(), PRESSED_TICKS)) fail(`the button at ${show(position)} stays pressed. Try again later.`)
  let moved = false
  // Listen for the change: on a slow server the button may be out again before the answer arrives.
  const stop = context.listen(`blockUpdate:${position}`, () => { moved ||= pressed() })
  try {
    await bot.activateBlock(block())
    await answered(context)
  } finally {
    stop()
  }
  if (!moved) fail(`the button at ${show(position)} did not move. Go nearer and try again.`)
}

/** Go to a door, trapdoor or gate and open or shut it; do nothing if it is in that state already. */
async function useDoor (context, position, open) {
  const { bot, fail } = context
  const door = bot.blockAt(position)
  const name = door?.name ?? 'door'
  if (name.startsWith('iron_') && DOOR.is(name)) {
    if (door.getProperties().open === open) return
    fail(`the ${name} at ${show(position)} is not moved by hand. Use the lever, button or plate that powers it.`)
  }
  const block = await goTo(context, position, DOOR)
  if (block().getProperties().open === open) return
  await bot.activateBlock(block())
  await answered(context)
  if (block().getProperties().open !== open) fail(`the ${name} at ${show(position)} did not move. Go nearer and try again.`)
}

/** Walk to a switch. The returned `block()` looks the block up, and fails if it is no such switch any more. */
async function goTo (context, position, { called, is }) {
  const { bot, fail } = context
  const block = () => {
    const block = bot.blockAt(position)
    if (block === null || !is(block.name)) {
      fail(`there is no ${called} at ${show(position)}, but ${nameOf(bot, block)}. Give the position of a ${called}.`)
    }
    return block
  }
  if (!isUnseen(bot, position)) block()
  await walkToUse(context, position, `the ${called}`)
  return block
}

module.exports = { pressButton, switchLever, useDoor }
