'use strict'
require('../src/prepare').prepare()
const assert = require('node:assert/strict')
const { EventEmitter } = require('node:events')
const { test } = require('node:test')
const { Vec3 } = require('vec3')
const { Operator } = require('../src/remote/operator')
const { RemotePlace } = require('../src/remote/remotePlace')
const { ServerClock } = require('../src/remote/serverClock')
const { Witness } = require('../src/remote/witness')

/** Return a clock and the ticks it shows while the server sends its age at arbitrary times. */
function following (tellings) {
  let now = 0
  const clock = new ServerClock(() => now)
  const ages = []
  for (const [at, age] of tellings) {
    for (; now < at; now += 10) ages.push(clock.age)
    clock.tell(age)
    ages.push(clock.age)
  }
  return ages
}

const rises = ages => ages.every((age, index) => index === 0 || age >= ages[index - 1])

test('between tellings ticks are counted as fast as the server goes', () => {
  const slow = following([[0, 100], [2000, 120], [4000, 140], [6000, 160]])
  assert.ok(rises(slow))
  // In the last two seconds it counts the server's own 20 ticks of 100 ms each, and not 19 in the first one.
  const last = slow.slice(-200)
  assert.deepEqual([last[0], last[100], last.at(-1)], [140, 150, 160])
})

test('ticks never fall, whatever the server tells', () => {
  assert.ok(rises(following([[0, 100], [1000, 120], [1100, 140], [5000, 141], [5500, 3], [6500, 23], [6600, 43]])))
})

test('an age of 0 at a login is no jump', () => {
  const ages = following([[0, 100], [1000, 5000], [1500, 0], [1510, 5012], [2500, 5032]])
  assert.equal(ages.at(-1), 5032)
  assert.ok(rises(ages))
  assert.equal(following([[0, 5000], [500, 0], [510, 0], [520, 5012]]).at(-1), 5012)
  // A server that was set up anew stays at its low age.
  assert.ok(following([[0, 5000], [500, 3], [1500, 23], [2500, 43]]).at(-1) < 5100)
})

test('a server that tells nothing is waited for', () => {
  assert.equal(following([[0, 100], [1000, 120], [60_000, 120]]).at(-1), 139)
})

test('ticks that pass between two looks count as one for limits', () => {
  let now = 0
  const clock = new ServerClock(() => now)
  clock.tell(100)
  const before = clock.followed
  for (let age = 120; age <= 200; age += 20) {
    for (const end = now + 1000; now < end; now += 5) clock.look()
    clock.tell(age)
  }
  assert.equal(clock.followed - before, 100)
  // The process is stopped for a minute, and then reads what the server has sent meanwhile.
  for (let age = 220; age <= 1400; age += 20) clock.tell(age)
  assert.equal(clock.age, 1400)
  assert.equal(clock.followed - before, 101)
})

test('an answer that comes with the ticks of a stop is waited for', async () => {
  const clock = new ServerClock()
  const link = Object.assign(new EventEmitter(), { isHere: true, failure: null, closed: false })
  const operator = new Operator(link, { patience: 30 }, clock)
  clock.tell(100)
  let isAnswered = false
  const waiting = operator.until(() => isAnswered)
  // The age is read from one connection, and then the answer from another one.
  clock.tell(1000)
  setTimeout(() => { isAnswered = true }, 30)
  assert.ok(await waiting)
})

test('what the server says long after a stop is still the answer to an attempt before it', () => {
  let now = 0
  const clock = new ServerClock(() => now)
  clock.tell(100)
  const place = new RemotePlace({ name: '/', box: null, origin: { x: 0, z: 0 }, tick: 0, agentNames: [] }, clock)
  const witness = new Witness('sally', place, { serv: { players: [] } }, null)
  const chest = new Vec3(1, 2, 3)
  witness.use({ location: chest })
  clock.tell(1000)
  place.tick = place.now()
  assert.equal(place.tick, 900)
  assert.ok(witness.usesNow(chest))
  assert.ok(witness.hasTried('use', chest))
  witness.use({ location: chest })
  for (const end = now + 4000; now < end; now += 5) {
    if (now % 1000 === 0) clock.tell(1000 + now / 50)
    clock.look()
  }
  assert.ok(!witness.hasTried('use', chest))
})
