'use strict'

const { withCount } = require('./items')

/** Items that remain in the grid when an ingredient is consumed. */
const REMAINDERS = {
  water_bucket: 'bucket', lava_bucket: 'bucket', milk_bucket: 'bucket',
  honey_bottle: 'glass_bottle', dragon_breath: 'glass_bottle',
}

/** Return rows of ids without empty rows and columns around them; null for an empty grid. */
function trim (ids, width) {
  const rows = []
  for (let y = 0; y < ids.length; y += width) rows.push(ids.slice(y, y + width))
  const used = (row) => row.some((id) => id !== null)
  while (rows.length && !used(rows[0])) rows.shift()
  while (rows.length && !used(rows[rows.length - 1])) rows.pop()
  if (!rows.length) return null
  const columns = rows[0].map((_, x) => rows.some((row) => row[x] !== null))
  const from = columns.indexOf(true)
  const to = columns.lastIndexOf(true) + 1
  return rows.map((row) => row.slice(from, to))
}

const shapeKey = (rows) => rows.map((row) => row.map((id) => id ?? '').join(',')).join('/')
const bagKey = (ids) => ids.filter((id) => id !== null).sort((a, b) => a - b).join('+')
const idOf = (entry) => {
  const id = entry !== null && typeof entry === 'object' ? entry.id : entry
  return id === -1 || id === undefined ? null : id
}

/** Return all recipes of minecraft-data, indexed by the grid's contents. */
function indexRecipes (registry) {
  const shaped = new Map()
  const shapeless = new Map()
  for (const recipe of Object.values(registry.recipes).flat()) {
    if (recipe.inShape) {
      const rows = recipe.inShape.map((row) => row.map(idOf))
      const width = Math.max(...rows.map((row) => row.length))
      const flat = rows.flatMap((row) => [...row, ...new Array(width - row.length).fill(null)])
      const trimmed = trim(flat, width)
      shaped.set(shapeKey(trimmed), recipe.result)
      shaped.set(shapeKey(trimmed.map((row) => [...row].reverse())), recipe.result)
    } else {
      shapeless.set(bagKey(recipe.ingredients.map(idOf)), recipe.result)
    }
  }
  return { shaped, shapeless }
}

/** Return the product of a grid of stacks, `{id, count}`, or undefined. */
function match (recipes, stacks, width) {
  const ids = stacks.map((item) => item?.type ?? null)
  const rows = trim(ids, width)
  if (!rows) return undefined
  return recipes.shaped.get(shapeKey(rows)) ?? recipes.shapeless.get(bagKey(ids))
}

/** Consume one of each ingredient in slots[1..width*width]. */
function consume (slots, width, makeItem) {
  for (let i = 1; i <= width * width; i++) {
    const item = slots[i]
    if (!item) continue
    const rest = withCount(item, item.count - 1)
    const remainder = REMAINDERS[item.name]
    slots[i] = rest ?? (remainder ? makeItem(remainder) : null)
  }
}

module.exports = { indexRecipes, match, consume }
