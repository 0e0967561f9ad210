'use strict'
const assert = require('node:assert/strict')
const { test } = require('node:test')
const { ServerClock } = require('../src/remote/serverClock')

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

test('a server that tells nothing is waited for', () => {
  assert.equal(following([[0, 100], [1000, 120], [60_000, 120]]).at(-1), 139)
})

test('time in which this process was stopped is not the silence of a server', () => {
  let now = 0
  const clock = new ServerClock(() => now)
  clock.tell(100)
  now = 60_000
  assert.ok(!clock.isSilentFor(5000))
  for (; now < 70_000; now += 100) clock.isSilentFor(5000)
  assert.ok(clock.isSilentFor(5000))
  clock.tell(120)
  assert.ok(!clock.isSilentFor(5000))
})
