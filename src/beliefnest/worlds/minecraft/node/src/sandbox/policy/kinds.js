'use strict'
/**
 * Allow-list of everything that a program can see and do. Anything else does not exist for it. `get` and `set` are
 * properties. `call` lists methods with the types of arguments and result; a third element is the fuel for the host's
 * work if it exceeds `COST.call`: a number, or a function of the arguments.
 */

const t = require('./types')

// A message is expensive because it is perceived and recorded for ever.
const COST = { call: 10_000, message: 200_000, section: 5000, ray: 20_000, recipes: 50_000 }
const SECTION = 16
const ofSearch = ([{ maxDistance }]) => COST.section * (2 * Math.ceil(maxDistance / SECTION) + 1) ** 3

const entity = t.live('entity')
const window = t.live('window')
const destination = t.choice('hand', 'head', 'torso', 'legs', 'feet', 'off-hand')
const itemOrType = t.either(t.item, t.count)
const control = t.choice('forward', 'back', 'left', 'right', 'jump', 'sprint', 'sneak')
const time = t.record({ time: t.number, timeOfDay: t.number, day: t.number, isDay: t.boolean, moonPhase: t.number, age: t.number, doDaylightCycle: t.boolean })
const game = t.record({ gameMode: t.text, dimension: t.text, difficulty: t.text, minY: t.number, height: t.number })
const player = t.record({ username: t.text, entity: t.maybe(entity), ping: t.number, gamemode: t.number })
const recipe = t.live('recipe')
const part = t.record({ id: t.number, metadata: t.maybe(t.number), count: t.number })
const transferred = [t.count, t.maybe(t.count), t.maybe(t.count)]

const bot = {
  get: {
    username: t.text, version: t.text, entity, entities: t.dictionary(entity), players: t.dictionary(player),
    player: t.maybe(player), inventory: window, currentWindow: t.maybe(window), heldItem: t.maybe(t.item),
    quickBarSlot: t.number, health: t.number, food: t.number, foodSaturation: t.number, oxygenLevel: t.number,
    experience: t.record({ level: t.number, points: t.number, progress: t.number }), game, time,
    isSleeping: t.boolean, isRaining: t.boolean, usingHeldItem: t.boolean, targetDigBlock: t.maybe(t.block),
    spawnPoint: t.vector, controlState: t.dictionary(t.boolean), pathfinder: t.live('pathfinder')
  },
  call: {
    chat: [[t.chatText], t.nothing, COST.message],
    whisper: [[t.playerName, t.whisperText], t.nothing, COST.message],
    blockAt: [[t.vector], t.maybe(t.block), 0],
    findBlock: [[t.search], t.maybe(t.block), ofSearch],
    findBlocks: [[t.search], t.list(t.vector), ofSearch],
    blockAtCursor: [[t.maybe(t.within(0, 256))], t.maybe(t.block), COST.ray],
    canSeeBlock: [[t.block], t.boolean, COST.ray],
    canDigBlock: [[t.block], t.boolean, COST.ray],
    digTime: [[t.block], t.number],
    entityAtCursor: [[t.maybe(t.within(0, 256))], t.maybe(entity), COST.ray],
    dig: [[t.block, t.maybe(t.either(t.boolean, t.choice('ignore'))), t.maybe(t.either(t.choice('auto', 'raycast'), t.vector))], t.later(t.nothing)],
    stopDigging: [[], t.nothing],
    placeBlock: [[t.block, t.vector], t.later(t.nothing)],
    activateBlock: [[t.block, t.maybe(t.vector), t.maybe(t.vector)], t.later(t.nothing)],
    updateSign: [[t.block, t.signText], t.nothing, COST.message],
    activateEntity: [[entity], t.later(t.nothing)],
    activateItem: [[t.maybe(t.boolean)], t.nothing],
    deactivateItem: [[], t.nothing],
    useOn: [[entity], t.nothing],
    attack: [[entity], t.nothing],
    swingArm: [[t.maybe(t.choice('left', 'right'))], t.nothing],
    lookAt: [[t.vector, t.maybe(t.boolean)], t.later(t.nothing)],
    look: [[t.within(-1000, 1000), t.within(-1000, 1000), t.maybe(t.boolean)], t.later(t.nothing)],
    setControlState: [[control, t.boolean], t.nothing],
    getControlState: [[control], t.boolean],
    clearControlStates: [[], t.nothing],
    waitForTicks: [[t.ticks], t.later(t.nothing)],
    waitForChunksToLoad: [[], t.later(t.nothing)],
    equip: [[itemOrType, destination], t.later(t.nothing)],
    unequip: [[destination], t.later(t.nothing)],
    setQuickBarSlot: [[t.whole(0, 8)], t.nothing],
    toss: [transferred, t.later(t.nothing)],
    tossStack: [[t.item], t.later(t.nothing)],
    consume: [[], t.later(t.nothing)],
    sleep: [[t.block], t.later(t.nothing)],
    wake: [[], t.later(t.nothing)],
    isABed: [[t.block], t.boolean],
    openContainer: [[t.either(t.block, entity)], t.later(window)],
    openChest: [[t.either(t.block, entity)], t.later(window)],
    openDispenser: [[t.block], t.later(window)],
    openFurnace: [[t.block], t.later(window)],
    openBlock: [[t.block], t.later(window)],
    closeWindow: [[window], t.nothing],
    craft: [[recipe, t.maybe(t.whole(1, 1000)), t.maybe(t.block)], t.later(t.nothing)],
    recipesFor: [[t.count, t.maybe(t.count), t.maybe(t.count), t.maybe(t.either(t.block, t.boolean))], t.list(recipe), COST.recipes],
    recipesAll: [[t.count, t.maybe(t.count), t.maybe(t.either(t.block, t.boolean))], t.list(recipe), COST.recipes],
    nearestEntity: [[t.maybe(t.entityFilter)], t.maybe(entity)],
    getEquipmentDestSlot: [[destination], t.number]
  }
}

