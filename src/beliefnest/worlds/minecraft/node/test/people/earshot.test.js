'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Earshot } = require('../../src/live/earshot')

/** Return a scene in which Anne and Carl are people and Bob is a bot. */
function scene () {
  const players = ['anne', 'bob', 'carl'].map(agent => ({ agent, read: [], system (text) { this.read.push(text) } }))
  const [anne, bob, carl] = players
  const serv = { players }
  const earshot = new Earshot(serv, agent => players.find(player => player.agent === agent && player !== bob) ?? null)
  return { anne, bob, carl, earshot, say: serv.tellSaid }
}
const chat = to => ({ kind: 'chat', detail: to === undefined ? {} : { to } })

describe('what people are told of what is said', () => {
  it('waits until it is known who heard it, but for the speaker and bots', () => {
    const { anne, bob, carl, earshot, say } = scene()
    say(anne, 'one')
    say(bob, 'two')
    assert.deepEqual([anne.read, bob.read, carl.read], [['one'], ['one', 'two'], []])
    earshot.framed({ tick: 5, events: [chat(), chat('carl'), { kind: 'emote', detail: {} }, chat()] })
    earshot.hear({ tick: 5, heard: [['anne', 'carl'], ['anne']] })
    assert.deepEqual([anne.read, carl.read], [['one', 'two'], ['one']])
  })

  it('is told at once where everybody hears everything', () => {
    const { anne, carl, earshot, say } = scene()
    earshot.isGlobal = true
    say(anne, 'one')
    assert.deepEqual(carl.read, ['one'])
  })

  it('is forgotten with what has not happened', () => {
    const { anne, carl, earshot, say } = scene()
    say(anne, 'one')
    earshot.framed({ tick: 5, events: [chat()] })
    earshot.forget()
    say(anne, 'two')
    earshot.framed({ tick: 5, events: [chat()] })
    earshot.hear({ tick: 5, heard: [['carl']] })
    assert.deepEqual(carl.read, ['two'])
  })
})
