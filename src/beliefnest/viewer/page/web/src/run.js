/**
 * Run as Python exported it: timelines, and for each timeline tracks of simulators. A track consists of rows that
 * begin with a tick. Updates add rows; this module computes no beliefs.
 */

import { putRuns } from './runs.js'

export const UNKNOWN = 0
export const CURRENT = 1
export const STALE = 2

const MILLI = 1000
const MOST_GRIDS = 4

/** Width or depth in blocks from which the plan of a world shows the ground from above in place of one storey. */
const WIDE = 64

/** Return true if the world of a run is so wide that its plan shows the ground. @returns {boolean} */
export function isWide (run) {
  return Math.max(run.shape[0], run.shape[2]) >= WIDE
}

/** Return the index of the last row at or before a tick; -1 if there is none. @returns {number} */
export function rowIndex (rows, tick, tickOf = row => row[0]) {
  let low = 0
  let high = rows.length
  while (low < high) {
    const middle = (low + high) >> 1
    if (tickOf(rows[middle]) <= tick) low = middle + 1
    else high = middle
  }
  return low - 1
}

function rowAt (rows, tick) {
  return rows === undefined ? undefined : rows[rowIndex(rows, tick)]
}

function put (list, [first, rows]) {
  list.length = first
  for (const row of rows) list.push(row)
}

/** Poses of one agent in the world of a timeline. */
class Stand {
  constructor () {
    this.ticks = []
    this.poses = []
  }

  put (columns) {
    this.ticks.length = this.poses.length = columns.from
    const gone = new Set(columns.gone)
    const sum = { t: 0, x: 0, y: 0, z: 0, yaw: 0, pitch: 0 }
    for (let row = 0; row < columns.t.length; row++) {
      for (const name of Object.keys(sum)) sum[name] += columns[name][row]
      this.ticks.push(sum.t)
      this.poses.push(gone.has(row) ? null : poseOf([sum.x, sum.y, sum.z, sum.yaw, sum.pitch]))
    }
  }

  at (tick) {
    return this.poses[rowIndex(this.ticks, tick, each => each)] ?? null
  }
}

function poseOf ([x, y, z, yaw, pitch]) {
  return { x: x / MILLI, y: y / MILLI, z: z / MILLI, yaw: yaw / MILLI, pitch: pitch / MILLI }
}

/** Content of one simulator over the ticks of one timeline. */
class Track {
  constructor (timeline, path) {
    this.timeline = timeline
    this.path = path
    this.agents = path === '/' ? [] : path.slice(1).split('/')
    this.lists = {}
    this.beginning = null
    this.heard = new Set()
    this.cursor = null
  }

  put (update) {
    for (const [name, rows] of Object.entries(update)) {
      if (name === 'grid') this.beginning = rows
      else put(this.lists[name] ??= [], rows)
    }
    if (update.heard !== undefined) this.heard = new Set(this.lists.heard)
    if (update.grid !== undefined || update.blocks?.[0] < this.cursor?.done) this.cursor = null
  }

  list (name) {
    return this.lists[name] ?? []
  }

  /** Return numbers of block states; -1 is unknown. The next call may overwrite the array. @returns {Int16Array} */
  grid (tick) {
    if (this.beginning === null) return new Int16Array(0)
    const rows = this.list('blocks')
    const wanted = rowIndex(rows, tick) + 1
    if (this.cursor === null || this.cursor.done > wanted) {
      this.cursor = { grid: this.firstGrid(), done: 0 }
    }
    const first = this.timeline.firstGrid
    for (; this.cursor.done < wanted; this.cursor.done++) putRuns(this.cursor.grid, rows[this.cursor.done][1], first)
    this.timeline.run.keepGrids(this)
    return this.cursor.grid
  }

