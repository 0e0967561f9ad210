'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./harness')

const both = (inventory, blocks = [], annes = {}) => ({
  agents: { sally: agent([0.5, FLOOR, 0.5], { inventory }), anne: agent([8.5, FLOOR, -6.5], { inventory: annes }) }, blocks
})

/** Return the counts of items in events of gifts, by actor, other agent and item. */
function countsOf (events) {
  const total = {}
  for (const { actor, detail } of events) {
    for (const [name, count] of Object.entries(detail.items)) {
      const key = `${actor} ${detail.other} ${name}`
      total[key] = (total[key] ?? 0) + count
    }
  }
  return total
}

test('what is given is tossed, picked up and received', async () => {
  await withSkills(both({ diamond: 3 }), async world => {
    const { bots: { sally, anne }, skills } = world
    const before = await world.everything()
    await world.during(Promise.all([
      skills.sally.giveItemToOther(sally, 'anne', 'diamond', 2), skills.anne.receiveItemFromOther(anne, 'sally', 'diamond', 2)
    ]))
    await world.ticks(1)
    assert.deepEqual([await world.has('sally'), await world.has('anne')], [{ diamond: 1 }, { diamond: 2 }])
    assert.deepEqual(await world.everything(), before)
    // One event or two: both diamonds are picked up in one tick or in two.
    assert.deepEqual(countsOf(await world.events('give_item_to_other')), { 'sally anne diamond': 2 })
    assert.deepEqual(countsOf(await world.events('receive_item_from_other')), { 'anne sally diamond': 2 })
    assert.deepEqual(world.emitted, [])
  })
})

test('a gift whose program has ended is not watched any more', async () => {
  const abort = new AbortController()
  await withSkills({ ...both({ diamond: 3 }, [], { diamond: 36 * 64 }), signal: abort.signal }, async world => {
    const { bots: { sally, anne }, skills: { sally: own } } = world
    const listening = () => sally.listenerCount('itemDrop') + sally.listenerCount('playerCollect')
    const before = listening()
    const giving = own.giveItemToOther(sally, 'anne', 'diamond', 1)
    await world.until(() => listening() > before)
    abort.abort()
    await world.during(anne.toss(anne.registry.itemsByName.diamond.id, null, 1))
    await world.during(giving)
    assert.equal(listening(), before)
  })
})

test('a gift that is not picked up, and one that is not there', async () => {
  await withSkills(both({ diamond: 3 }, [], { dirt: 36 * 64 }), async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    assert.match((await failure(world, own.giveItemToOther(sally, 'anne', 'diamond', 4))).message, /cannot give 4 diamond: the inventory holds 3/)
    assert.match((await failure(world, own.giveItemToOther(sally, 'bob', 'diamond', 1))).message, /"bob". Agents here: anne/)
    assert.match((await failure(world, own.giveItemToOther(sally, 'anne', 'diamond', 1))).message, /anne picked up 0 of the 1 diamond/)
    assert.equal((await world.everything()).diamond, 3)
  })
})

test('who waits for a gift that does not come is told so', async () => {
  await withSkills(both({}), async world => {
    const { bots: { anne }, skills } = world
    const error = await failure(world, skills.anne.receiveItemFromOther(anne, 'sally', 'diamond', 1))
    assert.match(error.message, /0 of 1 diamond came from sally within 600 ticks/)
  })
})

test('follow stays near somebody who walks', async () => {
  await withSkills(both({}), async world => {
    const { bots: { sally, anne }, skills } = world
    await world.during(Promise.all([
      skills.sally.goToPosition(sally, new Vec3(-8, FLOOR, 8), 0), skills.anne.follow(anne, 'sally', world.isVirtual ? 160 : 600, 2)
    ]))
    assert.ok(sally.entity.position.floored().distanceTo(anne.entity.position.floored()) <= 3)
    assert.ok(anne.entity.position.distanceTo(new Vec3(-8, FLOOR, 8)) <= 5)
  })
})

test('follow fails behind a wall', async () => {
  const wall = [0, 1, 2].flatMap(up => Array.from({ length: 23 }, (_, i) => [i - 11, FLOOR + up, -3, 'stone']))
  await withSkills(both({}, wall), async world => {
    const { bots: { anne }, skills } = world
    assert.match((await failure(world, skills.anne.follow(anne, 'sally', 60, 2))).message, /sally is .* blocks away after 60 ticks/)
  })
})

const wallWith = (opening) => [0, 1, 2]
  .flatMap(up => Array.from({ length: 23 }, (_, i) => [i - 11, FLOOR + up, -3, 'stone']))
  .filter(([x, y]) => !(x === 4 && y < FLOOR + 2)).concat(opening)
