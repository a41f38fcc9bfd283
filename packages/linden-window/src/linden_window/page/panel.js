// @ts-check
/** The figures of the page: world, chosen actor, score; sentences; help. */

/** @typedef {import("./timeline.js").Pose} Pose */
/** @typedef {import("./actors.js").Actor} Actor */
/** @typedef {{name: string, value: string, bad?: boolean, bar?: number, turn?: number}} Line */
/** @typedef {{name: string, colour: number[], report: string}} RecordedRun */
/** @typedef {{groups: {name: string, lines: Line[]}[], impulses: number[], tally: string[]}} ReadingsNote */
/** @typedef {{t: number, title: string, large?: string, lines: Line[], found: {text: string, bad?: boolean}[]}} ScorePanel */

const SAYS_MS = 9000;
const KEYS = [
  ["1 … 6", "views: orbit, chase, driver, free, map, spectator; V takes the next"],
  ["click", "choose an actor; click the ground to let go"],
  ["F, Shift F", "follow the next or the previous vehicle"],
  ["drag, wheel", "turn and zoom; in the free view W A S D, E and C fly, Shift is faster"],
  ["M", "map in two dimensions, and back"],
  ["N", "the agent's next sensor; after the last, none"],
  ["I", "all figures, on and off"],
  ["K", "keep a picture of the view as a file"],
  ["Space, ← →", "a record: play or stop, one frame back or ahead"],
  ["?", "this page"],
];
const DRIVING_KEYS = [
  ["W A S D, arrows", "throttle, brake, steer (gamepad and wheel likewise)"],
  ["Space", "hand brake, while it is down"],
  ["Q", "reverse, on and off"],
  ["P", "take over from the agent, and give back"],
  ["Esc", "end the run; what was driven is scored"],
];

/** @param {string} id */
export function element(id) {
  return /** @type {HTMLElement} */ (document.getElementById(id));
}

/** @param {HTMLElement} parent @param {Line[]} lines */
export function list(parent, lines) {
  const made = document.createElement("dl");
  for (const line of lines) {
    const name = document.createElement("dt");
    const value = document.createElement("dd");
    name.textContent = line.name;
    if (line.turn !== undefined) {
      value.className = "bar";
      const fill = document.createElement("i");
      const share = Math.min(1, Math.max(-1, line.turn));
      fill.style.width = `${Math.max(1, Math.round(50 * Math.abs(share)))}%`;
      fill.style.marginLeft = `${Math.round(50 + 50 * Math.min(0, share))}%`;
      value.append(fill);
      value.title = line.value;
    } else if (line.bar === undefined) value.textContent = line.value;
    else {
      value.className = "bar";
      const fill = document.createElement("i");
      fill.style.width = `${Math.round(100 * Math.min(1, Math.max(0, line.bar)))}%`;
      value.append(fill);
      value.title = line.value;
    }
    if (line.bad) value.classList.add("bad");
    made.append(name, value);
  }
  parent.replaceChildren(made);
}

/** Show a sentence for a while; the same one only once at a time. @param {string} sentence @param {boolean} isBad */
export function say(sentence, isBad = false, lasts = SAYS_MS) {
  const shown = [...element("says").children].find((each) => each.textContent === sentence);
  if (shown !== undefined) return;
  const line = document.createElement("p");
  line.textContent = sentence;
  line.classList.toggle("bad", isBad);
  element("says").append(line);
  while (element("says").children.length > 4) element("says").firstElementChild?.remove();
  if (Number.isFinite(lasts)) setTimeout(() => line.remove(), lasts);
}

/** Take away a sentence. @param {string} sentence */
export function unsay(sentence) {
  for (const each of [...element("says").children]) if (each.textContent === sentence) each.remove();
}

/** @param {boolean} drives */
export function help(drives) {
  const dialog = /** @type {HTMLDialogElement} */ (element("help"));
  if (dialog.open) {
    dialog.close();
    return;
  }
  const table = document.createElement("table");
  for (const [key, meaning] of [...(drives ? DRIVING_KEYS : []), ...KEYS]) {
    const row = table.insertRow();
    const kbd = document.createElement("kbd");
    kbd.textContent = key;
    row.insertCell().append(kbd);
    row.insertCell().textContent = meaning;
  }
  const title = document.createElement("h1");
  title.textContent = "Keys";
  const close = document.createElement("button");
  close.textContent = "Close";
  close.onclick = () => dialog.close();
  dialog.replaceChildren(title, table, close);
  dialog.showModal();
}

