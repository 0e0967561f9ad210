import { createRequire } from 'node:module'

const require = createRequire(import.meta.url)
const [, { rules }] = require('../../../worlds/minecraft/node/eslint.config.js')

const BROWSER = ['Blob', 'CSS', 'DecompressionStream', 'EventSource', 'FormData', 'ResizeObserver', 'Response', 'URLSearchParams', 'addEventListener', 'atob',
  'clearTimeout', 'devicePixelRatio', 'document', 'fetch', 'history', 'innerWidth', 'location', 'matchMedia', 'navigator', 'performance',
  'requestAnimationFrame', 'setTimeout']
const NODE = ['process']

export default [
  { ignores: ['node_modules/**'] },
  {
    files: ['**/*.js'],
    languageOptions: { ecmaVersion: 2024, sourceType: 'module' },
    linterOptions: { reportUnusedDisableDirectives: 'error' },
    // Modules are always in strict mode.
    rules: { ...rules, strict: 'off' }
  },
  { files: ['src/**/*.js'], languageOptions: { globals: Object.fromEntries(BROWSER.map(name => [name, 'readonly'])) } },
  { files: ['*.js'], languageOptions: { globals: Object.fromEntries(NODE.map(name => [name, 'readonly'])) } }
]
