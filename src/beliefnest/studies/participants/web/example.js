'use strict'

// The session under jsPsych: add trials of your own before and after.
;(async () => {
  const { initJsPsych, beliefnest, beliefnestStudy } = globalThis
  const study = await beliefnest.unpack(beliefnestStudy)
  const session = beliefnest.sessionOf(study)
  const jsPsych = initJsPsych({
    show_progress_bar: true,
    on_finish: () => jsPsych.data.get().localSave('csv', `answers-${session.properties.participant}.csv`)
  })
  jsPsych.data.addProperties(session.properties)
  await jsPsych.run(beliefnest.timelineOf(session))
})()
