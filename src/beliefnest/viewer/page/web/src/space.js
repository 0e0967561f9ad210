/** Simulator in three dimensions: boxes for blocks, figures for agents, labels as text on top. */

import {
  BoxGeometry, BufferAttribute, CapsuleGeometry, Color, ConeGeometry, DirectionalLight, EdgesGeometry, Group, HemisphereLight,
  Line, LineBasicMaterial, LineDashedMaterial, LineSegments, BufferGeometry, Mesh, MeshLambertMaterial,
  Raycaster, Scene, ShaderMaterial, SphereGeometry, TorusGeometry, Vector2, Vector3, WebGLRenderer
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { element } from './elements.js'
import { apart } from './labels.js'
import { CHUNK, Kinds, boxesOf, changedChunks, coarser, facesOf } from './surfaces.js'
import { contentsLabel, shortened, signsText } from './things.js'

const WRONG = 0xd55e00
const EYE = 1.62
const TALL = 23
const LETTER = 6.6
const SHARPEST = 1.5
const HURRIED = 0.5
const FINER = 2
const SUN = new Vector3(0.5, 1, 0.3)
const SUN_POWER = 1.6
const SKY_POWER = 2.2
const GROUND_LIGHT = 0xb8b0a4
const FAR = 60
const DARKER = 0.987
/** Shader of the corners of blocks' faces; `side` is the normal, and 1 for faces without a chequerboard. */
const FACE_CORNER = `
  attribute vec3 color;
  attribute vec4 side;
  flat varying vec3 vColor;
  flat varying float vPlain;
  varying vec2 vField;
  void main () {
    vColor = color;
    vPlain = side.w;
    vField = position.xz - 0.5 * side.xz;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`
const FACE_PIXEL = `
  uniform float opacity;
  flat varying vec3 vColor;
  flat varying float vPlain;
  varying vec2 vField;
  void main () {
    bool isDark = vPlain < 0.5 && mod(floor(vField.x) + floor(vField.y), 2.0) < 0.5;
    gl_FragColor = vec4(isDark ? ${DARKER} * vColor : vColor, opacity);
  }`
const OPACITY = { solid: 1, clear: 0.35, liquid: 0.6 }
/** Corners of the two triangles of a rectangle. */
const CORNERS = [0, 1, 2, 0, 2, 3]
const CUBE = new BoxGeometry(1, 1, 1)
const EDGES = new EdgesGeometry(CUBE)
/** Geometries of the parts of an agent: as it is drawn, and with few triangles for pictures from afar that move fast. */
const BODY = [new CapsuleGeometry(0.28, 0.75, 4, 12), new CapsuleGeometry(0.28, 0.75, 1, 6)]
const HEAD = [new SphereGeometry(0.26, 16, 12), new SphereGeometry(0.26, 6, 4)]
const NOSE = [new ConeGeometry(0.12, 0.32, 10), new ConeGeometry(0.12, 0.32, 4)]
const RING = new TorusGeometry(0.5, 0.045, 8, 32)
const UNSEEN = new Color('#55535c')

/** Return true if the browser can draw in three dimensions. @returns {boolean} */
export function hasWebGL () {
  try {
    return document.createElement('canvas').getContext('webgl2') !== null
  } catch {
    return false
  }
}

/** Picture in three dimensions; several pictures share a camera. */
export class Space {
  /** @param {boolean} isLarge - true for a world so large that each frame counts while it turns */
  constructor (camera, target, choose, moved, isLarge) {
    this.choose = choose
    this.isLarge = isLarge
    this.camera = camera
    this.renderer = new WebGLRenderer({ antialias: !isLarge, alpha: true, powerPreference: 'low-power' })
    this.canvas = this.renderer.domElement
    this.canvas.setAttribute('role', 'img')
    this.labels = element('div', { class: 'labels' })
    this.element = element('div', { class: 'space' }, this.canvas, this.labels)
    this.scene = new Scene()
    this.light = new HemisphereLight(0xffffff, GROUND_LIGHT, SKY_POWER)
    this.sun = new DirectionalLight(0xffffff, SUN_POWER)
    this.sun.position.copy(SUN)
    this.blocks = new Group()
    this.figures = new Group()
    this.scene.add(this.light, this.sun, this.blocks, this.figures)
    this.controls = new OrbitControls(camera, this.canvas)
    this.controls.target = target
    this.controls.maxPolarAngle = 0.495 * Math.PI
    this.controls.update()
    this.controls.addEventListener('change', moved)
    this.built = null
    this.run = null
    this.chunks = new Map()
    this.blocksBuilt = null
    this.coarse = null
    this.marks = []
    this.hurried = false
    // Keep materials for later pictures: creating a material costs more than drawing with it.
    this.materials = new Map()
    this.tags = new Map()
    this.listen()
  }

  listen () {
    let down = null
    this.canvas.addEventListener('pointerdown', event => { down = [event.clientX, event.clientY] })
    this.canvas.addEventListener('pointerup', event => {
      if (down !== null && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) this.pick(event)
      down = null
    })
  }

  dispose () {
    this.controls.dispose()
    this.renderer.dispose()
    this.renderer.forceContextLoss()
  }

  /**
   * Draw a scene.
   * @param {object} scene - as for `Plan.draw`
   */
  draw (scene) {
    this.canvas.setAttribute('aria-label', `${scene.track.path} in three dimensions; the list beside it says what it holds`)
    this.buildBlocks(scene)
    this.buildFigures(scene)
    this.render()
  }

  render () {
    const { width, height } = this.element.getBoundingClientRect()
    if (width < 2 || height < 2) return
    // A large world has no antialiasing, which costs most where pictures are drawn in software; the browser scales its
    // picture down once it rests.
    const scale = Math.min(SHARPEST, devicePixelRatio || 1) * (this.hurried ? HURRIED : this.isLarge ? FINER : 1)
    if (this.size !== `${width} ${height} ${scale}`) {
      this.size = `${width} ${height} ${scale}`
      this.renderer.setPixelRatio(scale)
      this.renderer.setSize(width, height)
    }
    this.camera.aspect = width / height
    this.camera.updateProjectionMatrix()
    this.chooseDetail()
    this.renderer.render(this.scene, this.camera)
    this.placeLabels(width, height)
  }

  buildBlocks (scene) {
    const version = `${scene.track.gridVersion(scene.tick)} ${scene.storey} ${scene.seenVersion} ${scene.dark}`
    if (version === this.built) return
    this.built = version
    if (this.run !== scene.run) this.dropChunks()
    this.run = scene.run
    const blocks = blocksOf(scene)
    const changed = changedChunks(this.blocksBuilt, blocks)
    if (this.isLarge) this.coarse = coarser(blocks, this.blocksBuilt?.top === blocks.top && (this.coarse?.seen === null) === (blocks.seen === null) ? this.coarse : null, changed)
    for (const number of changed) this.buildChunk(scene.run, blocks, number)
    // The arrays are overwritten when the track moves on.
    this.blocksBuilt = { ...blocks, grid: blocks.grid.slice(), seen: blocks.seen?.slice() ?? null }
  }

  /** Replace the meshes of one chunk. */
  buildChunk (run, blocks, number) {
    this.dropMeshes(this.chunks.get(number) ?? [])
    const made = [...this.mergedMeshes(run, blocks, number), ...this.boxMeshes(run, blocks, number)]
    if (this.isLarge) {
      // A picture from afar that moves fast shows blocks of twice the size in place of the merged ones.
      for (const mesh of made) mesh.userData.detail = mesh.userData.isMerged ? 'fine' : null
      for (const mesh of this.mergedMeshes(run, this.coarse, number)) {
        mesh.scale.setScalar(2)
        mesh.userData.detail = 'coarse'
        mesh.visible = false
        made.push(mesh)
      }
    }
    if (made.length) this.blocks.add(...made)
    this.chunks.set(number, made)
  }

  mergedMeshes (run, blocks, number) {
    const faces = facesOf(blocks, number, (state, isSeen, normal) => litShade(run.states[state], isSeen, normal))
    return ['solid', 'liquid'].filter(part => faces[part].places.length).map(part => {
      const mesh = meshOf(run, faces[part], this.material(part, () => faceMaterial(OPACITY[part])))
      mesh.userData.isMerged = true
      return mesh
    })
  }

  boxMeshes (run, blocks, number) {
    const faces = boxesOf(blocks, number, (state, isSeen, normal, isDark) => litShade(run.states[state], isSeen, normal, isDark))
    return ['solid', 'clear'].filter(part => faces[part].places.length).map(part => {
      const mesh = meshOf(run, faces[part], this.material(part, () => faceMaterial(OPACITY[part])))
      mesh.userData.cells = faces[part].cells
      return mesh
    })
  }

  /** Show what is far from the camera with less detail while pictures follow one another quickly. */
  chooseDetail () {
    if (!this.isLarge) return
    const isFar = (place, radius) => this.hurried && this.camera.position.distanceTo(place) - radius > FAR
    for (const meshes of this.chunks.values()) {
      for (const mesh of meshes) {
        if (mesh.userData.detail === null) continue
        const { center, radius } = sphereOf(mesh)
        mesh.visible = (mesh.userData.detail === 'coarse') === isFar(center, radius)
      }
    }
    for (const mesh of this.figures.children) {
      if (mesh.userData.fine) mesh.geometry = isFar(mesh.position, 0) ? mesh.userData.coarse : mesh.userData.fine
    }
  }

  dropMeshes (meshes) {
    for (const mesh of meshes) {
      this.blocks.remove(mesh)
      mesh.geometry.dispose()
    }
  }

  /** Remove all blocks, before those of another run are built. */
  dropChunks () {
    for (const meshes of this.chunks.values()) this.dropMeshes(meshes)
    this.chunks.clear()
    this.blocksBuilt = this.coarse = null
  }

  buildFigures (scene) {
    this.dropLines()
    this.figures.clear()
    this.marks = []
    for (const each of scene.things.containers) this.addContainer(scene, each)
    for (const each of scene.things.agents) if (each.pose !== null) this.addAgent(scene, each)
    for (const each of scene.things.signs) this.addSign(scene, each)
    for (const each of scene.run.head.places ?? []) this.addPlace(scene, each)
    for (const cell of scene.things.wrongBlocks.slice(0, 100)) this.outline(scene.run.place(cell), WRONG)
    for (const [, , x, y, z] of scene.things.items) this.add([CUBE], '#3fa7a7', [x, y + 0.15, z], { size: 0.22 })
    if (scene.ray !== null) this.addRay(scene.ray)
    this.dropTags()
  }

  /** Return the material of that name; create it on first use. */
  material (name, make) {
    if (!this.materials.has(name)) this.materials.set(name, make())
    return this.materials.get(name)
  }

  /** Dispose of the lines of the last picture; their points are not shared. */
  dropLines () {
    for (const each of this.figures.children) if (each.userData.own) each.geometry.dispose()
  }

  /** Remove the labels of things that are no longer in the picture. */
  dropTags () {
    const shown = new Set(this.marks.map(({ made }) => made))
    for (const [thing, made] of this.tags) {
      if (shown.has(made)) continue
      made.remove()
      this.tags.delete(thing)
    }
  }

  add ([geometry, coarse = geometry], colour, [x, y, z], { ghost = false, size = 1, thing = null } = {}) {
    const material = this.material(`${colour} ${ghost}`, () => new MeshLambertMaterial({ color: colour, transparent: ghost, opacity: ghost ? 0.45 : 1 }))
    const mesh = new Mesh(geometry, material)
    mesh.position.set(x, y, z)
    mesh.scale.setScalar(size)
    mesh.userData = { thing, fine: geometry, coarse }
    this.figures.add(mesh)
    return mesh
  }

  addAgent (scene, each) {
    const { pose, look, thing } = each
    const ghost = !pose.current
    const at = { ghost, thing }
    this.add(BODY, look.colour, [pose.x, pose.y + 0.68, pose.z], at)
    this.add(HEAD, look.colour, [pose.x, pose.y + 1.55, pose.z], at)
    const [dx, dz] = [-Math.sin(pose.yaw) * Math.cos(pose.pitch), -Math.cos(pose.yaw) * Math.cos(pose.pitch)]
    const dy = Math.sin(pose.pitch)
    const nose = this.add(NOSE, look.colour, [pose.x + 0.36 * dx, pose.y + 1.55 + 0.36 * dy, pose.z + 0.36 * dz], at)
    nose.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(dx, dy, dz).normalize())
    const wrong = each.marks.includes('false')
    if (wrong || scene.chosen === thing) {
      const ring = this.add([RING], wrong ? WRONG : '#2b2a33', [pose.x, pose.y + 0.06, pose.z], {})
      ring.rotation.x = Math.PI / 2
    }
    const sign = signsText(scene.run, each.marks, each.age)
    this.label(thing, [pose.x, pose.y + 2.15, pose.z], [look.name, sign].filter(Boolean).join(' '), wrong, look)
  }

  addContainer (scene, each) {
    const [x, y, z] = each.place
    const wrong = each.marks.includes('false')
    if (wrong) this.outline(each.place, WRONG)
    else if (scene.chosen === each.thing) this.outline(each.place, 0x2b2a33)
    if (each.contents === null && scene.track.grid(scene.tick)[each.cell] < 0) this.outline(each.place, 0x8a8890)
    const sign = signsText(scene.run, each.marks, each.age)
    const named = scene.run.label(each.place)
    const contentText = [contentsLabel(each.contents), sign].filter(Boolean).join(' ')
    this.label(each.thing, [x + 0.5, y + 1.35, z + 0.5], named === null ? contentText : `${named}: ${contentText}`, wrong)
  }

  /** Show the name of a place; names are no buttons, because nobody believes anything about them. */
  addPlace (scene, [x, y, z, name]) {
    if (y > scene.storey + 1) return
    this.label(`place-${name}`, [x + 0.5, y + 0.3, z + 0.5], name, false)
  }

  addSign (scene, each) {
    const [x, y, z] = each.place
    if (y > scene.storey + 1) return
    this.label(each.thing, [x + 0.5, y + 1.1, z + 0.5], `“${shortened(each.says)}”`, each.marks.includes('false'))
  }

  outline ([x, y, z], colour) {
    const lines = new LineSegments(EDGES, this.lines(colour))
    lines.position.set(x + 0.5, y + 0.5, z + 0.5)
    lines.scale.setScalar(1.04)
    this.figures.add(lines)
  }

  lines (colour) {
    return this.material(`lines ${colour}`, () => new LineBasicMaterial({ color: colour, linewidth: 2 }))
  }

  addRay (ray) {
    const points = (a, b) => new BufferGeometry().setFromPoints([new Vector3(a.x, a.y, a.z), new Vector3(b.x, b.y, b.z)])
    const free = new Line(points(ray.from, ray.stop), this.lines(ray.seen ? 0x009e73 : WRONG))
    free.userData.own = true
    this.figures.add(free)
    if (!ray.seen) {
      const beyond = new Line(points(ray.stop, ray.to), this.material('dashes', () => new LineDashedMaterial({ color: 0x8a8890, dashSize: 0.3, gapSize: 0.2 })))
      beyond.userData.own = true
      beyond.computeLineDistances()
      this.figures.add(beyond)
    }
    if (ray.blocker) this.outline(ray.blocker, WRONG)
  }

  label (thing, place, text, wrong, look = null) {
    const made = this.tag(thing)
    const classes = `tag${wrong ? ' false' : ''}${thing.startsWith('place-') ? ' place' : ''}`
    if (made.className !== classes) made.className = classes
    if (made.textContent !== text) made.textContent = text
    made.style.borderColor = look?.colour ?? ''
    this.marks.push({ made, at: new Vector3(...place), width: 20 + LETTER * text.length })
  }

  tag (thing) {
    if (!this.tags.has(thing)) {
      const made = thing.startsWith('place-')
        ? element('span', {})
        : element('button', { type: 'button', tabindex: '-1', onclick: () => this.choose({ thing, note: null }) })
      this.labels.append(made)
      this.tags.set(thing, made)
    }
    return this.tags.get(thing)
  }

  placeLabels (width, height) {
    const taken = []
    for (const mark of this.marks) {
      const point = mark.at.clone().project(this.camera)
      mark.made.hidden = point.z > 1
      const [x, y] = [(point.x + 1) / 2 * width, (1 - point.y) / 2 * height]
      const free = apart(taken, { left: x - mark.width / 2, top: y - TALL, width: mark.width, height: TALL })
      taken.push(free)
      mark.made.style.transform = `translate(${free.left.toFixed(1)}px, ${free.top.toFixed(1)}px)`
    }
  }

  pick (event) {
    const room = this.canvas.getBoundingClientRect()
    const point = new Vector2((event.clientX - room.left) / room.width * 2 - 1, 1 - (event.clientY - room.top) / room.height * 2)
    const caster = new Raycaster()
    caster.setFromCamera(point, this.camera)
    const [hit] = caster.intersectObjects([...this.figures.children.filter(each => each.userData.thing), ...this.blocks.children.filter(each => each.userData.detail !== 'coarse')])
    if (hit === undefined) return
    this.choose({ thing: hit.object.userData.thing ?? this.blockAt(hit), note: null })
  }

  /** Return the block or container that a ray hit. @returns {string} */
  blockAt ({ object, faceIndex, point, face }) {
    const run = this.run
    const cell = object.userData.isMerged ? run.cell(point.clone().addScaledVector(face.normal, -0.5).toArray()) : object.userData.cells[Math.floor(faceIndex / 2)]
    return `${run.states[this.blocksBuilt.grid[cell]].container ? 'container' : 'block'}-${cell}`
  }
}

