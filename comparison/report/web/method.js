"use strict";
// One method in the interactive view; `frame.js`, `picking.js` and `viewer.js` follow in the same script.

const INK = "#222222", FAINT = "#9a9a9a", FORCE = "#a3181f", THRUST = "#0b6e4f", PICKED = "#b8860b"; // as in the figures
const LONGEST = 0.25; // of the structure's size: the largest contact force
const LOAD = "#1b7837"; // as in the figures
const LOADS = { // by kind: label, width over the structure's size, and parts of the drawn body, one on the other: share of the width, from, to, colour
  dead: ["dead load", 0.017, [[1, 0, 1, LOAD]]],
  tie: ["tie", 0.012, [[1, 0, 1, LOAD]]],
  push: [null, 0.036, [[1.35, -0.02, 1.06, "#ffffff"], [1, 0, 1, INK]]], // its words name it
};
const ARROW = [[0, 0], [0.3, 0], [0.3, 0.55], [1, 0.55], [0, 1]], ROD = [[0, 0], [1, 0], [1, 0.02], [0.3, 0.02], [0.3, 0.98], [1, 0.98], [1, 1], [0, 1]];
const LEAST = 0.005; // of the largest contact force: smaller ones are left out
const MARKS = { // of a joint, by la_core.measures.ContactState: label, colour, edge; those that move as in the figures
  0: ["sticks", INK, "#ffffff"], 1: ["carries nothing", FAINT, "#ffffff"], 2: ["slides", INK, "#ffffff"], 3: ["opens", "#ffffff", INK],
};

