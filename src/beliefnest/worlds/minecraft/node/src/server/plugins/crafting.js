'use strict'

const { indexRecipes, match, consume } = require('./lib/grid')
const { cell, containerMenu } = require('./lib/menus')

const TABLE_WINDOW = 12
const TABLE_WIDTH = 3

/** Add crafting in the inventory's 2x2 grid and at a table, with minecraft-data's recipes. */
module.exports.server = (serv) => {
  // Index recipes on first use, so that a world without crafting starts sooner.
  let index = null
  const recipes = () => {
    index ??= indexRecipes(serv.registry)
    return index
  }
  const makeItem = (name) => new serv.Item(serv.registry.itemsByName[name].id, 1)

  /**
   * Connect a crafting grid: slot 0 of `slots` shows the product of slots 1 and up. Return `{refresh, takeResult}`; a
   * taken product counts as crafted by `player`.
   */
  serv.craftingGrid = (slots, width, player) => {
    function refresh () {
      const ingredients = slots.slice(1, width * width + 1)
      const result = ingredients.some(Boolean) ? match(recipes(), ingredients, width) : undefined
      slots[0] = result ? new serv.Item(result.id, result.count ?? 1) : null
    }
    function takeResult () {
      const result = slots[0]
      player.countAct('craft_item', result)
      consume(slots, width, makeItem)
      refresh()
      return result
    }
    return { refresh, takeResult }
  }

  function openTable ({ player }) {
    const slots = new Array(TABLE_WIDTH ** 2 + 1).fill(null)
    const grid = serv.craftingGrid(slots, TABLE_WIDTH, player)
    const menu = containerMenu(slots.map((_, i) => cell(slots, i)), player, {
      result: 0,
      takeResult: grid.takeResult,
      mayPlace: (i) => i !== 0,
      into: () => slots.map((_, i) => i).slice(1),
    })
    player.windows.open({
      type: TABLE_WINDOW,
      title: 'Crafting',
      menu,
      around: (run) => { run(); grid.refresh(); },
      leave: (giveBack) => {
        slots.slice(1).forEach((item, i) => {
          slots[i + 1] = null
          if (item) giveBack(item)
        })
      },
    })
    return true
  }
  serv.onInteraction('crafting_table', openTable)
}
