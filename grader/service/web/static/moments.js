// What happened when: log lines and commands as one list, in step with the replay.
const MOST_COMMANDS = 300;
const SAME = 1e-9;
const LATE_S = 5e-4; // log lines are written to the millisecond

export class Moments {
  /** `published`: how many commands the script sent. `jump(seconds)` is called when somebody chooses a line. */
  constructor(holder, motion, words, published, jump) {
    this.frame = holder.querySelector(".log");
    const list = this.frame.querySelector("ol");
    this.now = null;
    const logs = [...list.children].map((line) => ({ t: Number(line.dataset.t), line }));
    // the recording has one command for each update: where there were more, it does not know which were how many
    const isWhole = published === motion.commands.length;
    const commands = stretches(motion.commands, motion.end)
      .slice(0, MOST_COMMANDS)
      .map((stretch) => ({ t: stretch.t, line: commandLine(stretch, words, isWhole) }));
    this.lines = [...logs, ...commands].sort((one, other) => one.t - other.t);
    for (const { t, line } of this.lines) {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...line.childNodes);
      button.tabIndex = -1;
      button.addEventListener("click", () => jump(t));
      line.append(button);
    }
    list.addEventListener("keydown", (event) => this.step(event));
    list.replaceChildren(...this.lines.map(({ line }) => line));
    this.frame.removeAttribute("tabindex"); // one of its buttons takes the focus now, arrow keys the others
    this.reach(this.lines[0]?.line ?? null);
    holder.querySelector("[data-drawn]").hidden = false;
    holder.hidden = this.lines.length === 0;
  }

  /** Let the Tab key lead to a line, and to no other. */
  reach(line) {
    if (this.reached !== undefined) {
      this.reached.tabIndex = -1;
    }
    this.reached = line?.querySelector("button");
    if (this.reached !== undefined) {
      this.reached.tabIndex = 0;
    }
  }

  /** Go to the line above or below. */
  step(event) {
    const by = { ArrowUp: "previousElementSibling", ArrowDown: "nextElementSibling" }[event.key];
    const line = by === undefined ? null : event.target.closest("li")[by];
    if (line !== null) {
      event.preventDefault();
      const button = line.querySelector("button");
      button.click();
      button.focus();
    }
  }

  /** Mark the last line at or before `time`, and keep it in sight. */
  show(time) {
    let found = null;
    for (const { t, line } of this.lines) {
      if (t > time + LATE_S) {
        break;
      }
      found = line;
    }
    if (found === this.now) {
      return;
    }
    this.now?.removeAttribute("aria-current");
    found?.setAttribute("aria-current", "true");
    this.now = found;
    this.reach(found ?? this.lines[0]?.line ?? null);
    const top = found?.offsetTop ?? 0;
    const bottom = top + (found?.offsetHeight ?? 0);
    const { scrollTop, clientHeight } = this.frame;
    if (top < scrollTop || bottom > scrollTop + clientHeight) {
      this.frame.scrollTop = top - clientHeight / 2;
    }
  }
}

/** Equal commands after each other, as one. */
function stretches(commands, end) {
  const found = [];
  for (const { t, v, w } of commands) {
    const last = found.at(-1);
    if (last !== undefined && Math.abs(last.v - v) < SAME && Math.abs(last.w - w) < SAME) {
      last.count += 1;
    } else {
      found.push({ t, v, w, count: 1 });
    }
  }
  return found.map((one, i) => ({ ...one, until: found[i + 1]?.t ?? end }));
}

function commandLine({ t, v, w, count, until }, words, isWhole) {
  const line = document.createElement("li");
  line.className = "command";
  const number = (value) => String(Number(value.toFixed(3)));
  const text = words.command.replace("{v}", number(v)).replace("{w}", number(w));
  const counted = isWhole ? words.times.replace("{count}", String(count)) : words.lasting.replace("{seconds}", (until - t).toFixed(2));
  line.append(piece("t", `${t.toFixed(3)} s`), " ", piece("what", text + (count > 1 ? ` ${counted}` : "")));
  return line;
}

function piece(name, text) {
  return Object.assign(document.createElement("span"), { className: name, textContent: text });
}
