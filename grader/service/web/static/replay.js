// Replays a recorded motion: play, pause, scrub, speed; plan view, log lines and graphs share one point in time.
// It plays by itself once it is seen, unless the reader wants less motion or does something first.
import { Graph } from "./graph.js";
import { Moments } from "./moments.js";
import { Motion } from "./motion.js";
import { Plan } from "./plan.js";

const COMMAND_HELD_S = 1; // turtlesim drops a command after that
const LONGEST_S = 15; // to be watched, where one of the offered speeds allows it
const SEEN = 0.4; // of the plan view, or as much of it as fits on the screen
const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

/** Commands as steps that fall to zero when they are dropped. */
function steps(commands, name, end) {
  return commands.flatMap((command, i) => {
    const dropped = command.t + COMMAND_HELD_S;
    const next = commands[i + 1]?.t ?? end;
    const here = { t: command.t, value: command[name] };
    return next > dropped ? [here, { t: dropped, value: 0 }] : [here];
  });
}

class Replay {
  constructor(section, motion, sketch) {
    const words = JSON.parse(section.dataset.words);
    const find = (name) => section.querySelector(`[data-${name}]`);
    this.find = find;
    this.words = words;
    this.motion = motion;
    this.end = motion.lastChange;
    this.time = this.end;
    this.playing = false;
    this.plan = new Plan(find("plan"), motion, sketch, words);
    this.graphs = this.makeGraphs(sketch);
    this.button = find("play");
    this.scrub = find("scrub");
    this.speed = find("speed");
    this.moments = new Moments(find("moments"), motion, words, Number(section.dataset.published), (time) => this.jump(time));
    find("legend").hidden = sketch.view !== "path"; // it explains figures
    find("commanded").hidden = !sketch.commanded_m?.length;
    const speeds = [...this.speed.options].map((option) => option.value);
    this.speed.value = speeds.find((value) => Number(value) >= 2 && this.end / Number(value) <= LONGEST_S) ?? speeds.at(-1);
    this.listen();
    this.fit();
    this.playOnceSeen();
  }

  playOnceSeen() {
    if (calm.matches) {
      return;
    }
    const seen = new IntersectionObserver(
      ([entry]) => {
        if (entry.isIntersecting) {
          this.leaveAlone();
          this.play();
        }
      },
      { threshold: SEEN },
    );
    this.leaveAlone = () => seen.disconnect();
    seen.observe(this.find("plan"));
  }

  /** Do not play by itself any more. */
  leaveAlone() {}

  jump(time) {
    this.pause();
    this.show(Math.min(time, this.end));
  }

  makeGraphs(sketch) {
    const { motion, end } = this;
    const holder = this.find("graphs");
    const shown = [
      { name: "v", title: this.words.v, values: motion.v, steps: steps(motion.commands, "v", end) },
      { name: "w", title: this.words.w, values: motion.w, steps: steps(motion.commands, "w", end) },
    ];
    if (sketch.view === "heading") {
      const start = motion.heading[0];
      const degrees = (radians) => ((radians - start) * 180) / Math.PI;
      const wanted = sketch.wanted_turn_deg ?? null;
      const turned = motion.heading.map(degrees);
      const sign = Math.sign(turned.at(-1)) || 1;
      shown.unshift({ name: "heading", title: this.words.turned, values: turned, wanted: wanted === null ? null : sign * wanted, degrees });
    }
    return shown.map((series) => {
      const place = document.createElement("div");
      holder.append(place);
      const graph = new Graph(place, { ...series, t: motion.t }, end);
      const value = series.degrees ?? ((one) => one);
      return { graph, at: (state) => value(state[series.name]) };
    });
  }

  listen() {
    this.scrub.max = String(this.end);
    this.scrub.step = String(Math.max(this.end / 1000, 0.01));
    this.scrub.addEventListener("input", () => {
      this.jump(Number(this.scrub.value));
    });
    this.button.addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    this.find("other")?.addEventListener("change", async ({ target }) => {
      this.find("overlaid").hidden = target.value === "";
      this.plan.other = target.value === "" ? null : new Motion(await (await fetch(target.value, { redirect: "error" })).json());
      this.fit();
    });
    let width = 0;
    new ResizeObserver(() => {
      const now = this.find("plan").clientWidth;
      if (now !== width && now > 0) { // nothing can be drawn while it is hidden
        width = now;
        this.fit();
      }
    }).observe(this.find("plan"));
  }

  fit() {
    this.plan.draw(this.find("plan").clientWidth);
    for (const { graph } of this.graphs) {
      graph.draw(this.find("graphs").clientWidth);
    }
    this.show(this.time);
  }

  play() {
    this.leaveAlone();
    this.playing = true;
    this.say(this.words.pause);
    let time = this.time >= this.end - 1e-6 ? 0 : this.time;
    let before = performance.now();
    const step = (now) => {
      if (!this.playing) {
        return;
      }
      time += ((now - before) / 1000) * Number(this.speed.value);
      before = now;
      this.show(Math.min(time, this.end));
      if (time >= this.end) {
        this.pause();
      } else {
        requestAnimationFrame(step);
      }
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.leaveAlone();
    this.playing = false;
    this.say(this.words.play);
  }

  say(word) {
    this.button.textContent = word;
  }

  show(time) {
    this.time = time;
    const state = this.motion.state(time);
    this.plan.show(state);
    this.moments.show(time);
    for (const { graph, at } of this.graphs) {
      graph.show(time, at(state));
    }
    this.scrub.value = String(time);
    this.scrub.setAttribute("aria-valuetext", `${time.toFixed(2)} s`);
    this.readout(time, state);
  }

  readout(time, state) {
    const degrees = (((state.heading * 180) / Math.PI) % 360).toFixed(1);
    const lines = [
      [this.words.time, `${time.toFixed(2)} s`],
      ["x", `${state.x.toFixed(2)} m`],
      ["y", `${state.y.toFixed(2)} m`],
      [this.words.heading, `${degrees}°`],
      ["v", `${state.v.toFixed(2)} m/s`],
      ["ω", `${state.w.toFixed(2)} rad/s`],
    ];
    const list = this.find("readout");
    if (list.childElementCount === 0) {
      for (const [name] of lines) {
        const pair = document.createElement("div");
        pair.append(Object.assign(document.createElement("dt"), { textContent: name }), document.createElement("dd"));
        list.append(pair);
      }
    }
    lines.forEach(([, value], i) => {
      list.children[i].lastChild.textContent = value;
    });
  }
}

/** Show in `section` what the service says of a run: its columns and what the checks saw. */
export function show(section, columns, sketch) {
  const motion = new Motion(columns);
  const drawings = section.querySelectorAll("[data-drawing]");
  drawings.forEach((part) => (part.hidden = false));
  if (motion.moves) {
    new Replay(section, motion, sketch);
  } else {
    const remark = document.createElement("p");
    remark.textContent = JSON.parse(section.dataset.words).still;
    drawings.forEach((part) => part.replaceChildren());
    drawings[0].append(remark);
  }
  section.dataset.ready = "true";
}
