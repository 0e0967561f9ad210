'use strict'
/** Chat among the players of a region. */
const nbt = require('prismarine-nbt')

// The text may contain anything: a text that cannot be said is refused, and not taken for another command.
const WHISPER = /^(?:tell|msg|w) (\S+) (.+)$/s

module.exports.name = 'chat'

module.exports.server = serv => {
  serv._createChatComponent = text => {
    const component = nbt.comp({ text: nbt.string(text) })
    component.toNetworkFormat = () => component
    return component
  }
  serv._createNetworkEncodedChatComponent = text => serv._createChatComponent(text).toNetworkFormat()
  /** Handle a line of a player that begins with a slash and is no whisper. */
  serv.command = (player, command) => player.system(`Agents have no commands: /${command.split(' ')[0]} was not run.`)
  /** Send the words of one player to all players. */
  serv.tellSaid = (speaker, text) => { for (const player of serv.players) player.system(text) }
}

module.exports.player = (player, serv) => {
  player.system = text => player._client.write('system_chat', {
    content: serv._createNetworkEncodedChatComponent(text),
    isActionBar: false
  })
  player.chat = player.system

  player._client.on('chat_message', ({ message }) => {
    player.utter(message)
    serv.tellSaid(player, `<${player.username}> ${message}`)
    serv.region.emit({ kind: 'chat', actor: player.agent, detail: { text: message } })
  })

  // Every player may whisper, operator or not.
  player._client.on('chat_command', ({ command }) => {
    const whispered = WHISPER.exec(command)
    if (whispered === null) serv.command(player, command)
    else whisper(player, serv, ...whispered.slice(1))
  })
}

function whisper (player, serv, name, message) {
  const other = player.getOtherPlayers().find(({ username }) => username === name)
  if (other === undefined) return player.system(`There is no other agent ${name} here.`)
  player.utter(message)
  player.system(`You whisper to ${name}: ${message}`)
  other.system(`${player.username} whispers to you: ${message}`)
  serv.region.emit({ kind: 'chat', actor: player.agent, detail: { text: message, to: other.agent } })
}
