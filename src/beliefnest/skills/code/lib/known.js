'use strict'
/**
 * Positions of which a bot knows nothing. A bot of a program that reads only percepts has a method `perceived()`,
 * which resolves when the percepts of the present tick have arrived.
 */

/** Return true if the bot can learn only by going there which block is at a position. */
const isUnseen = (bot, position) => bot.perceived !== undefined && bot.blockAt(position) === null

/** Return the name of a block for a message, or words for an unknown block. */
const nameOf = (bot, block) => block?.name ?? (bot.perceived === undefined ? 'nothing that is loaded' : 'nothing that you know of')

module.exports = { isUnseen, nameOf }
