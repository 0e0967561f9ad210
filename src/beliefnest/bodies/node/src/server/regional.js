'use strict'
/**
 * Server state that belongs to a region. flying-squid keeps players and entities in lists of
 * the whole server; here these lists are those of the region whose code is running, so that
 * no loop over "all players" can reach another region.
 */
const REGIONAL = ['players', 'entities', 'uuidToPlayer', 'entityMaxId']

/** @returns {object} the server's state of one new region */
function regionalState () {
  return { players: [], entities: {}, uuidToPlayer: {}, entityMaxId: 0 }
}

/** Make the regional properties of `serv` those of `serv.region`. */
function makeRegional (serv) {
  serv.region = null
  const startUp = regionalState()
  for (const name of REGIONAL) {
    Object.defineProperty(serv, name, {
      enumerable: true,
      get: () => (serv.region === null ? startUp : serv.region.state)[name],
      set: value => { (serv.region === null ? startUp : serv.region.state)[name] = value }
    })
  }
}

module.exports = { makeRegional, regionalState }
