// The explanation of a result's marks, which is looked for once the page is there: changes that were tried.
const place = document.getElementById("explanation");

async function load() {
  try {
    const answer = await fetch(place.dataset.address, { headers: { Accept: "text/html" }, redirect: "error" });
    return answer.ok ? await answer.text() : "";
  } catch {
    return ""; // no network, or the page is being left
  }
}

const html = await load();
place.querySelector("[role=status]").hidden = true;
if (html) {
  place.innerHTML = html;
  document.body.classList.add("explained"); // what was tried silences what was guessed
}
