// Keep what is written in a field while its page is loaded anew; of a student (`data-draft`) on this browser for good,
// because an answer takes longer than a session and may be improved; sending any other form forgets its text.
const field = document.querySelector("[data-draft]");
const student = field.dataset.draft;
const storage = student ? window.localStorage : window.sessionStorage;
const key = ["draft", student, window.location.pathname].filter(Boolean).join(" ");

field.value ||= storage.getItem(key) ?? "";
field.addEventListener("input", () => storage.setItem(key, field.value));
field.form.addEventListener("submit", () => student || storage.removeItem(key));
