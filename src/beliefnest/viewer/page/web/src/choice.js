/** Selection of what the page shows. The address keeps it, so that every view has a link. */

const NUMBERS = new Set(['run', 'on', 'tick'])

export const DEFAULTS = { run: 0, on: 0, at: '/', beside: '/', tick: null, thing: null, sees: null, view: null, cut: null, note: null }

/** Return the selection that an address's hash encodes. @returns {object} */
export function readHash (hash, first = {}) {
  const values = Object.fromEntries(new URLSearchParams(hash.replace(/^#/, '')))
  const choice = { ...DEFAULTS, ...first }
  for (const name of Object.keys(DEFAULTS)) {
    if (values[name] === undefined) continue
    if (!NUMBERS.has(name)) choice[name] = values[name]
    else if (/^\d+$/.test(values[name])) choice[name] = Number(values[name])
  }
  return choice
}

export function hashOf (choice) {
  const entries = Object.entries(choice).filter(([name, value]) => value !== null && value !== DEFAULTS[name])
  return '#' + entries.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll('%2F', '/')}`).join('&')
}

/** Selection, its listeners, and the address that keeps it. */
export class Chooser {
  /**
   * @param {object} first - selection where the address says nothing
   */
  constructor (first) {
    this.choice = readHash(location.hash, first)
    this.listeners = []
    addEventListener('hashchange', () => {
      if (location.hash !== hashOf(this.choice)) this.set(readHash(location.hash, first))
    })
  }

  set (changes) {
    this.choice = { ...this.choice, ...changes }
    this.keepAddress()
    for (const listener of this.listeners) listener(this.choice, changes)
  }

  /** Write the address, at most ten times a second: browsers refuse more. */
  keepAddress () {
    if (this.waiting) return
    this.waiting = setTimeout(() => {
      this.waiting = null
      try {
        history.replaceState(null, '', hashOf(this.choice))
      } catch {
        // A frame without an address of its own cannot keep the selection.
        this.keepAddress = () => {}
      }
    }, 100)
  }
}
