'use strict'
/** Positions in a text: offsets, lines and columns (both from 1), looked up in precomputed tables. */

const ENDS = /\r\n|[\n\r\u2028\u2029]/g

class Lines {
  /**
   * @param {string} text
   * @param {RegExp} [ends] global expression that matches line ends
   */
  constructor (text, ends = ENDS) {
    this.starts = [0]
    for (const end of text.matchAll(ends)) this.starts.push(end.index + end[0].length)
  }

  get count () {
    return this.starts.length
  }

  /** Return line and column of an offset. @returns {{line: number, column: number}} */
  place (offset) {
    const line = lastAtMost(this.starts, offset) + 1
    return { line, column: offset - this.starts[line - 1] + 1 }
  }

  /** Return the offset of a line and column; -1 if there is no such line. @returns {number} */
  offset (line, column) {
    const start = this.starts[line - 1]
    return start === undefined ? -1 : start + column - 1
  }
}

/** Text with insertions. */
class Insertions {
  /**
   * @param {string} text
   * @param {{at: number, text: string}[]} edits insertions in order of their offsets, no two at the same
   */
  constructor (text, edits) {
    const parts = []
    let from = 0
    let inserted = 0
    this.edits = edits
    this.before = []
    this.places = []
    for (const edit of edits) {
      parts.push(text.slice(from, edit.at), edit.text)
      from = edit.at
      this.before.push(inserted)
      this.places.push(edit.at + inserted)
      inserted += edit.text.length
    }
    this.text = parts.join('') + text.slice(from)
  }

  /**
   * Return the offset in the original for an offset in the edited text. Inserted text maps to the point of its
   * insertion.
   * @returns {number}
   */
  original (offset) {
    const index = lastAtMost(this.places, offset)
    if (index < 0) return offset
    const { at, text } = this.edits[index]
    return Math.max(offset - this.before[index] - text.length, at)
  }
}

/**
 * Return the index of the last of some ascending numbers that is not above a number; -1 if all are.
 * @returns {number}
 */
function lastAtMost (numbers, number) {
  let low = 0
  let high = numbers.length
  while (low < high) {
    const middle = (low + high) >> 1
    if (numbers[middle] <= number) low = middle + 1
    else high = middle
  }
  return low - 1
}

module.exports = { Lines, Insertions }
