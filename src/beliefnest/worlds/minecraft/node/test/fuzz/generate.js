'use strict'
/** Random programs of skill calls, with sensible and senseless arguments. */
const { SKILLS } = require('../../../../../skills/code')

const AGENTS = ['sally', 'anne', 'bob']
const ITEMS = [
  'oak_log', 'oak_planks', 'stick', 'dirt', 'diamond', 'apple', 'bread', 'cobblestone', 'coal', 'raw_iron', 'iron_ingot', 'sand',
  'chest', 'crafting_table', 'furnace', 'wooden_pickaxe', 'stone_pickaxe', 'lever', 'torch', 'oak_door', 'red_bed', 'iron_helmet', 'glass'
]
const BLOCKS = ['dirt', 'oak_log', 'cobblestone', 'stone', 'chest', 'barrel', 'furnace', 'crafting_table', 'sand', 'glass', 'torch', 'lever', 'oak_door', 'red_bed', 'air']
const NONSENSE = [
  'NaN', '-1', '0', '1e9', '0.5', '""', '"constructor"', '"__proto__"', 'null', 'undefined', '{}', '[]', '() => { throw 1 }', 'bot', '"\\u{1F600}"',
  'new Vec3(NaN, 0, 0)', 'new Vec3(Infinity, -51, 0)', 'new Vec3(1e300, 0, 0)', 'new Vec3(40, -51, 40)', 'new Vec3(0, -53, 0)', '{ diamond: -1 }', '{ nothing: 1 }', 'true'
]

/** Return the generator of all random numbers here. */
function generator (seed) {
  let state = Math.imul(seed, 2654435761) >>> 0
  const below = n => {
    state = (Math.imul(state, 1103515245) + 12345) >>> 0
    return Math.floor(state / 65536) % n
  }
  return { below, pick: list => list[below(list.length)], chance: percent => below(100) < percent }
}

const vector = ([x, y, z]) => `new Vec3(${x}, ${y}, ${z})`

/** Arguments, besides bot, with which a skill can succeed. */
const SENSIBLE = {
  mineBlock: writer => [vector(writer.block(/./)), `"${writer.last}"`],
  givePlacedItemBack: writer => { const position = vector(writer.block(/chest|table|furnace|dirt|lever/)); return [`"${writer.last}"`, position] },
  getItemFromChest: writer => [vector(writer.block(/chest|barrel/)), `{ ${writer.random.pick(['apple', 'diamond', 'dirt', 'stick'])}: ${writer.few()} }`],
  depositItemIntoChest: writer => [vector(writer.block(/chest|barrel/)), `{ ${writer.own()}: ${writer.few()} }`],
  smeltItem: writer => [`"${writer.random.pick(['raw_iron', 'sand', 'cobblestone'])}"`, `"${writer.random.pick(['coal', 'oak_planks'])}"`, vector(writer.block(/^furnace|smoker/)), '1'],
  turnOnLever: writer => [vector(writer.block(/lever/))],
  turnOffLever: writer => [vector(writer.block(/lever/))],
  openDoor: writer => [vector(writer.block(/door/))],
  closeDoor: writer => [vector(writer.block(/door/))],
  sleep: writer => [vector(writer.block(/bed/)), String(writer.few())],
  craftItem: writer => [`"${writer.random.pick(['oak_planks', 'stick', 'chest', 'crafting_table', 'furnace', 'torch', 'lever'])}"`, vector(writer.block(/crafting_table/)), String(writer.few())],
  placeItem: writer => [`"${writer.own()}"`, writer.place()],
  giveItemToOther: writer => [`"${writer.random.pick(AGENTS)}"`, `"${writer.own()}"`, '1'],
  equip: writer => [`"${writer.own()}"`, `"${writer.random.pick(['hand', 'off-hand', 'head'])}"`],
  eat: writer => [`"${writer.random.pick(['bread', 'apple'])}"`]
}

