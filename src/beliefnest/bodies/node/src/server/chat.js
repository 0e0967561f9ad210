'use strict'
/** Chat among the players of a region. */
const nbt = require('prismarine-nbt')

module.exports.name = 'chat'

module.exports.server = serv => {
  serv._createChatComponent = text => {
    const component = nbt.comp({ text: nbt.string(text) })
    component.toNetworkFormat = () => component
    return component
  }
  serv._createNetworkEncodedChatComponent = text => serv._createChatComponent(text).toNetworkFormat()
  serv.broadcast = text => { for (const player of serv.players) player.system(text) }
}

module.exports.player = (player, serv) => {
  player.system = text => player._client.write('system_chat', {
    content: serv._createNetworkEncodedChatComponent(text),
    isActionBar: false
  })
  player.chat = player.system

  player._client.on('chat_message', ({ message }) => {
    serv.broadcast(`<${player.username}> ${message}`)
    serv.region.emit({ kind: 'chat', actor: player.agent, detail: { text: message } })
  })

  player._client.on('chat_command', ({ command }) => {
    player.system(`Agents have no commands: /${command.split(' ')[0]} was not run.`)
  })
}
