// A link of a slip brings its token behind the #, which no server sees; whoever follows it still chooses to come in.
const token = decodeURIComponent(location.hash.slice(1));
const field = document.getElementById("token");

if (token !== "" && field !== null) {
  history.replaceState(null, "", location.pathname + location.search);
  field.value = token;
  field.form.querySelector("button").focus();
}
