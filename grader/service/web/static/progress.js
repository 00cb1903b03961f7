// Follow the submission until it is graded, then show the result. Without scripts the page reloads.
//
// The server tells by events. Where these do not get through (a proxy that holds them back, too many streams), the
// page asks again and again instead. A page nobody looks at holds no connection: browsers allow few per server.
const panel = document.getElementById("progress");
const text = document.getElementById("progress-text");
const FIRST_EVENT_MS = 3000;
const FAILURES = 2;
const FIRST_MS = 400;
const LONGEST_MS = 5000;
const SLOWER = 1.3;

let source = null;
let failures = 0;
let patience = 0;
let pauseMs = FIRST_MS;

function show({ open, state, text: words }) {
  const steps = [...panel.querySelectorAll("[data-step]")];
  const now = steps.findIndex((step) => step.dataset.step === state);
  steps.forEach((step, index) => {
    step.classList.toggle("done", index < now);
    step.classList.toggle("now", index === now);
  });
  say(open ? words : panel.dataset.done);
  if (!open) {
    stop();
    window.location.reload();
  }
}

// an unchanged sentence must not be read out again
function say(sentence) {
  if (text.textContent !== sentence) {
    text.textContent = sentence;
  }
}

function follow() {
  source = new EventSource(panel.dataset.state.replace(/state\.json$/, "events"));
  patience = window.setTimeout(askInstead, FIRST_EVENT_MS);
  source.addEventListener("open", () => {
    failures = 0;
  });
  source.addEventListener("progress", (event) => {
    window.clearTimeout(patience);
    show(JSON.parse(event.data));
  });
  // a stream that ended is opened again by the browser itself; one that was refused is not
  source.addEventListener("error", () => {
    failures += 1;
    if (source.readyState === EventSource.CLOSED) {
      askInstead();
    } else if (failures >= FAILURES) {
      say(panel.dataset.lost);
    }
  });
}

function stop() {
  window.clearTimeout(patience);
  source?.close();
  source = null;
}

function askInstead() {
  document.removeEventListener("visibilitychange", onlyWhileSeen);
  stop();
  ask();
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
      return;
    }
  } catch {
    say(panel.dataset.lost);
  }
  window.setTimeout(ask, pauseMs);
  pauseMs = Math.min(pauseMs * SLOWER, LONGEST_MS);
}

function onlyWhileSeen() {
  stop();
  if (!document.hidden) {
    follow();
  }
}

document.addEventListener("visibilitychange", onlyWhileSeen);
onlyWhileSeen();