class Writer {
  /**
   * @param {{below: function, pick: function, chance: function}} random
   * @param {[number, number, number, string][]} blocks useful targets
   * @param {string[]} items items of the program's agent
   */
  constructor (random, blocks, items) {
    this.random = random
    this.blocks = blocks
    this.items = items
    this.last = null
  }

  /** Return one of the blocks with a matching name; `last` becomes its name. */
  block (name) {
    const block = this.random.pick(this.blocks.filter(entry => name.test(entry[3])))
    this.last = block[3]
    return block
  }

  own () {
    return this.random.pick(this.items)
  }

  few () {
    return 1 + this.random.below(4)
  }

  place () {
    const { below, pick, chance } = this.random
    return vector(chance(60) ? pick(this.blocks) : [below(23) - 11, -51 + below(3) - below(2), below(23) - 11])
  }

  /** Return an argument for a parameter of a skill's manifest. */
  argument ({ name, type }) {
    const { below, pick, chance } = this.random
    if (name === 'bot') return chance(99) ? 'bot' : pick(NONSENSE)
    if (chance(12)) return pick(NONSENSE)
    const named = {
      name: () => `"${pick([...ITEMS, ...BLOCKS])}"`,
      // No logs: torches of charcoal have another worth than torches of coal.
      itemName: () => `"${pick(ITEMS.filter(item => item !== 'oak_log'))}"`,
      otherName: () => `"${pick(AGENTS)}"`,
      destination: () => `"${pick(['hand', 'off-hand', 'head', 'torso', 'legs', 'feet'])}"`,
      direction: () => `new Vec3(${below(3) - 1}, 0, ${below(3) - 1})`,
      entity: () => 'bot.entity',
      timeout: () => String(1 + below(3)),
      count: () => String(1 + below(chance(80) ? 4 : 70))
    }
    if (Object.hasOwn(named, name)) return named[name]()
    if (type.startsWith('Vec3')) return this.place()
    if (type.startsWith('{')) return `{ ${pick(ITEMS)}: ${1 + below(6)}, ${pick(ITEMS)}: ${1 + below(70)} }`
    if (type.startsWith('()')) return pick(['() => false', '() => bot.entity.position.x > 3', '() => bot.findBlock({ matching: mcData.blocksByName.chest.id })'])
    if (type === 'number') return String(1 + below(30))
    return `"${pick(ITEMS)}"`
  }

  call () {
    const { name, parameters } = this.random.pick(SKILLS)
    if (Object.hasOwn(SENSIBLE, name) && this.random.chance(75)) return `${name}(${['bot', ...SENSIBLE[name](this)].join(', ')})`
    return `${name}(${parameters.map(parameter => this.argument(parameter)).join(', ')})`
  }

  statement () {
    const { below, pick } = this.random
    const call = () => this.call()
    return pick([
      () => `await ${call()}`,
      () => `try { await ${call()} } catch {}`,
      () => `try { await ${call()} } catch {}`,
      () => `try { await ${call()} } catch {}`,
      () => `${call()}.catch(() => {})`,
      () => `await Promise.all([${call()}, ${call()}].map((promise) => promise.catch(() => {})))`,
      () => `await Promise.race([${call()}, waitTicks(bot, ${1 + below(40)})]).catch(() => {})`,
      () => `for (let i = 0; i < ${1 + below(4)}; i++) await ${call()}.catch(() => {})`,
      () => `setTimeout(() => { ${call()}.catch(() => {}) }, ${below(2000)})`,
      () => `bot.${pick(['clearControlStates()', 'setControlState("jump", true)', 'setControlState("forward", true)', 'chat("hello")', 'swingArm()', 'setQuickBarSlot(3)'])}`
    ])()
  }

  /** Return the text of a program. @returns {string} */
  program () {
    return Array.from({ length: 1 + this.random.below(6) }, () => this.statement()).join('\n')
  }
}

module.exports = { AGENTS, Writer, generator }
