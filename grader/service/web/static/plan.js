// The plan view: grid, walls, ideal figure, detected sides and corners, the path driven so far, the car.
import { bounds } from "./motion.js";
import { Board } from "./placing.js";
import { add, picture, ticks, trace } from "./svg.js";

const FIELD_M = 11.088889; // turtlesim's window
const LEAST_EXTENT_M = 2.4;
const MARGIN_PX = 46;
const MOST_HEIGHT = 0.45; // of the window, so that player and log lines are in sight beside it
const LEAST_HEIGHT_PX = 320;
const CAR_PX = 11;
const IN_PLACE_PX = 220; // height for a car that only turns
const SCANNER_X_M = -0.032; // of a robot's laser scanner, ahead of the middle of its axle
const RANGE_M = 3.5;
const SHOWN_RAYS = 36;
const MOST_CONTACTS = 100;
const ARC_PX = 34;
const ARC_GROWTH_PX = 9; // outward per full turn, so that further turns stay visible

/** How far it is from (x, y) along (c, s) to a straight edge; infinite where they do not meet. */
function meet(x, y, c, s, [[ax, ay], [bx, by]]) {
  const across = c * (by - ay) - s * (bx - ax);
  const reach = ((ax - x) * (by - ay) - (ay - y) * (bx - ax)) / across;
  const share = ((ax - x) * s - (ay - y) * c) / across;
  return reach >= 0 && share >= 0 && share <= 1 ? reach : Infinity;
}

export class Plan {
  constructor(holder, motion, sketch, words) {
    this.holder = holder;
    this.motion = motion;
    this.sketch = sketch;
    this.words = words;
    this.other = null; // the motion of another attempt
  }

  /** Draw everything anew at `width` CSS pixels. */
  draw(width) {
    const { motion, sketch } = this;
    const ideal = sketch.ideal_m ?? [];
    const regions = sketch.regions ?? [];
    const solids = sketch.solids ?? [];
    const commanded = sketch.commanded_m ?? []; // where the turtle drove another path
    const other = this.other?.x.map((x, i) => [x, this.other.y[i]]) ?? [];
    const shown = [...ideal, ...commanded, ...other, ...[...regions, ...solids].flatMap((each) => each.outline_m)];
    const [left, right] = bounds([...motion.x, ...shown.map(([x]) => x)]);
    const [bottom, top] = bounds([...motion.y, ...shown.map(([, y]) => y)]);
    const extent = Math.max(right - left, top - bottom, LEAST_EXTENT_M) * 1.08;
    const tall = Math.max(top - bottom, LEAST_EXTENT_M) * 1.08;
    const most = Math.max(window.innerHeight * MOST_HEIGHT, LEAST_HEIGHT_PX);
    this.scale = Math.min((width - 2 * MARGIN_PX) / extent, (most - 2 * MARGIN_PX) / tall);
    const inPlace = sketch.view === "heading" && extent <= LEAST_EXTENT_M * 1.09;
    const height = inPlace ? IN_PLACE_PX : Math.round(Math.max(tall * this.scale, 170) + 2 * MARGIN_PX);
    this.x0 = width / 2 - ((left + right) / 2) * this.scale;
    this.y0 = height / 2 + ((bottom + top) / 2) * this.scale;
    this.svg = picture(this.holder, width, height, this.label());
    this.grid(width, height);
    this.room(solids);
    this.figure(ideal);
    this.regions(regions);
    if (commanded.length) {
      add(this.svg, "path", { class: "commanded", d: trace(commanded.map((point) => this.place(point))).path });
    }
    if (other.length) {
      add(this.svg, "path", { class: "other", d: trace(other.map((point) => this.place(point)), (i) => this.other.jumps.has(i)).path });
    }
    const points = motion.t.map((_, i) => this.place([motion.x[i], motion.y[i]]));
    this.track = trace(points, (i) => motion.jumps.has(i));
    add(this.svg, "path", { class: "path-rest", d: this.track.path });
    this.driven = add(this.svg, "path", { class: "path-driven" });
    this.board = new Board(width, height);
    this.board.line(points, (i) => motion.jumps.has(i));
    this.board.block(...points[0], 7);
    this.board.block(...points.at(-1), CAR_PX);
    this.finished = []; // what is shown only from a moment on
    this.measures();
    this.touches();
    this.turned = add(this.svg, "path", { class: "turned" });
    add(this.svg, "circle", { class: "start", cx: points[0][0], cy: points[0][1], r: 4.5 });
    const size = CAR_PX;
    this.car = add(this.svg, "path", { class: "car", d: `M${size} 0L${-size * 0.7} ${size * 0.7}L${-size * 0.35} 0L${-size * 0.7} ${-size * 0.7}Z` });
  }