/** Return the blocks that a scene shows, up to a storey's head height. @returns {object} */
function blocksOf ({ run, track, tick, storey, seen }) {
  if (run.kinds?.count !== run.states.length) run.kinds = new Kinds(run.states)
  const top = Math.max(0, Math.min(run.shape[1], storey - run.head.box.low[1] + 2))
  return { grid: track.grid(tick), shape: run.shape, top, kinds: run.kinds, seen, chunk: CHUNK, outset: 0 }
}

/** Return the colour of a block; the next call may return the same object. */
function shadeOf (block, isSeen) {
  block.shade ??= new Color(block.colour)
  block.unseen ??= block.shade.clone().lerp(UNSEEN, 0.6)
  return isSeen ? block.shade : block.unseen
}

/** Return the colour of a block's face in the light of the scene, as screens show it (sRGB). @returns {number[]} */
function litShade (block, isSeen, normal, isDark = false) {
  const name = `${isSeen} ${isDark} ${normal.join()}`
  block.lit ??= new Map()
  if (!block.lit.has(name)) {
    const lit = shadeOf(block, isSeen).clone().multiply(lightOn(normal)).convertLinearToSRGB()
    block.lit.set(name, lit.multiplyScalar(isDark ? DARKER : 1).toArray())
  }
  return block.lit.get(name)
}

