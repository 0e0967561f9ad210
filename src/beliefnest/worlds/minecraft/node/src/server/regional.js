'use strict'
/**
 * Server state by region. flying-squid keeps players and entities in lists of the whole server; here these lists are
 * those of the running region, so that no loop over "all players" can reach another region.
 */
const REGIONAL = ['players', 'entities', 'uuidToPlayer', 'entityMaxId']

/** Return the server state of a new region. @returns {object} */
function regionalState () {
  return { players: [], entities: {}, uuidToPlayer: {}, entityMaxId: 0 }
}

/** Redirect the regional properties of `serv` to those of `serv.region`. */
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
