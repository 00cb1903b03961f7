// Ask where the submission stands until it is graded, then show the result. Without scripts the page reloads.
const panel = document.getElementById("progress");
const text = document.getElementById("progress-text");
const FIRST_MS = 400;
const LONGEST_MS = 5000;
const SLOWER = 1.3;

let pauseMs = FIRST_MS;

function show({ open, state, text: words, position }) {
  const steps = [...panel.querySelectorAll("[data-step]")];
  const now = steps.findIndex((step) => step.dataset.step === state);
  steps.forEach((step, index) => {
    step.classList.toggle("done", index < now);
    step.classList.toggle("now", index === now);
  });
  say(open ? words + place(position) : panel.dataset.done);
}

function place(position) {
  if (position === null) {
    return "";
  }
  const colon = document.documentElement.lang.startsWith("zh") ? "：" : ": ";
  return colon + (position > 0 ? panel.dataset.ahead.replace("{count}", String(position)) : panel.dataset.next);
}

// an unchanged sentence must not be read out again
function say(sentence) {
  if (text.textContent !== sentence) {
    text.textContent = sentence;
  }
}

async function ask() {
  try {
    const answer = await fetch(panel.dataset.state, { headers: { Accept: "application/json" }, redirect: "error" });
    if (!answer.ok) {
      throw new Error(String(answer.status));
    }
    const state = await answer.json();
    show(state);
    if (!state.open) {
      window.location.reload();
      return;
    }
  } catch {
    say(panel.dataset.lost);
  }
  window.setTimeout(ask, pauseMs);
  pauseMs = Math.min(pauseMs * SLOWER, LONGEST_MS);
}

window.setTimeout(ask, pauseMs);
