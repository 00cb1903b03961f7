// The replay of a submission's run, which is asked for once the page is there.
import { show } from "./replay.js";

const section = document.getElementById("replay");

async function load(address) {
  let answer;
  try {
    answer = await fetch(address, { headers: { Accept: "application/json" }, redirect: "error" });
  } catch {
    return null; // no network, or the page is being left
  }
  if (!answer.ok) {
    throw new Error(`${address}: ${answer.status}`);
  }
  return answer.json();
}

try {
  const both = await Promise.all([load(section.dataset.trajectory), load(section.dataset.sketch)]);
  if (both.includes(null)) {
    section.querySelector("[data-failed]").hidden = false;
  } else {
    show(section, ...both);
  }
} catch (error) {
  section.querySelector("[data-failed]").hidden = false;
  throw error;
}
