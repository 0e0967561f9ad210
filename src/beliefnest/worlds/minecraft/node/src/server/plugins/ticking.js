'use strict'
/**
 * Add time for the plugins. No plugin owns a clock: the owner of time calls `serv.tickRegion(within)` once per tick of
 * 50 ms, where `within(position)` says to which part of the world the tick belongs. Each countdown therefore belongs
 * to a position, and stops while its part of the world does.
 */
module.exports.server = (serv) => {
  const tickers = []
  const forgetters = []
  const actions = new Map()
  let countdowns = []

  /** Register work for every tick: `ticker(within)`. */
  serv.onTick = (ticker) => { tickers.push(ticker) }

  /** Register an action for the end of a kind of countdown: `action(position)`. */
  serv.onDue = (kind, action) => actions.set(kind, action)

  /** Begin a countdown of `ticks` ticks at `position`. */
  serv.after = (ticks, position, kind) => countdowns.push({ left: ticks, position: position.clone(), kind })

  /** Return true if a countdown of a kind is running at a position. */
  serv.isDueAt = (position, kind) => countdowns.some((each) => each.kind === kind && each.position.equals(position))

  function runCountdowns (within) {
    const due = []
    for (const countdown of countdowns) {
      if (within(countdown.position) && --countdown.left <= 0) due.push(countdown)
    }
    countdowns = countdowns.filter((countdown) => !due.includes(countdown))
    due.forEach(({ kind, position }) => actions.get(kind)(position))
  }

  serv.tickRegion = (within) => {
    runCountdowns(within)
    tickers.forEach((ticker) => ticker(within))
  }

  const elsewhere = (within) => countdowns.filter(({ position }) => !within(position))

  serv.keeps('countdowns', {
    save: (region) => countdowns.filter(({ position }) => region.contains(position))
      .map(({ kind, position, left }) => [kind, ...region.toScenario(position), left]),
    restore (rows, region) {
      const restored = rows.map(([kind, x, y, z, left]) => ({ kind, position: region.toServer([x, y, z]), left }))
      countdowns = [...elsewhere((place) => region.contains(place)), ...restored]
    },
  })

  /** Drop all data of plugins about a part of the world that is given up. */
  serv.forgetRegion = (within) => {
    countdowns = elsewhere(within)
    forgetters.forEach((forget) => forget(within))
  }

  /** Register a function that `serv.forgetRegion` calls. */
  serv.onForget = (forget) => { forgetters.push(forget) }
}
