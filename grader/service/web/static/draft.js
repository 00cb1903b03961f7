// Keep what is written in a field while its page is loaded anew; sending the form forgets it.
const field = document.querySelector("[data-draft]");
const key = `draft ${window.location.pathname}`;

field.value ||= window.sessionStorage.getItem(key) ?? "";
field.addEventListener("input", () => window.sessionStorage.setItem(key, field.value));
field.form.addEventListener("submit", () => window.sessionStorage.removeItem(key));