  /** Return a new array with the blocks at the beginning. */
  firstGrid () {
    const isOwn = this.path === this.timeline.facts.path
    const grid = isOwn ? new Int16Array(this.timeline.run.cells).fill(-1) : this.timeline.firstGrid.slice()
    putRuns(grid, this.beginning, isOwn ? null : this.timeline.firstGrid)
    return grid
  }

  /** Return a text that stays the same as long as no block changes. @returns {string} */
  gridVersion (tick) {
    return `${this.timeline.number} ${this.path} ${rowIndex(this.list('blocks'), tick)} ${this.list('blocks').length}`
  }

  /** Return the believed pose of an agent; null if it is unknown. @returns {object|null} */
  agent (number, tick) {
    const row = rowAt(this.list(`agents ${number}`), tick)
    if (row === undefined || row[1] === UNKNOWN) return null
    if (row[1] === CURRENT) {
      const pose = this.timeline.stand(number, tick)
      return pose && { ...pose, current: true, seenAt: tick, source: 'seen', holds: this.timeline.holds(number, tick) }
    }
    if (row[1] === STALE) {
      const pose = this.timeline.stand(number, row[2])
      return pose && { ...pose, current: false, seenAt: row[2], source: 'seen', holds: this.timeline.holds(number, row[2]) }
    }
    const [, , seenAt, pose, source, current, holds, speaker] = row
    return { ...poseOf(pose), current, seenAt: current ? tick : seenAt, source, holds, speaker }
  }

  /**
   * Return [items, complete]: the items that an agent is believed to have, and whether they are all.
   * @returns {Array}
   */
  owned (number, tick) {
    const row = rowAt(this.list(`owns ${number}`), tick)
    return row === undefined ? [{}, false] : [row[1], row[2]]
  }

  /** Return the cells of containers whose contents are known at any tick. @returns {number[]} */
  cells () {
    const names = Object.keys(this.lists).filter(name => name.startsWith('contents '))
    return names.map(name => Number(name.slice(9))).sort((a, b) => a - b)
  }

  contents (cell, tick) {
    const row = rowAt(this.list(`contents ${cell}`), tick)
    if (row === undefined || row[1] === null) return null
    const [, items, complete, current, seenAt, source, event, speaker] = row
    return { items, complete, current, seenAt: current ? tick : seenAt, source, event, speaker }
  }

  /**
   * Return the verdict on a claim: `believed`, and the deciding `condition` of the semantics; null if the simulator's
   * agent did not hear it or the run has no verdict.
   * @returns {object|null}
   */
  verdict (event, claim) {
    const row = this.list('claims').find(each => each[0] === event && each[1] === claim)
    return row === undefined ? null : { believed: row[2], condition: row[3] }
  }

  /** Return the keys of the false beliefs at a tick, such as "container-12": see `wrong.py`. @returns {string[]} */
  wrong (tick) {
    return rowAt(this.list('wrong'), tick)?.[1] ?? []
  }

  /** Return the dropped items by number. @returns {Map} */
  items (tick) {
    const lying = new Map()
    for (const [when, number, item] of this.list('items')) {
      if (when > tick) break
      if (item === null) lying.delete(number)
      else lying.set(number, item)
    }
    return lying
  }
}

/** Timeline: facts about it, its events, poses of agents in its world, tracks. */
class Timeline {
  constructor (run, number) {
    this.run = run
    this.number = number
    this.facts = {}
    this.events = []
    this.stands = []
    this.tracks = new Map()
  }

  put (update) {
    if (update.facts !== undefined) this.facts = update.facts
    if (update.events !== undefined) put(this.events, update.events)
    for (const [number, columns] of Object.entries(update.poses ?? {})) (this.stands[number] ??= new Stand()).put(columns)
    for (const [path, rows] of Object.entries(update.tracks ?? {})) {
      if (!this.tracks.has(path)) this.tracks.set(path, new Track(this, path))
      this.tracks.get(path).put(rows)
    }
  }

