'use strict'
/** What an agent can utter at once: say, whisper, think, or call a gesture. */

const LONGEST = 256
// C0 and C1 controls (line breaks and ESC among them) and the two separators of lines that are none.
const CONTROLS = /[\u0000-\u001f\u007f-\u009f\u2028\u2029]/ // eslint-disable-line no-control-regex -- these are what is looked for

/**
 * @param {string} text
 * @param {number} [longest] in UTF-16 units, as the game counts
 * @returns {string | null} what the text would have to be instead; null if it can be uttered
 */
function flawOf (text, longest = LONGEST) {
  if (text.length > longest) return `must have at most ${longest} characters; it has ${text.length}. Say it in parts`
  const found = CONTROLS.exec(text)
  if (found === null) return null
  const code = found[0].charCodeAt(0).toString(16).toUpperCase().padStart(4, '0')
  return `must be one line without control characters; character ${found.index + 1} is U+${code}. Say lines one after the other`
}

module.exports = { LONGEST, flawOf }
