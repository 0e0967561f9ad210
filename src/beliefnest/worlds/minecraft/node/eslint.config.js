'use strict'

const NODE_GLOBALS = [
  'AbortController', 'AbortSignal', 'Buffer', 'BUNDLED', 'TextDecoder', 'TextEncoder', 'URL', 'WebAssembly', '__dirname',
  '__filename', 'clearImmediate', 'clearInterval', 'clearTimeout', 'console', 'exports', 'module', 'performance', 'process',
  'queueMicrotask', 'require', 'setImmediate', 'setInterval', 'setTimeout', 'structuredClone'
]

const rules = {
  // Errors under any style.
  'constructor-super': 'error',
  'for-direction': 'error',
  'getter-return': 'error',
  'no-async-promise-executor': 'error',
  'no-class-assign': 'error',
  'no-compare-neg-zero': 'error',
  'no-cond-assign': 'error',
  'no-const-assign': 'error',
  'no-debugger': 'error',
  'no-dupe-args': 'error',
  'no-dupe-class-members': 'error',
  'no-dupe-else-if': 'error',
  'no-dupe-keys': 'error',
  'no-duplicate-case': 'error',
  'no-empty': 'error',
  'no-empty-pattern': 'error',
  'no-fallthrough': 'error',
  'no-func-assign': 'error',
  'no-import-assign': 'error',
  'no-invalid-regexp': 'error',
  'no-loss-of-precision': 'error',
  'no-redeclare': 'error',
  'no-self-assign': 'error',
  'no-self-compare': 'error',
  'no-shadow-restricted-names': 'error',
  'no-sparse-arrays': 'error',
  'no-this-before-super': 'error',
  'no-undef': 'error',
  'no-unreachable': 'error',
  'no-unsafe-finally': 'error',
  'no-unsafe-negation': 'error',
  'no-unused-labels': 'error',
  'no-unused-vars': ['error', { ignoreRestSiblings: true }],
  'no-useless-catch': 'error',
  'no-useless-escape': 'error',
  'use-isnan': 'error',
  'valid-typeof': 'error',
  // Rules of this project.
  'id-denylist': ['error', 'found', 'told', 'held', 'known', 'given'],
  'eqeqeq': ['error', 'always', { null: 'ignore' }],
  'max-lines': ['error', { max: 500 }],
  'max-lines-per-function': ['error', { max: 60, skipComments: true, skipBlankLines: true }],
  'no-console': 'error',
  'no-eval': 'error',
  'no-implied-eval': 'error',
  'no-var': 'error',
  'prefer-const': 'error',
  'strict': ['error', 'global']
}

module.exports = [
  { ignores: ['node_modules/**'] },
  {
    files: ['**/*.js'],
    languageOptions: {
      ecmaVersion: 2024,
      sourceType: 'commonjs',
      globals: Object.fromEntries(NODE_GLOBALS.map(name => [name, 'readonly']))
    },
    linterOptions: { reportUnusedDisableDirectives: 'error' },
    rules
  },
  {
    // One function contains a whole guest module: the code that runs inside one sandbox guest.
    files: ['src/sandbox/guest/*.js'],
    rules: { 'max-lines-per-function': 'off' }
  },
  {
    // A describe or setup function contains many small tests.
    files: ['test/**/*.js'],
    rules: { 'max-lines-per-function': 'off' }
  }
]
