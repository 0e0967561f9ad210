'use strict'

/**
 * Plugin of jsPsych 7 and 8 that shows a story or a film and asks one question about it. `index.html` uses it without jsPsych.
 */
;(() => {
  const NAMES = ['BOOL', 'STRING', 'INT', 'OBJECT']
  const Type = globalThis.jsPsychModule?.ParameterType ?? Object.fromEntries(NAMES.map(name => [name, name]))

  const info = {
    name: 'beliefnest-question',
    version: '1.0.0',
    parameters: {
      /** Name of the person whose view is shown; empty: a narrator tells. */
      owner: { type: Type.STRING, default: '' },
      /** Paragraphs of the story; empty: no story is shown. */
      story: { type: Type.STRING, array: true, default: [] },
      /** Film: `pictures` (SVG texts) and `frames` (index of a picture, milliseconds, caption); null: no film is shown. */
      film: { type: Type.OBJECT, default: null },
      /** True if the participant has seen this film in an earlier trial, so that the question is shown at once. */
      seen: { type: Type.BOOL, default: false },
      /** The question. */
      question: { type: Type.STRING, default: undefined },
      /** Options in the order of the page; empty: an answer in words. */
      options: { type: Type.STRING, array: true, default: [] },
      /** True if the participant is also asked for a reason. */
      reason: { type: Type.BOOL, default: false },
      /** Text of the button. */
      button_label: { type: Type.STRING, default: 'Continue' }
    },
    data: {
      /** The answer: one of `options`, or words. */
      response: { type: Type.STRING },
      /** Position of the answer among the options, from 1; null: an answer in words. */
      position: { type: Type.INT },
      /** Options in the order of the page. */
      options: { type: Type.STRING, array: true },
      /** The reason in the participant's words. */
      reason: { type: Type.STRING },
      /** Milliseconds from the appearance of the question to the answer. */
      rt: { type: Type.INT },
      /** Number of times that the film was shown to its end in this trial. */
      film_shown: { type: Type.INT }
    }
  }

  /**
   * Make an element with a text.
   * @param {string} tag Its tag.
   * @param {object} [properties] Properties of the element, such as `className`.
   * @param {...(Node|string)} children Children; texts become text nodes.
   * @returns {HTMLElement} The element.
   */
  function element (tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties)
    made.append(...children)
    return made
  }

  /** Player of one film: picture, caption and buttons. */
  class FilmPlayer {
    /**
     * Make a player that shows the first picture, or the last one.
     * @param {object} film The film, as the parameter `film`.
     * @param {boolean} atEnd True to begin at the last picture.
     * @param {Function} onEnd Function that is called each time the film ends.
     */
    constructor (film, atEnd, onEnd) {
      this.film = film
      this.onEnd = onEnd
      this.shown = 0
      this.wasSeen = atEnd
      this.timer = null
      this.addresses = film.pictures.map(svg => `data:image/svg+xml,${encodeURIComponent(svg)}`)
      this.picture = element('img', { className: 'bn-picture' })
      this.caption = element('figcaption', { className: 'bn-caption', ariaLive: 'polite' })
      this.play = this.button('bn-play', () => this.toggle())
      this.back = this.button('bn-back', () => this.step(-1), 'Back')
      this.next = this.button('bn-next', () => this.step(1), 'Next')
      const controls = element('div', { className: 'bn-controls', role: 'group', ariaLabel: 'Film' }, this.play, this.back, this.next)
      this.root = element('figure', { className: 'bn-film' }, this.picture, this.caption, controls)
      this.show(atEnd ? film.frames.length - 1 : 0)
    }

    /**
     * Make a button of the player.
     * @param {string} className Its class.
     * @param {Function} onClick Function of a click.
     * @param {string} [label] Its text.
     * @returns {HTMLElement} The button.
     */
    button (className, onClick, label = '') {
      const made = element('button', { type: 'button', className: `bn-button ${className}` }, label)
      made.addEventListener('click', onClick)
      return made
    }

    /**
     * Show a frame.
     * @param {number} at Index of the frame.
     */
    show (at) {
      const [picture, , caption] = this.film.frames[at]
      this.at = at
      this.picture.src = this.addresses[picture]
      this.picture.alt = `Picture ${at + 1} of ${this.film.frames.length}`
      if (this.caption.textContent !== caption) this.caption.textContent = caption
      this.refresh()
    }

    /** Set texts and states of the buttons. */
    refresh () {
      const last = this.film.frames.length - 1
      const isAgain = this.at === last && (this.wasSeen || this.shown > 0)
      this.play.textContent = this.timer !== null ? 'Pause' : isAgain ? 'Play again' : 'Play'
      this.back.disabled = this.at === 0
      this.next.disabled = this.at === last
    }

    /** Start or stop the film; from its end it starts anew. */
    toggle () {
      if (this.timer !== null) return this.stop()
      if (this.at === this.film.frames.length - 1) this.show(0)
      this.wait()
    }

    /** Show the next frame after the duration of this one. */
    wait () {
      this.timer = setTimeout(() => {
        this.timer = null
        if (this.at < this.film.frames.length - 1) {
          this.show(this.at + 1)
          this.wait()
        } else {
          this.end()
        }
      }, this.film.frames[this.at][1])
      this.refresh()
    }

    /** Stop the film at this frame. */
    stop () {
      clearTimeout(this.timer)
      this.timer = null
      this.refresh()
    }

    /**
     * Show another caption's first frame, or the end, and stop there.
     * @param {number} direction 1: forward; -1: backward.
     */
    step (direction) {
      this.stop()
      const frames = this.film.frames
      const last = frames.length - 1
      let at = this.at + direction
      while (at > 0 && at < last && frames[at][2] === frames[at - 1][2]) at += direction
      this.show(Math.min(last, Math.max(0, at)))
      if (this.at === last && direction > 0) this.end()
    }

    /** Count a complete showing. */
    end () {
      this.shown += 1
      this.refresh()
      this.onEnd()
    }
  }

  /** Form with one question. */
  class QuestionForm {
    /**
     * Make the form.
     * @param {object} trial Parameters of the trial.
     * @param {Function} onAnswer Function of the answer: an object with `response`, `position` and `reason`.
     */
    constructor (trial, onAnswer) {
      this.trial = trial
      this.question = element('legend', { className: 'bn-question' }, trial.question)
      this.fields = element('fieldset', { className: 'bn-fields', tabIndex: -1 }, this.question, ...this.answers())
      this.reason = trial.reason ? element('textarea', { className: 'bn-reason', rows: 3 }) : null
      const why = this.reason ? [element('label', { className: 'bn-why' }, 'Why?', this.reason)] : []
      const button = element('button', { type: 'submit', className: 'bn-button bn-submit' }, trial.button_label)
      this.root = element('form', { className: 'bn-form' }, this.fields, ...why, button)
      this.root.addEventListener('submit', event => {
        event.preventDefault()
        onAnswer(this.answer())
      })
    }

    /**
     * Make the radio buttons, or the text field.
     * @returns {HTMLElement[]} Elements of the fieldset.
     */
    answers () {
      const { options, question } = this.trial
      if (options.length === 0) {
        this.words = element('input', { type: 'text', className: 'bn-words', required: true, autocomplete: 'off', ariaLabel: question, pattern: '.*\\S.*' })
        return [this.words]
      }
      this.radios = options.map(value => element('input', { type: 'radio', name: 'answer', value, required: true }))
      return this.radios.map((radio, at) => element('label', { className: 'bn-option' }, radio, element('span', {}, options[at])))
    }

    /**
     * Read the answer.
     * @returns {object} `response`, `position` and `reason`.
     */
    answer () {
      const reason = this.reason ? this.reason.value.trim() : ''
      if (!this.radios) return { response: this.words.value.trim(), position: null, reason }
      const at = this.radios.findIndex(radio => radio.checked)
      return { response: this.trial.options[at], position: at + 1, reason }
    }
  }

  /** Plugin in the form that jsPsych expects. */
  class QuestionPlugin {
    static info = info

    /**
     * Keep the object that receives the data.
     * @param {object} jsPsych Object with the function `finishTrial`.
     */
    constructor (jsPsych) {
      this.jsPsych = jsPsych
    }

    /**
     * Show a trial; its end calls `finishTrial`.
     * @param {HTMLElement} display Element to fill.
     * @param {object} trial Parameters, as `info.parameters`.
     */
    trial (display, trial) {
      let shownAt = 0
      const form = new QuestionForm(trial, answer => {
        player?.stop()
        display.replaceChildren()
        const rt = Math.round(performance.now() - shownAt)
        this.jsPsych.finishTrial({ ...answer, options: [...trial.options], rt, film_shown: player?.shown ?? 0 })
      })
      const ask = focus => {
        if (!form.root.hidden) return
        form.root.hidden = false
        shownAt = performance.now()
        if (focus) form.fields.focus()
      }
      const player = trial.film ? new FilmPlayer(trial.film, trial.seen, () => ask(true)) : null
      form.root.hidden = true
      const heading = element('h1', {}, trial.owner ? `You are ${trial.owner}.` : 'You are told everything that happened.')
      const story = trial.story.map(text => element('p', {}, text))
      const scenes = story.length ? [element('div', { className: 'bn-story' }, ...story)] : []
      const root = element('section', { className: 'bn-trial', tabIndex: -1 }, heading, ...scenes, ...(player ? [player.root] : []), form.root)
      display.replaceChildren(root)
      root.focus()
      if (!player || trial.seen) ask(false)
    }
  }

  globalThis.jsPsychBeliefnestQuestion = QuestionPlugin
})()
