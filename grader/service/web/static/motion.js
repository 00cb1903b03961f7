// A recorded trajectory as a function of time.
const NANO = 1e-9;
const NEAR_M = 0.15;
const AWAY_M = 0.03;

export class Motion {
  /** `columns` as the service sends them: one array per quantity, times in virtual nanoseconds. */
  constructor(columns) {
    this.x = columns.x_m;
    this.y = columns.y_m;
    this.heading = columns.heading_rad;
    this.v = columns.v_mps;
    this.w = columns.w_radps;
    this.t = columns.t_ns.map((ns) => ns * NANO);
    this.end = Math.max(columns.end_ns * NANO, this.t.at(-1));
    this.jumps = new Set(columns.jumps);
    this.contacts = (columns.contacts ?? []).map((contact) => contact.start_ns * NANO);
    this.commands = columns.commands.map(([ns, v, w]) => ({ t: ns * NANO, v, w }));
  }

  get length() {
    return this.t.length;
  }

  /** Whether the car ever left its place or turned. */
  get moves() {
    return [this.x, this.y, this.heading].some((values) => {
      const [low, high] = bounds(values);
      return high - low > 1e-3;
    });
  }

  /** Time from which nothing changes any more: nobody wants to watch the rest. */
  get lastChange() {
    let i = this.length - 1;
    while (i > 0 && this.v[i] === this.v[i - 1] && this.w[i] === this.w[i - 1] && this.x[i] === this.x[i - 1]) {
      i -= 1;
    }
    return Math.min(this.end, this.t[i] + 0.5);
  }

  /** Index of the last sample at or before `time`. */
  at(time) {
    let low = 0;
    let high = this.length - 1;
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.t[middle] <= time) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    return low;
  }

  /** Index at which the car comes nearest to a point: the first time after index `from`, if it comes near at all. */
  reach([x, y], from) {
    let best = from;
    let least = Infinity;
    for (let i = from; i < this.length; i += 1) {
      const distance = Math.hypot(this.x[i] - x, this.y[i] - y);
      if (distance < least) {
        [best, least] = [i, distance];
      } else if (least < NEAR_M && distance > least + AWAY_M) {
        break;
      }
    }
    return best;
  }

  /** Index at which the car leaves a point where it is at index `from`; the last one when it stays. */
  leave([x, y], from) {
    let i = from;
    while (i < this.length - 1 && Math.hypot(this.x[i] - x, this.y[i] - y) < Math.hypot(this.x[from] - x, this.y[from] - y) + AWAY_M) {
      i += 1;
    }
    return i;
  }

  /** Pose and speeds at `time`, between two samples on the line between them. */
  state(time) {
    const i = this.at(time);
    const next = Math.min(i + 1, this.length - 1);
    const span = this.t[next] - this.t[i];
    const share = span > 0 && !this.jumps.has(next) ? Math.min(1, (time - this.t[i]) / span) : 0;
    const mix = (values) => values[i] + (values[next] - values[i]) * share;
    return { index: i, x: mix(this.x), y: mix(this.y), heading: mix(this.heading), v: mix(this.v), w: mix(this.w) };
  }
}

/** Return [smallest, largest] of numbers, any amount of them. */
export function bounds(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high];
}
