// Small pieces of SVG. Colours and fonts are the style sheet's business: elements only carry classes.
const NAMESPACE = "http://www.w3.org/2000/svg";

/** Append a new element to `parent` and return it; text goes in as text, never as markup. */
export function add(parent, name, attributes = {}, text = undefined) {
  const element = document.createElementNS(NAMESPACE, name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, String(value));
  }
  if (text !== undefined) {
    element.textContent = text;
  }
  parent.append(element);
  return element;
}

/** Return a fresh picture of the given size in CSS pixels inside `holder`, whose former content goes. */
export function picture(holder, width, height, label) {
  holder.replaceChildren();
  return add(holder, "svg", {
    viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": label,
  });
}

/** Return about `wanted` round numbers covering [low, high]. */
export function ticks(low, high, wanted) {
  const raw = (high - low) / Math.max(wanted, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= raw);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(6)));
}

/** Return a path through `points` and, for each of them, where its piece of the text ends. */
export function trace(points, broken = () => false) {
  const ends = [];
  let path = "";
  points.forEach(([x, y], i) => {
    path += `${i === 0 || broken(i) ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`;
    ends.push(path.length);
  });
  return { path, ends };
}
