"use strict";
// One method in the interactive view; `viewer.js` follows in the same script.

const INK = "#222222", FAINT = "#9a9a9a", FORCE = "#a3181f"; // the first two as in the figures
const LONGEST = 0.25; // of the structure's size: the largest contact force
const LEAST = 0.005; // of the largest contact force: smaller ones are left out
const MARKS = { // by la_core.measures.ContactState: label, colour, edge
  0: ["sticks", INK, "#ffffff"], 1: ["carries nothing", FAINT, "#ffffff"], 2: ["slides", "#c2185b", "#ffffff"], 3: ["opens", "#ffffff", "#00695c"],
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

// Mark of a contact point for the picture and its legend; states differ in shape and colour.
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

// One method's blocks, contact points and forces in a separate scene; `show` moves them.
class Method {
  constructor(three, data, geometry, method, place) {
    Object.assign(this, { three, data, geometry, label: method.label, note: method.note, scene: new three.Scene() });
    this.look = data.palette.length - data.methods.length + place; // of the blocks that move
    this.settlement = decode(method.settlement, Float32Array);
    this.displacement = decode(method.displacement, Float32Array);
    this.forces = decode(method.forces, Float32Array);
    this.looks = decode(method.looks, Uint8Array);
    this.states = decode(method.contacts, Int8Array);
    this.position = new three.BufferAttribute(geometry.vertices.slice(), 3);
    this.scene.add(new three.HemisphereLight("#ffffff", "#c8c8c8", 2.4));
    const sun = new three.DirectionalLight("#ffffff", 1.6);
    sun.position.set(-0.35, -0.75, 0.55);
    this.scene.add(sun);
    this.addBlocks();
    this.addPoints();
    this.addForces();
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
      const style = { map, size: share * (state > 1 ? 12 : 9), sizeAttenuation: false, transparent: true, alphaTest: 0.2 };
      return this.part("Points", this.middle, index, new this.three.PointsMaterial(style));
    });
  }

  addForces() {
    const { three } = this, paint = new three.MeshBasicMaterial({ color: FORCE, transparent: true });
    this.needles = new three.InstancedMesh(new three.OctahedronGeometry(0.5), paint, this.states.length);
    this.needles.frustumCulled = false;
    this.scene.add(this.needles);
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
    const { geometry } = this, { centroids } = geometry, into = this.position.array;
    const moved = this.at(this.displacement, 6 * this.looks.length, settlement);
    const displace = (from, place, block, share, target) => {
      const c = 3 * block, d = 6 * block, k = share * magnification;
      const x = from[place] - centroids[c], y = from[place + 1] - centroids[c + 1], z = from[place + 2] - centroids[c + 2];
      target[place] += k * (moved[d] + moved[d + 4] * z - moved[d + 5] * y);
      target[place + 1] += k * (moved[d + 1] + moved[d + 5] * x - moved[d + 3] * z);
      target[place + 2] += k * (moved[d + 2] + moved[d + 3] * y - moved[d + 4] * x);
    };
    into.set(geometry.vertices);
    geometry.owner.forEach((block, vertex) => displace(geometry.vertices, 3 * vertex, block, 1, into));
    this.middle.array.set(geometry.points);
    geometry.sides.forEach((block, side) => displace(geometry.points, 3 * (side >> 1), block, 0.5, this.middle.array));
    this.position.needsUpdate = this.middle.needsUpdate = true;
    if (this.needles.visible) this.turnNeedles(this.at(this.forces, 3 * this.states.length, settlement));
  }

  turnNeedles(forces) {
    const { three, data } = this, along = new three.Vector3(), middle = new three.Vector3(), scale = new three.Vector3();
    const turn = new three.Quaternion(), up = new three.Vector3(0, 1, 0), matrix = new three.Matrix4();
    for (let point = 0; point < this.states.length; point++) {
      const force = along.fromArray(forces, 3 * point).length() / (data.largest_force || 1);
      const width = force > LEAST ? 0.009 * data.size : 0;
      turn.setFromUnitVectors(up, along.normalize());
      matrix.compose(middle.fromArray(this.middle.array, 3 * point), turn, scale.set(width, width && LONGEST * data.size * force, width));
      this.needles.setMatrixAt(point, matrix);
    }
    this.needles.instanceMatrix.needsUpdate = true;
  }

  dress({ points, forces, through }) {
    Object.assign(this.blocks.material, { transparent: through, opacity: through ? 0.4 : 1, depthWrite: !through, needsUpdate: true });
    for (const object of [...this.points, this.needles]) {
      object.visible = object === this.needles ? forces : points;
      object.material.depthTest = !through;
      object.renderOrder = object === this.needles ? 1 : 2;
    }
  }
}
