'use strict'
/**
 * What the border needs of the language, taken before a program can replace it. What leaves the guest is put
 * together from texts by these alone: no setter, iterator or toJSON of the program has a part in it.
 * Runs inside QuickJS: the function is handed over as text and must not refer to anything outside it.
 */
module.exports = function definePrimordials (env) {
  const { stringify, parse } = JSON
  const { apply } = Reflect
  const { isFinite } = Number
  const { is, keys, defineProperty } = Object
  const { isArray } = Array
  const { map } = Array.prototype
  const toText = String
  const toNumber = Number

  /** A Map or WeakMap with methods of its own. */
  function own (collection) {
    for (const name of ['get', 'set', 'has', 'delete']) defineProperty(collection, name, { value: collection[name] })
    return collection
  }

  /** JSON of a text; of anything that is none, JSON of what it is as a text. */
  function quote (value) {
    return stringify(toText(value))
  }

  /** @returns {Array} what a function makes of each element */
  function each (list, change) {
    return apply(map, list, [(item) => change(item)])
  }

  Object.assign(env, { apply, each, is, isArray, isFinite, keys, own, parse, quote, toNumber, toText })
}
