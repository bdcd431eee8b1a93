// The report's interactive views: one for each <details class="viewer">, built when it opens and released when it closes.

const MOST_OPEN = 6; // a browser keeps about sixteen WebGL contexts, and memory is finite
const MARGIN = 0.12; // of the size: room for what moves
const STEP = Math.PI / 24; // of a key
const TURN = 1200; // pixels of height at which a drag turns as three.js has it; flat pictures would turn too fast
const NEAR = 12; // pixels: a click this close to a joint's mark picks the joint
const MOST_LABELS = 12; // of loads in one view
const STILL = 5; // pixels: a pointer that moved less did not drag
const opened = [];

// The opened view: both methods under one camera, in parts of one canvas.
class View {
  constructor(details) {
    const three = library(), data = JSON.parse(details.querySelector(".viewer-data").textContent);
    Object.assign(this, { three, data, details, stage: details.querySelector(".stage") });
    this.canvas = make("canvas", { tabIndex: 0 });
    const keys = "Arrows turn, shift and arrows move, plus and minus zoom, f fits everything, 0 resets, n and p choose the next and the previous block.";
    this.canvas.setAttribute("role", "application"); // the keys are the picture's, not those of a screen reader
    this.canvas.setAttribute("aria-label", `${data.title}: blocks in 3D. ${keys}`);
    this.renderer = new three.WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.setClearColor("#ffffff");
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    const geometry = {};
    for (const name of ["vertices", "centroids", "points", "normals", "weights", "friction"]) geometry[name] = decode(data[name], Float32Array);
    for (const name of ["owner", "triangles", "edges", "sides", "thrust"]) geometry[name] = decode(data[name], Uint32Array);
    this.geometry = geometry;
    this.methods = data.methods.map((method, place) => new Method(three, data, geometry, method, place));
    this.fill();
    this.look(geometry.vertices);
    this.listen();
  }

  // Controls and legend; every text from a scene enters as text.
  fill() {
    const { data } = this, box = (name, label, checked) => {
      this[name] = make("input", { type: "checkbox", checked, className: name });
      return make("label", {}, this[name], ` ${label}`);
    };
    this.slider = make("input", { type: "range", min: 0, max: 1000, value: 1000, disabled: !(data.end > data.start) });
    this.slider.setAttribute("aria-label", data.quantity);
    this.words = make("output", {});
    this.play = make("button", { type: "button", textContent: "play" });
    this.reset = make("button", { type: "button", textContent: "reset the view" });
    this.fit = make("button", { type: "button", textContent: "fit to frame" });
    this.picked = make("p", { className: "picked", textContent: "Click a block or a joint for its name and values." });
    this.picked.setAttribute("aria-live", "polite");
    this.scale = make("i", { className: "scale" });
    this.scale.style.background = FORCE;
    this.force = make("span", {});
    const row = (className, ...children) => make("div", { className }, ...children);
    this.titles = this.methods.map((method) => make("span", {}, make("b", { textContent: method.label }), method.note && ` ${method.note}`));
    const boxes = [box("points", "joints", true), box("forces", "forces of the joints", false)];
    const loads = data.loads ?? [], kinds = [...new Set(loads.map((load) => load.kind))], drawn = box("loads", "loads", true);
    if (loads.length) boxes.push(drawn);
    const named = (kind) => LOADS[kind][0] ?? `${loads.find((load) => load.kind === kind).words}, proportional to weight`;
    const signs = kinds.map((kind) => make("span", {}, loadSign(kind), named(kind)));
    this.labels = this.methods.map((method) => method.loads.slice(0, MOST_LABELS).map((load) => make("span", { textContent: load.words })));
    const swatch = (colour, words, border = INK) => {
      const key = make("i", {});
      Object.assign(key.style, { background: colour, borderColor: border });
      return make("span", {}, key, words);
    };
    const values = (name) => new Set(this.methods.flatMap((method) => [...method[name]])), looks = values("looks"), states = values("states");
    const palette = data.palette.filter((_, look) => looks.has(look)), known = Object.keys(MARKS).filter((state) => states.has(Number(state)));
    const marks = known.map((state) => make("span", {}, mark(state), `joint ${MARKS[state][0]}`));
    const thrust = this.geometry.thrust.length ? [swatch(THRUST, "line of thrust", THRUST)] : [];
    this.stage.replaceChildren(
      this.canvas, row("titles", ...this.titles), this.picked,
      row("controls", make("label", { className: "travel" }, data.quantity, this.slider), this.play, this.words),
      row("controls", ...boxes, box("through", "see through the blocks", data.see_through), this.reset, this.fit),
      row("legend", ...palette.map((entry) => swatch(entry.colour, entry.name)), swatch("transparent", "before", FAINT), ...marks,
        make("span", {}, this.scale, this.force), ...thrust, ...signs),
      row("labels", ...this.labels.flat()),
    );
  }

