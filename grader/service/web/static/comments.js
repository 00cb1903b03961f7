// Choosing the number of a line of the file is the short way to write about it. The form works the same without this.
const lines = document.querySelector(".lines");
const write = document.getElementById("write");
const field = document.getElementById("comment-line");

lines?.classList.add("choosable");
lines?.addEventListener("click", (event) => {
  const line = event.target.closest("li");
  if (line !== null && event.target === line) {
    // its number is no element of its own
    write.open = true;
    field.value = line.id.slice(1);
    document.getElementById("comment-text").focus();
  }
});
