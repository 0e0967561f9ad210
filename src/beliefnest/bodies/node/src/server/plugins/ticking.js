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
  let countdowns = []

  /** Register work done every tick: `ticker(within)`. */
  serv.onTick = (ticker) => { tickers.push(ticker) }

  /** Run `action` after `ticks` ticks of the place `position`; returns a cancel function. */
  serv.after = (ticks, position, action) => {
    const countdown = { left: ticks, position: position.clone(), action }
    countdowns.push(countdown)
    return () => { countdowns = countdowns.filter((other) => other !== countdown) }
  }

  function runCountdowns (within) {
    const due = []
    for (const countdown of countdowns) {
      if (within(countdown.position) && --countdown.left <= 0) due.push(countdown)
    }
    countdowns = countdowns.filter((countdown) => !due.includes(countdown))
    due.forEach((countdown) => countdown.action())
  }

  serv.tickRegion = (within) => {
    runCountdowns(within)
    tickers.forEach((ticker) => ticker(within))
  }

  /** Drops what plugins keep about a part of the world that is given up. */
  serv.forgetRegion = (within) => {
    countdowns = countdowns.filter((countdown) => !within(countdown.position))
    forgetters.forEach((forget) => forget(within))
  }

  /** Register what `serv.forgetRegion` calls. */
  serv.onForget = (forget) => { forgetters.push(forget) }
}
