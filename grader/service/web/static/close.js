// The platform's page that shows this one in a frame, or has opened its window, closes it when it is told so.
const button = document.querySelector("[data-close]");
button.hidden = false;
button.addEventListener("click", () => {
  (window.opener ?? window.parent).postMessage({ subject: "org.imsglobal.lti.close" }, "*");
});
