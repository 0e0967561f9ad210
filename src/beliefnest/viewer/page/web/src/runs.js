/** Numbers as short texts, and blocks of grids as such texts; see `../../runs.py`, which writes them. */

const BITS = 5
const MORE = 2 ** BITS
const UNKNOWN = 1
const FIRST_STATE = 2

const VALUES = new Uint8Array(128)
for (const [value, letter] of [...'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_'].entries()) VALUES[letter.charCodeAt(0)] = value

/** Reader of the numbers of a text, one after the other. */
class Numbers {
  constructor (text) {
    this.text = text
    this.at = 0
  }

  get isAtEnd () {
    return this.at >= this.text.length
  }

  next () {
    let value = 0
    for (let unit = 1; ; unit *= MORE) {
      const code = VALUES[this.text.charCodeAt(this.at++)]
      value += (code % MORE) * unit
      if (code < MORE) return value
    }
  }
}

/** Return the numbers of a text. @returns {number[]} */
export function numbersOf (text) {
  const numbers = new Numbers(text)
  const values = []
  while (!numbers.isAtEnd) values.push(numbers.next())
  return values
}

/**
 * Write the blocks that a text holds into a grid.
 * @param {Int16Array} grid
 * @param {string} text - runs, as Python's `runs_text` writes them
 * @param {Int16Array|null} first - the blocks that reality had at first
 */
export function putRuns (grid, text, first) {
  const numbers = new Numbers(text)
  let cell = 0
  while (!numbers.isAtEnd) {
    cell += numbers.next()
    const pair = numbers.next()
    const end = cell + (pair >> 1)
    if (pair % 2 === 0) grid.set(first.subarray(cell, end), cell)
    else {
      const mark = numbers.next() + 1
      grid.fill(mark === UNKNOWN ? -1 : mark - FIRST_STATE, cell, end)
    }
    cell = end
  }
}
