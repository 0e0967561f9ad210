'use strict'
/** Driver of main.js over its real channel, as Python does it. */
const assert = require('node:assert/strict')
const { spawn } = require('node:child_process')
const path = require('node:path')
const { Channel } = require('../src/channel/channel')
const { Box, runsOf, statesOf } = require('../src/regions/box')

const MAIN = path.join(__dirname, '..', 'src', 'main.js')

class Node {
  constructor (main = MAIN, options = []) {
    this.child = spawn(process.execPath, [...options, main, '3', '4'], { stdio: ['ignore', 'pipe', 'pipe', 'pipe', 'pipe'] })
    this.errors = ''
    this.child.stderr.on('data', chunk => { this.errors += chunk })
    this.child.stdout.on('data', chunk => { this.errors += chunk })
    this.exited = new Promise(resolve => this.child.on('exit', (code, signal) => resolve({ code, signal })))
    this.frames = []
    this.beats = []
    this.waiting = null
    this.lastId = 0
    this.channel = new Channel(this.child.stdio[3], message => this.receive(message))
    this.exited.then(() => this.waiting?.reject(new Error(`Node ended: ${this.errors}`)))
    for (const descriptor of [3, 4]) this.child.stdio[descriptor].on('error', () => {})
  }

  receive (message) {
    if (message.frame) this.frames.push(message.frame)
    else if ('beat' in message) this.beats.push(message.beat)
    else if (message.ok) this.waiting.resolve(message.result)
    else this.waiting.reject(Object.assign(new Error(message.error.message), message.error))
  }

  /** Return the result of a request; reject with the error of its reply. @returns {Promise<any>} */
  request (op, args = {}) {
    return new Promise((resolve, reject) => {
      this.waiting = { resolve, reject }
      this.channel.send({ id: ++this.lastId, op, ...args })
    })
  }

  hello (seed = 0) {
    return this.request('hello', { protocol: 6, seed, minecraft: '1.20.4' })
  }

  /** End the process as the end of Python would. */
  async close () {
    this.child.stdio[4].destroy()
    this.child.stdio[3].destroy()
    return this.exited
  }
}

const STONE = 1
const BOX = [[-11, -52, -11], [11, -49, 11]]

/** Return the runs of a stone floor and the blocks in `extra` above it, as [x, y, z, state]. @returns {Uint8Array} */
function floor (extra = [], box = BOX) {
  const shape = [0, 1, 2].map(axis => box[1][axis] - box[0][axis] + 1)
  const states = new Int32Array(shape[0] * shape[1] * shape[2])
  const set = (x, y, z, state) => {
    states[((x - box[0][0]) * shape[1] + y - box[0][1]) * shape[2] + z - box[0][2]] = state
  }
  for (let x = box[0][0]; x <= box[1][0]; x++) {
    for (let z = box[0][2]; z <= box[1][2]; z++) set(x, box[0][1], z, STONE)
  }
  for (const [x, y, z, state] of extra) set(x, y, z, state)
  return runsOf(states)
}

/** Return the block states of a snapshot of a box that has them all. @returns {Int32Array} */
function statesIn (snapshot, box = BOX) {
  return statesOf(snapshot.blocks, new Box(...box))
}

/**
 * Return the SNAPSHOT of a region of a handler in this process, with all blocks that stand there in place of the changes.
 * @returns {Promise<object>}
 */
async function wholeSnapshot (handler, name) {
  const { changes, ...snapshot } = await handler.perform({ op: 'snapshot', region: name })
  const { serv } = handler.regions
  const region = handler.regions.get(name)
  const states = new Int32Array(region.box.size)
  region.box.forEach((x, y, z, index) => { states[index] = serv.overworld.sync.getBlockStateId(region.toServer([x, y, z])) })
  for (const [x, y, z, state] of changes) assert.equal(states[region.box.index(x, y, z)], state, 'a change is what stands there')
  return { ...snapshot, blocks: runsOf(states) }
}

function agent (position, more = {}) {
  return {
    position, yaw: 0, pitch: 0, on_ground: true, equipment: {}, inventory: {}, health: 20, food: 20, ...more
  }
}

const THREE = () => ({
  sally: agent([0.5, -51, 0.5]), anne: agent([-4.5, -51, 3.5]), observer: agent([0.5, -51, 8.5])
})

/** Return the arguments of create_region. @returns {object} */
function region (name, more = {}) {
  return {
    region: name, seed: name, box: BOX, tick: 0, blocks: floor(), containers: [], agents: THREE(), items: {}, internal_state: null, ...more
  }
}

module.exports = { agent, BOX, floor, MAIN, Node, region, statesIn, STONE, THREE, wholeSnapshot }
