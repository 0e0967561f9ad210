'use strict'
/**
 * Rewriter of a WebAssembly module that adds counters of its computation and a bound of its recursion.
 *
 * An interpreter polls for interrupts only in its own loops. Library loops inside it (a search in a sparse array of
 * 2^53 elements, the multiplication of large integers) never poll and could run forever. In the rewritten module every
 * loop turn and every call costs one unit of the exported global `fuel`, copied memory costs one unit per 64 bytes,
 * and every active call adds an estimate of its frame size to the exported global `depth`. The module traps
 * (`unreachable`) when `fuel` falls below zero or `depth` rises above `stackBytes`. Both counts depend only on the
 * program, so that a program reaches a limit at the same point on every machine.
 */

const { Reader, writeVector, unsigned, section } = require('./wasm-binary')
const { skipImmediates } = require('./wasm-opcodes')

const SECTION = { type: 1, import: 2, function: 3, global: 6, export: 7, code: 10 }
const KIND = { function: 0, table: 1, memory: 2, global: 3 }
const OP = {
  unreachable: 0x00, block: 0x02, loop: 0x03, if: 0x04, end: 0x0b, br: 0x0c, return: 0x0f,
  call: 0x10, callIndirect: 0x11, prefix: 0xfc, localGet: 0x20, globalGet: 0x23, globalSet: 0x24,
  i32Const: 0x41, ltSigned: 0x48, gtSigned: 0x4a, add: 0x6a, subtract: 0x6b, shiftRight: 0x76
}
const BULK = { copy: 10, fill: 11 }
const I32 = 0x7f
const EMPTY = 0x40
const FRAME_BYTES = 96
const LOCAL_BYTES = 8
const BYTES_PER_FUEL_BITS = 6
const MAX_I32 = 0x7fffffff

/**
 * Return the rewritten module.
 * @param {Uint8Array} bytes module of the WebAssembly MVP with bulk memory and at most one result per function
 * @param {object} limits
 * @param {number} limits.stackBytes largest value of `depth`, in estimated bytes
 * @param {number} limits.initialPages initial size of the imported memory, in pages of 64 KiB
 * @returns {Uint8Array} the rewritten module, with three more exports: `fuel` and `depth` (mutable i32) and `table`
 * @throws {Error} if the module contains something that this rewriter does not know
 */
function meter (bytes, { stackBytes, initialPages }) {
  const sections = readSections(bytes)
  const plan = survey(sections, stackBytes)
  const bodies = readBodies(sections.get(SECTION.code)).map((body, i) => rewriteBody(body, plan.signatures[i], plan))
  bodies.push(bulkBody(plan, BULK.copy), bulkBody(plan, BULK.fill))
  const replaced = new Map([
    [SECTION.import, resizedMemory(sections.get(SECTION.import), initialPages)],
    [SECTION.type, appended(sections.get(SECTION.type), [bulkType()])],
    [SECTION.function, appended(sections.get(SECTION.function), [plan.bulkType, plan.bulkType].map(unsigned))],
    [SECTION.global, appended(sections.get(SECTION.global), [counter(MAX_I32), counter(0)])],
    [SECTION.export, appended(sections.get(SECTION.export),
      [exported('fuel', KIND.global, plan.fuel), exported('depth', KIND.global, plan.depth), exported('table', KIND.table, 0)])],
    [SECTION.code, writeVector(bodies.flatMap((body) => [Uint8Array.from(unsigned(body.length)), body]), bodies.length)]
  ])
  return assemble(bytes, replaced)
}

function readSections (bytes) {
  const sections = new Map()
  for (const { id, content } of new Reader(bytes, 8).sections()) if (id !== 0) sections.set(id, content)
  for (const [name, id] of Object.entries(SECTION)) {
    if (!sections.has(id)) throw new Error(`the module has no ${name} section`)
  }
  return sections
}

function assemble (bytes, replaced) {
  const parts = [bytes.subarray(0, 8)]
  for (const { id, whole } of new Reader(bytes, 8).sections()) {
    parts.push(replaced.has(id) ? section(id, replaced.get(id)) : whole)
  }
  return new Uint8Array(Buffer.concat(parts))
}

function survey (sections, stackBytes) {
  const types = readTypes(new Reader(sections.get(SECTION.type)))
  const imports = countImports(new Reader(sections.get(SECTION.import)))
  const signatures = new Reader(sections.get(SECTION.function)).vector((r) => types[r.unsigned()])
  const globals = imports.globals + new Reader(sections.get(SECTION.global)).unsigned()
  const functions = imports.functions + signatures.length
  return { stackBytes, signatures, fuel: globals, depth: globals + 1, copy: functions, fill: functions + 1, bulkType: types.length }
}

function readTypes (reader) {
  return reader.vector((r) => {
    if (r.byte() !== 0x60) throw new Error('a type of the module is not a function type')
    const params = r.vector((p) => p.byte())
    const results = r.vector((p) => p.byte())
    if (results.length > 1) throw new Error('a function of the module has several results')
    return { params: params.length, block: results[0] ?? EMPTY }
  })
}

function countImports (reader) {
  const kinds = reader.vector(importKind)
  const count = (wanted) => kinds.filter(({ kind }) => kind === wanted).length
  return { functions: count(KIND.function), globals: count(KIND.global) }
}

function importKind (reader) {
  reader.bytes(reader.unsigned())
  reader.bytes(reader.unsigned())
  const kind = reader.byte()
  const start = reader.position
  if (kind === KIND.function) reader.unsigned()
  else if (kind === KIND.global) reader.bytes(2)
  else if (kind === KIND.memory) reader.limits()
  else if (kind === KIND.table) { reader.byte(); reader.limits() } else throw new Error(`an import of the module has the unknown kind ${kind}`)
  return { kind, start, end: reader.position }
}

