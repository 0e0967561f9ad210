'use strict'
module.exports.server = (serv) => {
  serv.useItemOn = () => {}
}
