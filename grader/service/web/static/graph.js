// One quantity over time: measured as a line, commanded as steps, and a cursor at the time being shown.
import { bounds } from "./motion.js";
import { add, picture, ticks } from "./svg.js";

const HEIGHT_PX = 120;
const LEFT_PX = 40;
const RIGHT_PX = 10;
const TOP_PX = 22;
const BOTTOM_PX = 20;

export class Graph {
  /** `series`: { title, t, values, steps?: [{ t, value }], wanted? } */
  constructor(holder, series, end) {
    this.holder = holder;
    this.series = series;
    this.end = end;
  }

  draw(width) {
    const { t, values, steps = [], wanted = null, title } = this.series;
    const every = [...values, ...steps.map((step) => step.value), 0, ...(wanted === null ? [] : [wanted])];
    let [low, high] = bounds(every);
    if (high - low < 1e-3) {
      [low, high] = [low - 0.5, high + 0.5];
    }
    const room = (high - low) * 0.08;
    this.low = low - room;
    this.high = high + room;
    this.width = width;
    const svg = picture(this.holder, width, HEIGHT_PX, title);
    this.axes(svg);
    add(svg, "text", { class: "title", x: LEFT_PX, y: 14 }, title);
    if (wanted !== null) {
      add(svg, "line", { class: "wanted", x1: this.x(0), x2: this.x(this.end), y1: this.y(wanted), y2: this.y(wanted) });
    }
    if (steps.length > 0) {
      add(svg, "path", { class: "commanded", d: this.staircase(steps) });
    }
    add(svg, "path", { class: "measured", d: values.map((value, i) => `${i === 0 ? "M" : "L"}${this.point(t[i], value)}`).join("") });
    this.cursor = add(svg, "line", { class: "cursor", x1: 0, x2: 0, y1: TOP_PX, y2: HEIGHT_PX - BOTTOM_PX });
    this.dot = add(svg, "circle", { class: "dot", r: 4 });
  }

  show(time, value) {
    const x = this.x(time).toFixed(1);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
    this.dot.setAttribute("cx", x);
    this.dot.setAttribute("cy", this.y(value).toFixed(1));
  }

  axes(svg) {
    for (const value of ticks(this.low, this.high, 3)) {
      const y = this.y(value);
      add(svg, "line", { class: value === 0 ? "grid zero" : "grid", x1: LEFT_PX, x2: this.width - RIGHT_PX, y1: y, y2: y });
      add(svg, "text", { class: "tick end", x: LEFT_PX - 5, y: y + 4 }, String(value));
    }
    for (const second of ticks(0, this.end, this.width / 80)) {
      add(svg, "text", { class: "tick middle", x: this.x(second), y: HEIGHT_PX - 5 }, `${second} s`);
    }
  }

  staircase(steps) {
    const last = { t: this.end, value: steps.at(-1).value };
    return [...steps, last]
      .map((step, i) => (i === 0 ? `M${this.point(step.t, step.value)}` : `H${this.x(step.t).toFixed(1)}V${this.y(step.value).toFixed(1)}`))
      .join("");
  }

  point(time, value) {
    return `${this.x(time).toFixed(1)} ${this.y(value).toFixed(1)}`;
  }

  x(time) {
    return LEFT_PX + (time / this.end) * (this.width - LEFT_PX - RIGHT_PX);
  }

  y(value) {
    return HEIGHT_PX - BOTTOM_PX - ((value - this.low) / (this.high - this.low)) * (HEIGHT_PX - BOTTOM_PX - TOP_PX);
  }
}
