// The page of `ilaw view`: draws one run, whose data are in the page. three.js and its OrbitControls come before.
// SPDX-License-Identifier: BSD-3-Clause
"use strict";

const NO_VALUE = 65535;
const SECONDS = 8; // that the whole run takes at speed 1
const VIRIDIS = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121],
  [109, 205, 89], [180, 222, 44], [253, 231, 37]];
const BLUE_RED = [[33, 102, 172], [103, 169, 207], [209, 229, 240], [247, 247, 247], [253, 219, 199], [239, 138, 98], [178, 24, 43]];
const STATUS_COLORS = ["#bdbdbd", "#56b4e9", "#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#000000"];
const CURVE_COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d31"];
const BODY_COLORS = ["#b9cbe0", "#e3cfae", "#bfdcc2", "#ddc3d6", "#d8d8c0", "#bfdbe0"];
const KINDS = { "<u2": Uint16Array, "<i4": Int32Array, "<f4": Float32Array, "<f8": Float64Array };

const $ = id => document.getElementById(id);
const rgb = text => new THREE.Color(text).toArray();
const run = JSON.parse($("run").textContent);

function make(tag, parent, text, css) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (css) element.className = css;
  if (parent) parent.appendChild(element);
  return element;
}

function number(value) {
  if (value === null || !isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return Number(value.toPrecision(3)).toExponential().replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}

const withUnit = (label, unit) => unit ? `${label} [${unit}]` : label;

// --- data ------------------------------------------------------------------------------------------------------------

const opened = new Map();

function open(part) {
  if (!opened.has(part.block)) opened.set(part.block, unpack($("block" + part.block), KINDS[part.kind]));
  return opened.get(part.block);
}

async function unpack(element, Kind) {
  const text = atob(element.textContent), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  element.textContent = "";
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Kind(await new Response(stream).arrayBuffer());
}

// Values of frames, in 16 bits of the range of each frame.
class Channel {
  constructor(levels, low, step, components) {
    this.levels = levels, this.low = low, this.step = step, this.components = components;
    this.size = levels.length / (low.length / components);
  }
  static async open(part, components) {
    return new Channel(await open(part), await open(part.low), await open(part.step), components);
  }
  value(frame, i) {
    const level = this.levels[frame * this.size + i], at = frame * this.components + i % this.components;
    return level === NO_VALUE ? NaN : this.low[at] + this.step[at] * level;
  }
  // Linear between frames; a value that only one of both has stays.
  between(position, out, linear) {
    const frame = Math.floor(position), part = linear ? position - frame : 0;
    for (let i = 0; i < this.size; ++i) out[i] = this.value(frame, i);
    if (part > 0) for (let i = 0; i < this.size; ++i) {
      const next = this.value(frame + 1, i);
      if (next === next && out[i] === out[i]) out[i] += part * (next - out[i]);
    }
    return out;
  }
}

const frames = run.times.length;

function timeAt(position) {
  const k = Math.min(Math.floor(position), frames - 1), next = Math.min(k + 1, frames - 1);
  return run.times[k] + (position - k) * (run.times[next] - run.times[k]);
}

function positionAt(time) {
  let k = 0;
  while (k < frames - 2 && run.times[k + 1] <= time) ++k;
  const span = k + 1 < frames ? run.times[k + 1] - run.times[k] : 0;
  return Math.max(0, Math.min(frames - 1, k + (span > 0 ? (time - run.times[k]) / span : 0)));
}

// --- scene -----------------------------------------------------------------------------------------------------------

const flat = run.dimension < 3;
const state = { position: 0, playing: false, scale: 1, field: null, low: 0, high: 1, shown: 0 };
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true, alpha: true });
renderer.setPixelRatio(window.devicePixelRatio);
const view = $("stage");
view.appendChild(renderer.domElement);
const scene = new THREE.Scene();
const camera = flat ? new THREE.OrthographicCamera(-1, 1, 1, -1, -1e6, 1e6) : new THREE.PerspectiveCamera(28, 1, 0.1, 1000);
if (!flat) camera.up.set(0, 0, 1);
const controls = new THREE.OrbitControls(camera, renderer.domElement);
controls.enableRotate = !flat;
controls.screenSpacePanning = true;
if (flat) controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
const headlight = new THREE.DirectionalLight(0xffffff, 0.42);
camera.add(headlight);
headlight.position.set(0.4, 0.6, 1);
scene.add(camera, new THREE.AmbientLight(0xffffff, 0.66));

const model = { bodies: [], obstacles: [], size: 1, center: new THREE.Vector3() };
let dirty = true;

// Colors of nodes that have no value: those of their bodies.
function baseColors(film) {
  const colors = new Float32Array(3 * film.nodes);
  model.bodies.forEach((body, k) => {
    const color = rgb(BODY_COLORS[k % BODY_COLORS.length]);
    for (const node of body.nodes) colors.set(color, 3 * node);
  });
  return colors;
}