const door = open => ['lower', 'upper'].map((half, up) => [4, FLOOR + up, -3, 'oak_door', { half, open, facing: 'north' }])
const gate = [[4, FLOOR, -3, 'oak_fence_gate', { open: false, facing: 'north' }]]

for (const [name, opening] of [['a shut door', door(false)], ['an open door', door(true)], ['a gate', gate]]) {
  test(`the way leads through ${name}, both ways`, async () => {
    await withSkills(both({}, wallWith(opening)), async world => {
      const { bots: { sally }, skills } = world
      await world.during(skills.sally.goToPosition(sally, new Vec3(4, FLOOR, -7), 0))
      assert.equal((await world.block(4, FLOOR, -3)).properties.open, true)
      await world.during(skills.sally.goToPosition(sally, new Vec3(0, FLOOR, 0), 0))
    })
  })
}

const iron = open => door(open).map(([x, y, z, , properties]) => [x, y, z, 'iron_door', properties])

test('an open iron door is gone through, and stays open', async () => {
  await withSkills(both({}, wallWith(iron(true))), async world => {
    const { bots: { sally }, skills } = world
    await world.during(skills.sally.goToPosition(sally, new Vec3(4, FLOOR, -7), 0, { openDoors: false, closeDoors: true }))
    assert.equal((await world.block(4, FLOOR, -3)).properties.open, true)
    assert.deepEqual(await world.events('use_door'), [])
  })
})

test('a door on the way is shut behind oneself on request, and not opened if that is not wanted', async () => {
  await withSkills(both({}, wallWith(door(false))), async world => {
    const { bots: { sally }, skills } = world
    const go = (z, doors) => skills.sally.goToPosition(sally, new Vec3(4, FLOOR, z), 0, doors)
    assert.match((await failure(world, go(-7, { openDoors: false }))).message, /no way to it on foot/)
    await world.during(go(-7, { closeDoors: true }))
    await world.during(go(0, { closeDoors: true }))
    assert.deepEqual((await world.events('use_door')).map(({ actor, detail }) => [actor, detail]), [true, false, true, false].map(open => [
      'sally', { position: [4, FLOOR, -3], open }]))
    assert.match((await failure(world, go(-7, { openDoor: true }))).message, /openDoors and closeDoors, each true or false.*it is "openDoor": true/)
    assert.match((await failure(world, go(-7, false))).message, /it is false/)
  })
})

const doorAt = (x, z, properties) => ['lower', 'upper'].map((half, up) => [x, FLOOR + up, z, 'oak_door', { half, facing: 'north', ...properties }])
const wallAt = z => [0, 1, 2].flatMap(up => Array.from({ length: 23 }, (_, i) => [i - 11, FLOOR + up, z, 'stone']))

test('one walk leads through two doors, wherever the target is seen from', async () => {
  for (const [first, open] of [[4, true], [-6, false]]) {
    await withSkills(both({}, [...wallAt(-3), ...doorAt(first, -3, { open }), ...wallAt(-6), ...doorAt(4, -6, { open })]), async world => {
      const { bots: { sally }, skills } = world
      await world.during(skills.sally.goToPosition(sally, new Vec3(4, FLOOR, -9), 0))
      assert.equal((await world.events('use_door')).length, open ? 0 : 2)
    })
  }
})

test('a doorway is stood in, and a room that leads nowhere not gone into', async () => {
  const cell = [[3, -5], [5, -5], [3, -4], [5, -4], [4, -6]].flatMap(([x, z]) => [0, 1, 2].map(up => [x, FLOOR + up, z, 'stone']))
  await withSkills(both({}, wallWith(door(false)).concat(cell)), async world => {
    const { bots: { sally }, skills } = world
    const go = z => skills.sally.goToPosition(sally, new Vec3(4, FLOOR, z), 0)
    assert.match((await failure(world, go(-9))).message, /no way to it on foot/)
    assert.deepEqual(await world.events('use_door'), [])
    for (const z of [-3, -5, -3, 2]) {
      await world.during(go(z))
      assert.equal(sally.entity.position.floored().z, z)
    }
  })
})

