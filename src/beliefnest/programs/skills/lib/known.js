'use strict'
/**
 * What there is to say of places that a bot knows nothing of. The bot of a program that reads percepts alone has `perceived()`,
 * which resolves when what came of the present tick has been perceived.
 */

/** Whether what is in a place has to be found out by going there. */
const isUnseen = (bot, position) => bot.perceived !== undefined && bot.blockAt(position) === null

/** What is found in a place, for a message. */
const nameOf = (bot, block) => block?.name ?? (bot.perceived === undefined ? 'nothing that is loaded' : 'nothing that you know of')

module.exports = { isUnseen, nameOf }
