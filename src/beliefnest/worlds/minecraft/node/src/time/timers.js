'use strict'
/** Virtual timers of one context, fired in order of (time, creation). */

class VirtualTimer {
  constructor (queue, callback, args, delay, repeat, owner) {
    this.queue = queue
    this.owner = owner
    this.callback = callback
    this.args = args
    this.delay = delay
    this.repeat = repeat
    this.due = 0
    this.order = 0
    this.active = false
    this.referenced = true
  }

  ref () { this.referenced = true; return this }
  unref () { this.referenced = false; return this }
  hasRef () { return this.referenced }
  close () { this.active = false; return this }
  refresh () { this.queue.schedule(this); return this }
  [Symbol.toPrimitive] () { return this.order }
  [Symbol.dispose] () { this.close() }
}

class TimerQueue {
  /**
   * @param {() => number} now returns the virtual milliseconds of the context
   */
  constructor (now) {
    this.now = now
    this.heap = []
    this.created = 0
  }

  /**
   * @param {?string} [owner] owner of the timer
   */
  add (callback, args, delay, repeat, owner = null) {
    const timer = new VirtualTimer(this, callback, args, delay, repeat, owner)
    this.schedule(timer)
    return timer
  }

  /** Start or restart a timer from now. A waiting timer is queued again under a new order. */
  schedule (timer) {
    const entry = { timer, due: this.now() + timer.delay, order: ++this.created }
    timer.due = entry.due
    timer.order = entry.order
    timer.active = true
    this.push(entry)
  }

  /** Return the next live entry, or undefined; stale entries are dropped. */
  peek () {
    while (this.heap.length > 0) {
      const { timer, order } = this.heap[0]
      if (timer.active && timer.order === order) return timer
      this.pop()
    }
    return undefined
  }

  push (entry) {
    const heap = this.heap
    let index = heap.push(entry) - 1
    while (index > 0) {
      const parent = (index - 1) >> 1
      if (!before(entry, heap[parent])) break
      heap[index] = heap[parent]
      index = parent
    }
    heap[index] = entry
  }

  pop () {
    const heap = this.heap
    const top = heap[0]
    const last = heap.pop()
    if (heap.length === 0) return top
    let index = 0
    for (;;) {
      let child = 2 * index + 1
      if (child >= heap.length) break
      if (child + 1 < heap.length && before(heap[child + 1], heap[child])) child++
      if (!before(heap[child], last)) break
      heap[index] = heap[child]
      index = child
    }
    heap[index] = last
    return top
  }

  clear () {
    for (const { timer } of this.heap) timer.active = false
    this.heap.length = 0
  }
}

function before (a, b) {
  return a.due < b.due || (a.due === b.due && a.order < b.order)
}

module.exports = { TimerQueue, VirtualTimer }
