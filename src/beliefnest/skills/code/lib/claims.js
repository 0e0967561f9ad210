'use strict'
const { item, position, show } = require('./arguments')

const STATE = /^(?:minecraft:)?([a-z0-9_]+)(?:\[([a-z0-9_]+=[a-z0-9_]+(?:,[a-z0-9_]+=[a-z0-9_]+)*)\])?$/
const NAME = /^\w{1,16}$/
const MOST = 16

const coordinates = ({ x, y, z }) => [x, y, z]
const blockPlace = (context, name, place) => coordinates(position(context, name, place).floored())

const FORMS = {
  located: (context, name, claim) => ({ item: item(context, `the item of ${name}`, claim.item).name, place: blockPlace(context, `the container of ${name}`, claim.place) }),
  absent: (context, name, claim) => FORMS.located(context, name, claim),
  position: (context, name, claim) => ({ agent: agentName(context, name, claim.agent), place: coordinates(position(context, `the place of ${name}`, claim.place)) }),
  block: (context, name, claim) => ({ state: blockState(context, name, claim.state), place: blockPlace(context, `the place of ${name}`, claim.place) })
}

function agentName ({ fail }, name, value) {
  if (typeof value !== 'string' || !NAME.test(value)) fail(`the agent of ${name} must be the name of an agent; it is ${show(value)}`)
  return value
}

function blockState ({ bot, fail }, name, value) {
  const [, block, properties] = (typeof value === 'string' && STATE.exec(value.replaceAll(' ', ''))) || []
  const entry = block !== undefined && Object.hasOwn(bot.registry.blocksByName, block) ? bot.registry.blocksByName[block] : undefined
  if (!entry) fail(`the block of ${name} must be a block, like "oak_door[open=true]"; it is ${show(value)}`)
  const chosen = properties ? properties.split(',').map(pair => pair.split('=')) : []
  for (const [key, word] of chosen) {
    const property = entry.states.find(state => state.name === key)
    if (!property) fail(`${block} has no property ${key}; it has ${entry.states.map(state => state.name).join(', ') || 'none'}`)
    const words = valuesOf(property)
    if (!words.includes(word)) fail(`${key} of ${block} is one of ${words.join(', ')}; ${name} says ${word}`)
  }
  return chosen.length === 0 ? block : `${block}[${chosen.map(pair => pair.join('=')).sort().join(',')}]`
}

function valuesOf ({ type, values, num_values: count }) {
  if (type === 'bool') return ['true', 'false']
  return values ?? Array.from({ length: count }, (_, number) => String(number))
}

/** Return claims as plain data: `{kind, place: [x, y, z], item | agent | state}`. @returns {object[]} */
function claims (context, value) {
  const list = value === undefined || value === null ? [] : value
  if (!Array.isArray(list) || list.length > MOST) {
    context.fail(`claims must be a list of at most ${MOST} claims, like [located("diamond", new Vec3(2, -51, -4))]; it is ${show(value)}`)
  }
  return list.map((claim, index) => {
    const name = `claims[${index}]`
    const kind = claim?.kind
    if (typeof kind !== 'string' || !Object.hasOwn(FORMS, kind)) {
      context.fail(`${name} must be made with located, absent, positionOf or blockAt; it is ${show(claim)}`)
    }
    return { kind, ...FORMS[kind](context, name, claim) }
  })
}

const MAKING = 'the facts that the text states: [located(item, containerPosition), absent(item, containerPosition), ' +
  'positionOf(name, position), blockAt(position, state)]; none if left out'

/** Parameter `claims` of a manifest. */
const PARAMETER = { name: 'claims', type: 'Claim[]', description: MAKING, default: '[]', action: ['phrase'] }

module.exports = { claims, PARAMETER }
