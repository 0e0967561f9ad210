'use strict'

const nbt = require('prismarine-nbt')

const LINES = 4
/** Numbers of block entities in 1.20.4. */
const SIGN = 7
const HANGING_SIGN = 8

/** Return the packet `tile_entity_data` for the sign `name` at a position. */
function signPacket (position, name, text) {
  return { location: position, action: name.endsWith('hanging_sign') ? HANGING_SIGN : SIGN, nbtData: entityOf(text) }
}

/** Return the data of a sign in the form for clients. */
function entityOf (text) {
  const lines = text.split('\n')
  const side = (messages) => nbt.comp({
    has_glowing_text: nbt.byte(0),
    color: nbt.string('black'),
    messages: nbt.list(nbt.string(messages.map((line) => JSON.stringify(line)))),
  })
  const four = (lines) => Array.from({ length: LINES }, (_, i) => lines[i] ?? '')
  return nbt.comp({ is_waxed: nbt.byte(0), front_text: side(four(lines)), back_text: side(four([])) })
}

module.exports = { signPacket }
