'use strict'
/**
 * A worker thread that ends the process when the descriptor it is given reaches its end: the
 * other end is held by the process that started this one, and closes however that one dies.
 */
const net = require('node:net')
const { workerData } = require('node:worker_threads')

const lifeline = new net.Socket({ fd: workerData.descriptor, readable: true, writable: false })
const end = () => process.kill(process.pid, 'SIGKILL')
lifeline.on('end', end)
lifeline.on('error', end)
lifeline.on('close', end)
lifeline.resume()
