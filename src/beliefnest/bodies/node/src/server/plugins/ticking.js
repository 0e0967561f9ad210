'use strict'
/**
 * Time for the plugins. Nothing here owns a clock: whoever owns time calls
 * `serv.tickRegion(within)` once per tick of 50 ms, where `within(position)` says which
 * part of the world that tick belongs to. Every countdown therefore belongs to a place,
 * and stands still while its place does.
 */
module.exports.server = (serv) => {
  const tickers = []
  const forgetters = []
  const actions = new Map()
  let countdowns = []

  /** Register work done every tick: `ticker(within)`. */
  serv.onTick = (ticker) => { tickers.push(ticker) }

  /** Register what happens when a countdown of a kind ends: `action(position)`. */
  serv.onDue = (kind, action) => actions.set(kind, action)

  /** Begin a countdown of `ticks` ticks of the place `position`. */
  serv.after = (ticks, position, kind) => countdowns.push({ left: ticks, position: position.clone(), kind })

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

  /** Drop what plugins keep about a part of the world that is given up. */
  serv.forgetRegion = (within) => {
    countdowns = elsewhere(within)
    forgetters.forEach((forget) => forget(within))
  }

  /** Register what `serv.forgetRegion` calls. */
  serv.onForget = (forget) => { forgetters.push(forget) }
}