function roundSprite() {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const brush = canvas.getContext("2d"), shade = brush.createRadialGradient(26, 22, 2, 32, 32, 31);
  shade.addColorStop(0, "#fff"), shade.addColorStop(0.55, "#e4e4e4"), shade.addColorStop(1, "#8a8a8a");
  brush.fillStyle = shade;
  brush.beginPath(), brush.arc(32, 32, 31, 0, 7), brush.fill();
  return new THREE.CanvasTexture(canvas);
}

async function addBodies(film) {
  model.points = await open(film.points);
  model.u = await Channel.open(film.u, 3);
  model.displacement = new Float32Array(3 * film.nodes);
  model.place = new THREE.BufferAttribute(new Float32Array(3 * film.nodes), 3);
  model.color = new THREE.BufferAttribute(new Float32Array(3 * film.nodes), 3);
  model.modelNodes = await open(film.modelNodes);
  findSize(film, film.others && await open(film.others));
  for (const part of film.bodies) {
    const body = { name: part.name, group: new THREE.Group(), facets: part.facets || 0 };
    const geometry = index => {
      const made = new THREE.BufferGeometry();
      made.setAttribute("position", model.place), made.setAttribute("color", model.color);
      made.setIndex(new THREE.BufferAttribute(new Uint32Array(index), 1));
      return made;
    };
    if (film.isPoints) {
      body.nodes = await open(part.drawn);
      const material = new THREE.PointsMaterial({ vertexColors: THREE.VertexColors, map: roundSprite(), alphaTest: 0.5 });
      material.sizeAttenuation = !flat;
      material.size = flat ? 17 : model.size * 0.03;
      body.dots = new THREE.Points(geometry(body.nodes), material);
      body.group.add(body.dots);
    } else {
      const triangles = await open(part.triangles), edges = await open(part.edges);
      body.nodes = Array.from(new Set(triangles));
      body.surface = new THREE.Mesh(geometry(triangles), new THREE.MeshPhongMaterial({ vertexColors: THREE.VertexColors,
        flatShading: true, side: THREE.DoubleSide, specular: 0, shininess: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
      body.lines = new THREE.LineSegments(geometry(edges), new THREE.LineBasicMaterial({ color: 0x1d2733, transparent: true, opacity: 0.45 }));
      body.group.add(body.surface, body.lines);
    }
    for (const child of body.group.children) child.frustumCulled = false;
    scene.add(body.group);
    model.bodies.push(body);
  }
  model.base = baseColors(film);
  if (film.others) await addOthers(film.others);
  if (film.springs) addSprings(film.springs);
  if (film.forces) await addForces(film.forces);
}

// The box of all places in all frames, from a sample of the nodes where there are many.
function findSize(film, others) {
  const box = new THREE.Box3(), x = new THREE.Vector3(), every = Math.max(1, Math.floor(film.nodes * frames / 2e6));
  const start = new THREE.Box3();
  let largest = 0;
  for (let n = 0; n < film.nodes; n += every) {
    for (let frame = 0; frame < model.u.low.length / 3; ++frame) {
      const u = [0, 1, 2].map(c => model.u.value(frame, 3 * n + c));
      largest = Math.max(largest, Math.hypot(...u));
      x.set(...u.map((value, c) => value + model.points[3 * n + c]));
      box.expandByPoint(x);
    }
    start.expandByPoint(x.fromArray(model.points, 3 * n));
  }
  if (film.others) for (let k = 0; k < others.length; k += 3) box.expandByPoint(x.fromArray(others, k));
  box.getCenter(model.center);
  model.box = box;
  model.size = box.getSize(x).length() || 1;
  model.startSize = start.getSize(x).length() || model.size;
  model.largest = largest;
}

// Points whose motion is not known.
async function addOthers(part) {
  const geometry = new THREE.BufferGeometry(), places = await open(part), dots = new THREE.Points(geometry,
    new THREE.PointsMaterial({ color: 0xc9d0d8, map: roundSprite(), alphaTest: 0.5, size: 9, sizeAttenuation: false }));
  geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  dots.frustumCulled = false;
  scene.add(dots);
  model.others = dots;
}

function addSprings(springs) {
  const count = springs.pairs.length + springs.anchors.length, geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6 * count), 3));
  const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x666666 }));
  lines.frustumCulled = false;
  scene.add(lines);
  model.moveSprings = () => {
    const out = geometry.attributes.position.array, node = k => model.place.array.subarray(3 * k, 3 * k + 3);
    springs.pairs.forEach(([a, b], k) => { out.set(node(a), 6 * k), out.set(node(b), 6 * k + 3); });
    springs.anchors.forEach(([a, ...place], k) => {
      out.set(node(a), 6 * (springs.pairs.length + k)), out.set(place, 6 * (springs.pairs.length + k) + 3);
    });
    geometry.attributes.position.needsUpdate = true;
  };
}

// An arrow of length 1 along y that ends at the origin.
function arrowGeometry() {
  const shaft = new THREE.CylinderBufferGeometry(0.022, 0.022, 0.72, 8, 1), head = new THREE.ConeBufferGeometry(0.075, 0.28, 12, 1);
  shaft.translate(0, -0.64, 0), head.translate(0, -0.14, 0);
  const geometry = new THREE.BufferGeometry(), shift = shaft.attributes.position.count;
  const position = [...shaft.attributes.position.array, ...head.attributes.position.array];
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(position, 3));
  geometry.setIndex([...shaft.index.array, ...Array.from(head.index.array, i => i + shift)]);
  return geometry;
}

