'use strict'

const { ContainerStore } = require('./lib/containerStore')

/** `serv.containers`: what containers hold (see lib/containerStore.js). */
module.exports.server = (serv) => {
  serv.containers = new ContainerStore(serv)
  serv.onForget((within) => serv.containers.forget(within))

  /** A container that is broken by somebody spills; one that is replaced otherwise is gone. */
  serv.blocks.on('change', ({ position, before, after, player }) => {
    const names = [before, after].map((stateId) => serv.blocks.describe(stateId).name)
    const items = serv.containers.blockChanged(position, ...names)
    if (player) items.forEach((item) => serv.popItem(position, item))
  })
}
