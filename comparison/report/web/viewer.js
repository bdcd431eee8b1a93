// The report's interactive views: one for each <details class="viewer">, built when it opens and released when it closes.

const MOST_OPEN = 6; // a browser keeps about sixteen WebGL contexts, and memory is finite
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
    this.frame = new Frame(three, data, geometry.vertices, this.canvas);
    this.picking = new Picking(three, data, geometry, this.methods);
    this.fill();
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
      this.canvas, row("titles", ...this.titles), this.picking.words,
      row("controls", make("label", { className: "travel" }, data.quantity, this.slider), this.play, this.words),
      row("controls", ...boxes, box("through", "see through the blocks", data.see_through), this.reset, this.fit),
      row("legend", ...palette.map((entry) => swatch(entry.colour, entry.name)), swatch("transparent", "before", FAINT), ...marks,
        make("span", {}, this.scale, this.force), ...thrust, ...signs),
      row("labels", ...this.labels.flat()),
    );
  }

  get camera() {
    return this.frame.camera;
  }

  listen() {
    const { controls } = this.frame;
    controls.addEventListener("change", () => this.ask());
    this.canvas.addEventListener("pointerdown", (event) => {
      this.pressed = [event.clientX, event.clientY];
      this.canvas.focus({ preventScroll: true });
    }, true);
    this.canvas.addEventListener("click", (event) => {
      const [x, y] = this.pressed ?? [event.clientX, event.clientY];
      if (Math.hypot(event.clientX - x, event.clientY - y) < STILL) this.pick(event);
    });
    this.canvas.addEventListener("focus", () => { controls.enableZoom = true; });
    this.canvas.addEventListener("blur", () => { controls.enableZoom = false; });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.ask());
    this.slider.addEventListener("input", () => { this.stop(); this.move(); });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.run()));
    this.reset.addEventListener("click", () => controls.reset());
    this.fit.addEventListener("click", () => { this.frame.fit(this.methods); this.ask(); });
    this.forces.addEventListener("change", () => { this.through.checked ||= this.forces.checked; }); // they are inside of the blocks
    for (const box of [this.points, this.forces, this.through, this.loads]) box.addEventListener("change", () => this.dress());
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.stage);
    this.dress();
    this.resize();
  }

  key(event) {
    const step = { n: 1, p: -1 }[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (step) this.picking.walk(step);
    else if (!this.frame.key(event, this.methods)) return;
    this.ask();
    event.preventDefault();
  }

  pick(event) {
    const box = this.canvas.getBoundingClientRect();
    this.picking.pick(this.frame, event.clientX - box.left, event.clientY - box.top, this.points.checked);
    this.ask();
  }

  dress() {
    const chosen = { points: this.points.checked, forces: this.forces.checked, through: this.through.checked, loads: this.loads.checked };
    for (const method of this.methods) method.dress(chosen);
    this.move();
  }

  move() {
    const { data } = this, settlement = data.start + (this.slider.value / 1000) * (data.end - data.start);
    const shown = (value) => rounded(value * data.unit_per_si);
    const drawn = (data.magnification ?? 1) === 1 ? "" : `; displacements drawn ${rounded(data.magnification)} times as large`;
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
    const width = this.stage.clientWidth, { frame } = this;
    if (!width) return;
    frame.divide(width, this.methods.length);
    this.stage.classList.toggle("stacked", frame.stacked);
    this.renderer.setSize(...frame.size);
    this.titles.forEach((title, k) => {
      const [left, bottom, , height] = frame.cells[k];
      Object.assign(title.style, { left: `${left}px`, top: `${this.canvas.offsetTop + frame.size[1] - bottom - height}px` });
    });
    this.ask();
  }

  // Draws at most once a frame, whatever the number of events.
  ask() {
    this.asked ??= requestAnimationFrame(() => {
      this.asked = undefined;
      for (const method of this.next === undefined ? [] : this.methods) method.show(this.next, this.data.magnification ?? 1);
      if (this.next !== undefined) this.picking.tell();
      this.next = undefined;
      if (!this.frame.size) return;
      this.measure();
      this.frame.draw(this.renderer, this.methods);
      this.methods.forEach((method, k) => this.label(method, k));
    });
  }

  // The scale of the forces: a bar of a round force, as long as that force is drawn now.
  measure() {
    const { data } = this;
    if (!(data.largest_force > 0)) return;
    const longest = (LONGEST * data.size) / this.frame.metresPerPixel; // pixels
    const most = data.largest_force * Math.min(1, 120 / longest) / data.force_unit_size, power = 10 ** Math.floor(Math.log10(most));
    const round = power * [5, 2, 1].find((step) => step * power <= most);
    this.scale.style.width = `${(longest * round * data.force_unit_size) / data.largest_force}px`;
    this.force.textContent = `force of ${Number(round.toPrecision(1))} ${data.force_unit}`;
  }

  // The words of the loads beside what is drawn, none upon another and none beyond the method's part.
  label(method, k) {
    const [x, y, width, height] = this.frame.cells[k], [, high] = this.frame.size, taken = [], point = new this.three.Vector3();
    this.labels[k].forEach((label, place) => {
      const at = this.frame.pixel(method.anchor(method.loads[place], point), k), wide = label.offsetWidth, tall = label.offsetHeight;
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
    cancelAnimationFrame(this.asked);
    this.observer.disconnect();
    this.frame.controls.dispose();
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