async function addForces(part) {
  const force = { part, nodes: await open(part.nodes), values: await Channel.open(part.values, 3) };
  force.now = new Float32Array(3 * part.count);
  force.mesh = new THREE.InstancedMesh(arrowGeometry(), new THREE.MeshBasicMaterial({ color: 0xc2185b, depthTest: false, transparent: true, opacity: 0.9 }), part.count);
  force.mesh.frustumCulled = false, force.mesh.renderOrder = 5;
  scene.add(force.mesh);
  model.forces = force;
}

function moveForces() {
  const force = model.forces;
  if (!force) return;
  force.mesh.visible = $("arrows").checked;
  force.values.between(state.position, force.now, false);
  const unit = 0.13 * model.viewSize * Math.pow(10, Number($("arrowSize").value) / 2) / force.part.typical;
  const to = new THREE.Vector3(), place = new THREE.Vector3(), up = new THREE.Vector3(0, 1, 0), turn = new THREE.Quaternion();
  const size = new THREE.Vector3(), matrix = new THREE.Matrix4();
  const slender = Math.min(1, Math.sqrt(150 / force.part.count)) * 0.5 + 0.5;
  const every = Math.ceil(force.part.count / 600); // more of them would hide the bodies
  let shown = 0;
  for (let k = 0; k < force.part.count; k += every) {
    to.fromArray(force.now, 3 * k);
    const f = to.length(), length = Math.min(f * unit, model.viewSize);
    if (!(f > 1e-3 * force.part.typical)) continue;
    turn.setFromUnitVectors(up, to.divideScalar(f));
    const width = Math.min(length, 0.1 * model.viewSize) * slender;
    place.fromArray(model.place.array, 3 * force.nodes[k]).y += run.film.lift || 0;
    matrix.compose(place, turn, size.set(width, length, width));
    force.mesh.setMatrixAt(shown++, matrix);
  }
  force.mesh.count = shown;
  force.mesh.instanceMatrix.needsUpdate = true;
}

// --- obstacles -------------------------------------------------------------------------------------------------------

const WALL = new THREE.MeshBasicMaterial({ color: 0x7d8b99, transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false });
const WALL_LINE = new THREE.LineBasicMaterial({ color: 0x55616d, transparent: true, opacity: 0.55 });

function lines(points) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  return new THREE.LineSegments(geometry, WALL_LINE);
}

// How far a plane is drawn along its two directions: as far as the bodies, and a little more.
function footprint(given, reach) {
  if (!model.box || given.turns) return [reach, reach];
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3().fromArray(given.axis[0])).inverse();
  const size = new THREE.Vector3(), corner = new THREE.Vector3(), { min, max } = model.box;
  for (let k = 0; k < 8; ++k) {
    corner.set(k & 1 ? min.x : max.x, k & 2 ? min.y : max.y, k & 4 ? min.z : max.z).sub(model.center).applyQuaternion(turn);
    size.set(Math.max(size.x, Math.abs(corner.x)), 0, Math.max(size.z, Math.abs(corner.z)));
  }
  return [size.x, size.z].map(half => half + 0.15 * reach);
}

// Along y the normal, with the origin in its middle; in 2D a strip below a line.
function planeShape(given, reach) {
  const group = new THREE.Group();
  if (flat) {
    const strip = new THREE.Mesh(new THREE.PlaneBufferGeometry(2 * reach, 0.06 * reach), WALL), points = [-reach, 0, 0, reach, 0, 0];
    strip.position.y = -0.03 * reach;
    for (let k = -20; k < 20; ++k) points.push(k * reach / 20, -0.06 * reach, 0, (k + 1) * reach / 20, 0, 0);
    group.add(strip, lines(points));
    return group;
  }
  const cell = reach / 5, [a, b] = footprint(given, reach).map(half => Math.ceil(half / cell) * cell), points = [];
  const quad = new THREE.Mesh(new THREE.PlaneBufferGeometry(2 * a, 2 * b), WALL);
  quad.rotateX(Math.PI / 2);
  for (let x = -a; x <= a * (1 + 1e-9); x += cell) points.push(x, 0, -b, x, 0, b);
  for (let z = -b; z <= b * (1 + 1e-9); z += cell) points.push(-a, 0, z, a, 0, z);
  group.add(quad, lines(points));
  return group;
}

