'use strict'
/** The guest's Vec3 compared with the vec3 package, method by method. */
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Vec3, default: make = require('vec3') } = require('vec3')
const vm = require('node:vm')
const defineVec3 = require('../../src/sandbox/guest/vec3')

const env = {}
vm.runInThisContext(defineVec3)(env)
const Guest = env.Vec3

const POINTS = [[0, 0, 0], [1.5, -2.25, 3], [-7.1, 64, 0.3], [1e6, -0.5, 2 / 3]]
const ARGUMENTS = new Map(Object.entries({ set: [4, 5, 6], offset: [1, -2, 0.5], translate: [1, -2, 0.5], scaled: [2.5], scale: [2.5], at: [1] }))
const UNARY = new Set(['isZero', 'xz', 'xy', 'yz', 'xzy', 'rounded', 'round', 'floored', 'floor', 'abs', 'volume', 'toString', 'clone', 'norm', 'unit', 'normalize', 'toArray'])

const plain = value => typeof value === 'object' && !Array.isArray(value) ? { x: value.x, y: value.y, z: value.z } : value

describe('the guest\'s Vec3', () => {
  const methods = Object.getOwnPropertyNames(Vec3.prototype).filter(name => name !== 'constructor')
  for (const name of methods) {
    it(`has ${name}, which does the same`, () => {
      for (const first of POINTS) {
        for (const second of POINTS) {
          const outcome = Class => {
            const self = new Class(...first)
            const args = ARGUMENTS.get(name) ?? (UNARY.has(name) ? [] : [new Class(...second)])
            return { result: plain(self[name](...args)), self: plain(self) }
          }
          assert.deepEqual(outcome(Guest), outcome(Vec3))
        }
      }
    })
  }

  it('returns itself where the package does', () => {
    for (const name of methods) {
      const self = new Vec3(1, 2, 3)
      const args = () => ARGUMENTS.get(name) ?? (UNARY.has(name) ? [] : [new Vec3(4, 5, 6)])
      const guest = new Guest(1, 2, 3)
      assert.equal(guest[name](...args()) === guest, self[name](...args()) === self, name)
    }
  })

  it('can be called without new, with an array, an object or a text', () => {
    for (const args of [[], [1, 2, 3], ['1', '2', '3'], [[1, 2, 3]], [{ x: 1, y: 2, z: 3 }], ['(1, -2.5, 3)']]) {
      assert.deepEqual(plain(Guest(...args)), plain(make(...args)))
    }
    assert.throws(() => Guest('nothing'), /cannot parse/)
    assert.ok(Guest(1, 2, 3) instanceof Guest)
    assert.equal(new Guest(1, 2, 3).constructor, Guest)
  })
})
