'use strict'

/**
 * Return the count of all items by name: in containers, inventories, on cursors and on the ground.
 * @param {object} serv
 * @param {(position: Vec3) => boolean} within returns true for positions in the part of the world that counts
 * @returns {Object<string, number>}
 */
function everything (serv, within) {
  const total = {}
  const add = counts => Object.entries(counts).forEach(([name, count]) => {
    total[name] = (total[name] ?? 0) + count
  })
  serv.containers.positions(within).forEach(position => add(serv.containers.get(position)))
  serv.players.forEach(player => add(player.possessions().inventory))
  serv.itemEntities(within).forEach(({ item }) => add({ [item.name]: item.count }))
  return total
}

module.exports = { everything }
