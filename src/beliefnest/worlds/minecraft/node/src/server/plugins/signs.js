'use strict'

const { EventEmitter } = require('events')
const { signFlawOf } = require('../../../../../../skills/code/lib/text')
const { byPlace, keyOf, listOf, vecOf } = require('./lib/positions')
const { signPacket } = require('./lib/signPacket')

/**
 * Add texts on the fronts of signs; backs stay empty. Lines are joined by line breaks, without empty ones at the end.
 *
 * `serv.signs.on('change', ({position, text, player}) => ...)` reports every change of a text whose sign stays. For a
 * changed block ask `serv.signs.get(position)`.
 */
module.exports.server = (serv) => {
  const texts = new Map()
  const signs = new EventEmitter()
  signs.setMaxListeners(0)

  const isSign = (name) => name.endsWith('_sign')

  const flawOf = (text) => signFlawOf(text) ?? (text.isWellFormed() ? null : 'must not have half a character')

  function put (position, text) {
    if (text === '') texts.delete(keyOf(position))
    else texts.set(keyOf(position), { position: vecOf(position), text })
    for (const player of serv.players) {
      if (player.hasColumn?.(position)) player.sendSign(position)
    }
  }

  /** Return the text of a sign; empty if nothing is written or no sign stands there. */
  signs.get = (position) => texts.get(keyOf(position))?.text ?? ''

  /** Write on a sign. @throws RangeError if there is none, or the text does not fit */
  signs.set = (position, text, player = null) => {
    const { name } = serv.blocks.at(position)
    if (!isSign(name)) throw new RangeError(`there is no sign, but ${name}`)
    const flaw = flawOf(text)
    if (flaw !== null) throw new RangeError(`the text ${flaw}`)
    if (signs.get(position) === text) return
    put(position, text)
    signs.emit('change', { position: vecOf(position), text, player })
  }

  /** Return the positions of signs with a text in a part of the world, in order. */
  signs.positions = (within) => [...texts.values()].map(({ position }) => position).filter(within)
    .sort((a, b) => byPlace(listOf(a), listOf(b)))

  serv.blocks.on('change', ({ position, before, after }) => {
    if (serv.blocks.describe(before).name !== serv.blocks.describe(after).name && signs.get(position) !== '') put(position, '')
  })
  serv.onForget((within) => signs.positions(within).forEach((position) => texts.delete(keyOf(position))))

  /** Let a player who uses a sign edit its text; the next update of that sign is written, once. */
  function edit ({ player, position }) {
    player.edits = keyOf(position)
    player._client.write('open_sign_entity', { location: position, isFrontText: true })
    return true
  }
  for (const { name } of serv.registry.blocksArray) {
    if (isSign(name)) serv.onInteraction(name, edit)
  }
  serv.blocks.on('update', ({ position, before, after, player }) => {
    if (player && isSign(serv.blocks.describe(after).name) && !isSign(serv.blocks.describe(before).name)) edit({ player, position })
  })

  signs.flawOf = flawOf
  serv.signs = signs
}

module.exports.player = (player, serv) => {
  player.edits = null

  player.sendSign = (position) => {
    player._client.write('tile_entity_data', signPacket(position, serv.blocks.at(position).name, serv.signs.get(position)))
  }

  /** Send a player the texts of its region's signs. */
  player.sendSigns = () => serv.signs.positions((position) => serv.region.contains(position)).forEach(player.sendSign)

  player._client.on('update_sign', ({ location, isFrontText, text1, text2, text3, text4 }) => {
    const position = vecOf(location)
    const mayWrite = player.edits === keyOf(position) && player.health > 0 && player.canUse(position)
    player.edits = null
    const text = [text1, text2, text3, text4].join('\n').replace(/\n+$/, '')
    if (!mayWrite || !isFrontText || !serv.blocks.at(position).name.endsWith('_sign') || serv.signs.flawOf(text) !== null) return
    serv.signs.set(position, text, player)
  })
  for (const end of ['rest', 'disconnected']) player.on(end, () => { player.edits = null })
}
