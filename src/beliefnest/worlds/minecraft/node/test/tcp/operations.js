'use strict'
/** Requests of tests to the server: making places and reading them. */

/**
 * Return the operations.
 * @param {import('./places').Places} places
 * @param {(serv: object, within: function) => object} everything
 * @returns {Object<string, function(object): any>} operations by name; positions are scenario coordinates
 */
function operations (places, everything) {
  const { serv } = places
  const at = (name, look) => {
    const place = places.get(name)
    return places.inside(place, () => look(place, position => place.region.contains(position)))
  }
  return {
    create: setting => places.create(setting),
    destroy: ({ place }) => places.destroy(place),
    pass: ({ place, ticks }) => places.pass(places.get(place), ticks),
    tick: ({ place }) => places.get(place).region.tick,
    events: ({ place }) => places.get(place).events,
    agent: ({ place, agent }) => places.agent(places.get(place), agent),
    container: ({ place, position }) => at(place, ({ region }) => serv.containers.get(region.toServer(position))),
    block: ({ place, position }) => at(place, ({ region }) => {
      const { name, properties } = serv.blocks.at(region.toServer(position))
      return { name, properties }
    }),
    blocks: ({ place, names }) => at(place, ({ region }) => countBlocks(serv, region, names)),
    everything: ({ place }) => at(place, (_, within) => everything(serv, within)),
    drop: ({ place, position, name, age }) => at(place, ({ region }) => {
      serv.dropItem(region.toServer(position), new serv.Item(serv.registry.itemsByName[name].id, 1)).born = region.tick - age
    })
  }
}

/** Return the number of blocks of some kinds in a region, by name. */
function countBlocks (serv, region, names) {
  const counts = {}
  region.box.forEach((x, y, z) => {
    const { name } = serv.blocks.at(region.toServer([x, y, z]))
    if (names.includes(name)) counts[name] = (counts[name] ?? 0) + 1
  })
  return counts
}

module.exports = { countBlocks, operations }