  /** Blocks of the timeline's own simulator at the beginning, to which texts of blocks refer. */
  get firstGrid () {
    this.first ??= this.track(this.facts.path).firstGrid()
    return this.first
  }

  get name () {
    return this.facts.path === '/' ? 'real world' : `${this.facts.path} on “${this.facts.branch}”`
  }

  get base () {
    return this.facts.base === null ? null : this.run.timelines[this.facts.base.timeline]
  }

  /**
   * Return the pose of an agent in the world of this timeline, or in the world of its base before this timeline began.
   */
  stand (agent, tick) {
    if (tick < this.facts.start && this.base) return this.base.stand(agent, tick)
    return this.stands[agent]?.at(tick) ?? null
  }

  holds (agent, tick) {
    if (tick < this.facts.start && this.base) return this.base.holds(agent, tick)
    return rowAt(this.tracks.get(this.facts.path)?.list(`holds ${agent}`), tick)?.[1] ?? null
  }

  track (path) {
    return this.tracks.get(path)
  }
}

/** Return kind (agent, block, container, inventory) and number of a thing such as "agent-1". @returns {{kind: string, number: number}} */
export function partsOf (thing) {
  const [kind, number] = thing.split('-')
  return { kind, number: Number(number) }
}

/** Run of a scenario, with all its timelines. */
export class Run {
  constructor () {
    this.head = null
    this.states = []
    this.programs = []
    this.prompts = []
    this.timelines = []
    this.ahead = { explanations: {}, looks: {}, sights: {}, views: [] }
    this.episode = null
    this.shownTracks = []
  }

  /** Forget the grids of all but the tracks that were shown last; in a large world each takes megabytes. */
  keepGrids (track) {
    if (this.shownTracks.at(-1) === track) return
    this.shownTracks = [...this.shownTracks.filter(each => each !== track), track]
    if (this.shownTracks.length > MOST_GRIDS) this.shownTracks.shift().cursor = null
  }

  put (update) {
    if (update.head !== undefined) this.head = update.head
    for (const name of ['states', 'programs', 'prompts']) if (update[name] !== undefined) put(this[name], update[name])
    for (const [number, rows] of Object.entries(update.timelines ?? {})) {
      (this.timelines[number] ??= new Timeline(this, Number(number))).put(rows)
    }
    if (update.ahead !== undefined) this.ahead = update.ahead
    if (update.episode !== undefined) this.episode = update.episode
  }

  get cells () {
    const [width, height, depth] = this.shape
    return width * height * depth
  }

  get shape () {
    return this.head.box.shape
  }

  /** Return the position of a cell. @returns {number[]} */
  place (cell) {
    const [, height, depth] = this.shape
    const [x, y, z] = this.head.box.low
    return [x + Math.floor(cell / (height * depth)), y + Math.floor(cell / depth) % height, z + cell % depth]
  }

  cell ([x, y, z]) {
    const [width, height, depth] = this.shape
    const [i, j, k] = [x, y, z].map((value, axis) => Math.floor(value) - this.head.box.low[axis])
    const inside = i >= 0 && j >= 0 && k >= 0 && i < width && j < height && k < depth
    return inside ? (i * height + j) * depth + k : -1
  }

  label (place) {
    return this.head.labels.find(([x, y, z]) => x === place[0] && y === place[1] && z === place[2])?.[3] ?? null
  }

  /** Return the name of a thing for people. @returns {string} */
  thingName (thing) {
    const { kind, number } = partsOf(thing)
    if (kind === 'agent') return this.head.agents[number].name
    if (kind === 'inventory') return `what ${this.head.agents[number].name} has`
    const place = this.place(number)
    return this.label(place) ?? `${kind} at ${place.join(', ')}`
  }

  /** Return the key under which explanations and lines of sight of a track are stored. @returns {string} */
  nameOf (track) {
    return `${track.timeline.facts.path} ${track.path} ${track.timeline.facts.branch}`
  }
}