/** @param {Actor} actor @param {Pose} pose @param {Actor[]} sensors on the actor @returns {Line[]} */
export function aboutActor(actor, pose, sensors) {
  /** @type {Line[]} */
  const lines = [{ name: "id", value: String(actor.id) }];
  if (actor.role) lines.push({ name: "role", value: actor.role });
  if (actor.kind !== "prop") lines.push({ name: "speed", value: `${(pose.speed * 3.6).toFixed(1)} km/h` });
  if (actor.kind === "vehicle") {
    if (pose.limit) lines.push({ name: "limit", value: `${pose.limit} km/h`, bad: pose.speed * 3.6 > pose.limit + 1 });
    lines.push(
      { name: "throttle", value: pose.throttle.toFixed(2), bar: pose.throttle },
      { name: "brake", value: pose.brake.toFixed(2), bar: pose.brake },
      { name: "steer", value: `${((pose.steer * 180) / Math.PI).toFixed(0)}°` },
    );
  }
  if (sensors.length) lines.push({ name: "sensors", value: sensors.map((each) => each.type.replace(/^sensor\./, "")).join(", ") });
  lines.push({ name: "place, m", value: `${pose.x.toFixed(1)}, ${pose.y.toFixed(1)}, ${pose.z.toFixed(1)}` });
  return lines;
}

/** Show the figures of a drive. @param {HTMLElement} box @param {ReadingsNote} readings */
export function showReadings(box, readings) {
  box.className = "readings";
  /** @type {HTMLElement[]} */
  const parts = [];
  for (const group of readings.groups) {
    if (group.name) parts.push(heading(group.name));
    const lines = document.createElement("div");
    list(lines, group.lines);
    parts.push(lines);
  }
  parts.push(heading("Collisions"), graphOf(readings.impulses));
  for (const text of readings.tally) {
    const line = document.createElement("div");
    line.className = "bad";
    line.textContent = text;
    parts.push(line);
  }
  box.replaceChildren(...parts);
}

/** @param {string} text */
function heading(text) {
  const made = document.createElement("h2");
  made.textContent = text;
  return made;
}

/** Return the graph of the collision sensor's latest ticks, the newest on the right. @param {number[]} impulses in N s */
function graphOf(impulses) {
  const canvas = document.createElement("canvas");
  canvas.width = impulses.length;
  canvas.height = 22;
  canvas.className = "graph";
  const most = Math.max(1, ...impulses);
  canvas.title = `largest impulse of the last ${impulses.length} ticks: ${Math.max(0, ...impulses).toFixed(0)} N s`;
  canvas.setAttribute("aria-label", canvas.title);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--alarm");
  impulses.forEach((impulse, at) => {
    const high = impulse > 0 ? Math.max(2, (20 * impulse) / most) : 0;
    context.fillRect(at, 22 - high, 2, high);
  });
  return canvas;
}

/** Show the recorded runs with their colours and links to their reports. @param {RecordedRun[]} runs */
export function showRuns(runs) {
  const lines = runs.map(({ name, colour, report }) => {
    const line = document.createElement("div");
    const swatch = document.createElement("i");
    swatch.style.background = `rgb(${colour.join(",")})`;
    if (runs.length > 1) line.append(swatch, `${name} `);
    const link = Object.assign(document.createElement("a"), { href: report, textContent: "report" });
    if (report) line.append(link);
    return line;
  });
  element("reports").replaceChildren(...lines);
  element("reports").hidden = runs.length < 2 && !runs[0]?.report;
}

/** @param {ScorePanel} panel */
export function showScore(panel) {
  const section = element("score");
  section.hidden = false;
  document.body.classList.add("scored");
  const title = document.createElement("h1");
  title.textContent = panel.title;
  const lines = document.createElement("div");
  list(lines, panel.lines);
  section.replaceChildren(title);
  if (panel.large) {
    const large = document.createElement("div");
    large.className = "large";
    large.textContent = panel.large;
    large.append(Object.assign(document.createElement("span"), { className: "soft", textContent: " driving score so far" }));
    section.append(large);
  }
  section.append(lines);
  if (panel.found.length) {
    const found = document.createElement("ul");
    for (const each of panel.found.slice(-8).reverse()) {
      const item = document.createElement("li");
      item.textContent = each.text;
      if (each.bad !== false) item.className = "bad";
      found.append(item);
    }
    section.append(found);
  }
}
