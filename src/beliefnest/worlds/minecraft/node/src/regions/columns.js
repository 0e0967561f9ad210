'use strict'
/** Blocks of a region in the server's world. */
const { Ground } = require('./ground')

/**
 * Give a region its blocks. The columns of the server's world are made when they are first needed.
 * @param {object} serv
 * @param {import('./region').Region} region
 * @param {import('./terrain').Terrain} terrain blocks of the box
 */
function buildColumns (serv, region, terrain) {
  region.ground = new Ground(serv, region, terrain)
  serv.grounds.add(region.ground)
  terrain.find(state => serv.containers.holds(state), (x, y, z) => serv.containers.stand(region.toServer([x, y, z])))
}

function dropColumns (serv, { ground }) {
  if (ground === null) return
  serv.grounds.delete(ground)
  for (const [x, z] of ground.made) serv.overworld.sync.unloadColumn(x, z)
}

module.exports = { buildColumns, dropColumns }
