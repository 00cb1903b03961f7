// Writing a script, running it for practice, handing it in. The file that is handed in is what the editor shows.
//
// The editor's styles are rules of a shadow root: the page's policy takes no style that a script writes into it.
import {
  bracketMatching, defaultKeymap, drawSelection, EditorState, EditorView, HighlightStyle, highlightActiveLine, history,
  historyKeymap, indentOnInput, indentUnit, indentWithTab, keymap, lineNumbers, pythonLanguage, syntaxHighlighting, tags,
} from "./codemirror.js";
import { completion } from "./completion.js";
import { Draft } from "./draft_kept.js";
import { mark, marks } from "./marks.js";
import { show } from "./replay.js";

const form = document.getElementById("practice");
const plain = document.getElementById("starter");
const holder = document.getElementById("editor");
const runButton = document.getElementById("run");
const state = document.getElementById("practice-state");
const soFar = document.getElementById("so-far");
const virtualTime = document.getElementById("virtual-time");
const refused = document.getElementById("refused");
const result = document.getElementById("result");
const words = JSON.parse(form.dataset.words);
const opened = JSON.parse(form.dataset.opened);
const starter = plain.value;

const colours = HighlightStyle.define([
  { tag: [tags.keyword, tags.controlKeyword, tags.operatorKeyword], color: "var(--accent)", fontWeight: "600" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--part)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--bad)" },
  { tag: tags.comment, color: "var(--quiet)", fontStyle: "italic" },
]);
const look = EditorView.theme({
  "&": { color: "var(--ink)", backgroundColor: "var(--paper)", fontSize: "0.9rem", border: "1px solid var(--quiet)", borderRadius: "6px" },
  "&.cm-focused": { outline: "3px solid var(--accent)", outlineOffset: "2px" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.5", maxHeight: "70vh", minHeight: "18rem" },
  ".cm-gutters": { backgroundColor: "var(--raised)", color: "var(--quiet)", border: "0" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "var(--raised)" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "var(--good-tint)" },
  ".cm-wrong": { backgroundColor: "var(--bad-tint)" },
  ".cm-said": { color: "var(--bad)", fontFamily: "var(--sans, sans-serif)", padding: "0 0 .25rem 1.5rem" },
  ".cm-tooltip": { backgroundColor: "var(--raised)", color: "var(--ink)", border: "1px solid var(--quiet)" },
  ".cm-tooltip-autocomplete > ul > li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--paper)" },
  "&.cm-focused .cm-matchingBracket": { backgroundColor: "var(--part-tint)", outline: "1px solid var(--part)" },
});

/**
 * Type over what is selected. A browser that does so by itself gives the new text the look of the old, in a style of
 * its own, which the page's policy refuses.
 */
function typeOver(event, view) {
  if (event.inputType !== "insertText" || event.data === null || view.state.selection.main.empty) {
    return false;
  }
  view.dispatch(view.state.replaceSelection(event.data), { userEvent: "input.type", scrollIntoView: true });
  return true;
}

function open(doc) {
  const root = holder.attachShadow({ mode: "open" });
  return new EditorView({
    root,
    parent: root,
    state: EditorState.create({
      doc,
      extensions: [
        lineNumbers(), history(), drawSelection(), highlightActiveLine(), bracketMatching(), indentOnInput(), completion, marks,
        indentUnit.of("    "), pythonLanguage, syntaxHighlighting(colours), look, EditorView.lineWrapping,
        keymap.of([
          { key: "Mod-Enter", run: () => (runOnce(), true) },
          indentWithTab, ...defaultKeymap, ...historyKeymap,
        ]),
        EditorView.domEventHandlers({ beforeinput: typeOver }),
        EditorView.contentAttributes.of({ "aria-label": words.editor, "aria-multiline": "true", tabindex: "0" }),
        EditorView.updateListener.of((update) => update.docChanged && draft.later()),
      ],
    }),
  });
}

const editor = open(opened.draft ?? starter);
const draft = new Draft(form, file, words, (problem) => mark(editor, "python", problem === null ? [] : [problem]));
plain.remove();
if (opened.draft !== null) {
  draft.later(); // what Python has against it stands there again
}
if (opened.brought !== undefined) { // a submission to be mended; what was there comes back with Ctrl+Z
  put(opened.brought);
  mark(editor, "told", opened.marks);
  window.history.replaceState(null, "", window.location.pathname);
  if (opened.marks.length) {
    goTo(opened.marks[0].line);
  }
  editor.focus();
}
document.getElementById("keys").hidden = document.getElementById("actions").hidden = false;

