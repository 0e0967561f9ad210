'use strict'

// The rules are those of the JavaScript of worlds; run it with the eslint of `viewer/page/web`.
const [, { rules }] = require('../../../worlds/minecraft/node/eslint.config.js')

const BROWSER = ['AbortSignal', 'Blob', 'DecompressionStream', 'Response', 'TextEncoder', 'URL', 'URLSearchParams', 'addEventListener', 'atob', 'clearTimeout', 'crypto',
  'document', 'fetch', 'localStorage', 'location', 'performance', 'removeEventListener', 'scrollTo', 'sessionStorage', 'setTimeout']

module.exports = [
  {
    files: ['**/*.js'],
    languageOptions: { ecmaVersion: 2024, sourceType: 'script', globals: Object.fromEntries(BROWSER.map(name => [name, 'readonly'])) },
    linterOptions: { reportUnusedDisableDirectives: 'error' },
    rules
  },
  {
    files: ['eslint.config.js'],
    languageOptions: { sourceType: 'commonjs' }
  },
  {
    // One function holds each file, so that it leaves one global name.
    files: ['plugin.js', 'session.js', 'runner.js'],
    rules: { 'max-lines-per-function': ['error', { max: 260, skipComments: true, skipBlankLines: true }] }
  }
]
