// Lines of the program about which something is said: the line is tinted, and the sentence stands below it.
import { Decoration, EditorView, StateEffect, StateField, WidgetType } from "./codemirror.js";

const setMarks = StateEffect.define();

class Sentence extends WidgetType {
  constructor(text) {
    super();
    this.text = text;
  }

  eq(other) {
    return other.text === this.text;
  }

  toDOM() {
    return Object.assign(document.createElement("div"), { className: "cm-said", textContent: `✗ ${this.text}` });
  }
}

/** Decorations for `[{ line, text }]`; a line without text is only tinted. */
function decorations(doc, said) {
  const fitting = said.filter(({ line }) => line >= 1 && line <= doc.lines).sort((one, other) => one.line - other.line);
  return Decoration.set(
    fitting.flatMap(({ line, text }) => {
      const { from, to } = doc.line(line);
      const tint = Decoration.line({ class: "cm-wrong" }).range(from);
      return text === "" ? [tint] : [tint, Decoration.widget({ widget: new Sentence(text), block: true, side: 1 }).range(to)];
    }),
    true,
  );
}

// by who says it: Python's compiler while one writes ("python"), the result of a run ("told")
const field = StateField.define({
  create: () => ({ python: Decoration.none, told: Decoration.none }),
  update(value, transaction) {
    let next = transaction.docChanged
      ? { python: value.python.map(transaction.changes), told: value.told.map(transaction.changes) }
      : value;
    for (const effect of transaction.effects) {
      if (effect.is(setMarks)) {
        next = { ...next, [effect.value.by]: decorations(transaction.state.doc, effect.value.said) };
      }
    }
    return next;
  },
  provide: (own) => ["python", "told"].map((by) => EditorView.decorations.from(own, (value) => value[by])),
});

export const marks = field;

export function mark(editor, by, said) {
  editor.dispatch({ effects: setMarks.of({ by, said }) });
}
