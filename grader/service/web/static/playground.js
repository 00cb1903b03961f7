// A car in real time, driven over rosbridge as any other client does it: docs/live.md.
const WINDOW_M = 499 / 45; // turtlesim's
const COMMAND_MS = 200; // a command drives for a second; while a key is held it is sent again
const TOPICS_MS = 3000;
const MOST_POINTS = 5000;
const LEAST_M = 0.02;
const ECHO_MS = 250;
const MOST_ECHOED = 20;
const TURN_RADPS = 1.2;
const KEYS = {
  ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1],
  w: [1, 0], s: [-1, 0], a: [0, 1], d: [0, -1], " ": [0, 0],
};

const find = (id) => document.getElementById(id);
const words = JSON.parse(find("car").dataset.words);
const view = find("view");
const canvas = find("field");
const turtles = new Map(); // by name: pose and the points driven through
let socket = null;
let serial = 0;
const answers = new Map();
let repeating = 0;
let held = ""; // what drives: a key, or "button"
let painting = 0;

function say(text) {
  find("car-state").textContent = text;
}

function send(frame) {
  if (socket?.readyState === WebSocket.OPEN) {
    socket.send(JSON.stringify(frame));
  }
}

function call(service, args, then = () => {}) {
  const id = `call_${(serial += 1)}`;
  answers.set(id, then);
  send({ op: "call_service", id, service, args });
}

function command(v, w) {
  const message = { linear: { x: v * Number(find("speed").value) }, angular: { z: w * TURN_RADPS } };
  send({ op: "publish", topic: "/turtle1/cmd_vel", type: "geometry_msgs/msg/Twist", msg: message });
}

/** Drive as long as `by` is held, until `halt`. */
function drive(by, v, w) {
  window.clearInterval(repeating);
  command(v, w);
  held = by;
  repeating = v === 0 && w === 0 ? 0 : window.setInterval(() => command(v, w), COMMAND_MS);
}

/** Stop what `by` drives. A press of a button takes the focus from the view: that must not stop what it has begun. */
function halt(by) {
  if (repeating && held === by) {
    drive("", 0, 0);
  }
}

// the drawing

function seen(name, pose) {
  const turtle = turtles.get(name) ?? { points: [] };
  turtle.pose = pose;
  const last = turtle.points.at(-1);
  if (!last || Math.hypot(last[0] - pose.x, last[1] - pose.y) >= LEAST_M) {
    turtle.points.push([pose.x, pose.y]);
    turtle.points.splice(0, turtle.points.length - MOST_POINTS);
  }
  turtles.set(name, turtle);
  painting ||= window.requestAnimationFrame(paint);
}

function paint() {
  painting = 0;
  const ratio = window.devicePixelRatio || 1;
  const side = canvas.clientWidth;
  if (canvas.width !== Math.round(side * ratio)) {
    canvas.width = canvas.height = Math.round(side * ratio);
  }
  const style = getComputedStyle(view);
  const ink = (name) => style.getPropertyValue(`--${name}`);
  const pen = canvas.getContext("2d");
  const scale = side / WINDOW_M;
  const at = ([x, y]) => [x * scale, side - y * scale];
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = ink("paper");
  pen.fillRect(0, 0, side, side);
  pen.lineWidth = 1;
  pen.strokeStyle = ink("grid");
  for (let metre = 1; metre < WINDOW_M; metre += 1) {
    pen.beginPath();
    pen.moveTo(...at([metre, 0]));
    pen.lineTo(...at([metre, WINDOW_M]));
    pen.moveTo(...at([0, metre]));
    pen.lineTo(...at([WINDOW_M, metre]));
    pen.stroke();
  }
  for (const { points, pose } of turtles.values()) {
    pen.strokeStyle = pen.fillStyle = ink("accent");
    pen.lineWidth = 2;
    pen.beginPath();
    points.forEach((point, i) => {
      const jumped = i > 0 && Math.hypot(point[0] - points[i - 1][0], point[1] - points[i - 1][1]) > 1;
      pen[i === 0 || jumped ? "moveTo" : "lineTo"](...at(point));
    });
    pen.stroke();
    turtle(pen, at([pose.x, pose.y]), pose.theta);
  }
  const own = turtles.get("turtle1")?.pose;
  if (own) {
    const degrees = ((own.theta * 180) / Math.PI).toFixed(0);
    find("place").textContent = words.place
      .replace("{x}", own.x.toFixed(2)).replace("{y}", own.y.toFixed(2)).replace("{degrees}", degrees);
  }
}

function turtle(pen, [x, y], theta) {
  const size = 12;
  pen.save();
  pen.translate(x, y);
  pen.rotate(-theta);
  pen.beginPath();
  pen.moveTo(size, 0);
  pen.lineTo(-size * 0.7, size * 0.7);
  pen.lineTo(-size * 0.35, 0);
  pen.lineTo(-size * 0.7, -size * 0.7);
  pen.closePath();
  pen.fill();
  pen.restore();
}

// topics

