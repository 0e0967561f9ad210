'use strict'
/** Limits of texts: of one utterance (say, whisper, think or gesture) and of a sign. */

const LONGEST = 256
// Together with the longest name, this fits into one message of the game.
const LONGEST_WHISPER = 230
const SIGN_LINES = 4
const SIGN_LINE = 45
// C0 and C1 control characters (line breaks and ESC among them), the separators U+2028 and U+2029, and the marks that
// change the direction of the text around them; as `fault_of` in world/texts.py.
const CONTROLS = /[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/

/**
 * Return what is wrong with an utterance, as the end of a sentence.
 * @param {string} text
 * @param {number} [longest] in UTF-16 units, as the game counts
 * @returns {string | null} the requirement that the text breaks; null if the text can be uttered
 */
function flawOf (text, longest = LONGEST) {
  if (text.length > longest) return `must have at most ${longest} characters; it has ${text.length}. Say it in parts`
  const match = CONTROLS.exec(text)
  if (match === null) return null
  const code = match[0].charCodeAt(0).toString(16).toUpperCase().padStart(4, '0')
  return `must be one line without control characters; character ${match.index + 1} is U+${code}. Say lines one after the other`
}

/**
 * Return what is wrong with the text of a sign, as the end of a sentence; null if it can be written.
 * @returns {string | null}
 */
function signFlawOf (text) {
  const lines = text.split('\n')
  if (lines.length > SIGN_LINES) return `must have at most ${SIGN_LINES} lines; it has ${lines.length}. Use another sign`
  const long = lines.findIndex(line => line.length > SIGN_LINE)
  if (long >= 0) return `must have lines of at most ${SIGN_LINE} characters; line ${long + 1} has ${lines[long].length}. Break it with \\n`
  for (const line of lines) {
    const flaw = flawOf(line)
    if (flaw !== null) return flaw
  }
  return null
}

module.exports = { LONGEST, LONGEST_WHISPER, flawOf, signFlawOf }
