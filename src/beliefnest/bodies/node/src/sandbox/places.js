'use strict'
/** Places in a text: offsets, lines and columns (both from 1), each looked up in a table made once. */

const ENDS = /\r\n|[\n\r\u2028\u2029]/g

class Lines {
  /**
   * @param {string} text
   * @param {RegExp} [ends] what ends a line, a global expression
   */
  constructor (text, ends = ENDS) {
    this.starts = [0]
    for (const end of text.matchAll(ends)) this.starts.push(end.index + end[0].length)
  }

  get count () {
    return this.starts.length
  }

  /** @returns {{line: number, column: number}} */
  place (offset) {
    const line = lastAtMost(this.starts, offset) + 1
    return { line, column: offset - this.starts[line - 1] + 1 }
  }

  /** @returns {number} an offset, -1 if there is no such line */
  offset (line, column) {
    const start = this.starts[line - 1]
    return start === undefined ? -1 : start + column - 1
  }
}

/** A text with others inserted into it. */
class Insertions {
  /**
   * @param {string} text
   * @param {{at: number, text: string}[]} edits in the order of their places, no two at the same
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

  /** @returns {number} the offset in the original for one in the edited text; what was inserted stands for its place */
  original (offset) {
    const index = lastAtMost(this.places, offset)
    if (index < 0) return offset
    const { at, text } = this.edits[index]
    return Math.max(offset - this.before[index] - text.length, at)
  }
}

/** @returns {number} the index of the last of some rising numbers that is not above a number, -1 if all are */
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