/**
 * Return the light that a face of a block reflects, as the lights of the scene shine on a MeshLambertMaterial. Faces of
 * blocks look to six sides only, so that their colours include it and no pixel computes it.
 * @returns {Color} share of each colour
 */
function lightOn (normal) {
  const direction = new Vector3(...normal)
  const sky = new Color(GROUND_LIGHT).lerp(new Color(0xffffff), 0.5 * direction.y + 0.5).multiplyScalar(SKY_POWER)
  const sun = SUN_POWER * Math.max(0, direction.dot(SUN.clone().normalize()))
  return sky.addScalar(sun).multiplyScalar(1 / Math.PI)
}

/** Return the material of faces that have their light in their colours, with every second block a little darker. */
function faceMaterial (opacity) {
  return new ShaderMaterial({ vertexShader: FACE_CORNER, fragmentShader: FACE_PIXEL, uniforms: { opacity: { value: opacity } }, transparent: opacity < 1 })
}

/** Return the mesh of faces of a run's blocks. */
function meshOf (run, { places, colours, sides }, material) {
  const corners = Uint32Array.from({ length: 3 * sides.length / 8 }, (_, at) => 4 * Math.floor(at / 6) + CORNERS[at % 6])
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3))
  geometry.setAttribute('color', new BufferAttribute(new Float32Array(colours), 3))
  geometry.setAttribute('side', new BufferAttribute(new Int8Array(sides), 4))
  geometry.setIndex(new BufferAttribute(corners, 1))
  const mesh = new Mesh(geometry, material)
  mesh.position.set(...run.head.box.low)
  return mesh
}

/** Return a sphere around a mesh, in coordinates of the world. */
function sphereOf (mesh) {
  if (mesh.userData.sphere === undefined) {
    mesh.geometry.computeBoundingSphere()
    mesh.userData.sphere = mesh.geometry.boundingSphere.clone()
    mesh.userData.sphere.center.multiply(mesh.scale).add(mesh.position)
    mesh.userData.sphere.radius *= mesh.scale.x
  }
  return mesh.userData.sphere
}

export { EYE }