function roundShape(obstacle, reach) {
  const group = new THREE.Group(), radius = obstacle.radius, points = [], parts = flat ? 720 : 72;
  for (let k = 0; k < parts; ++k) for (const j of [k, k + 1])
    points.push(radius * Math.cos(2 * Math.PI * j / parts), radius * Math.sin(2 * Math.PI * j / parts), 0);
  if (flat) {
    for (let k = 0; k < 8; ++k) points.push(0, 0, 0, radius * Math.cos(k * Math.PI / 4), radius * Math.sin(k * Math.PI / 4), 0);
    group.add(new THREE.Mesh(new THREE.CircleBufferGeometry(radius, parts), WALL), lines(points));
  } else if (obstacle.type === "sphere") {
    const solid = new THREE.MeshPhongMaterial({ color: 0x9aa7b4, transparent: true, opacity: 0.55, specular: 0 });
    group.add(new THREE.Mesh(new THREE.SphereBufferGeometry(radius, 40, 28), solid));
  } else {
    const solid = new THREE.MeshPhongMaterial({ color: 0x9aa7b4, transparent: true, opacity: 0.55, specular: 0, side: THREE.DoubleSide });
    const length = 2 * Math.max(reach, radius), tube = new THREE.CylinderBufferGeometry(radius, radius, length, 48, 1, true), spokes = [];
    for (let k = 0; k < 12; ++k) {
      const c = radius * Math.cos(k * Math.PI / 6), s = radius * Math.sin(k * Math.PI / 6);
      spokes.push(c, -length / 2, s, c, length / 2, s);
    }
    group.add(new THREE.Mesh(tube, solid), lines(spokes));
  }
  return group;
}

function addObstacles() {
  const reach = 0.62 * (model.size || 1);
  for (const given of run.obstacles) {
    const shape = given.type === "plane" ? planeShape(given, reach) : roundShape(given, reach);
    scene.add(shape);
    model.obstacles.push({ name: given.interface, given, shape, reach });
  }
}

function moveObstacles() {
  const k = Math.floor(state.position), next = Math.min(k + 1, frames - 1), part = $("smooth").checked ? state.position - k : 0;
  const up = new THREE.Vector3(0, flat ? 1 : 1, 0);
  for (const { given, shape, reach } of model.obstacles) {
    const at = (table, i) => new THREE.Vector3().fromArray(table[k]).lerp(new THREE.Vector3().fromArray(table[next]), part);
    const start = new THREE.Vector3().fromArray(given.place[0]);
    const moved = at(given.place).sub(start).multiplyScalar(state.scale), place = start.add(moved), axis = at(given.axis).normalize();
    const angle = given.angle[k] + part * (given.angle[next] - given.angle[k]);
    if (given.type === "sphere" || (flat && given.type !== "plane")) shape.quaternion.setFromAxisAngle(new THREE.Vector3(0, 0, 1), angle);
    else shape.quaternion.setFromUnitVectors(up, axis).premultiply(new THREE.Quaternion().setFromAxisAngle(axis, angle));
    if (given.type === "plane" && !given.turns) {
      // Drawn near the bodies; its grid goes with it.
      const off = model.center.clone().sub(place), cell = reach / 5;
      off.addScaledVector(axis, -off.dot(axis));
      place.add(new THREE.Vector3(...off.toArray().map(c => Math.round(c / cell) * cell)).projectOnPlane(axis));
    } else if (given.type === "cylinder") place.addScaledVector(axis, model.center.clone().sub(place).dot(axis));
    shape.position.copy(place);
  }
}

// --- colors ----------------------------------------------------------------------------------------------------------

function sampled(colors, x) {
  const at = Math.max(0, Math.min(1, x)) * (colors.length - 1), k = Math.min(Math.floor(at), colors.length - 2);
  return colors[k].map((c, i) => (c + (at - k) * (colors[k + 1][i] - c)) / 255);
}

const tables = [VIRIDIS, BLUE_RED].map(colors => Array.from({ length: 256 }, (_, k) => sampled(colors, k / 255)));
const statusTable = STATUS_COLORS.map(rgb);

async function chooseField(index) {
  const field = run.film && run.film.fields[index];
  state.field = null;
  $("field").value = index;
  if (field) {
    const nodes = field.nodes ? await open(field.nodes) : null, values = await Channel.open(field.values, 1);
    state.field = { ...field, nodes, channel: values, now: new Float32Array(values.size), isStatus: field.name === "status" };
    setRange();
  }
  show(state.position);
  drawBar();
}

function setRange() {
  const field = state.field, mode = $("range").value;
  if (!field || mode === "own") return;
  let low = field.least, high = field.most;
  // A peak of an impact, in a few frames, would leave all others in one color.
  if (mode === "all" && field.most > 4 * field.peaks && field.least >= 0) high = field.peaks;
  if (mode === "frame") {
    const known = Array.from(field.channel.between(state.position, field.now, true)).filter(isFinite);
    low = known.reduce((a, b) => Math.min(a, b), Infinity), high = known.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!known.length) low = high = 0;
  }
  if (low < 0 && high > 0 && mode === "all" && -low > 0.2 * high) high = Math.max(high, -low), low = -high;
  state.low = low, state.high = high;
  $("least").value = number(low), $("most").value = number(high);
}

const tableOf = () => state.low < 0 && state.high === -state.low ? tables[1] : tables[0];

