// Finds room for remarks, so that they cover neither each other nor the path; as grader/render/placing.py does.
const TURNS_DEG = [0, 25, -25, 50, -50, 80, -80, 115, -115, 150, -150, 180];
const GAPS_PX = [3, 7, 13, 21, 32];
const PADDING_PX = 2;
const INK_STEP_PX = 6;
const PRICE_PER_PX = 0.07;
const PRICE_PER_TURN = 0.35;

export class Board {
  constructor(width, height) {
    this.frame = { left: 0, right: width, top: 0, bottom: height };
    this.ink = [];
    this.taken = [];
  }

  /** Keep remarks off a line through `points`; `broken(i)`: none leads to point i. */
  line(points, broken = () => false) {
    let [x0, y0] = points[0];
    points.forEach(([x, y], i) => {
      const count = broken(i) ? 0 : Math.floor(Math.hypot(x - x0, y - y0) / INK_STEP_PX);
      if (i > 0 && count === 0 && !broken(i)) {
        return; // too near to the one before to be told apart
      }
      for (let part = 1; part <= count; part += 1) {
        this.ink.push([x0 + ((x - x0) * part) / count, y0 + ((y - y0) * part) / count]);
      }
      [x0, y0] = [x, y];
    });
  }

  /** Keep remarks off a marker. */
  block(x, y, half) {
    this.taken.push(box(x, y, half, half));
  }

  /** Take room for a text of `width` by `height` near (x, y), rather in the direction (dx, dy); return its middle. */
  put(x, y, width, height, [dx, dy]) {
    const half = [width / 2 + PADDING_PX, height / 2 + PADDING_PX];
    const preferred = Math.atan2(dy, dx);
    let best = null;
    for (const gap of GAPS_PX) {
      TURNS_DEG.forEach((degrees, turn) => {
        const angle = preferred + (degrees * Math.PI) / 180;
        const [ux, uy] = [Math.cos(angle), Math.sin(angle)];
        const distance = gap + Math.min(half[0] / Math.max(Math.abs(ux), 1e-9), half[1] / Math.max(Math.abs(uy), 1e-9));
        const place = box(x + ux * distance, y + uy * distance, ...half);
        const cost = this.cost(place) + PRICE_PER_PX * distance + PRICE_PER_TURN * turn;
        if (best === null || cost < best.cost) {
          best = { cost, place };
        }
      });
    }
    this.taken.push(best.place);
    return [(best.place.left + best.place.right) / 2, (best.place.top + best.place.bottom) / 2];
  }

  cost(place) {
    const area = (place.right - place.left) * (place.bottom - place.top);
    const covered = this.taken.reduce((sum, other) => sum + overlap(place, other), 0);
    const outside = area - overlap(place, this.frame);
    const inside = this.ink.filter(([x, y]) => x > place.left && x < place.right && y > place.top && y < place.bottom);
    return (60 * covered + 80 * outside) / area + 1.2 * inside.length;
  }
}

function box(x, y, halfWidth, halfHeight) {
  return { left: x - halfWidth, right: x + halfWidth, top: y - halfHeight, bottom: y + halfHeight };
}

function overlap(one, other) {
  const width = Math.min(one.right, other.right) - Math.max(one.left, other.left);
  const height = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
  return Math.max(width, 0) * Math.max(height, 0);
}
