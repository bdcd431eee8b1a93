// The parts of the canvas, one for each method, under one camera.

const MARGIN = 0.12; // of the size: room for what moves
const STEP = Math.PI / 24; // of a key
const TURN = 1200; // pixels of height at which a drag turns as three.js has it; flat pictures would turn too fast
const FULL = 0.92; // of a part's width or height: what fills it

class Frame {
  // A parallel view from the direction of the figures; its frustum shows one method with a margin.
  constructor(three, data, vertices, canvas) {
    this.three = three;
    this.camera = new three.OrthographicCamera(-1, 1, 1, -1, 0.1 * data.size, 30 * data.size);
    this.camera.up.set(0, 0, 1);
    this.camera.position.fromArray(data.toward).multiplyScalar(10 * data.size);
    this.camera.lookAt(0, 0, 0);
    const axes = this.axes(2), vertex = new three.Vector3();
    this.halfSize = [0, 0];
    for (let v = 0; v < vertices.length; v += 3) {
      vertex.fromArray(vertices, v);
      axes.forEach((axis, k) => { this.halfSize[k] = Math.max(this.halfSize[k], Math.abs(vertex.dot(axis))); });
    }
    this.halfSize = this.halfSize.map((half) => half + MARGIN * data.size);
    this.controls = new three.OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false; // a page that is scrolled past must not zoom
    this.controls.saveState();
  }

  // The first of the camera's directions: right, up and back.
  axes(count) {
    this.camera.updateMatrixWorld();
    return Array.from({ length: count }, (_, axis) => new this.three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, axis));
  }

  get metresPerPixel() {
    return (this.camera.right - this.camera.left) / this.size[0] / this.camera.zoom;
  }

  // Divides a canvas of this width among the methods; `stacked` says whether they stand one above another.
  divide(width, count) {
    const [halfWidth, halfHeight] = this.halfSize, beside = width >= 560 || count === 1;
    const cell = beside ? width / count : width, tall = Math.min(Math.max((cell * halfHeight) / halfWidth, 220), 560);
    this.cells = Array.from({ length: count }, (_, k) => (beside ? [k * cell, 0, cell, tall] : [0, (count - 1 - k) * tall, cell, tall]));
    this.size = [width, beside ? tall : count * tall];
    this.stacked = !beside;
    this.controls.rotateSpeed = this.size[1] / TURN;
    const metres = Math.max(halfWidth / cell, halfHeight / tall); // for half a pixel
    Object.assign(this.camera, { left: -metres * width, right: metres * width, top: metres * this.size[1], bottom: -metres * this.size[1] });
    this.camera.updateProjectionMatrix();
  }

  // Places and zooms the camera so that every method's blocks, as they are drawn now, fill the frame from where it looks.
  fit(methods) {
    const { three, camera, controls } = this, axes = this.axes(2), vertex = new three.Vector3();
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (const { position } of methods) {
      for (let v = 0; v < position.array.length; v += 3) {
        vertex.fromArray(position.array, v);
        axes.forEach((axis, k) => { low[k] = Math.min(low[k], vertex.dot(axis)); high[k] = Math.max(high[k], vertex.dot(axis)); });
      }
    }
    const shift = new three.Vector3();
    axes.forEach((axis, k) => shift.addScaledVector(axis, (low[k] + high[k]) / 2 - controls.target.dot(axis)));
    camera.position.add(shift);
    controls.target.add(shift);
    const [, , width, height] = this.cells[0], metres = this.metresPerPixel * camera.zoom; // unzoomed
    camera.zoom = FULL * metres * Math.min(width / (high[0] - low[0]), height / (high[1] - low[1]));
    camera.updateProjectionMatrix();
    controls.update();
  }

  // What a key does to the camera; false for a key that does nothing.
  key({ key, shiftKey }, methods) {
    const { controls } = this, turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[key];
    if (turns && shiftKey) controls.pan(40 * turns[0], 40 * turns[1]);
    else if (turns) { controls.rotateLeft(STEP * turns[0]); controls.rotateUp(STEP * turns[1]); }
    else if (key === "+" || key === "=") controls.dollyIn(0.9);
    else if (key === "-") controls.dollyOut(0.9);
    else if (key === "0") controls.reset();
    else if (key === "f") this.fit(methods);
    else return false;
    return true;
  }

  // The camera spans the whole canvas, so that the mouse moves what it points at; each method shows the middle of it in its own part.
  draw(renderer, methods) {
    renderer.setScissorTest(true);
    methods.forEach((method, k) => {
      const [x, y, width, height] = this.cells[k], [whole, high] = this.size;
      renderer.setViewport(x + (width - whole) / 2, y + (height - high) / 2, whole, high);
      renderer.setScissor(x, y, width, height);
      renderer.render(method.scene, this.camera);
    });
  }

  // The pixel, from the upper left corner of the canvas, at which a method's part shows a point; the point is used up.
  pixel(point, place) {
    const [x, y, width, height] = this.cells[place], [whole, high] = this.size;
    point.project(this.camera);
    return [x + width / 2 + (point.x * whole) / 2, high - (y + height / 2 + (point.y * high) / 2)];
  }

  // The method whose part has this pixel, and the pixel's place along the axes, m; null outside of all parts.
  under(x, fromTop, [right, up]) {
    const { camera } = this, y = this.size[1] - fromTop;
    const place = this.cells.findIndex(([left, bottom, width, height]) => x >= left && x < left + width && y >= bottom && y < bottom + height);
    if (place < 0) return null;
    const [left, bottom, width, height] = this.cells[place], metres = this.metresPerPixel;
    return { place, at: [(x - left - width / 2) * metres + camera.position.dot(right), (y - bottom - height / 2) * metres + camera.position.dot(up)] };
  }
}
