// The block or the joint that is picked, with its values in words.

const NEAR = 12; // pixels: a click this close to a joint's mark picks the joint
const NOTHING = "Click a block or a joint for its name and values.";

class Picking {
  constructor(three, data, geometry, methods) {
    Object.assign(this, { three, data, geometry, methods, chosen: null });
    this.words = make("p", { className: "picked", textContent: NOTHING });
    this.words.setAttribute("aria-live", "polite");
  }

  // Picks what is under a pixel of the canvas; joints only where their marks are shown.
  pick(frame, x, fromTop, withJoints) {
    const axes = frame.axes(3), under = frame.under(x, fromTop, axes);
    if (under === null) return;
    const { place, at } = under, method = this.methods[place];
    const joint = withJoints ? this.nearestJoint(method, at, axes, NEAR * frame.metresPerPixel) : null;
    const block = joint === null ? this.blockAt(method, at, axes) : null;
    this.choose(joint === null && block === null ? null : { place, joint, block });
  }

  // Picks the next block or the one before it, of one method after another.
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
  }

  nearestJoint(method, at, [right, up], reach) {
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
  blockAt(method, at, [right, up, back]) {
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

  // Says what is picked, with its values as they are drawn now.
  tell() {
    const { place, joint, block } = this.chosen ?? {}, method = this.methods[place];
    const words = !method ? NOTHING : `${method.label}: ${joint === null ? this.blockWords(method, block) : this.jointWords(method, joint)}`;
    if (words !== this.words.textContent) this.words.textContent = words; // a screen reader reads every change
  }

  force(value) {
    return `${rounded(value / this.data.force_unit_size)} ${this.data.force_unit}`;
  }

  blockWords(method, block) {
    const [x, y, z, a, b, c] = method.moved.slice(6 * block, 6 * block + 6), weight = this.geometry.weights[block];
    return `block "${this.data.names[block]}"${weight > 0 ? `, weight ${this.force(weight)}` : ""}; moved by `
      + `(${[x, y, z].map((part) => rounded(1e3 * part)).join(", ")}) mm, turned by ${rounded(1e3 * Math.hypot(a, b, c))} mrad (true size)`;
  }

  jointWords(method, joint) {
    const { normals, friction, sides } = this.geometry, { names } = this.data;
    const [first, second] = sides.slice(2 * joint, 2 * joint + 2), on = method.loaded.slice(3 * joint, 3 * joint + 3);
    const along = [0, 1, 2].reduce((sum, k) => sum + on[k] * normals[3 * joint + k], 0);
    const across = Math.hypot(...[0, 1, 2].map((k) => on[k] - along * normals[3 * joint + k]));
    const used = along > 0 ? `; shear over normal ${rounded(across / along)} of mu ${rounded(friction[joint])}` : "";
    return `joint of "${names[first]}" and "${names[second]}" ${(MARKS[method.states[joint]] ?? ["is unknown"])[0]}; `
      + `normal force ${this.force(along)}, shear ${this.force(across)}${used}`;
  }
}

// A number with three digits; + 0 takes the sign of a negative zero.
function rounded(value) {
  return (Number(value.toPrecision(3)) + 0).toLocaleString("en", { maximumSignificantDigits: 3 });
}
