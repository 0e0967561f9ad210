'use strict'

const { ContainerStore } = require('./lib/containerStore')

/** Add `serv.containers`: contents of containers (see lib/containerStore.js). */
module.exports.server = (serv) => {
  serv.containers = new ContainerStore(serv)
  serv.onForget((within) => serv.containers.forget(within))
  serv.keeps('contents', {
    save: (region) => serv.containers.save(region),
    restore: (rows, region) => serv.containers.restore(rows, region),
  })

  /**
   * Spill the contents of a container that a player breaks; drop the contents of one that is replaced in another way.
   */
  serv.blocks.on('change', ({ position, before, after, player }) => {
    const blocks = [before, after].map((stateId) => serv.blocks.describe(stateId))
    const items = serv.containers.blockChanged(position, ...blocks)
    serv.containers.stand(position)
    if (player) items.forEach((item) => serv.popItem(position, item))
  })
}
