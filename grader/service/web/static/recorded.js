// The replay of a submission's run, which is asked for once the page is there.
import { show } from "./replay.js";

const section = document.getElementById("replay");

async function load(address) {
  const answer = await fetch(address, { headers: { Accept: "application/json" }, redirect: "error" });
  if (!answer.ok) {
    throw new Error(`${address}: ${answer.status}`);
  }
  return answer.json();
}

try {
  show(section, ...(await Promise.all([load(section.dataset.trajectory), load(section.dataset.sketch)])));
} catch (error) {
  section.querySelector("[data-failed]").hidden = false;
  throw error;
}
