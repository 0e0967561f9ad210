'use strict'
/** Error for the author of a program. Its message says what was asked, what was found and what to do. */

class SkillError extends Error {
  /**
   * @param {string} skill name of the skill that failed
   * @param {string} message
   * @param {Error} [cause]
   */
  constructor (skill, message, cause) {
    super(message, cause && { cause })
    this.name = 'SkillError'
    this.skill = skill
  }
}

module.exports = { SkillError }