function paint() {
  const out = model.color.array, field = state.field;
  out.set(model.base);
  if (field) {
    field.channel.between(state.position, field.now, !field.isStatus);
    if ($("range").value === "frame" && !field.isStatus) setRange();
    const span = state.high - state.low || 1, table = tableOf();
    for (let i = 0; i < field.now.length; ++i) {
      const value = field.now[i], node = field.nodes ? field.nodes[i] : i;
      if (value !== value || (field.isStatus && value < 0)) continue;
      const at = Math.round(255 * (value - state.low) / span);
      out.set(field.isStatus ? statusTable[Math.round(value)] : table[at < 0 ? 0 : at > 255 ? 255 : at], 3 * node);
    }
  }
  model.color.needsUpdate = true;
}

function drawBar() {
  const bar = $("bar"), field = state.field;
  bar.replaceChildren();
  bar.style.display = field ? "" : "none";
  if (!field) return;
  make("b", bar, (field.interface ? field.interface + ": " : "") + withUnit(field.label, field.unit));
  if (field.isStatus) {
    for (let k = Math.max(0, field.least); k <= field.most; ++k) {
      const row = make("div", bar);
      make("span", row, undefined, "chip").style.background = STATUS_COLORS[k];
      row.append(run.statusNames[k]);
    }
  } else {
    const row = make("div", bar, undefined, "scale"), canvas = make("canvas", row), ticks = make("div", row, undefined, "ticks");
    canvas.width = 1, canvas.height = 256;
    const brush = canvas.getContext("2d"), table = tableOf();
    for (let k = 0; k < 256; ++k) brush.fillStyle = `rgb(${table[255 - k].map(c => Math.round(255 * c))})`, brush.fillRect(0, k, 1, 1);
    for (let k = 4; k >= 0; --k) make("span", ticks, number(state.low + k / 4 * (state.high - state.low)));
    if (field.most > state.high * (1 + 1e-6)) ticks.firstChild.textContent = "≥ " + number(state.high);
    if (field.least < state.low - 1e-6 * Math.abs(state.low)) ticks.lastChild.textContent = "≤ " + number(state.low);
    make("div", bar, `all times: ${number(field.least)} to ${number(field.most)}`).style.fontSize = "11px";
  }
  if (!field.interface || run.film.isPoints) return;
  const row = make("div", bar);
  row.style.fontSize = "11px";
  make("span", row, undefined, "chip").style.background = BODY_COLORS[0];
  row.append(/pressure|shear|slip/.test(field.name) ? "free, or not in it" : "not in the interface");
}

// --- time ------------------------------------------------------------------------------------------------------------

function show(position) {
  state.position = Math.max(0, Math.min(frames - 1, position));
  state.shown = timeAt(state.position);
  if (run.film) {
    const linear = $("smooth").checked, u = model.u.between(Math.min(state.position, model.u.low.length / 3 - 1), model.displacement, linear);
    const out = model.place.array;
    for (let i = 0; i < out.length; ++i) out[i] = model.points[i] + state.scale * u[i];
    model.place.needsUpdate = true;
    paint();
    moveForces();
    if (model.moveSprings) model.moveSprings();
  }
  moveObstacles();
  if ($("range").value === "frame") drawBar();
  $("slider").value = state.position;
  tellMoment();
  panels.forEach(panel => panel.draw());
  markEvent();
  dirty = true;
}

function tellMoment() {
  const frame = Math.floor(state.position + 1e-9) + 1;
  let text = `time ${number(state.shown)} ${run.timeUnit}`.trim() + ` of ${number(run.end)}, frame ${frame} of ${frames}`;
  if (state.scale !== 1) text += `, deformation × ${number(state.scale)}`;
  if (model.forces && $("arrows").checked) text += `; largest force ${number(largestForce())} ${model.forces.part.unit}`;
  $("told").textContent = text;
}

function largestForce() {
  let most = 0;
  const now = model.forces.now;
  for (let i = 0; i < now.length; i += 3) most = Math.max(most, Math.hypot(now[i], now[i + 1], now[i + 2]));
  return most;
}

function play(on) {
  if (on && state.position >= frames - 1) show(0);
  state.playing = on && frames > 1;
  $("play").textContent = state.playing ? "❚❚" : "▶";
}

let last = 0;
function tick(now) {
  requestAnimationFrame(tick);
  if (state.playing) {
    const span = run.times[frames - 1] - run.times[0];
    const time = state.shown + Math.min(now - last, 100) / 1000 * span / SECONDS * Number($("speed").value);
    show(positionAt(time));
    if (state.position >= frames - 1) play(false);
  }
  last = now;
  controls.update();
  if (dirty) draw();
}

function draw() {
  dirty = false;
  renderer.render(scene, camera);
  drawAxes();
}

