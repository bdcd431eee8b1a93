// The report's interactive views: one for each <details class="viewer">, built when it opens and released when it closes.

const MOST_OPEN = 6; // a browser keeps about sixteen WebGL contexts, and memory is finite
const MARGIN = 0.12; // of the size: room for what moves
const STEP = Math.PI / 24; // of a key
const opened = [];

// The opened view: both methods under one camera, in parts of one canvas.
class View {
  constructor(details) {
    const three = library(), data = JSON.parse(details.querySelector(".viewer-data").textContent);
    Object.assign(this, { three, data, details, stage: details.querySelector(".stage") });
    this.canvas = make("canvas", { tabIndex: 0 });
    const keys = "Arrows turn, shift and arrows move, plus and minus zoom, 0 resets.";
    this.canvas.setAttribute("aria-label", `${data.title}: blocks in 3D. ${keys}`);
    this.renderer = new three.WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.setClearColor("#ffffff");
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    const geometry = {};
    for (const name of ["vertices", "centroids", "points"]) geometry[name] = decode(data[name], Float32Array);
    for (const name of ["owner", "triangles", "edges", "sides"]) geometry[name] = decode(data[name], Uint32Array);
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
    const row = (className, ...children) => make("div", { className }, ...children);
    const titles = this.methods.map((method) => make("span", {}, make("b", { textContent: method.label }), method.note && ` ${method.note}`));
    const boxes = [box("points", "contact points", true), box("forces", "contact forces", false)];
    const swatch = (colour, words, border = INK) => {
      const key = make("i", {});
      Object.assign(key.style, { background: colour, borderColor: border });
      return make("span", {}, key, words);
    };
    const values = (name) => new Set(this.methods.flatMap((method) => [...method[name]])), looks = values("looks"), states = values("states");
    const palette = data.palette.filter((_, look) => looks.has(look)), known = Object.keys(MARKS).filter((state) => states.has(Number(state)));
    const marks = known.map((state) => make("span", {}, mark(state), MARKS[state][0]));
    this.stage.replaceChildren(
      row("titles", ...titles), this.canvas,
      row("controls", make("label", { className: "travel" }, data.quantity, this.slider), this.play, this.words),
      row("controls", ...boxes, box("through", "see through the blocks", data.see_through), this.reset),
      row("legend", ...palette.map((entry) => swatch(entry.colour, entry.name)), swatch("transparent", "before", FAINT), ...marks,
        swatch(FORCE, "contact force, its length by its size")),
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
    this.controls.enableZoom = false; // a page that is scrolled past must not zoom
    this.controls.saveState();
  }

  listen() {
    this.controls.addEventListener("change", () => this.ask());
    this.canvas.addEventListener("pointerdown", () => this.canvas.focus({ preventScroll: true }), true);
    this.canvas.addEventListener("focus", () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener("blur", () => { this.controls.enableZoom = false; });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.ask());
    this.slider.addEventListener("input", () => { this.stop(); this.move(); });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.run()));
    this.reset.addEventListener("click", () => this.controls.reset());
    this.forces.addEventListener("change", () => { this.through.checked ||= this.forces.checked; }); // they are inside of the blocks
    for (const box of [this.points, this.forces, this.through]) box.addEventListener("change", () => this.dress());
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
    else return;
    event.preventDefault();
  }

  dress() {
    const chosen = { points: this.points.checked, forces: this.forces.checked, through: this.through.checked };
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
      this.next = undefined;
      this.draw();
    });
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
