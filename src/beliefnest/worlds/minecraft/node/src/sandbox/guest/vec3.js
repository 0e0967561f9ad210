'use strict'
/**
 * Vec3 class of the guest: that of the vec3 package.
 *
 * The function runs inside QuickJS: it is handed over as text, with the package's exports.
 */
const { vec3Text } = require('./vec3-text')

function defineVec3 (env, make) {
  const { Vec3: Vector } = make
  // Programs write both `new Vec3(x, y, z)` and `Vec3(x, y, z)`; the package allows both.
  function Vec3 (x, y, z) {
    return new.target ? Reflect.construct(Vector, [x, y, z], new.target) : make(x, y, z)
  }
  Vec3.prototype = Vector.prototype
  Vec3.Vec3 = Vec3
  Object.defineProperty(Vector.prototype, 'constructor', { value: Vec3, writable: true, configurable: true })
  env.Vec3 = Vec3
  env.vector = (x, y, z) => new Vector(x, y, z)
  env.isVector = (value) => value instanceof Vector
}

module.exports = `(env) => {
  const module = {};
  (() => { ${vec3Text} })();
  (${defineVec3})(env, module.exports)
}`
