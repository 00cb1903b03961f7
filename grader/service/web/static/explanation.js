// The explanation of a result's marks: changes that were tried. A worker looks for them behind all submissions, so
// the page says that it is looking, follows the stream that tells when they are there, and puts them in.
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
    show(answer.ok ? await answer.text() : "");
  }
}

function show(html) {
  place.querySelector("[role=status]").hidden = true;
  if (html.includes('class="change"')) {
    place.innerHTML = html;
    document.body.classList.add("explained"); // what was tried silences what was guessed
  } else {
    place.insertAdjacentHTML("afterbegin", html); // a stated cause, or nothing, beside the hint
  }
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

load();
