// Programs, in which NUMBER stands for one; many leave something under way.
// --
bot.setControlState('sprint', true); bot.setControlState('forward', true)
bot.setControlState('jump', true); await bot.waitForTicks(NUMBER)
// --
bot.setControlState('jump', true); bot.setControlState('jump', false)
// --
bot.setControlState('sneak', true); bot.setControlState('left', true); await bot.waitForTicks(NUMBER)
// --
await bot.look(NUMBER / 3, NUMBER / 20, true); await bot.toss(mcData.itemsByName.dirt.id, null, NUMBER)
// --
await bot.look(NUMBER / 3, 0); await bot.tossStack(bot.inventory.items()[0])
// --
await goToPosition(bot, new Vec3(4, 1, 4), 1)
await depositItemIntoChest(bot, new Vec3(3, 1, 3), {dirt: NUMBER})
// --
await goToPosition(bot, new Vec3(4, 1, 4), 1)
await getItemFromChest(bot, new Vec3(3, 1, 3), {emerald: 1})
// --
const chest = await bot.openContainer(bot.blockAt(new Vec3(3, 1, 3)))
await chest.deposit(mcData.itemsByName.dirt.id, null, NUMBER)
// --
const barrel = await bot.openContainer(bot.blockAt(new Vec3(3, 1, 9))); await bot.waitForTicks(NUMBER)
// --
bot.activateBlock(bot.blockAt(new Vec3(3, 1, 9)))
// --
await smeltItem(bot, 'raw_iron', 'coal', new Vec3(6, 1, 3), 1)
// --
const furnace = await bot.openFurnace(bot.blockAt(new Vec3(6, 1, 3)))
await furnace.putFuel(mcData.itemsByName.coal.id, null, 1)
await furnace.putInput(mcData.itemsByName.raw_iron.id, null, 1)
await bot.waitForTicks(NUMBER)
// --
await goToPosition(bot, new Vec3(6, 1, 8), 1)
await bot.activateBlock(bot.blockAt(new Vec3(6, 1, 9)))
// --
await goToPosition(bot, new Vec3(8, 1, 9), 1); await bot.dig(bot.blockAt(new Vec3(10, 2, 10)))
// --
await bot.dig(bot.blockAt(bot.entity.position.offset(1, -1, 0)))
// --
await placeItem(bot, 'dirt', bot.entity.position.offset(2, 0, 0).floored())
// --
await craftItem(bot, 'oak_planks', null, 1)
// --
bot.setQuickBarSlot(NUMBER % 9); await bot.equip(mcData.itemsByName.diamond.id, 'hand')
// --
await bot.equip(mcData.itemsByName.coal.id, 'off-hand')
// --
await sleep(bot, new Vec3(11, 1, 6), NUMBER)
// --
await bot.equip(mcData.itemsByName.bread.id, 'hand'); bot.activateItem()
await bot.waitForTicks(NUMBER)
// --
bot.pathfinder.thinkTimeout = 1; bot.pathfinder.setMovements(new Movements(bot))
await bot.pathfinder.goto(new goals.GoalNear(NUMBER % 12, 1, 11, 1))
// --
bot.pathfinder.stop(); bot.pathfinder.setGoal(new goals.GoalNear(12, 1, 1, 1))
await bot.waitForTicks(NUMBER)
// --
await goToPosition(bot, new Vec3(1, 2, 12), 0)
bot.setControlState('forward', true); await bot.waitForTicks(NUMBER)
// --
for (const name of Object.keys(bot.entities).sort()) {
  const e = bot.entities[name]
  bot.chat([e.id, e.name, e.position, e.velocity, e.onGround, e.height].join(' '))
}
// --
bot.chat(JSON.stringify(bot.inventory.slots.map(s => s && [s.name, s.count])) + bot.quickBarSlot)
// --
bot.chat([Math.random(), Date.now(), bot.health, bot.isSleeping, bot.entity.velocity].join(' '))
// --
await doNothing(bot); throw new Error('as told')
// --
await bot.equip(mcData.itemsByName.clay.id, 'hand'); await bot.equip(mcData.itemsByName.bow.id, 'hand')
bot.chat('holding ' + bot.quickBarSlot)
