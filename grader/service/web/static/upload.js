// Dropping a file, and saying at once when it is too large. The form works the same without this.
const form = document.getElementById("upload");
const drop = document.getElementById("drop");
const input = document.getElementById("file");
const chosen = document.getElementById("chosen");
const button = form.querySelector("button[type=submit]");
const KIB = 1024;

function say() {
  const [file] = input.files;
  const tooLarge = file !== undefined && file.size > Number(form.dataset.maxBytes);
  input.setCustomValidity(tooLarge ? form.dataset.tooLarge : "");
  if (file === undefined) {
    chosen.textContent = "";
  } else if (tooLarge) {
    chosen.textContent = form.dataset.tooLarge;
  } else {
    const kib = (file.size / KIB).toFixed(1);
    chosen.textContent = form.dataset.chosen.replace("{name}", () => file.name).replace("{kib}", kib);
  }
}

function carriesFiles(event) {
  return event.dataTransfer?.types.includes("Files") ?? false;
}

drop.addEventListener("dragover", (event) => {
  if (carriesFiles(event)) {
    event.preventDefault();
    drop.classList.add("over");
  }
});
drop.addEventListener("dragleave", () => drop.classList.remove("over"));
drop.addEventListener("drop", (event) => {
  drop.classList.remove("over");
  if (carriesFiles(event)) {
    event.preventDefault();
    const one = new DataTransfer();
    one.items.add(event.dataTransfer.files[0]);
    input.files = one.files;
    say();
  }
});
input.addEventListener("change", say);
form.addEventListener("submit", () => {
  button.disabled = true;
  chosen.textContent = form.dataset.sending;
});
// coming back with the browser's history must not find a dead button
window.addEventListener("pageshow", () => {
  button.disabled = false;
  say();
});
drop.querySelector(".drop-hint").hidden = false;
