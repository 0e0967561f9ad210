'use strict'
/**
 * Language functions that the border needs, saved before a program can replace them. Messages to the host are composed
 * only with these functions, so that no setter, iterator or toJSON of the program takes part.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function definePrimordials (env) {
  const { stringify, parse } = JSON
  const { apply } = Reflect
  const { isFinite } = Number
  const { is, keys, defineProperty } = Object
  const { isArray } = Array
  const { map } = Array.prototype
  const { slice } = String.prototype
  const toText = String
  const toNumber = Number

  /** Return a Map or WeakMap with its own copies of the methods. */
  function own (collection) {
    for (const name of ['get', 'set', 'has', 'delete']) defineProperty(collection, name, { value: collection[name] })
    return collection
  }

  /** Return a text as JSON; other values are converted to text first. */
  function quote (value) {
    return stringify(toText(value))
  }

  /** Return the beginning of a text as JSON, as `quote` does. */
  function quoteSome (value) {
    return stringify(apply(slice, toText(value), [0, 20_000]))
  }

  /** Return the results of a function for each element. @returns {Array} */
  function each (list, change) {
    return apply(map, list, [(item) => change(item)])
  }

  Object.assign(env, { apply, each, is, isArray, isFinite, keys, own, parse, quote, quoteSome, toNumber, toText })
}