const kinds = {
  bot,
  entity: {
    get: {
      id: t.number, type: t.text, name: t.maybe(t.text), username: t.maybe(t.text), displayName: t.maybe(t.text), kind: t.maybe(t.text),
      position: t.vector, velocity: t.vector, yaw: t.number, pitch: t.number, height: t.number, width: t.number, eyeHeight: t.maybe(t.number),
      onGround: t.boolean, isValid: t.boolean, health: t.maybe(t.number), equipment: t.list(t.maybe(t.item)), heldItem: t.maybe(t.item), count: t.maybe(t.number)
    },
    call: { getDroppedItem: [[], t.maybe(t.item)] }
  },
  window: {
    get: {
      id: t.number, type: t.text, title: t.words, slots: t.list(t.maybe(t.item)), selectedItem: t.maybe(t.item),
      inventoryStart: t.number, inventoryEnd: t.number, hotbarStart: t.number, fuel: t.maybe(t.number),
      fuelSeconds: t.maybe(t.number), progress: t.maybe(t.number), progressSeconds: t.maybe(t.number)
    },
    call: {
      items: [[], t.list(t.item)],
      containerItems: [[], t.list(t.item)],
      count: [[t.either(t.count, t.text), t.maybe(t.count)], t.number],
      findInventoryItem: [[t.either(t.count, t.text), t.maybe(t.count), t.maybe(t.boolean)], t.maybe(t.item)],
      findContainerItem: [[t.either(t.count, t.text), t.maybe(t.count), t.maybe(t.boolean)], t.maybe(t.item)],
      emptySlotCount: [[], t.number],
      firstEmptyInventorySlot: [[t.maybe(t.boolean)], t.maybe(t.number)],
      firstEmptyContainerSlot: [[], t.maybe(t.number)],
      deposit: [transferred, t.later(t.nothing)],
      withdraw: [transferred, t.later(t.nothing)],
      close: [[], t.nothing],
      inputItem: [[], t.maybe(t.item)],
      fuelItem: [[], t.maybe(t.item)],
      outputItem: [[], t.maybe(t.item)],
      putInput: [transferred, t.later(t.nothing)],
      putFuel: [transferred, t.later(t.nothing)],
      takeInput: [[], t.later(t.maybe(t.item))],
      takeFuel: [[], t.later(t.maybe(t.item))],
      takeOutput: [[], t.later(t.maybe(t.item))]
    }
  },
  recipe: {
    get: { result: part, ingredients: t.maybe(t.list(part)), inShape: t.maybe(t.list(t.list(part))), delta: t.list(part), requiresTable: t.boolean },
    call: {}
  },
  pathfinder: {
    get: { thinkTimeout: t.number, tickTimeout: t.number, searchRadius: t.number, goal: t.nothing },
    set: { thinkTimeout: t.within(0, 10_000), tickTimeout: t.within(1, 50), searchRadius: t.within(-1, 1000) },
    call: {
      goto: [[t.goal], t.later(t.nothing)],
      setGoal: [[t.maybe(t.goal), t.maybe(t.boolean)], t.nothing],
      setMovements: [[t.movements], t.nothing],
      stop: [[], t.nothing],
      isMoving: [[], t.boolean],
      isMining: [[], t.boolean],
      isBuilding: [[], t.boolean],
      bestHarvestTool: [[t.block], t.maybe(t.item)]
    }
  }
}

/** Names of members by kind, from which the guest makes its classes. */
const kindNames = Object.fromEntries(Object.entries(kinds).map(([name, { get, set, call }]) =>
  [name, { gets: Object.keys(get), sets: Object.keys(set ?? {}), calls: Object.keys(call) }]))

/** Tables of minecraft-data that a program can read: `table` entry by entry, `value` as a whole. */
const tables = {
  blocks: 'table', blocksByName: 'table', blocksArray: 'value', blocksByStateId: 'table', items: 'table', itemsByName: 'table',
  itemsArray: 'value', foods: 'table', foodsByName: 'table', foodsArray: 'value', biomes: 'table', biomesByName: 'table',
  entities: 'table', entitiesByName: 'table', recipes: 'table', enchantments: 'table', enchantmentsByName: 'table',
  effects: 'table', effectsByName: 'table', materials: 'table', version: 'value'
}

module.exports = { COST, kinds, kindNames, tables }
