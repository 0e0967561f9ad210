'use strict'
/**
 * What goes on in a region and no SNAPSHOT has: speed, countdowns, fires, which slot holds what.
 * Each plugin keeps its own part of it as plain rows, places in scenario coordinates, so that a
 * region made anew goes on as the one the rows were taken of.
 */
module.exports.server = (serv) => {
  const parts = []

  /**
   * Register a part.
   * @param {string} name of the part
   * @param {object} part `save(region)` gives rows, none for what is as in a region just made from a
   *   SNAPSHOT; `restore(rows, region)` makes a region so, whatever it was like before
   */
  serv.keeps = (name, part) => { parts.push([name, part]) }

  /** @returns {object} rows by part, only parts that have any */
  serv.internalState = (region) => Object.fromEntries(
    parts.map(([name, { save }]) => [name, save(region)]).filter(([, rows]) => rows.length > 0))

  /** Make what goes on in a region be as `serv.internalState` said. */
  serv.restoreState = (region, parted) => parts.forEach(([name, { restore }]) => restore(parted[name] ?? [], region))
}