test('doors, trapdoors and gates are opened and shut once, iron ones not by hand', async () => {
  const trapdoor = [-4, FLOOR, 3, 'oak_trapdoor', { half: 'bottom', open: false }]
  const gate = [-6, FLOOR, 3, 'oak_fence_gate', { open: false, facing: 'north' }]
  await withSkills(both({}, [...door(false), ...iron(false).map(([x, ...rest]) => [x + 4, ...rest]), trapdoor, gate]), async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    for (const [place, named] of [[[4, FLOOR + 1, -3], [4, FLOOR, -3]], [trapdoor], [gate]].map(([at, lower]) => [at, lower ?? at.slice(0, 3)])) {
      const position = new Vec3(...place)
      for (const skill of ['openDoor', 'openDoor', 'closeDoor', 'closeDoor']) await world.during(own[skill](sally, position))
      assert.deepEqual((await world.events('use_door')).slice(-2).map(({ detail }) => detail), [true, false].map(open => ({ position: named, open })))
    }
    assert.equal((await world.events('use_door')).length, 6)
    const far = new Vec3(8, FLOOR, -3)
    assert.match((await failure(world, own.openDoor(sally, far))).message, /the iron_door at \(8, -51, -3\) is not moved by hand. Use the lever/)
    await world.during(own.closeDoor(sally, far))
    assert.match((await failure(world, own.openDoor(sally, new Vec3(0, FLOOR - 1, 3)))).message, /no door at \(0, -52, 3\), but stone/)
  })
})

test('walks of one agent that look for ways through doors at the same time take turns', async () => {
  const behind = door(false).map(([x, y, z, ...rest]) => [x, y, z - 2, ...rest])
  const boxed = [[3, -5], [5, -5], [4, -4], [4, -6]].flatMap(([x, z]) => [0, 1, 2].map(up => [x, FLOOR + up, z, 'stone']))
  await withSkills(both({}, [...wallWith([]), [4, FLOOR, -3, 'stone'], [4, FLOOR + 1, -3, 'stone'], ...boxed, ...behind]), async world => {
    const { bots: { sally }, skills } = world
    let [searches, most] = [0, 0]
    const { getPathFromTo } = sally.pathfinder
    sally.pathfinder.getPathFromTo = (...args) => {
      searches += 1
      return getPathFromTo(...args)
    }
    sally.on('physicsTick', () => { [searches, most] = [0, Math.max(most, searches)] })
    const walks = Array.from({ length: 6 }, () => skills.sally.goToPosition(sally, new Vec3(4, FLOOR, -9), 0).catch(error => error.message))
    const outcomes = await world.during(Promise.all(walks))
    assert.ok(outcomes.some(message => /no way to it on foot/.test(message)), String(outcomes))
    // The first search need not wait: both sides of one door.
    assert.ok(most > 0 && most <= 3, String(most))
  })
})

test('an iron door is not opened by hand', async () => {
  await withSkills(both({}, wallWith(iron(false))), async world => {
    const { bots: { sally }, skills } = world
    assert.match((await failure(world, skills.sally.goToPosition(sally, new Vec3(4, FLOOR, -7), 0))).message, /no way to it on foot/)
  })
})

test('exploreUntil stops at what it looks for, and gives null when it is not found', async () => {
  await withSkills(both({}, [[-9, FLOOR, 0, 'chest'], [9, FLOOR, 0, 'stone'], [9, FLOOR + 1, 0, 'stone']]), async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const near = name => () => sally.findBlock({ matching: sally.registry.blocksByName[name].id, maxDistance: 4 })
    const block = await world.during(own.exploreUntil(sally, new Vec3(-1, 0, 0), 20, near('chest')))
    assert.equal(block.name, 'chest')
    assert.equal(await world.during(own.exploreUntil(sally, new Vec3(0, 0, 1), 6, near('barrel'))), null)
    assert.match((await failure(world, own.exploreUntil(sally, new Vec3(0, 0, 1), 30, near('barrel')))).message, /could not reach .*further on/)
    assert.match((await failure(world, own.exploreUntil(sally, new Vec3(0, 1, 0), 5, near('chest')))).message, /on the level/)
    assert.match((await failure(world, own.exploreUntil(sally, new Vec3(1, 0, 0), 5, 'chest'))).message, /must be a function/)
  })
})

test('waiting for a number of ticks, a condition, and a mob', async () => {
  await withSkills(both({}), async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const start = await world.tick()
    await world.during(own.waitTicks(sally, 30))
    const passed = await world.tick() - start
    if (world.isVirtual) assert.ok(Math.abs(passed - 30) <= 1)
    else assert.ok(passed >= 29)
    let looks = 0
    assert.equal(await world.during(own.waitUntil(sally, () => ++looks > 20 && 'late')), 'late')
    assert.match((await failure(world, own.waitUntil(sally, () => false, 20))).message, /within 20 ticks/)
    await world.drop([9.5, FLOOR, 9.5], 'stone', 5980)
    await world.ticks(1)
    const item = Object.values(sally.entities).find(({ name }) => name === 'item')
    await world.during(own.waitForMobRemoved(sally, item, 5))
    const anne = sally.players.anne.entity
    assert.match((await failure(world, own.waitForMobRemoved(sally, anne, 1))).message, /still there after 1 seconds/)
  })
})

