// Completion: names of rclpy, of ROS's messages and of the program itself. names.json is made by tools/editor/names.py.
import { acceptCompletion, autocompletion, completionStatus, keymap, moveCompletionSelection } from "./codemirror.js";

const WORDS = (
  "and as break class continue def elif else except False finally for from global if import in is lambda None nonlocal " +
  "not or pass raise return self True try while with yield abs bool float input int len list max min print range round str super"
).split(" ");
let names = null;

async function known() {
  names ??= await (await fetch(new URL("names.json", import.meta.url))).json().catch(() => null);
  return names ?? { modules: {}, node: [], members: [] };
}

const found = (text, pattern) => [...text.matchAll(pattern)].map((one) => one[1]);

/** What may stand behind `line`, the part of a line before the cursor: `[typed, labels]`, or null. */
function labels(line, text, { modules, node, members }) {
  let typed = line.match(/^\s*from\s+([\w.]+)\s+import\s+(?:\w+\s*,\s*)*(\w*)$/);
  if (typed) {
    return [typed[2], modules[typed[1]] ?? []];
  }
  typed = line.match(/^\s*(?:from|import)\s+([\w.]*)$/);
  if (typed) {
    return [typed[1], Object.keys(modules)];
  }
  typed = line.match(/(?:\b([\w.]+)|[)\]])\.(\w*)$/);
  if (typed && !/^\d+$/.test(typed[1] ?? "")) {
    const own = found(text, /\.([A-Za-z_]\w*)/g);
    const methods = isNode(typed[1], text) ? [...node, ...found(text, /def (\w+)/g)] : members;
    return [typed[2], modules[typed[1]] ?? [...methods, ...own]];
  }
  typed = line.match(/(?<!\w)([A-Za-z_]\w+)$/);
  return typed && [typed[1], [...WORDS, ...found(text, /\b([A-Za-z_]\w{2,})/g)]];
}

/** Whether the program says that `name` is a node: `self`, or what a class of nodes was called for. */
function isNode(name, text) {
  const classes = ["Node", "create_node", ...found(text, /class\s+(\w+)\([^)]*\bNode\b/g)].join("|");
  return name === "self" || (name && new RegExp(`(?<![\\w.])${name.replaceAll(".", "\\.")}\\s*=\\s*(?:\\w+\\.)*(?:${classes})\\(`).test(text));
}

async function complete(context) {
  const line = context.state.doc.lineAt(context.pos);
  const before = line.text.slice(0, context.pos - line.from);
  const text = context.state.doc.toString();
  const inText = (before.match(/"/g)?.length ?? 0) % 2 || (before.match(/'/g)?.length ?? 0) % 2;
  const may = before.includes("#") || inText ? null : labels(before, text, await known());
  if (!may || may[1].length === 0) {
    return null;
  }
  const [typed, every] = may;
  const options = [...new Set(every)].filter((label) => label !== typed).map((label) => ({ label }));
  return { from: context.pos - typed.length, options, validFor: /^[\w.]*$/ };
}

/** Take the marked suggestion, else the first; while the list is being made, nothing. */
function take(view) {
  const taken = acceptCompletion(view) || (moveCompletionSelection(true)(view) && acceptCompletion(view));
  return taken || completionStatus(view.state) !== null;
}

// Enter makes a new line unless a suggestion was chosen: nobody's line ends with a word they did not type
export const completion = [
  autocompletion({ override: [complete], selectOnOpen: false, icons: false, interactionDelay: 0 }),
  keymap.of([{ key: "Tab", run: take }]),
];
