'use strict'
/**
 * Internal state of a region: processes that its SNAPSHOT does not contain, such as speeds, countdowns, fires, and
 * which slot holds which item. Each plugin keeps its own part as plain rows with scenario coordinates, so that a
 * region that is created anew continues like the one whose rows were saved.
 */
module.exports.server = (serv) => {
  const parts = []

  /**
   * Register a part.
   * @param {string} name name of the part
   * @param {object} part `save(region)` returns rows for what differs from a region just created from a SNAPSHOT;
   *   `restore(rows, region)` restores the saved state, whatever the region's state was before
   */
  serv.keeps = (name, part) => { parts.push([name, part]) }

  /** Return rows by part, for parts that have any. @returns {object} */
  serv.internalState = (region) => Object.fromEntries(
    parts.map(([name, { save }]) => [name, save(region)]).filter(([, rows]) => rows.length > 0))

  /** Restore the internal state that `serv.internalState` returned. */
  serv.restoreState = (region, parted) => parts.forEach(([name, { restore }]) => restore(parted[name] ?? [], region))
}
