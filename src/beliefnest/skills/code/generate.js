'use strict'
/**
 * Writer of the generated texts about the skills. `node generate.js` writes docs/skills.md for people and
 * manifests.json for the Python side, both from the manifests.
 */
const fs = require('node:fs')
const path = require('node:path')
const { SKILLS } = require('./index')
const { LONGEST, LONGEST_WHISPER } = require('./lib/text')

const ROOT = path.join(__dirname, '..', '..', '..', '..')
const INTRODUCTION = `# Skills

Skills are functions that a program can call besides Mineflayer's own. Every skill does something that a player
could do, returns when it is done, and otherwise throws an error that says what was asked,
what was found and what to do; \`error.skill\` is its name. Positions are scenario
coordinates; 20 ticks are a second.

You can use, mine and place blocks within the reach of an arm (6 blocks from the eye) and with a free line from the eye
to the block; walls, and glass too, obstruct it. Skills that use a block first walk to where there is such a line.
The world records what agents do; skills do not report it. It records a gift when one agent has thrown something and
another one has picked it up within 240 ticks, and an arrival when an agent has walked and then stands still.

An utterance, thought or gesture is one line of at most ${LONGEST} characters, a whisper of ${LONGEST_WHISPER}; an agent can make at most 20 of them
in a tick. A longer text, or one with line breaks, control characters, the separators U+2028 and U+2029 or marks that
change the direction of text, is refused with an error.

This page is generated from the skills' own files by \`src/beliefnest/skills/code/generate.js\`.
`

function markdown ({ name, signature, description, parameters, example, fails, scripted, listed }) {
  const parts = [...new Set(parameters.flatMap(({ action }) => (Array.isArray(action) ? action : [])))]
  const notes = [
    ...(scripted ? ['Works in the [scripted world](scripted-world.md), too.'] : []),
    ...(listed === false ? ['Lists of skills in prompts leave it out.'] : []),
    ...(parts.length > 0 ? [`A [structured action](pettingzoo.md#actions) reads ${parts.map(part => `\`${part}\``).join(', ')}.`] : [])
  ]
  const rows = parameters.map(parameter => `| \`${parameter.name}\` | \`${parameter.type.replaceAll('|', '\\|')}\` | ${parameter.description} |`)
  return [
    `## ${name}`, '', `\`${signature}\``, '', description, '', '| argument | type | meaning |', '|---|---|---|', ...rows, '',
    `Fails: ${fails}.`, '', ...(notes.length > 0 ? [notes.join(' '), ''] : []), '```js', example, '```', ''
  ].join('\n')
}

/** Return the text of docs/skills.md. @returns {string} */
function documentation () {
  return [INTRODUCTION, ...SKILLS.map(markdown)].join('\n')
}

/** Return the text of manifests.json: the manifests without their code, one in each line. @returns {string} */
function manifest () {
  return `[\n${SKILLS.map(skill => JSON.stringify(skill)).join(',\n')}\n]\n`
}

const OUTPUTS = [
  { file: path.join(ROOT, 'docs', 'skills.md'), text: documentation },
  { file: path.join(__dirname, '..', 'manifests.json'), text: manifest }
]

if (require.main === module) OUTPUTS.forEach(({ file, text }) => fs.writeFileSync(file, text()))

module.exports = { OUTPUTS }
