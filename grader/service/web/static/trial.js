// Ask how far a trial is until all of it is made, then show the result: at once, unless somebody is writing a reason.
const line = document.getElementById("progress");
const bar = line.querySelector("progress");
const count = line.querySelector("[data-count]");
const said = document.querySelector("[data-said]");
const ready = document.querySelector("[data-ready]");
const reason = document.querySelector("[data-draft]");
const FIRST_MS = 500;
const LONGEST_MS = 4000;
const SLOWER = 1.25;

let pauseMs = FIRST_MS;

function show({ waiting, total }) {
  bar.max = total;
  bar.value = total - waiting;
  count.textContent = line.dataset.text.replace("{done}", String(total - waiting)).replace("{total}", String(total));
}

function finish() {
  const writing = reason !== null && (reason.value !== "" || document.activeElement === reason);
  said.textContent = writing ? line.dataset.complete : line.dataset.done;
  ready.hidden = !writing;
  if (!writing) {
    window.location.reload();
  }
}

async function ask() {
  try {
    const answer = await fetch(line.dataset.state, { headers: { Accept: "application/json" }, redirect: "error" });
    if (!answer.ok) {
      throw new Error(String(answer.status));
    }
    const state = await answer.json();
    show(state);
    said.textContent = "";
    if (!state.open || state.waiting === 0) {
      finish();
      return;
    }
  } catch {
    said.textContent = line.dataset.lost;
  }
  window.setTimeout(ask, pauseMs);
  pauseMs = Math.min(pauseMs * SLOWER, LONGEST_MS);
}

window.setTimeout(ask, pauseMs);
