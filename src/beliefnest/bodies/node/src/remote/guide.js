'use strict'
/** A player that stands in for the operator where that is not: it looks, and what has to be typed the operator types. */
const { Operator } = require('./operator')

class Guide extends Operator {
  /**
   * @param {import('./link').Link} link of the guide
   * @param {Operator} operator
   */
  constructor (link, operator) {
    super(link, operator.server, operator.clock, operator.settling)
    this.operator = operator
  }

  type (command) {
    this.operator.type(command)
  }

  can (name) {
    return this.operator.can(name)
  }

  ask (command) {
    return this.operator.ask(command)
  }

  /** Resolve when what the operator typed is done, and the guide has been told of it. */
  async settled () {
    await this.operator.settled()
    await super.settled()
  }
}

module.exports = { Guide }