// Axes of the scene, as the camera sees them, and a length at the middle of the model.
function drawAxes() {
  const canvas = $("axes"), brush = canvas.getContext("2d"), back = camera.quaternion.clone().inverse();
  brush.clearRect(0, 0, 128, 128);
  brush.font = "22px sans-serif", brush.lineWidth = 4;
  [["x", "#c62828", [1, 0, 0]], ["y", "#2e7d32", [0, 1, 0]], ["z", "#1565c0", [0, 0, 1]]].slice(0, Math.max(2, run.dimension)).forEach(([name, color, axis]) => {
    const seen = new THREE.Vector3(...axis).applyQuaternion(back);
    brush.strokeStyle = brush.fillStyle = color;
    brush.beginPath(), brush.moveTo(64, 64), brush.lineTo(64 + 40 * seen.x, 64 - 40 * seen.y), brush.stroke();
    brush.fillText(name, 58 + 54 * seen.x, 71 - 54 * seen.y);
  });
  const height = flat ? (camera.top - camera.bottom) / camera.zoom
    : 2 * Math.tan(camera.fov * Math.PI / 360) * camera.position.distanceTo(controls.target);
  const perPixel = height / view.clientHeight, power = Math.pow(10, Math.floor(Math.log10(130 * perPixel)));
  const length = [5, 2, 1].map(k => k * power).find(k => k <= 130 * perPixel);
  $("ruler").style.width = length / perPixel + "px";
  $("length").textContent = `${number(length)} ${run.lengthUnit}`;
}

const VIEWS = { oblique: [0.55, -1, 0.42], front: [0, -1, 0], right: [1, 0, 0], top: [0, -1e-3, 1], below: [0.4, -0.8, -0.6] };

function fit() {
  const box = model.box ? model.box.clone() : new THREE.Box3(), size = new THREE.Vector3();
  for (const { given } of model.obstacles) if (given.type !== "plane" && (!model.box || given.radius < model.size))
    for (const place of given.place) for (const side of [-1, 1]) box.expandByPoint(new THREE.Vector3().fromArray(place).addScalar(side * given.radius));
  if (box.isEmpty()) box.setFromCenterAndSize(new THREE.Vector3(), new THREE.Vector3(2, 2, 2));
  box.getCenter(controls.target);
  const wide = box.getSize(size).length() || 1, aspect = view.clientWidth / view.clientHeight;
  model.viewSize = wide;
  if (flat) {
    const half = 0.62 * Math.max(size.y, size.x / aspect, 0.25 * wide);
    Object.assign(camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half, zoom: 1 });
    camera.position.copy(controls.target).setZ(10 * wide);
  } else {
    const toward = new THREE.Vector3(...VIEWS[$("from").value]).normalize(), corner = new THREE.Vector3();
    let distance = 0.6 * wide / Math.tan(camera.fov * Math.PI / 360) / Math.min(1, aspect);
    Object.assign(camera, { near: distance / 100, far: distance * 30, aspect });
    camera.updateProjectionMatrix();
    for (let round = 0; round < 4; ++round) { // until the corners of the box reach 0.86 of the picture
      camera.position.copy(controls.target).addScaledVector(toward, distance);
      camera.lookAt(controls.target), camera.updateMatrixWorld();
      let most = 0;
      for (let k = 0; k < 8; ++k) {
        corner.set(...["x", "y", "z"].map((axis, c) => (k >> c & 1 ? box.min : box.max)[axis])).project(camera);
        most = Math.max(most, Math.abs(corner.x), Math.abs(corner.y));
      }
      distance *= most / 0.86;
    }
    camera.position.copy(controls.target).addScaledVector(toward, distance);
  }
  camera.updateProjectionMatrix();
  controls.update();
  dirty = true;
}

function resize() {
  renderer.setSize(view.clientWidth, view.clientHeight, false);
  const aspect = view.clientWidth / view.clientHeight;
  if (flat) camera.left = -camera.top * aspect, camera.right = camera.top * aspect;
  else camera.aspect = aspect;
  camera.updateProjectionMatrix();
  panels.forEach(panel => panel.draw());
  dirty = true;
}

// --- curves and events -----------------------------------------------------------------------------------------------

const panels = [];

function niceTicks(low, high, most) {
  const raw = (high - low) / most || 1, power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 2.5, 5, 10].map(k => k * power).find(k => k >= raw * (1 - 1e-9)), ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push(k * step);
  return ticks;
}