const make = (tag, properties, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

const decode = (text, Type) => new Type(Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer);

// The library is in the page as text: it costs nothing until the first view opens.
function library() {
  if (!window.THREE) document.head.append(make("script", { textContent: document.getElementById("viewer-library").textContent }));
  return window.THREE;
}

// Mark of a joint for the picture and its legend; states differ in shape and colour.
function mark(state) {
  const [, fill, edge] = MARKS[state], canvas = make("canvas", { width: 32, height: 32 }), pen = canvas.getContext("2d");
  const shape = new Path2D(state === "2" ? "M7 7L25 25M25 7L7 25" : "");
  if (state !== "2") shape.arc(16, 16, state === "3" ? 11 : 7, 0, 2 * Math.PI);
  for (const [colour, width] of state === "2" ? [[edge, 12], [fill, 7]] : [[edge, state === "3" ? 5 : 2]]) {
    Object.assign(pen, { lineCap: "round", strokeStyle: colour, fillStyle: fill, lineWidth: width });
    pen.fill(shape);
    pen.stroke(shape);
  }
  return canvas;
}

// Sign of a kind of load for the legend: kinds differ in shape, so that they differ in grey.
function loadSign(kind) {
  const canvas = make("canvas", { width: 32, height: 32 }), pen = canvas.getContext("2d");
  const shapes = { dead: "M2 14H18V9L30 16L18 23V18H2Z", tie: "M2 10H7V14H25V10H30V22H25V18H7V22H2Z", push: "M1 11H15V3L31 16L15 29V21H1Z" };
  pen.fillStyle = kind === "push" ? INK : LOAD;
  pen.fill(new Path2D(shapes[kind]));
  return canvas;
}

// A body of revolution about y: corners [radius, height] from its start at 0 to its end at 1.
function turned(three, profile, sides) {
  const corners = [], index = [], round = profile.length;
  for (let side = 0; side < sides; side++) {
    const angle = (2 * Math.PI * side) / sides, next = ((side + 1) % sides) * round;
    for (const [radius, height] of profile) corners.push(radius * Math.cos(angle) / 2, height, radius * Math.sin(angle) / 2);
    for (let k = 0; k + 1 < round; k++) index.push(side * round + k, next + k + 1, next + k, side * round + k, side * round + k + 1, next + k + 1);
  }
  const shape = new three.BufferGeometry();
  shape.setAttribute("position", new three.BufferAttribute(new Float32Array(corners), 3));
  shape.setIndex(new three.BufferAttribute(new Uint32Array(index), 1));
  return shape;
}

// One method's blocks, joints and their resultant forces in a separate scene; `show` moves them.
class Method {
  constructor(three, data, geometry, method, place) {
    Object.assign(this, { three, data, geometry, label: method.label, note: method.note, scene: new three.Scene() });
    this.look = data.palette.length - data.methods.length + place; // of the blocks that move
    this.settlement = decode(method.settlement, Float32Array);
    this.displacement = decode(method.displacement, Float32Array);
    this.forces = decode(method.forces, Float32Array);
    this.looks = decode(method.looks, Uint8Array);
    this.centres = decode(method.centres, Float32Array);
    this.states = decode(method.joints, Int8Array);
    this.position = new three.BufferAttribute(geometry.vertices.slice(), 3);
    this.scene.add(new three.HemisphereLight("#ffffff", "#c8c8c8", 2.4));
    const sun = new three.DirectionalLight("#ffffff", 1.6);
    sun.position.set(-0.35, -0.75, 0.55);
    this.scene.add(sun);
    this.addBlocks();
    this.addPoints();
    this.addForces();
    this.addLoads();
  }

  part(kind, position, index, material) {
    const shape = new this.three.BufferGeometry();
    shape.setAttribute("position", position);
    if (index) shape.setIndex(new this.three.BufferAttribute(index, 1));
    const object = new this.three[kind](shape, material);
    object.frustumCulled = false;
    this.scene.add(object);
    return object;
  }

  addBlocks() {
    const { three, geometry } = this, colours = new Float32Array(geometry.vertices.length);
    const palette = this.data.palette.map((entry) => new three.Color(entry.colour));
    geometry.owner.forEach((block, vertex) => palette[this.looks[block]].toArray(colours, 3 * vertex));
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }; // the edges
    const stone = new three.MeshLambertMaterial({ vertexColors: true, flatShading: true, side: three.DoubleSide, ...behind });
    this.blocks = this.part("Mesh", this.position, geometry.triangles, stone);
    this.blocks.geometry.setAttribute("color", new three.BufferAttribute(colours, 3));
    this.part("LineSegments", this.position, geometry.edges, new three.LineBasicMaterial({ color: INK }));
    const moves = Uint8Array.from(geometry.owner, (block) => this.looks[block] === this.look);
    const before = geometry.edges.filter((vertex) => moves[vertex]);
    this.part("LineSegments", new three.BufferAttribute(geometry.vertices, 3), before, new three.LineBasicMaterial({ color: FAINT }));
  }

  addPoints() {
    const share = Math.min(1, Math.max(0.5, Math.sqrt(400 / this.states.length))); // many are drawn smaller
    this.middle = new this.three.BufferAttribute(this.geometry.points.slice(), 3);
    this.points = Object.keys(MARKS).map((state) => {
      const index = Uint32Array.from(this.states.keys()).filter((point) => this.states[point] === Number(state));
      const map = new this.three.CanvasTexture(mark(state));
      map.colorSpace = "srgb";
      const style = { map, size: share * (state > 1 ? 12 : 6), sizeAttenuation: false, transparent: true, alphaTest: 0.2 };
      return this.part("Points", this.middle, index, new this.three.PointsMaterial(style));
    });
  }

  addForces() {
    const { three } = this, paint = new three.MeshBasicMaterial({ color: FORCE, transparent: true });
    this.needles = new three.InstancedMesh(new three.OctahedronGeometry(0.5), paint, this.states.length);
    this.needles.frustumCulled = false;
    this.scene.add(this.needles);
    this.pressure = new three.BufferAttribute(this.centres.slice(0, 3 * this.states.length), 3);
    this.thrust = this.part("LineSegments", this.pressure, this.geometry.thrust, new three.LineBasicMaterial({ color: THRUST }));
  }

  // Arrows of loads and rods of ties, drawn over everything: many end inside of the blocks.
  addLoads() {
    const { three } = this;
    this.loads = (this.data.loads ?? []).map((load) => {
      const [start, end] = ["start", "end"].map((name) => decode(load[name], Float32Array));
      const blocks = ["of_start", "of_end"].map((name) => decode(load[name], Int32Array)), parts = LOADS[load.kind][2];
      const bodies = parts.map(([, , , colour], place) => {
        const shape = turned(three, load.kind === "tie" ? ROD : ARROW, load.kind === "tie" ? 4 : 16);
        const paint = new three.MeshBasicMaterial({ color: colour, depthTest: false, transparent: true });
        const body = new three.InstancedMesh(shape, paint, start.length / 3);
        Object.assign(body, { frustumCulled: false, renderOrder: 4 + place });
        this.scene.add(body);
        return body;
      });
      return { ...load, start, end, blocks, bodies, now: [start.slice(), end.slice()] };
    });
  }

  // Loads follow their blocks; those of no block stay. A dead load keeps its direction, a tie joins its ends.
  moveLoads(displace) {
    const { three } = this, first = new three.Vector3(), along = new three.Vector3(), scale = new three.Vector3();
    const turn = new three.Quaternion(), up = new three.Vector3(0, 1, 0), matrix = new three.Matrix4();
    for (const { kind, start, end, blocks, bodies, now } of this.loads) {
      const [, width, parts] = LOADS[kind], ends = [start, end];
      ends.forEach((rest, k) => {
        now[k].set(rest);
        blocks[k].forEach((block, place) => block >= 0 && displace(rest, 3 * place, block, 1, now[k]));
      });
      if (kind === "dead") now[0].forEach((_, k) => { now[0][k] = start[k] + now[1][k] - end[k]; });
      for (let place = 0; place < start.length; place += 3) {
        along.fromArray(now[1], place).sub(first.fromArray(now[0], place));
        const length = along.length(), thick = width * this.data.size;
        turn.setFromUnitVectors(up, along.clone().normalize());
        bodies.forEach((body, part) => {
          const [share, from, to] = parts[part];
          scale.set(share * thick, (to - from) * length, share * thick);
          body.setMatrixAt(place / 3, matrix.compose(first.fromArray(now[0], place).addScaledVector(along, from), turn, scale));
        });
      }
      for (const body of bodies) body.instanceMatrix.needsUpdate = true;
    }
  }

  // Where the words of a load stand: at the end of an arrow in the middle, or in the middle of a tie.
  anchor({ kind, now: [start, end] }, into) {
    const place = 3 * ((start.length / 3) >> 1);
    into.fromArray(end, place);
    return kind === "tie" ? into.lerp(new this.three.Vector3().fromArray(start, place), 0.5) : into;
  }

  // The outline of a picked block, drawn over everything; nothing for null.
  outline(block) {
    if (this.frame) { this.scene.remove(this.frame); this.frame.geometry.dispose(); this.frame = undefined; }
    if (block === null) return;
    const { owner, edges } = this.geometry, own = edges.filter((vertex) => owner[vertex] === block);
    this.frame = this.part("LineSegments", this.position, own, new this.three.LineBasicMaterial({ color: PICKED, depthTest: false }));
    this.frame.renderOrder = 3;
  }

  // Displacements and forces at a settlement, linear between the stored states.
  at(series, width, settlement) {
    const states = this.settlement, last = Math.min(states.length, series.length / width) - 1;
    let after = states.findIndex((state) => state >= settlement);
    after = Math.min(after < 0 ? last : Math.max(after, 1), last);
    const before = Math.max(after - 1, 0), step = states[after] - states[before];
    const share = step > 0 ? Math.min(Math.max((settlement - states[before]) / step, 0), 1) : 1;
    return Float32Array.from({ length: width }, (_, k) => (1 - share) * series[before * width + k] + share * series[after * width + k]);
  }

  show(settlement, magnification) {
    const { geometry } = this, { centroids } = geometry, into = this.position.array, count = this.states.length;
    this.settled = settlement;
    this.moved = this.at(this.displacement, 6 * this.looks.length, settlement);
    this.loaded = this.at(this.forces, 3 * count, settlement);
    const { moved } = this;
    const displace = (from, place, block, share, target) => {
      const c = 3 * block, d = 6 * block, k = share * magnification;
      const x = from[place] - centroids[c], y = from[place + 1] - centroids[c + 1], z = from[place + 2] - centroids[c + 2];
      target[place] += k * (moved[d] + moved[d + 4] * z - moved[d + 5] * y);
      target[place + 1] += k * (moved[d + 1] + moved[d + 5] * x - moved[d + 3] * z);
      target[place + 2] += k * (moved[d + 2] + moved[d + 3] * y - moved[d + 4] * x);
    };
    const halfway = (from, target) => geometry.sides.forEach((block, side) => displace(from, 3 * (side >> 1), block, 0.5, target));
    into.set(geometry.vertices);
    geometry.owner.forEach((block, vertex) => displace(geometry.vertices, 3 * vertex, block, 1, into));
    this.middle.array.set(geometry.points);
    halfway(geometry.points, this.middle.array);
    const centres = this.at(this.centres, 3 * count, settlement);
    this.pressure.array.set(centres);
    halfway(centres, this.pressure.array);
    this.position.needsUpdate = this.middle.needsUpdate = this.pressure.needsUpdate = true;
    if (this.needles.visible) this.turnNeedles(this.loaded);
    this.moveLoads(displace);
  }

  turnNeedles(forces) {
    const { three, data } = this, along = new three.Vector3(), middle = new three.Vector3(), scale = new three.Vector3();
    const turn = new three.Quaternion(), up = new three.Vector3(0, 1, 0), matrix = new three.Matrix4();
    for (let joint = 0; joint < this.states.length; joint++) {
      const force = along.fromArray(forces, 3 * joint).length() / (data.largest_force || 1);
      const width = force > LEAST ? 0.009 * data.size : 0;
      turn.setFromUnitVectors(up, along.normalize());
      matrix.compose(middle.fromArray(this.pressure.array, 3 * joint), turn, scale.set(width, width && LONGEST * data.size * force, width));
      this.needles.setMatrixAt(joint, matrix);
    }
    this.needles.instanceMatrix.needsUpdate = true;
  }

  dress({ points, forces, through, loads }) {
    for (const body of this.loads.flatMap((load) => load.bodies)) body.visible = loads;
    Object.assign(this.blocks.material, { transparent: through, opacity: through ? 0.4 : 1, depthWrite: !through, needsUpdate: true });
    for (const object of [...this.points, this.needles, this.thrust]) {
      object.visible = object === this.needles || object === this.thrust ? forces : points;
      object.material.depthTest = !through;
      object.renderOrder = object === this.needles || object === this.thrust ? 1 : 2;
    }
  }
}
