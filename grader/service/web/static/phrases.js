// A key with a semicolon before it becomes its phrase where it is typed; a button puts the phrase where one wrote last.
const phrases = new Map([...document.querySelectorAll("[data-phrase]")].map((one) => [one.dataset.phrase, one.value]));
const fields = [...document.querySelectorAll("textarea[data-phrases]")];
let latest = fields[0];

function insert(field, text, from, to) {
  field.setRangeText(text, from, to, "end");
  field.focus();
}

for (const field of fields) {
  field.addEventListener("focus", () => {
    latest = field;
  });
  field.addEventListener("input", () => {
    const at = field.selectionStart;
    const [typed, key] = field.value.slice(0, at).match(/;(\S+)\s$/) ?? [];
    if (phrases.has(key)) {
      insert(field, phrases.get(key), at - typed.length, at);
    }
  });
}
for (const button of document.querySelectorAll("[data-phrase]")) {
  button.addEventListener("click", () => insert(latest, button.value, latest.selectionStart, latest.selectionEnd));
}
