'use strict'
/**
 * Vec3 class of the guest: the interface of the vec3 package, computed inside the guest.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineVec3 (env) {
  const TEXT = /\((-?[.\d]+), (-?[.\d]+), (-?[.\d]+)\)/
  const modulo = (numerator, denominator) => {
    const result = numerator % denominator
    return result < 0 ? result + denominator : result
  }

  class Vector {
    constructor (x, y, z) {
      this.x = x
      this.y = y
      this.z = z
    }

    isZero () { return this.x === 0 && this.y === 0 && this.z === 0 }
    at (id) { return this.toArray()[id] }
    xz () { return [this.x, this.z] }
    xy () { return [this.x, this.y] }
    yz () { return [this.y, this.z] }
    xzy () { return new Vector(this.x, this.z, this.y) }
    toArray () { return [this.x, this.y, this.z] }
    toString () { return '(' + this.x + ', ' + this.y + ', ' + this.z + ')' }
    clone () { return new Vector(this.x, this.y, this.z) }
    map (f) { return new Vector(f(this.x), f(this.y), f(this.z)) }
    zip (other, f) { return new Vector(f(this.x, other.x), f(this.y, other.y), f(this.z, other.z)) }

    set (x, y, z) {
      this.x = x
      this.y = y
      this.z = z
      return this
    }

    update (other) { return this.set(other.x, other.y, other.z) }
    rounded () { return this.map(Math.round) }
    round () { return this.update(this.rounded()) }
    floored () { return this.map(Math.floor) }
    floor () { return this.update(this.floored()) }
    abs () { return this.map(Math.abs) }
    offset (dx, dy, dz) { return new Vector(this.x + dx, this.y + dy, this.z + dz) }
    translate (dx, dy, dz) { return this.update(this.offset(dx, dy, dz)) }
    plus (other) { return this.offset(other.x, other.y, other.z) }
    minus (other) { return this.offset(-other.x, -other.y, -other.z) }
    scaled (scalar) { return this.map((value) => value * scalar) }
    scale (scalar) { return this.update(this.scaled(scalar)) }
    add (other) { return this.update(this.plus(other)) }
    subtract (other) { return this.update(this.minus(other)) }
    multiply (other) { return this.update(this.zip(other, (a, b) => a * b)) }
    divide (other) { return this.update(this.zip(other, (a, b) => a / b)) }
    modulus (other) { return this.zip(other, modulo) }
    min (other) { return this.zip(other, Math.min) }
    max (other) { return this.zip(other, Math.max) }
    volume () { return this.x * this.y * this.z }
    dot (other) { return this.x * other.x + this.y * other.y + this.z * other.z }
    innerProduct (other) { return this.dot(other) }
    norm () { return Math.sqrt(this.dot(this)) }

    cross (other) {
      return new Vector(this.y * other.z - this.z * other.y, this.z * other.x - this.x * other.z,
        this.x * other.y - this.y * other.x)
    }

    unit () {
      const norm = this.norm()
      return norm === 0 ? this.clone() : this.scaled(1 / norm)
    }

    normalize () {
      const norm = this.norm()
      return norm === 0 ? this : this.update(this.zip({ x: norm, y: norm, z: norm }, (a, b) => a / b))
    }

    distanceSquared (other) {
      const dx = other.x - this.x
      const dy = other.y - this.y
      const dz = other.z - this.z
      return dx * dx + dy * dy + dz * dz
    }

    distanceTo (other) { return Math.sqrt(this.distanceSquared(other)) }
    xyDistanceTo (other) { return Math.sqrt((other.x - this.x) ** 2 + (other.y - this.y) ** 2) }
    xzDistanceTo (other) { return Math.sqrt((other.x - this.x) ** 2 + (other.z - this.z) ** 2) }
    yzDistanceTo (other) { return Math.sqrt((other.y - this.y) ** 2 + (other.z - this.z) ** 2) }

    manhattanDistanceTo (other) {
      return Math.abs(other.x - this.x) + Math.abs(other.y - this.y) + Math.abs(other.z - this.z)
    }

    equals (other, error = 0) {
      return Math.abs(this.x - other.x) <= error && Math.abs(this.y - other.y) <= error &&
        Math.abs(this.z - other.z) <= error
    }
  }

  function make (x, y, z) {
    if (x == null) return new Vector(0, 0, 0)
    if (Array.isArray(x)) return new Vector(parseFloat(x[0]), parseFloat(x[1]), parseFloat(x[2]))
    if (typeof x === 'object') return new Vector(parseFloat(x.x), parseFloat(x.y), parseFloat(x.z))
    if (typeof x !== 'string' || y != null) return new Vector(parseFloat(x), parseFloat(y), parseFloat(z))
    const match = x.match(TEXT)
    if (!match) throw new Error('vec3: cannot parse: ' + x)
    return new Vector(parseFloat(match[1]), parseFloat(match[2]), parseFloat(match[3]))
  }

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