class Panel {
  constructor(given, time, values, parent) {
    this.given = given, this.time = time, this.values = values, this.hidden = new Set();
    make("h2", parent, withUnit(given.title, given.unit));
    this.canvas = make("canvas", parent);
    const key = make("div", parent, undefined, "key");
    this.marks = given.curves.map((curve, k) => {
      const label = make("span", key);
      make("span", label, undefined, "chip").style.background = CURVE_COLORS[k];
      label.append(curve.name + " ");
      label.style.cursor = "pointer", label.title = "click: hide or show";
      label.onclick = () => {
        if (!this.hidden.delete(k)) this.hidden.add(k);
        label.style.opacity = this.hidden.has(k) ? 0.35 : 1;
        this.findRange(), this.draw();
      };
      return make("b", label);
    });
    if (given.leftOut) make("span", key, `and ${given.leftOut} more in history.csv`);
    const go = event => {
      const box = this.canvas.getBoundingClientRect(), x = (event.clientX - box.left - 62) / (box.width - 72);
      play(false), show(positionAt(this.from + Math.max(0, Math.min(1, x)) * (this.to - this.from)));
    };
    this.canvas.onpointerdown = event => { this.canvas.setPointerCapture(event.pointerId); go(event); };
    this.canvas.onpointermove = event => event.buttons && go(event);
    this.from = Math.min(time[0], run.times.length ? run.times[0] : time[0]), this.to = time[time.length - 1];
    this.findRange();
  }
  findRange() {
    this.low = Infinity, this.high = -Infinity;
    this.values.forEach((values, k) => {
      if (!this.hidden.has(k)) for (const value of values) this.low = Math.min(this.low, value), this.high = Math.max(this.high, value);
    });
    if (!(this.low <= this.high)) this.low = 0, this.high = 1;
    const rim = 0.05 * (this.high - this.low) || 0.05 * Math.abs(this.high) || 1;
    this.low -= rim, this.high += rim;
  }
  draw() {
    const ratio = window.devicePixelRatio, width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    this.canvas.width = width * ratio, this.canvas.height = height * ratio;
    const brush = this.canvas.getContext("2d"), left = 62, right = width - 10, top = 5, bottom = height - 30;
    const x = t => left + (t - this.from) / (this.to - this.from || 1) * (right - left);
    const y = v => bottom - (v - this.low) / (this.high - this.low) * (bottom - top);
    brush.scale(ratio, ratio);
    brush.font = "11px sans-serif", brush.fillStyle = "#444", brush.strokeStyle = "#e2e2e2", brush.lineWidth = 1;
    brush.textAlign = "right", brush.textBaseline = "middle";
    for (const tick of niceTicks(this.low, this.high, 5)) {
      brush.beginPath(), brush.moveTo(left, y(tick)), brush.lineTo(right, y(tick)), brush.stroke();
      brush.fillText(number(tick), left - 5, y(tick));
    }
    brush.textAlign = "center", brush.textBaseline = "top";
    for (const tick of niceTicks(this.from, this.to, 5)) {
      brush.beginPath(), brush.moveTo(x(tick), top), brush.lineTo(x(tick), bottom), brush.stroke();
      brush.fillText(number(tick), Math.min(x(tick), right - 8), bottom + 3);
    }
    brush.fillText(withUnit("time", run.timeUnit), (left + right) / 2, bottom + 16);
    brush.strokeStyle = "#888", brush.strokeRect(left, top, right - left, bottom - top);
    brush.lineWidth = 1.4;
    this.values.forEach((values, k) => {
      if (this.hidden.has(k)) return;
      brush.strokeStyle = CURVE_COLORS[k];
      brush.beginPath();
      for (let i = 0; i < values.length; ++i) brush.lineTo(x(this.time[i]), y(values[i]));
      brush.stroke();
    });
    brush.strokeStyle = "#c2185b";
    brush.beginPath(), brush.moveTo(x(state.shown), top), brush.lineTo(x(state.shown), bottom), brush.stroke();
    this.values.forEach((values, k) => { this.marks[k].textContent = number(this.at(values)); });
  }
  at(values) {
    let low = 0, high = this.time.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= state.shown) low = middle; else high = middle;
    }
    const span = this.time[high] - this.time[low], part = span > 0 ? Math.max(0, Math.min(1, (state.shown - this.time[low]) / span)) : 0;
    return values[low] + part * (values[high] - values[low]);
  }
}

let eventRows = [];

function addEvents(parent) {
  if (!run.events.length) return;
  make("h2", parent, withUnit("events", run.timeUnit));
  const list = make("div", parent);
  list.id = "events";
  eventRows = run.events.map(event => {
    const row = make("div", list);
    make("span", row, number(event.time));
    make("span", row, `${event.interface}: ${event.event}` + (event.count > 1 ? `, ${event.count} nodes` : event.count === 1 ? `, node ${event.nodes[0]}` : ""));
    row.onclick = () => { play(false), show(positionAt(event.time)), flash(event); };
    return row;
  });
}

function markEvent() {
  let now = -1;
  run.events.forEach((event, k) => { if (event.time <= state.shown * (1 + 1e-9)) now = k; });
  eventRows.forEach((row, k) => row.classList.toggle("now", k === now));
}

// Nodes of an event, for two seconds.
function flash(event) {
  if (!run.film || !event.nodes.length) return;
  const wanted = new Set(event.nodes), points = [];
  model.modelNodes.forEach((node, k) => { if (wanted.has(node)) points.push(...model.place.array.subarray(3 * k, 3 * k + 3)); });
  if (!points.length) return;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  const dots = new THREE.Points(geometry, new THREE.PointsMaterial({ color: 0xff1744, size: 10, sizeAttenuation: false, depthTest: false, transparent: true }));
  dots.renderOrder = 9;
  scene.add(dots), dirty = true;
  setTimeout(() => { scene.remove(dots), dirty = true; }, 2000);
}

// --- controls --------------------------------------------------------------------------------------------------------

function toggle(parent, color, text, onChange) {
  const label = make("label", parent), box = make("input", label);
  box.type = "checkbox", box.checked = true;
  make("span", label, undefined, "chip").style.background = color;
  label.append(text);
  box.onchange = () => { onChange(box.checked), dirty = true; };
}

