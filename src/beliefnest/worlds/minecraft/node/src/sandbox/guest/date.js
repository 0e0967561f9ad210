'use strict'
/**
 * Date class with the program's own time. Its local time is UTC, because a real local time would depend on the
 * machine.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineDate (env) {
  const RealDate = Date
  class VirtualDate extends RealDate {
    constructor (...args) {
      if (args.length === 0) super(env.now())
      else if (args.length === 1) super(args[0])
      else super(RealDate.UTC(...args))
    }

    static now () { return env.now() }
    getTimezoneOffset () { return 0 }
    toString () { return this.toUTCString() }
  }
  for (const part of ['FullYear', 'Month', 'Date', 'Day', 'Hours', 'Minutes', 'Seconds', 'Milliseconds']) {
    for (const verb of ['get', 'set']) {
      const utc = RealDate.prototype[`${verb}UTC${part}`]
      if (utc) RealDate.prototype[verb + part] = utc
    }
  }
  RealDate.prototype.constructor = VirtualDate
  Object.defineProperty(VirtualDate, 'name', { value: 'Date' })
  globalThis.Date = VirtualDate
}
