'use strict'
/**
 * Worker thread that ends the process when its descriptor reaches the end of file. The process that started this one
 * holds the other end, which closes however that process dies.
 */
const net = require('node:net')
const { workerData } = require('node:worker_threads')

const lifeline = new net.Socket({ fd: workerData.descriptor, readable: true, writable: false })
const end = () => process.kill(process.pid, 'SIGKILL')
lifeline.on('end', end)
lifeline.on('error', end)
lifeline.on('close', end)
lifeline.resume()