  // The camera: a parallel view from the direction of the figures; its frustum shows one method with a margin.
  look(vertices) {
    const { three, data } = this;
    this.camera = new three.OrthographicCamera(-1, 1, 1, -1, 0.1 * data.size, 30 * data.size);
    this.camera.up.set(0, 0, 1);
    this.camera.position.fromArray(data.toward).multiplyScalar(10 * data.size);
    this.camera.lookAt(0, 0, 0);
    this.camera.updateMatrixWorld();
    const [right, up] = [0, 1].map((axis) => new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, axis));
    const vertex = new three.Vector3();
    this.halfSize = [0, 0];
    for (let v = 0; v < vertices.length; v += 3) {
      vertex.fromArray(vertices, v);
      this.halfSize = [Math.max(this.halfSize[0], Math.abs(vertex.dot(right))), Math.max(this.halfSize[1], Math.abs(vertex.dot(up)))];
    }
    this.halfSize = this.halfSize.map((half) => half + MARGIN * data.size);
    this.controls = new three.OrbitControls(this.camera, this.canvas);
    this.radius = 10 * data.size; // of the camera from what it looks at
    this.controls.enableZoom = false; // a page that is scrolled past must not zoom
    this.controls.saveState();
  }

  listen() {
    this.controls.addEventListener("change", () => this.ask());
    this.canvas.addEventListener("pointerdown", (event) => {
      this.pressed = [event.clientX, event.clientY];
      this.canvas.focus({ preventScroll: true });
    }, true);
    this.canvas.addEventListener("click", (event) => {
      const [x, y] = this.pressed ?? [event.clientX, event.clientY];
      if (Math.hypot(event.clientX - x, event.clientY - y) < STILL) this.pick(event);
    });
    this.canvas.addEventListener("focus", () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener("blur", () => { this.controls.enableZoom = false; });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.ask());
    this.slider.addEventListener("input", () => { this.stop(); this.move(); });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.run()));
    this.reset.addEventListener("click", () => this.controls.reset());
    this.fit.addEventListener("click", () => this.fitFrame());
    this.forces.addEventListener("change", () => { this.through.checked ||= this.forces.checked; }); // they are inside of the blocks
    for (const box of [this.points, this.forces, this.through, this.loads]) box.addEventListener("change", () => this.dress());
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.stage);
    this.dress();
    this.resize();
  }

  key(event) {
    const turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (turns && event.shiftKey) this.controls.pan(40 * turns[0], 40 * turns[1]);
    else if (turns) { this.controls.rotateLeft(STEP * turns[0]); this.controls.rotateUp(STEP * turns[1]); }
    else if (event.key === "+" || event.key === "=") this.controls.dollyIn(0.9);
    else if (event.key === "-") this.controls.dollyOut(0.9);
    else if (event.key === "0") this.controls.reset();
    else if (event.key === "f") this.fitFrame();
    else if (event.key === "n") this.walk(1);
    else if (event.key === "p") this.walk(-1);
    else return;
    event.preventDefault();
  }

  dress() {
    const chosen = { points: this.points.checked, forces: this.forces.checked, through: this.through.checked, loads: this.loads.checked };
    for (const method of this.methods) method.dress(chosen);
    this.move();
  }

  move() {
    const { data } = this, settlement = data.start + (this.slider.value / 1000) * (data.end - data.start);
    const number = (value) => Number(value.toPrecision(3)).toLocaleString("en"), shown = (value) => number(value * data.unit_per_si);
    const drawn = (data.magnification ?? 1) === 1 ? "" : `; displacements drawn ${number(data.magnification)} times as large`;
    this.words.textContent = data.end > data.start ? `${shown(settlement)} of ${shown(data.end)} ${data.unit}${drawn}` : "nothing moves";
    this.slider.setAttribute("aria-valuetext", this.words.textContent);
    this.next = settlement;
    this.ask();
  }

  // Places and zooms the camera so that every method's blocks, as they are drawn now, fill the frame from where it looks.
  fitFrame() {
    const { three, camera, controls } = this;
    camera.updateMatrixWorld();
    const axes = [0, 1].map((axis) => new three.Vector3().setFromMatrixColumn(camera.matrixWorld, axis)), vertex = new three.Vector3();
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (const { position } of this.methods) {
      for (let v = 0; v < position.array.length; v += 3) {
        vertex.fromArray(position.array, v);
        axes.forEach((axis, k) => { low[k] = Math.min(low[k], vertex.dot(axis)); high[k] = Math.max(high[k], vertex.dot(axis)); });
      }
    }
    const shift = new three.Vector3();
    axes.forEach((axis, k) => shift.addScaledVector(axis, (low[k] + high[k]) / 2 - controls.target.dot(axis)));
    camera.position.add(shift);
    controls.target.add(shift);
    const [, , width, height] = this.cells[0], metres = (camera.right - camera.left) / this.size[0];
    camera.zoom = 0.92 * metres * Math.min(width / (high[0] - low[0]), height / (high[1] - low[1]));
    camera.updateProjectionMatrix();
    controls.update();
    this.ask();
  }

  // The joint or the block under the pointer, its name and its values in words.
  pick(event) {
    const box = this.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = this.size[1] - (event.clientY - box.top);
    const place = this.cells.findIndex(([left, bottom, width, height]) => x >= left && x < left + width && y >= bottom && y < bottom + height);
    if (place < 0) return;
    const method = this.methods[place], [left, bottom, width, height] = this.cells[place], { camera, three } = this;
    const perPixel = (camera.right - camera.left) / this.size[0] / camera.zoom;
    camera.updateMatrixWorld();
    const [right, up, back] = [0, 1, 2].map((axis) => new three.Vector3().setFromMatrixColumn(camera.matrixWorld, axis));
    const at = [(x - left - width / 2) * perPixel + camera.position.dot(right), (y - bottom - height / 2) * perPixel + camera.position.dot(up)];
    const joint = this.points.checked ? this.nearestJoint(method, at, right, up, NEAR * perPixel) : null;
    const block = joint === null ? this.blockAt(method, at, right, up, back) : null;
    this.choose(joint === null && block === null ? null : { place, joint, block });
  }

  // The next block or the one before it, of one method after another.
  walk(step) {
    const count = this.data.names.length, all = count * this.methods.length, { place, block } = this.chosen ?? {};
    const from = Number.isInteger(block) ? place * count + block : step > 0 ? -1 : 0;
    const next = (from + step + all) % all;
    this.choose({ place: Math.floor(next / count), joint: null, block: next % count });
  }

  choose(chosen) {
    this.chosen = chosen;
    this.methods.forEach((one, k) => one.outline(k === chosen?.place ? chosen.block : null));
    this.tell();
    this.ask();
  }

  nearestJoint(method, at, right, up, reach) {
    const point = new this.three.Vector3();
    let nearest = null, least = reach;
    for (let joint = 0; joint < method.states.length; joint++) {
      point.fromArray(method.middle.array, 3 * joint);
      const distance = Math.hypot(point.dot(right) - at[0], point.dot(up) - at[1]);
      if (distance < least) [nearest, least] = [joint, distance];
    }
    return nearest;
  }

  // The block of the frontmost triangle that covers a place in the plane of the picture.
  blockAt(method, at, right, up, back) {
    const { triangles, owner } = this.geometry, { array } = method.position, point = new this.three.Vector3();
    let found = null, front = -Infinity;
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => {
        point.fromArray(array, 3 * triangles[t + k]);
        return [point.dot(right) - at[0], point.dot(up) - at[1], point.dot(back)];
      });
      const cross = (p, q) => p[0] * q[1] - p[1] * q[0], areas = [cross(b, c), cross(c, a), cross(a, b)];
      const whole = areas[0] + areas[1] + areas[2];
      if (!whole || areas.some((area) => area * whole < 0)) continue;
      const depth = (areas[0] * a[2] + areas[1] * b[2] + areas[2] * c[2]) / whole;
      if (depth > front) [found, front] = [owner[triangles[t]], depth];
    }
    return found;
  }

  tell() {
    if (!this.chosen) {
      this.picked.textContent = "Click a block or a joint for its name and values.";
      return;
    }
    const { data, geometry } = this, { place, joint, block } = this.chosen, method = this.methods[place];
    const number = (value) => (Number(value.toPrecision(3)) + 0).toLocaleString("en", { maximumSignificantDigits: 3 }), force = (value) => `${number(value / data.force_unit_size)} ${data.force_unit}`;
    if (block !== null) {
      const [x, y, z, a, b, c] = method.moved.slice(6 * block, 6 * block + 6), weight = geometry.weights[block];
      this.picked.textContent = `${method.label}: block "${data.names[block]}"${weight > 0 ? `, weight ${force(weight)}` : ""}; moved by `
        + `(${[x, y, z].map((part) => number(1e3 * part)).join(", ")}) mm, turned by ${number(1e3 * Math.hypot(a, b, c))} mrad (true size)`;
      return;
    }
    const [first, second] = geometry.sides.slice(2 * joint, 2 * joint + 2), on = method.loaded.slice(3 * joint, 3 * joint + 3);
    const along = [0, 1, 2].reduce((sum, k) => sum + on[k] * geometry.normals[3 * joint + k], 0);
    const across = Math.hypot(...[0, 1, 2].map((k) => on[k] - along * geometry.normals[3 * joint + k]));
    const used = along > 0 ? `; shear over normal ${number(across / along)} of mu ${number(geometry.friction[joint])}` : "";
    this.picked.textContent = `${method.label}: joint of "${data.names[first]}" and "${data.names[second]}" ${(MARKS[method.states[joint]] ?? ["is unknown"])[0]}; `
      + `normal force ${force(along)}, shear ${force(across)}${used}`;
  }

  run() {
    const from = Number(this.slider.value) % 1000, began = performance.now();
    this.play.textContent = "stop";
    const step = (now) => {
      this.slider.value = Math.min(1000, from + (now - began) / 4);
      this.move();
      if (this.slider.value < 1000) this.running = requestAnimationFrame(step);
      else this.stop();
    };
    this.running = requestAnimationFrame(step);
  }

  stop() {
    cancelAnimationFrame(this.running);
    this.running = 0;
    this.play.textContent = "play";
  }

  resize() {
    const width = this.stage.clientWidth, count = this.methods.length, [halfWidth, halfHeight] = this.halfSize;
    if (!width) return;
    const beside = width >= 560 || count === 1;
    const cell = beside ? width / count : width, tall = Math.min(Math.max((cell * halfHeight) / halfWidth, 220), 560);
    this.cells = this.methods.map((_, k) => (beside ? [k * cell, 0, cell, tall] : [0, (count - 1 - k) * tall, cell, tall]));
    this.size = [width, beside ? tall : count * tall];
    this.stage.classList.toggle("stacked", !beside);
    this.renderer.setSize(...this.size);
    this.controls.rotateSpeed = this.size[1] / TURN;
    this.titles.forEach((title, k) => Object.assign(title.style, {
      left: `${this.cells[k][0]}px`, top: `${this.canvas.offsetTop + this.size[1] - this.cells[k][1] - this.cells[k][3]}px`,
    }));
    const metres = Math.max(halfWidth / cell, halfHeight / tall); // for half a pixel
    Object.assign(this.camera, { left: -metres * width, right: metres * width, top: metres * this.size[1], bottom: -metres * this.size[1] });
    this.camera.updateProjectionMatrix();
    this.ask();
  }

  // Draws at most once a frame, whatever the number of events.
  ask() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = undefined;
      for (const method of this.next === undefined ? [] : this.methods) method.show(this.next, this.data.magnification ?? 1);
      if (this.next !== undefined && this.chosen) this.tell();
      this.next = undefined;
      this.measure();
      this.draw();
    });
  }

  // The scale of the forces: a bar of a round force, as long as that force is drawn now.
  measure() {
    const { data, camera } = this;
    if (!this.size || !(data.largest_force > 0)) return;
    const longest = LONGEST * data.size * camera.zoom * this.size[0] / (camera.right - camera.left); // pixels
    const most = data.largest_force * Math.min(1, 120 / longest) / data.force_unit_size, power = 10 ** Math.floor(Math.log10(most));
    const round = power * [5, 2, 1].find((step) => step * power <= most);
    this.scale.style.width = `${(longest * round * data.force_unit_size) / data.largest_force}px`;
    this.force.textContent = `force of ${Number(round.toPrecision(1))} ${data.force_unit}`;
  }

  // The camera spans the whole canvas, so that the mouse moves what it points at; each method shows the middle of it in its own part.
  draw() {
    if (!this.size) return;
    this.renderer.setScissorTest(true);
    this.methods.forEach((method, k) => {
      const [x, y, width, height] = this.cells[k], [whole, high] = this.size;
      this.renderer.setViewport(x + (width - whole) / 2, y + (height - high) / 2, whole, high);
      this.renderer.setScissor(x, y, width, height);
      this.renderer.render(method.scene, this.camera);
      this.label(method, k);
    });
  }

  // The words of the loads beside what is drawn, none upon another and none beyond the method's part.
  label(method, k) {
    const [x, y, width, height] = this.cells[k], [whole, high] = this.size, taken = [], point = new this.three.Vector3();
    this.labels[k].forEach((label, place) => {
      method.anchor(method.loads[place], point).project(this.camera);
      const at = [x + width / 2 + (point.x * whole) / 2, high - (y + height / 2 + (point.y * high) / 2)], wide = label.offsetWidth, tall = label.offsetHeight;
      const left = Math.min(Math.max(at[0] + 6, x), x + width - wide);
      let top = at[1] + 3;
      for (let other; (other = taken.find(([l, t, w]) => left < l + w && l < left + wide && Math.abs(top - t) < tall));) top = other[1] + tall + 1;
      const outside = at[0] < x || at[0] > x + width || top < high - y - height || top + tall > high - y;
      Object.assign(label.style, { left: `${left}px`, top: `${this.canvas.offsetTop + top}px`, visibility: outside || !this.loads.checked ? "hidden" : "visible" });
      if (!outside) taken.push([left, top, wide]);
    });
  }

  release() {
    this.stop();
    cancelAnimationFrame(this.frame);
    this.observer.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.stage.replaceChildren();
  }
}

function show(details) {
  const fallback = details.querySelector(".fallback");
  try {
    if (opened.length >= MOST_OPEN) opened[0].details.open = false;
    opened.push(new View(details));
    fallback.hidden = true;
  } catch (error) {
    fallback.hidden = false;
    fallback.textContent = `The view cannot be shown here (${error.message}); the figures below show the same.`;
  }
}

function hide(details) {
  const place = opened.findIndex((view) => view.details === details);
  if (place >= 0) opened.splice(place, 1)[0].release();
}

for (const details of document.querySelectorAll("details.viewer"))
  details.addEventListener("toggle", () => (details.open ? show(details) : hide(details)));
