// Reads all that a program can. Before it stand `const gets = [...]`, the properties of any object of the game, and
// `const events = [...]`; after it `read(where)` writes what is found to the console, long values as a sum of theirs.
const every = []
for (let x = -1; x <= 10; x++) for (let y = -1; y <= 4; y++) for (let z = -1; z <= 7; z++) every.push(new Vec3(x, y, z))

function told (value, depth = 0) {
  if (value === null || typeof value !== 'object') return typeof value === 'function' ? 'a function' : String(value)
  if (depth > 4) return 'more'
  if (Array.isArray(value)) return value.map(each => told(each, depth + 1))
  const names = [...Object.keys(value), ...gets.filter(name => name in value)]
  return names.map(name => [name, told(value[name], depth + 1)])
}

function sumOf (value) {
  const text = JSON.stringify(told(value))
  let sum = 0
  for (let i = 0; i < text.length; i++) sum = (sum * 31 + text.charCodeAt(i)) | 0
  return [text.length, sum]
}

function looks () {
  const known = every.map(place => bot.blockAt(place)).filter(Boolean)
  return {
    blockAt: every.map(place => bot.blockAt(place)),
    findBlock: bot.findBlock({ matching: block => block.name !== 'stone', maxDistance: 64 }),
    findBlocks: bot.findBlocks({ matching: () => true, maxDistance: 64, count: 1000 }),
    blockAtCursor: [bot.blockAtCursor(64), bot.blockAtCursor(3)],
    canSeeBlock: known.map(block => bot.canSeeBlock(block)),
    canDigBlock: known.map(block => bot.canDigBlock(block)),
    digTime: known.map(block => bot.digTime(block)),
    entityAtCursor: bot.entityAtCursor(64),
    getControlState: bot.getControlState('forward'),
    isABed: known.map(block => bot.isABed(block)),
    recipesFor: bot.recipesFor(mcData.itemsByName.stick.id, null, 1, null).length,
    recipesAll: bot.recipesAll(mcData.itemsByName.stick.id, null, null).length,
    nearestEntity: bot.nearestEntity(),
    getEquipmentDestSlot: bot.getEquipmentDestSlot('hand'),
    random: Math.random(),
    time: Date.now()
  }
}

function read (where) {
  const all = looks()
  for (const name of gets) if (name in bot) all[name] = bot[name]
  for (const [name, value] of Object.entries(all)) console.log(JSON.stringify([where, name, sumOf(value)]))
  console.log(JSON.stringify([where, told(bot.players), told(bot.entities)]))
}

const happened = []
for (const event of events) {
  bot.on(event, (...values) => { if (happened.length < 100) happened.push([event, values.map(value => told(value, 3))]) })
}