test('saying and looking', async () => {
  await withSkills(both({}), async world => {
    const { bots: { sally, anne }, skills: { sally: own } } = world
    const heard = []
    anne.on('chat', (name, text) => heard.push([name, text]))
    await world.during(own.say(sally, 'Hello'))
    await world.until(() => heard.length === 1)
    assert.deepEqual([heard, (await world.events('chat')).map(({ detail }) => detail)], [[['sally', 'Hello']], [{ text: 'Hello' }]])
    assert.match((await failure(world, own.say(sally, '/give me all'))).message, /slash/)
    assert.match((await failure(world, own.say(sally, 'x'.repeat(300)))).message, /256 characters; it has 300/)
    await world.during(own.lookAt(sally, new Vec3(10.5, FLOOR + 1.62, 0.5)))
    assert.ok(Math.abs((await world.player('sally')).yaw + Math.PI / 2) < 0.01)
  })
})

test('whispering reaches one, and is no command of operators', async () => {
  const three = { ...both({}).agents, bob: agent([-4.5, FLOOR, 0.5]) }
  await withSkills({ agents: three }, async world => {
    const { bots: { sally, anne, bob }, skills: { sally: own } } = world
    const heard = []
    for (const [name, bot] of Object.entries({ anne, bob })) {
      bot.on('whisper', (speaker, words) => heard.push([name, speaker, words]))
      bot.on('messagestr', () => heard.push([name]))
    }
    await world.during(own.whisper(sally, 'anne', 'It is in the left chest'))
    await world.ticks(1)
    assert.deepEqual(heard, [['anne', 'sally', 'It is in the left chest'], ['anne']])
    assert.deepEqual(await world.events('chat'), [
      { kind: 'chat', actor: 'sally', detail: { text: 'It is in the left chest', to: 'anne' } }
    ])
    assert.match((await failure(world, own.whisper(sally, 'carol', 'x'))).message, /"carol". Agents here: anne, bob/)
    assert.match((await failure(world, own.whisper(sally, 'sally', 'x'))).message, /another agent; it is "sally"/)
    assert.match((await failure(world, own.whisper(sally, 'anne', ' /op sally'))).message, /slash/)
    assert.match((await failure(world, own.whisper(sally, 'anne', 'a\nb'))).message, /one line/)
    assert.match((await failure(world, own.whisper(sally, 'anne', 'x'.repeat(231)))).message, /230 characters; it has 231/)
    await world.during(own.whisper(sally, 'anne', 'x'.repeat(230)))
    await world.ticks(1)
    assert.equal((await world.events('chat')).length, 2)
  })
})

test('who speaks tells beforehand what the words claim', async () => {
  await withSkills(both({}), async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    await world.during(own.say(sally, 'Here!', [{ kind: 'located', item: 'diamond', place: new Vec3(0.5, -50, 3.5) }]))
    await world.during(own.whisper(sally, 'anne', 'Open!', [{ kind: 'block', state: 'oak_door[open=true]', place: new Vec3(1, -51, 3) }]))
    assert.deepEqual(world.emitted, [
      { actor: 'sally', kind: 'claims', detail: { text: 'Here!', claims: [{ kind: 'located', item: 'diamond', place: [0, -50, 3] }] } },
      { actor: 'sally', kind: 'claims', detail: { text: 'Open!', to: 'anne', claims: [{ kind: 'block', state: 'oak_door[open=true]', place: [1, -51, 3] }] } }
    ])
    assert.match((await failure(world, own.say(sally, 'x', 'y'))).message, /must be a list/)
  })
})

test('a whisper to nobody, and commands, do nothing', async () => {
  await withSkills(both({}), async world => {
    const { bots: { sally } } = world
    const lines = []
    sally.on('messagestr', text => lines.push(text))
    for (const words of ['/tell carol x', '/tell sally x', '/tell anne', '/op sally', '/give sally diamond']) sally.chat(words)
    await world.ticks(2)
    assert.deepEqual(lines, [
      'There is no other agent carol here.', 'There is no other agent sally here.',
      ...['tell', 'op', 'give'].map(name => `Agents have no commands: /${name} was not run.`)
    ])
    assert.deepEqual(await world.events('chat'), [])
  })
})
