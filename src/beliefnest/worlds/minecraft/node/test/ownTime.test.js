'use strict'
/** A process that gets no processor runs into no limit. */
const assert = require('node:assert/strict')
const { EventEmitter } = require('node:events')
const { after, before, test } = require('node:test')
const keepConnected = require('minecraft-protocol/src/client/keepalive')
const { keepAlive } = require('../src/live/keepAlive')
const { OwnTime } = require('../src/time/ownTime')
const { TimerQueue } = require('../src/time/timers')

const TURN_MS = 10
const real = { setTimeout, clearTimeout, setInterval, clearInterval }

/** A process with real time that the test moves: `run` lets its event loop turn, `stop` lets it get no processor. */
class Process {
  constructor () {
    this.time = 0
    const queue = this.queue = new TimerQueue(() => this.time)
    this.own = new OwnTime(() => this.time)
    const add = repeat => (callback, delay, ...args) => queue.add(callback, args, delay, repeat)
    const clear = timer => timer?.close()
    this.functions = { ...this.own.timers({ setTimeout: add(false), clearTimeout: clear }), setInterval: add(true), clearInterval: clear }
  }

  stop (ms) {
    this.time += ms
    this.turn()
  }

  run (ms) {
    for (const end = this.time + ms; this.time < end;) this.stop(TURN_MS)
  }

  turn () {
    this.own.now()
    for (let timer = this.queue.peek(); timer?.due <= this.time; timer = this.queue.peek()) {
      this.queue.pop()
      timer.active = false
      if (timer.repeat) this.queue.schedule(timer)
      timer.callback(...timer.args)
    }
  }
}

let ours
before(() => {
  ours = new Process()
  Object.assign(globalThis, ours.functions)
})
after(() => Object.assign(globalThis, real))

function connection () {
  const client = new EventEmitter()
  client.ended = 0
  client.end = () => { client.ended += 1; client.emit('end') }
  client.write = () => {}
  client.on('error', () => {})
  return client
}

test('own time is real time, except where the process was stopped', () => {
  const start = ours.own.now()
  ours.run(5000)
  assert.equal(ours.own.now() - start, 5000)
  ours.stop(60_000)
  assert.ok(ours.own.now() - start <= 5100)
})

test('a timeout waits for its whole delay of own time, and can be cleared at any moment', () => {
  const fired = []
  setTimeout(text => fired.push(text), 5000, 'first')
  const second = setTimeout(() => fired.push('second'), 5000)
  ours.stop(60_000)
  ours.run(4000)
  clearTimeout(second)
  assert.deepEqual(fired, [])
  ours.run(1000)
  assert.deepEqual(fired, ['first'])
})

test('a connection is not lost while its process is stopped, but by a silent server', () => {
  const client = connection()
  keepConnected(client, { checkTimeoutInterval: 30_000 })
  client.emit('keep_alive', { keepAliveId: 1 })
  ours.stop(600_000)
  assert.equal(client.ended, 0)
  ours.run(31_000)
  assert.equal(client.ended, 1)
})

test('a person is not disconnected while the process is stopped, but when their game is silent', () => {
  const client = connection()
  keepAlive(client, () => ours.own.now())
  ours.stop(600_000)
  ours.run(20_000)
  assert.equal(client.ended, 0)
  client.emit('keep_alive')
  ours.run(29_000)
  assert.equal(client.ended, 0)
  ours.run(10_000)
  assert.equal(client.ended, 1)
})
