// Stand-in for the part of jsPsych 8 that a plugin meets. It notes what jsPsych refuses or warns of.
const ParameterType = Object.fromEntries(['BOOL', 'STRING', 'INT', 'FLOAT', 'OBJECT'].map((name, at) => [name, at]))
globalThis.jsPsychModule = { ParameterType }
globalThis.faults = []
const kinds = { [ParameterType.BOOL]: 'boolean', [ParameterType.STRING]: 'string', [ParameterType.OBJECT]: 'object' }
function parametersOf (info, trial) {
  const own = {}
  for (const [name, declared] of Object.entries(info.parameters)) {
    own[name] = name in trial ? trial[name] : declared.default
    if (own[name] === undefined) faults.push(`no ${name}`)
    const values = declared.array ? own[name] : [own[name]]
    if (declared.array && !Array.isArray(own[name])) faults.push(`${name} is no list`)
    else if (!values.every(value => typeof value === kinds[declared.type])) faults.push(`type of ${name}`)
  }
  for (const name of Object.keys(trial)) if (!(name in info.parameters || ['type', 'data'].includes(name))) faults.push(`unknown ${name}`)
  return own
}
globalThis.initJsPsych = options => {
  const rows = []
  const properties = {}
  const jsPsych = {
    data: {
      addProperties: more => Object.assign(properties, more),
      get: () => ({ localSave: (form, name) => Object.assign(globalThis, { saved: { form, name, rows } }) })
    },
    run: async timeline => {
      for (const trial of timeline) {
        const { info } = trial.type
        for (const key of ['name', 'version', 'parameters', 'data']) if (!info[key]) faults.push(`no info.${key}`)
        document.body.innerHTML = '<div id="jspsych-content" class="jspsych-content"></div>'
        const data = await new Promise(resolve => {
          jsPsych.finishTrial = resolve
          new trial.type(jsPsych).trial(document.getElementById('jspsych-content'), parametersOf(info, trial))
        })
        if (Object.keys(data).sort().join() !== Object.keys(info.data).sort().join()) faults.push('data')
        rows.push({ ...data, ...trial.data, ...properties, trial_type: info.name, trial_index: rows.length })
      }
      options.on_finish()
    }
  }
  return jsPsych
}