function listTopics() {
  call("/rosapi/topics", {}, ({ topics, types }) => {
    const choice = find("topic");
    const shown = [...choice.options].map((one) => one.value);
    topics.forEach((topic, i) => {
      const name = topic.match(/^\/([^/]+)\/pose$/)?.[1];
      if (name && types[i].startsWith("turtlesim/") && !turtles.has(name)) {
        turtles.set(name, { points: [], pose: { x: -9, y: -9, theta: 0 } });
        send({ op: "subscribe", id: `see_${name}`, topic, type: types[i], throttle_rate: 33, queue_length: 1 });
      }
      if (!shown.includes(topic)) {
        choice.add(new Option(`${topic} (${types[i]})`, topic));
      }
    });
    [...choice.options].filter((one) => one.value && !topics.includes(one.value)).forEach((one) => one.remove());
    for (const name of turtles.keys()) {
      if (!topics.includes(`/${name}/pose`)) {
        turtles.delete(name);
      }
    }
  });
}

let echoed = "";
let lines = [];
find("topic").addEventListener("change", ({ target }) => {
  if (echoed) {
    send({ op: "unsubscribe", id: "echo", topic: echoed });
  }
  echoed = target.value;
  lines = [];
  find("echo").textContent = "";
  find("echo").hidden = !echoed;
  if (echoed) {
    send({ op: "subscribe", id: "echo", topic: echoed, throttle_rate: ECHO_MS, queue_length: 1 });
  }
});

let echoedAt = -Infinity;
function echo(message) {
  const now = performance.now();
  if (now - echoedAt >= ECHO_MS * 0.8) { // the picture of the same topic asks for it more often
    echoedAt = now;
    lines = [JSON.stringify(message), ...lines].slice(0, MOST_ECHOED);
    find("echo").textContent = lines.join("\n");
  }
}

function received({ data }) {
  const frame = JSON.parse(data);
  if (frame.op === "publish") {
    const name = frame.topic.match(/^\/([^/]+)\/pose$/)?.[1];
    if (name && turtles.has(name)) {
      seen(name, frame.msg);
    }
    if (frame.topic === echoed) {
      echo(frame.msg);
    }
  } else if (frame.op === "service_response") {
    const then = answers.get(frame.id);
    answers.delete(frame.id);
    if (frame.result) {
      then?.(frame.values);
    }
  }
}

// the connection

let listing = 0;
function connect(url) {
  find("url").value = url;
  turtles.clear();
  socket = new WebSocket(url);
  socket.addEventListener("open", () => {
    say(words.connected);
    find("drive").hidden = false;
    find("start").querySelector("button").hidden = true;
    paint();
    listTopics();
    listing = window.setInterval(listTopics, TOPICS_MS);
    view.focus();
  });
  socket.addEventListener("message", received);
  socket.addEventListener("close", () => {
    window.clearInterval(listing);
    halt(held);
    answers.clear();
    say(find("drive").hidden ? words.lost : words.ended);
    find("drive").hidden = true;
    Object.assign(find("start").querySelector("button"), { hidden: false, disabled: false, textContent: words.again });
  });
}

find("start").addEventListener("submit", async (event) => {
  event.preventDefault();
  const form = event.currentTarget;
  const button = form.querySelector("button");
  button.disabled = true;
  say(words.starting);
  try {
    const answer = await fetch(form.action, { method: "POST", body: new URLSearchParams(new FormData(form)), headers: { Accept: "application/json" }, redirect: "error" });
    const told = await answer.json();
    if (answer.ok) {
      connect(told.url);
      return;
    }
    say((told.refused ?? [told.title ?? words.lost, told.fix ?? ""]).join(" ")); // else a problem document
  } catch {
    say(words.lost);
  }
  button.disabled = false;
});

// the controls

const nameOf = ({ key }) => (key.length === 1 ? key.toLowerCase() : key);
view.addEventListener("keydown", (event) => {
  const wanted = KEYS[nameOf(event)];
  if (wanted && !event.ctrlKey && !event.altKey && !event.metaKey) {
    event.preventDefault();
    if (!event.repeat) {
      drive(nameOf(event), ...wanted);
    }
  }
});
view.addEventListener("keyup", (event) => halt(nameOf(event)));
view.addEventListener("blur", () => held !== "button" && halt(held));
document.addEventListener("visibilitychange", () => halt(held));

document.querySelectorAll(".pad button").forEach((button) => {
  const wanted = [Number(button.dataset.v), Number(button.dataset.w)];
  button.addEventListener("pointerdown", (event) => {
    button.setPointerCapture(event.pointerId);
    drive("button", ...wanted);
  });
  ["pointerup", "pointercancel", "lostpointercapture"].forEach((name) => button.addEventListener(name, () => halt("button")));
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  button.addEventListener("click", (event) => {
    if (event.detail === 0) { // by the keyboard: a command drives for a second
      command(...wanted);
    }
  });
});

find("hold").addEventListener("click", () => {
  const held = find("hold").getAttribute("aria-pressed") !== "true";
  call("/emergency_stop", { data: held }, () => {
    find("hold").setAttribute("aria-pressed", String(held));
    say(held ? words.held : words.connected);
  });
});
find("reset").addEventListener("click", () => call("/reset", {}, () => turtles.forEach((one) => one.points.splice(0))));
find("copy").addEventListener("click", async () => {
  find("url").select();
  try {
    await navigator.clipboard.writeText(find("url").value);
    say(words.copied);
  } catch {
    // it is selected: Ctrl+C copies it
  }
});
window.addEventListener("resize", paint);
