// What is written is kept by the service a moment after the last key, and when the page is left. The answer says what
// Python has against it.
const PAUSE_MS = 1200;
const AGAIN_MS = 10_000;

export class Draft {
  /** `file()` is what the editor shows; `heard(problem)` takes `{ line, text }`, or null. */
  constructor(form, file, words, heard) {
    Object.assign(this, { form, file, words, heard, timer: 0, changed: false, asking: false });
    this.state = document.getElementById("kept");
    this.alarm = document.getElementById("not-kept");
    document.addEventListener("visibilitychange", () => document.hidden && this.leave());
    window.addEventListener("pagehide", () => this.leave());
  }

  /** Something was written: keep it soon. */
  later(pause = PAUSE_MS) {
    this.changed = true;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.keep(), pause);
  }

  body() {
    const body = new FormData();
    body.append("form_token", this.form.elements.form_token.value);
    body.append("file", this.file());
    return body;
  }

  leave() {
    if (this.changed) {
      this.changed = !navigator.sendBeacon(this.form.dataset.keep, this.body());
    }
  }

  async keep() {
    if (this.asking) {
      this.later();
      return;
    }
    this.asking = true;
    this.changed = false;
    const answer = await fetch(this.form.dataset.keep, { method: "POST", body: this.body(), redirect: "error" }).catch(() => null);
    this.asking = false;
    const told = await answer?.json().catch(() => null);
    const kept = answer?.ok === true;
    this.state.textContent = kept ? this.words.kept : "";
    const waits = answer?.status === 429;
    this.alarm.hidden = kept || waits;
    this.alarm.textContent = kept || waits ? "" : [told?.title, this.words.not_kept].filter(Boolean).join(" ");
    if (waits || answer === null) {
      this.later(waits ? 1000 * Number(answer.headers.get("Retry-After") ?? AGAIN_MS / 1000) : AGAIN_MS);
    } else if (kept && !this.changed) { // else it is about an older text
      this.heard(told.problem);
    }
  }
}
