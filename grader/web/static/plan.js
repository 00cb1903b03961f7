// The plan view: grid, walls, ideal figure, detected sides and corners, the path driven so far, the car.
import { bounds } from "./motion.js";
import { add, picture, ticks, trace } from "./svg.js";

const FIELD_M = 11.088889; // turtlesim's window
const LEAST_EXTENT_M = 2.4;
const MARGIN_PX = 46;
const CAR_PX = 11;
const IN_PLACE_PX = 220; // height for a car that only turns
const ARC_PX = 34;
const ARC_GROWTH_PX = 9; // outward per full turn, so that further turns stay visible
const STEEP_PX = 5; // a remark this far to the side begins or ends there, instead of being centred

export class Plan {
  constructor(holder, motion, sketch, words) {
    this.holder = holder;
    this.motion = motion;
    this.sketch = sketch;
    this.words = words;
  }

  /** Draw everything anew at `width` CSS pixels. */
  draw(width) {
    const { motion, sketch } = this;
    const ideal = sketch.ideal_m ?? [];
    const [left, right] = bounds([...motion.x, ...ideal.map(([x]) => x)]);
    const [bottom, top] = bounds([...motion.y, ...ideal.map(([, y]) => y)]);
    const extent = Math.max(right - left, top - bottom, LEAST_EXTENT_M) * 1.08;
    const tall = Math.max(top - bottom, LEAST_EXTENT_M) * 1.08;
    this.scale = (width - 2 * MARGIN_PX) / extent;
    const inPlace = sketch.view === "heading" && extent <= LEAST_EXTENT_M * 1.09;
    const height = inPlace ? IN_PLACE_PX : Math.round(Math.max(tall * this.scale, 170) + 2 * MARGIN_PX);
    this.x0 = width / 2 - ((left + right) / 2) * this.scale;
    this.y0 = height / 2 + ((bottom + top) / 2) * this.scale;
    this.svg = picture(this.holder, width, height, this.label());
    this.grid(width, height);
    this.figure(ideal);
    const points = motion.t.map((_, i) => this.place([motion.x[i], motion.y[i]]));
    this.track = trace(points, (i) => motion.jumps.has(i));
    add(this.svg, "path", { class: "path-rest", d: this.track.path });
    this.driven = add(this.svg, "path", { class: "path-driven" });
    this.measures();
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
    const [x, y] = this.place([0, FIELD_M]);
    const side = FIELD_M * this.scale;
    add(this.svg, "rect", { class: "wall", x, y, width: side, height: side });
  }

  figure(ideal) {
    if (ideal.length > 1) {
      const points = ideal.map((point) => this.place(point));
      const closed = this.sketch.ideal_closed && ideal.length > 2 ? "Z" : "";
      add(this.svg, "path", { class: "ideal", d: trace(points).path + closed });
    }
  }

  measures() {
    for (const side of this.sketch.sides ?? []) {
      this.side(side, `${side.length_m.toFixed(2)} m`);
    }
    if (this.sketch.gap && this.sketch.gap.ok !== true) {
      this.side(this.sketch.gap, `${this.sketch.gap.length_m.toFixed(2)} m`, "gap");
    }
    for (const corner of this.sketch.corners ?? []) {
      const [x, y] = this.place(corner.at_m);
      const turned = `${corner.angle_deg.toFixed(1)}°`;
      add(this.svg, "circle", { class: `corner ${verdict(corner.ok)}`, cx: x, cy: y, r: 3.5 });
      this.remark(x, y, turned, corner.ok, this.outward(x, y, 14));
    }
    for (const label of this.sketch.labels ?? []) {
      const [x, y] = this.place(label.at_m);
      this.remark(x, y, label.text, label.ok, [0, 20]);
    }
  }

  side({ start_m: start, end_m: end, ok }, text, kind = "side") {
    const [x1, y1] = this.place(start);
    const [x2, y2] = this.place(end);
    add(this.svg, "line", { class: `${kind} ${verdict(ok)}`, x1, y1, x2, y2 });
    const [x, y] = [(x1 + x2) / 2, (y1 + y2) / 2];
    this.remark(x, y, text, ok, this.outward(x, y, 12));
  }

  /** A step of `pixels` away from the middle of the motion, so that remarks do not lie on the path. */
  outward(x, y, pixels) {
    const [cx, cy] = this.centre();
    const away = Math.hypot(x - cx, y - cy);
    return away < 1 ? [0, pixels] : [((x - cx) / away) * pixels, ((y - cy) / away) * pixels];
  }

  centre() {
    const vertices = this.sketch.ideal_m?.length > 2 ? this.sketch.ideal_m : (this.sketch.sides ?? []).map((side) => side.start_m);
    const points = vertices.map((point) => this.place(point));
    const mean = (axis) => points.reduce((sum, point) => sum + point[axis], 0) / Math.max(points.length, 1);
    return [mean(0), mean(1)];
  }

  remark(x, y, text, ok, [dx, dy]) {
    const mark = ok === false ? "✗ " : "";
    const anchor = dx > STEEP_PX ? "start" : dx < -STEEP_PX ? "end" : "middle";
    add(this.svg, "text", { class: `remark ${verdict(ok)}`, x: x + dx, y: y + dy + 4, "text-anchor": anchor }, mark + text);
  }
}

function verdict(ok) {
  return ok === null ? "unjudged" : ok ? "good" : "bad";
}
