// The explanation of a result's marks: changes that were tried. A worker looks for them behind all submissions: a page
// that came before they were there follows the stream that tells when they are, and puts them in.
import { begin } from "./marked.js";

const place = document.getElementById("explanation");
const PAUSE_MS = 5000;
let source = null;

async function load() {
  let answer;
  try {
    answer = await fetch(place.dataset.address, { headers: { Accept: "text/html" }, redirect: "error" });
  } catch {
    return; // no network, or the page is being left
  }
  if (answer.status === 202) {
    follow();
  } else {
    show(answer.ok ? await answer.text() : null);
  }
}

function show(html) {
  if (html === null) { // the page keeps what it says
    place.querySelector("[data-looking]").remove();
    return;
  }
  place.innerHTML = html;
  if (html.includes('class="change"')) {
    place.closest(".result").classList.add("explained");
    mark([]); // of the guess
  }
}

/** Mark the lines of the program that `links` lead to, and no others. */
function mark(links) {
  document.querySelectorAll(".lines .hinted").forEach((line) => line.classList.remove("hinted"));
  links.forEach((link) => document.querySelector(link.hash)?.classList.add("hinted"));
  begin();
}

// a page nobody looks at holds no connection
function follow() {
  if (document.hidden) {
    document.addEventListener("visibilitychange", load, { once: true });
    return;
  }
  source = new EventSource(`${place.dataset.address}/events`);
  source.addEventListener("explanation", (event) => {
    if (!JSON.parse(event.data).open) {
      source.close();
      load();
    }
  });
  source.addEventListener("error", () => {
    if (source.readyState === EventSource.CLOSED) {
      window.setTimeout(load, PAUSE_MS);
    }
  });
}

// a further hint was opened or closed; the event does not bubble
place.addEventListener("toggle", () => mark([...place.querySelectorAll("details[open] > p a[href^='#L']")]), true);
if (place.querySelector("[data-looking]")) {
  follow();
}
