'use strict'

/**
 * @param {object} serv
 * @param {(position: Vec3) => boolean} within which part of the world counts
 * @returns {Object<string, number>} name to count of all there is: in containers, inventories, on
 *   cursors and on the ground
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