function fillLegend() {
  const parts = $("parts"), moment = $("moment");
  model.bodies.slice(0, 40).forEach((body, k) => {
    const facets = body.facets ? `, ${body.facets} facets` : body.dots ? `, ${body.nodes.length}` : "";
    toggle(parts, BODY_COLORS[k % BODY_COLORS.length], body.name + facets, on => { body.group.visible = on; });
  });
  if (model.bodies.length > 40) make("div", parts, `and ${model.bodies.length - 40} more bodies`);
  if (model.others) toggle(parts, "#c9d0d8", "not watched, at the start", on => { model.others.visible = on; });
  model.obstacles.forEach(obstacle => toggle(parts, "#aeb8c2", `${obstacle.name} (${obstacle.given.type})`, on => { obstacle.shape.visible = on; }));
  const axes = make("canvas", moment), text = make("div", moment);
  axes.id = "axes", axes.width = axes.height = 128;
  make("div", text).id = "told";
  make("span", text).id = "length";
  make("div", text).id = "ruler";
}

function autoScale() {
  const value = model.largest > 0 ? 0.1 * model.startSize / model.largest : 1, power = Math.pow(10, Math.floor(Math.log10(value)));
  return Math.max(1, [5, 2, 1].map(k => k * power).find(k => k <= value));
}

function setScale(value) {
  state.scale = value;
  $("scale").value = value;
  show(state.position);
}

function connect() {
  $("slider").max = frames - 1;
  $("slider").oninput = () => { play(false), show($("smooth").checked ? Number($("slider").value) : Math.round(Number($("slider").value))); };
  $("play").onclick = () => play(!state.playing);
  const step = by => { play(false), show(by > 0 ? Math.floor(state.position + 1e-9) + 1 : Math.ceil(state.position - 1e-9) - 1); };
  $("back").onclick = () => step(-1), $("next").onclick = () => step(1);
  document.onkeydown = event => {
    if (/INPUT|SELECT|BUTTON/.test(event.target.tagName)) return;
    if (event.key === " ") play(!state.playing), event.preventDefault();
    if (event.key === "ArrowLeft") step(-1);
    if (event.key === "ArrowRight") step(1);
  };
  const fields = run.film ? run.film.fields : [];
  fields.forEach((field, k) => {
    make("option", $("field"), (field.interface ? field.interface + ": " : "") + field.label).value = k;
  });
  make("option", $("field"), "bodies").value = -1;
  $("field").onchange = () => { if ($("range").value === "own") $("range").value = "all"; chooseField(Number($("field").value)); };
  $("range").onchange = () => { setRange(), show(state.position), drawBar(); };
  for (const id of ["least", "most"]) $(id).onchange = () => {
    const low = Number($("least").value), high = Number($("most").value);
    if (!isFinite(low) || !isFinite(high)) return;
    $("range").value = "own", state.low = low, state.high = high;
    show(state.position), drawBar();
  };
  $("scale").onchange = () => setScale(Number($("scale").value) || 0);
  $("auto").onclick = () => setScale(autoScale());
  for (const id of ["arrows", "arrowSize", "smooth"]) $(id).oninput = () => show(state.position);
  $("edges").onchange = () => { model.bodies.forEach(body => { if (body.lines) body.lines.visible = $("edges").checked; }); dirty = true; };
  $("clear").onchange = () => {
    for (const { surface } of model.bodies) if (surface)
      Object.assign(surface.material, { transparent: $("clear").checked, opacity: $("clear").checked ? 0.35 : 1, depthWrite: !$("clear").checked, needsUpdate: true });
    dirty = true;
  };
  $("fit").onclick = fit, $("from").onchange = fit;
  $("from").parentElement.hidden = flat;
  controls.addEventListener("change", () => { dirty = true; });
  new ResizeObserver(resize).observe(view);
}

async function begin() {
  const names = {};
  for (const { name, law } of run.interfaces) (names[law] = names[law] || []).push(name);
  const told = Object.entries(names).map(([law, of]) => `${of.length > 4 ? of.length + " interfaces" : of.join(", ")}: ${law}`);
  $("laws").textContent = told.join(" · ") + ` · ${run.steps} steps of ${number(run.dt)} ${run.timeUnit}`;
  const side = $("side");
  for (const note of run.notes) make("div", side, note, "note");
  if (run.film) await addBodies(run.film);
  addObstacles();
  addEvents(side);
  for (const given of run.curves)
    panels.push(new Panel(given, await open(given.time), await Promise.all(given.curves.map(curve => open(curve.values))), side));
  fillLegend();
  connect();
  resize();
  fit();
  // What moves by less than a hundredth of the model would seem to stand still.
  if (run.film && model.largest > 0 && model.largest < 0.01 * model.startSize && !run.film.isPoints) setScale(autoScale());
  await chooseField(0);
  requestAnimationFrame(tick);
}

// For tests, and for pictures that a script takes.
window.ilawView = { run, state, model, camera, resize, fit, show, play, chooseField, draw, ready: begin().catch(reason => {
  make("div", view, `This page cannot be drawn: ${reason.message}. It needs WebGL and a browser of 2023 or later.`, "over").style.cssText = "top: 40%; left: 20%";
  throw reason;
}) };