  /** Show the car as it was at `state`. */
  show(state) {
    const [x, y] = this.place([state.x, state.y]);
    const end = this.track.ends[state.index];
    this.driven.setAttribute("d", `${this.track.path.slice(0, end)}L${x.toFixed(1)} ${y.toFixed(1)}`);
    if (this.sketch.view === "heading") {
      this.turned.setAttribute("d", this.arc(x, y, state.heading));
    }
    this.rays?.setAttribute("d", this.scan(state));
    for (const { index, element } of this.finished) {
      element.classList.toggle("later", index > state.index);
    }
    const degrees = (-state.heading * 180) / Math.PI;
    this.car.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)}) rotate(${degrees.toFixed(2)})`);
  }

  /** The angle turned so far as an arc round the car, a spiral beyond one turn. */
  arc(x, y, heading) {
    const start = this.motion.heading[0];
    const turned = heading - start;
    const count = Math.max(2, Math.ceil(Math.abs(turned) / 0.1));
    const points = Array.from({ length: count + 1 }, (_, i) => {
      const part = (turned * i) / count;
      const radius = ARC_PX + (Math.abs(part) / (2 * Math.PI)) * ARC_GROWTH_PX;
      return [x + radius * Math.cos(start + part), y - radius * Math.sin(start + part)];
    });
    return trace(points).path;
  }

  label() {
    const { motion, words } = this;
    const fixed = (value) => value.toFixed(2);
    return words.plan
      .replace("{seconds}", fixed(motion.end))
      .replace("{x}", fixed(motion.x.at(-1)))
      .replace("{y}", fixed(motion.y.at(-1)));
  }

  place([x, y]) {
    return [this.x0 + x * this.scale, this.y0 - y * this.scale];
  }

  grid(width, height) {
    const lines = ticks(-this.x0 / this.scale, (width - this.x0) / this.scale, width / 70);
    for (const metres of lines) {
      const [x] = this.place([metres, 0]);
      add(this.svg, "line", { class: "grid", x1: x, x2: x, y1: 0, y2: height });
      if (x > 16 && x < width - 30) {
        add(this.svg, "text", { class: "tick", x: x + 3, y: height - 5 }, String(metres));
      }
    }
    for (const metres of ticks((this.y0 - height) / this.scale, this.y0 / this.scale, height / 70)) {
      const [, y] = this.place([0, metres]);
      add(this.svg, "line", { class: "grid", x1: 0, x2: width, y1: y, y2: y });
      if (y > 20 && y < height - 24) {
        add(this.svg, "text", { class: "tick", x: 4, y: y - 3 }, String(metres));
      }
    }
    add(this.svg, "text", { class: "tick", x: width - 14, y: height - 5 }, "m");
    if (this.sketch.solids?.length) {
      return; // a robot's room has walls of its own
    }
    const [x, y] = this.place([0, FIELD_M]);
    const side = FIELD_M * this.scale;
    add(this.svg, "rect", { class: "wall", x, y, width: side, height: side });
  }

  /** What stands in a robot's room, the lines on its floor, and the rays of its scanner, which `show` moves. */
  room(solids) {
    this.edges = [];
    for (const { kind, outline_m: outline } of solids) {
      add(this.svg, "path", { class: `solid ${kind}`, d: `${trace(outline.map((point) => this.place(point))).path}Z` });
      if (kind !== "line" && kind !== "ramp") {
        outline.forEach((point, i) => this.edges.push([point, outline[(i + 1) % outline.length]]));
      }
    }
    this.rays = this.edges.length ? add(this.svg, "path", { class: "rays" }) : null;
  }

  /** Where a robot touched something, from that moment on. */
  touches() {
    if (!this.edges.length) {
      return;
    }
    for (const time of this.motion.contacts.slice(0, MOST_CONTACTS)) {
      const index = this.motion.at(time);
      const [cx, cy] = this.place([this.motion.x[index], this.motion.y[index]]);
      this.finished.push({ index, element: add(this.svg, "circle", { class: "contact", cx, cy, r: 6 }) });
    }
  }

  /** Rays of the scanner, one in ten, each up to what it meets. */
  scan(state) {
    const x = state.x + SCANNER_X_M * Math.cos(state.heading);
    const y = state.y + SCANNER_X_M * Math.sin(state.heading);
    const [x0, y0] = this.place([x, y]);
    const lines = Array.from({ length: SHOWN_RAYS }, (_, i) => {
      const angle = state.heading + (i * 2 * Math.PI) / SHOWN_RAYS;
      const reach = Math.min(RANGE_M, ...this.edges.map((edge) => meet(x, y, Math.cos(angle), Math.sin(angle), edge)));
      const [x1, y1] = this.place([x + reach * Math.cos(angle), y + reach * Math.sin(angle)]);
      return `M${x0.toFixed(1)} ${y0.toFixed(1)}L${x1.toFixed(1)} ${y1.toFixed(1)}`;
    });
    return lines.join("");
  }

  figure(ideal) {
    if (ideal.length > 1) {
      const points = ideal.map((point) => this.place(point));
      const closed = this.sketch.ideal_closed && ideal.length > 2 ? "Z" : "";
      add(this.svg, "path", { class: "ideal", d: trace(points).path + closed });
    }
  }

  /** The places to visit, with their names, and those to avoid. */
  regions(regions) {
    for (const { outline_m: outline, at_m: at, text, ok, avoid } of regions) {
      const points = outline.map((point) => this.place(point));
      add(this.svg, "path", { class: `region ${avoid ? "avoid" : "goal"} ${verdict(ok)}`, d: `${trace(points).path}Z` });
      if (!avoid) {
        const [x, y] = this.place(at);
        const name = { class: `remark ${verdict(ok)}`, x, y: y + 4, "text-anchor": "middle" };
        add(this.svg, "text", name, (ok ? "" : "✗ ") + text);
      }
    }
  }

  measures() {
    const { corners = [], labels = [], gap } = this.sketch;
    const ends = this.ends();
    const sides = (this.sketch.sides ?? []).map((side, i) => [side, "side", ends.sides[i]]);
    const last = this.lastIndex();
    const lines = gap && gap.ok !== true ? [...sides, [gap, "gap", last]] : sides;
    for (const [{ start_m: start, end_m: end, ok }, kind, index] of lines) {
      const places = [this.place(start), this.place(end)];
      const [[x1, y1], [x2, y2]] = places;
      this.later(index, add(this.svg, "line", { class: `${kind} ${verdict(ok)}`, x1, y1, x2, y2 }));
      this.board.line(places);
    }
    corners.forEach(({ at_m: at, ok }, i) => {
      const [x, y] = this.place(at);
      this.later(ends.corners[i], add(this.svg, "circle", { class: `corner ${verdict(ok)}`, cx: x, cy: y, r: 3.5 }));
      this.board.block(x, y, 5);
    });
    corners.forEach((corner, i) => {
      const at = this.place(corner.at_m);
      const text = `${Number(corner.angle_deg.toFixed(1))}°`;
      this.later(ends.corners[i], this.remark(at, text, corner.ok, this.outward(at)));
    });
    for (const [line, , index] of lines) {
      this.later(index, this.length(line));
    }
    for (const label of labels) {
      this.later(last, this.remark(this.place(label.at_m), label.text, label.ok, [0, 1]));
    }
  }

  /** Show an element from the sample `index` on. */
  later(index, element) {
    this.finished.push({ index, element });
  }

  /** Index of the last sample that is shown. */
  lastIndex() {
    return this.motion.at(this.motion.lastChange);
  }

  /** Indices at which each side and each corner is finished, in the order driven. */
  ends() {
    const { motion } = this;
    const last = this.lastIndex();
    const found = { sides: [], corners: [] };
    let at = 0;
    (this.sketch.sides ?? []).forEach((side, i) => {
      at = motion.reach(side.end_m, motion.reach(side.start_m, at));
      found.sides.push(Math.min(at, last));
      const corner = this.sketch.corners?.[i];
      if (corner !== undefined) {
        found.corners.push(Math.min(motion.leave(corner.at_m, at), last));
      }
    });
    while (found.corners.length < (this.sketch.corners?.length ?? 0)) {
      found.corners.push(last);
    }
    return found;
  }

  /** Write how long a side or gap is beside its middle, away from the middle of the figure. */
  length({ start_m: start, end_m: end, length_m: length, ok }) {
    const [[x1, y1], [x2, y2]] = [this.place(start), this.place(end)];
    const middle = [(x1 + x2) / 2, (y1 + y2) / 2];
    const [ox, oy] = this.outward(middle);
    const [nx, ny] = [y1 - y2, x2 - x1];
    const away = nx * ox + ny * oy >= 0 ? [nx, ny] : [-nx, -ny];
    return this.remark(middle, `${Number(length.toFixed(2))} m`, ok, away);
  }

  /** The direction from the middle of the figure. */
  outward([x, y]) {
    const [cx, cy] = this.centre();
    return Math.hypot(x - cx, y - cy) < 1 ? [0, 1] : [x - cx, y - cy];
  }

  centre() {
    const vertices = this.sketch.ideal_m?.length > 2 ? this.sketch.ideal_m : (this.sketch.sides ?? []).map((side) => side.start_m);
    const points = vertices.map((point) => this.place(point));
    const mean = (axis) => points.reduce((sum, point) => sum + point[axis], 0) / Math.max(points.length, 1);
    return [mean(0), mean(1)];
  }

  remark([x, y], text, ok, away) {
    const mark = ok === false ? "✗ " : "";
    const written = add(this.svg, "text", { class: `remark ${verdict(ok)}`, "text-anchor": "middle" }, mark + text);
    const { width, height, y: top } = written.getBBox();
    const [left, middle] = this.board.put(x, y, width, height, away);
    written.setAttribute("x", left.toFixed(1));
    written.setAttribute("y", (middle - top - height / 2).toFixed(1));
    return written;
  }
}

function verdict(ok) {
  return ok === null ? "unjudged" : ok ? "good" : "bad";
}
