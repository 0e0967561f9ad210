'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Clock, Context, EPOCH_MS } = require('../src/time/clock')
const { installTime } = require('../src/time/install')
const { Random } = require('../src/time/random')

const clock = new Clock('root')
installTime(clock)

describe('a clock', () => {
  it('fires timers in order of time, then of creation, at their own times', async () => {
    const fired = []
    await clock.within(new Context('a'), async () => {
      const note = name => () => fired.push([name, Date.now() - EPOCH_MS, performance.now()])
      setTimeout(note('late'), 30)
      setTimeout(note('first'), 10)
      setTimeout(note('second'), 10)
      setImmediate(note('now'))
      const every = setInterval(note('every'), 20)
      clearTimeout(setTimeout(note('never'), 5))
      await clock.advance(45)
      clearInterval(every)
      await clock.advance(100)
    })
    assert.deepEqual(fired.map(([name, time]) => `${name} ${time}`),
      ['now 0', 'first 10', 'second 10', 'every 20', 'late 30', 'every 40'])
    assert.ok(fired.every(([, time, counter]) => time === counter))
  })

  it('lets promises and nextTick run before the next timer', async () => {
    const order = []
    await clock.within(new Context('a'), async () => {
      setTimeout(async () => {
        order.push('timer 1')
        await null
        order.push('after await')
        process.nextTick(() => order.push('next tick'))
        await new Promise(resolve => setTimeout(resolve, 0))
        order.push('one millisecond later')
      }, 1)
      setTimeout(() => order.push('timer 2'), 1)
      await clock.advance(5)
    })
    assert.deepEqual(order, ['timer 1', 'after await', 'next tick', 'timer 2', 'one millisecond later'])
  })

  it('stands still in one context while another goes on', async () => {
    const [one, two] = [new Context('one'), new Context('two')]
    const fired = []
    await clock.within(one, () => { setTimeout(() => fired.push('one'), 10) })
    await clock.within(two, async () => {
      setTimeout(() => fired.push('two'), 20)
      await clock.advance(50)
      assert.equal(Date.now() - EPOCH_MS, 50)
    })
    assert.deepEqual(fired, ['two'])
    await clock.within(one, async () => {
      assert.equal(Date.now() - EPOCH_MS, 0)
      await clock.advance(10)
    })
    assert.deepEqual(fired, ['two', 'one'])
    assert.equal(Date.now(), EPOCH_MS)
  })

  it('draws random numbers per context, the same for the same seed', async () => {
    const draw = seed => clock.within(new Context(seed), () =>
      [Math.random(), Math.random(), require('node:crypto').randomUUID()])
    const first = await draw('x')
    assert.deepEqual(await draw('x'), first)
    assert.notDeepEqual(await draw('y'), first)
    assert.ok(first.slice(0, 2).every(number => number >= 0 && number < 1))
  })

  it('charges thinking to the callback that thinks', async () => {
    const seen = []
    await clock.within(new Context('a'), async () => {
      setTimeout(() => {
        clock.charge(7)
        seen.push(performance.now())
      }, 10)
      setTimeout(() => seen.push(performance.now()), 10)
      await clock.advance(20)
    })
    assert.deepEqual(seen, [17, 10])
  })

  it('goes on although immediates call for one another for ever', async () => {
    await clock.within(new Context('a'), async () => {
      const again = () => { setImmediate(again) }
      again()
      await clock.advance(1)
      assert.equal(performance.now(), 1)
    })
  })

  it('goes on after a timer that throws, and tells of it', async () => {
    const faults = []
    const context = new Context('a', fault => faults.push(fault.message))
    await clock.within(context, async () => {
      setTimeout(() => { throw new Error('first') }, 1)
      setTimeout(() => { throw new Error('second') }, 2)
      await clock.advance(5)
    })
    assert.deepEqual(faults, ['first', 'second'])
    await assert.rejects(clock.within(new Context('b'), async () => {
      setTimeout(() => { throw new Error('unheard') }, 1)
      await clock.advance(5)
    }), /unheard/)
    assert.equal(clock.active, clock.root)
  })

  it('refuses to run two contexts at once', async () => {
    await clock.within(new Context('a'), async () => {
      await assert.rejects(clock.within(new Context('b'), () => {}), /already running/)
    })
  })
})

describe('random numbers', () => {
  it('are spread over the unit interval', () => {
    const random = new Random('spread')
    const counts = new Array(10).fill(0)
    for (let i = 0; i < 10000; i++) counts[Math.floor(random.next() * 10)]++
    assert.ok(counts.every(count => count > 850 && count < 1150), counts.join())
  })
})