function resizedMemory (content, initialPages) {
  const memory = new Reader(content).vector(importKind).find(({ kind }) => kind === KIND.memory)
  if (memory === undefined) throw new Error('the module imports no memory')
  const limits = new Reader(content, memory.start)
  const flags = limits.byte()
  limits.unsigned()
  return Buffer.concat([content.subarray(0, memory.start), Uint8Array.from([flags, ...unsigned(initialPages)]), content.subarray(limits.position)])
}

function readBodies (content) {
  return new Reader(content).vector((r) => r.bytes(r.unsigned()))
}

/**
 * Wrap a function's body in a block, so that all its exits pass through one point. Code for fuel and depth goes before
 * the block, code that restores the depth after it. Functions without loops and calls stay as they are: their cost is
 * bounded, and their caller pays for it.
 */
function rewriteBody (body, signature, plan) {
  const reader = new Reader(body)
  const locals = reader.vector((r) => { const count = r.unsigned(); r.byte(); return count })
  const start = reader.position
  const { loops, calls } = scan(body, start)
  if (!loops && !calls) return body
  const header = body.subarray(0, start)
  const weight = FRAME_BYTES + LOCAL_BYTES * (signature.params + locals.reduce((sum, count) => sum + count, 0))
  // The depth matters only for functions that call others.
  const frame = calls ? weight : 0
  const inner = rewriteCode(body, start, plan)
  return Buffer.concat([header, Uint8Array.from(charge(plan)), Uint8Array.from(enter(plan, frame)),
    Uint8Array.from([OP.block, signature.block]), inner, Uint8Array.from([...leave(plan, frame), OP.end])])
}

function scan (body, start) {
  const reader = new Reader(body, start)
  let loops = false
  let calls = false
  while (!reader.done) {
    const op = reader.byte()
    if (op === OP.loop) loops = true
    if (op === OP.call || op === OP.callIndirect || op === OP.prefix) calls = true
    skipImmediates(reader, op)
  }
  return { loops, calls }
}

// Replace `return` by a jump out of the wrapping block. Jumps to the function's own label need no change: inside the
// block they leave the block.
function rewriteCode (body, start, plan) {
  const reader = new Reader(body, start)
  const parts = []
  let nesting = 0
  let copied = start
  const replace = (from, code) => {
    parts.push(body.subarray(copied, from), Uint8Array.from(code))
    copied = reader.position
  }
  while (!reader.done) {
    const from = reader.position
    const op = reader.byte()
    const immediate = skipImmediates(reader, op)
    if (op === OP.return) replace(from, [OP.br, ...unsigned(nesting)])
    else if (op === OP.loop) replace(reader.position, charge(plan))
    else if (op === OP.prefix && immediate === BULK.copy) replace(from, [OP.call, ...unsigned(plan.copy)])
    else if (op === OP.prefix && immediate === BULK.fill) replace(from, [OP.call, ...unsigned(plan.fill)])
    if (op === OP.block || op === OP.loop || op === OP.if) nesting++
    else if (op === OP.end) nesting--
  }
  parts.push(body.subarray(copied))
  return Buffer.concat(parts)
}

function charge ({ fuel }) {
  return [...take(fuel, [OP.i32Const, 1]), OP.globalGet, ...unsigned(fuel), OP.i32Const, 0, OP.ltSigned, ...trapIf()]
}

function enter ({ depth, stackBytes }, frame) {
  if (frame === 0) return []
  return [OP.globalGet, ...unsigned(depth), OP.i32Const, ...signed(frame), OP.add, OP.globalSet, ...unsigned(depth),
    OP.globalGet, ...unsigned(depth), OP.i32Const, ...signed(stackBytes), OP.gtSigned, ...trapIf()]
}

function leave ({ depth }, frame) {
  return frame === 0 ? [] : take(depth, [OP.i32Const, ...signed(frame)])
}

function take (global, amount) {
  return [OP.globalGet, ...unsigned(global), ...amount, OP.subtract, OP.globalSet, ...unsigned(global)]
}

function trapIf () {
  return [OP.if, EMPTY, OP.unreachable, OP.end]
}

function bulkType () {
  return [0x60, 3, I32, I32, I32, 0]
}

function bulkBody (plan, operation) {
  const length = [OP.localGet, 2, OP.i32Const, BYTES_PER_FUEL_BITS, OP.shiftRight]
  const act = [OP.prefix, operation, 0, ...(operation === BULK.copy ? [0] : [])]
  return Uint8Array.from([0, ...take(plan.fuel, length), ...charge(plan),
    OP.localGet, 0, OP.localGet, 1, OP.localGet, 2, ...act, OP.end])
}

function counter (initial) {
  return [I32, 1, OP.i32Const, ...signed(initial), OP.end]
}

function exported (name, kind, index) {
  return [name.length, ...Buffer.from(name), kind, ...unsigned(index)]
}

function appended (content, entries) {
  const reader = new Reader(content)
  const count = reader.unsigned()
  return Buffer.concat([Uint8Array.from(unsigned(count + entries.length)), content.subarray(reader.position),
    ...entries.map((entry) => Uint8Array.from(entry))])
}

function signed (value) {
  const bytes = []
  for (;;) {
    const low = value & 0x7f
    value >>= 7
    if (value === 0 && (low & 0x40) === 0) return [...bytes, low]
    bytes.push(low | 0x80)
  }
}

module.exports = { meter }