function file() {
  return new File([editor.state.doc.toString()], holder.dataset.name, { type: "text/x-python" });
}

function tell(sentences) {
  refused.hidden = sentences.length === 0;
  refused.replaceChildren(...sentences.map((one) => Object.assign(document.createElement("p"), { textContent: one })));
}

/** Put a program in the place of what is there. */
function put(program) {
  editor.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: program }, userEvent: "input" });
}

function goTo(number) {
  const line = editor.state.doc.line(Math.min(Math.max(number, 1), editor.state.doc.lines));
  // nothing is selected: what is typed next would take the place of the line
  editor.dispatch({ selection: { anchor: line.from + line.text.search(/\S|$/) }, scrollIntoView: true });
  editor.focus();
}

const lineOf = (link) => Number(link.hash.slice(2));

function showResult({ html, trajectory, sketch }) {
  // made by our own templates, which escape whatever a script wrote
  result.innerHTML = html;
  const links = [...result.querySelectorAll("a[href^='#L']")];
  links.forEach((link) => link.addEventListener("click", (event) => {
    event.preventDefault();
    goTo(lineOf(link));
  }));
  const told = links.filter((link) => link.dataset.said !== undefined || link.closest(".next") !== null);
  mark(editor, "told", told.map((link) => ({ line: lineOf(link), text: link.dataset.said ?? "" })));
  const replay = result.querySelector("#replay");
  if (replay !== null && trajectory !== null) {
    show(replay, trajectory, sketch);
  }
}

/** The events of an answer as they come: `{ name, data }`. Behind a proxy that holds them back, all come at the end. */
async function* events(answer) {
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) {
      return;
    }
    const blocks = (text + value).split("\n\n");
    text = blocks.pop();
    for (const block of blocks) {
      const fields = Object.fromEntries(block.split("\n").map((line) => [line.split(": ", 1)[0], line.slice(line.indexOf(": ") + 2)]));
      if (fields.event) {
        yield { name: fields.event, data: JSON.parse(fields.data) };
      }
    }
  }
}

// what has not changed is not said again: it would be read out each time
function say(sentence) {
  if (state.textContent !== sentence) {
    state.textContent = sentence;
  }
}

function tellOf({ virtual_s: seconds, stdout, stderr }) {
  say(words.running);
  soFar.hidden = seconds === 0;
  virtualTime.textContent = words.virtual_time.replace("{seconds}", seconds.toFixed(1));
  for (const [id, text] of Object.entries({ stdout, stderr })) {
    const printed = document.getElementById(id);
    printed.textContent = text;
    printed.hidden = text === "";
    printed.scrollTop = printed.scrollHeight;
  }
}

const on = {
  waiting: ({ before }) => say(before ? words.waiting.replace("{count}", before) : words.next),
  running: tellOf,
  refused: (problem) => tell([...new Set([problem.title, problem.detail, problem.fix])].filter(Boolean)),
  seen(shown) {
    showResult(shown);
    say(words.done);
    if (result.getBoundingClientRect().top > window.innerHeight / 2) {
      result.scrollIntoView(); // on a phone it stands below the editor
    }
  },
};

async function runOnce() {
  if (!runButton || runButton.disabled) {
    return;
  }
  runButton.disabled = true;
  say(words.next);
  tell([]);
  result.ariaBusy = "true";
  let last = "";
  try {
    const body = new FormData();
    body.append("form_token", form.elements.form_token.value);
    body.append("file", file());
    const headers = { Accept: "text/event-stream, application/json" };
    const answer = await fetch(form.dataset.run, { method: "POST", body, headers, redirect: "error" });
    if (answer.ok) {
      for await (const { name, data } of events(answer)) {
        last = name;
        on[name]?.(data);
      }
    } else {
      last = "refused";
      on.refused(await answer.json());
    }
  } catch {
    last = "";
  }
  if (last !== "seen") {
    say("");
  }
  if (last !== "seen" && last !== "refused") {
    tell([words.lost]);
  }
  soFar.hidden = true;
  result.ariaBusy = null;
  runButton.disabled = false;
}

runButton?.addEventListener("click", runOnce);
document.getElementById("reset").addEventListener("click", () => {
  if (window.confirm(words.reset_sure)) {
    put(starter);
  }
});
document.getElementById("last")?.addEventListener("click", async ({ target }) => {
  const answer = await fetch(target.dataset.source, { redirect: "error" });
  if (answer.ok) {
    put(await answer.text());
    editor.focus();
  }
});
form.addEventListener("submit", () => {
  const one = new DataTransfer();
  one.items.add(file());
  form.elements.file.files = one.files;
});
