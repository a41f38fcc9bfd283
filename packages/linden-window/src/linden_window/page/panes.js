// @ts-check
/** Panes of sensors: pictures, points from above, readings. panes.py packs what arrives here. */

import { element, list } from "./panel.js";

/** @typedef {{name: string, type: string, parent?: number}} Sensor a parent carries it, 0 without one */
/** @typedef {{kind: string, name: string, frame: number, width: number, height: number, count: number,
 *   lines: import("./panel.js").Line[]}} Head */

export const PANE_MAGIC = 0x31504c57;
const POINT_BYTES = 8;
const RINGS_M = [10, 20, 40, 80];
const POINTS_PX = 360;

export class Panes {
  /** @param {(order: Record<string, unknown>) => void} send */
  constructor(send) {
    this.send = send;
    /** @type {Sensor[]} */
    this.sensors = [];
    /** @type {Map<string, HTMLElement>} */
    this.open = new Map();
    /** @type {Map<string, number>} how often each pane was drawn */
    this.drawn = new Map();
    this.carrier = 0;
    this.named = "";
  }

  /** Take the sensors among a world's actors. @param {import("./actors.js").Actor[]} actors */
  describeOf(actors) {
    const found = actors.filter((actor) => actor.kind === "sensor");
    const names = found.map(({ id, type }) => `${type.split(".").pop()} ${id}`);
    if (names.join() === this.named) return;
    this.named = names.join();
    this.describe(found.map(({ type, parent }, at) => ({ name: names[at], type, parent })));
  }

  /** Show buttons for the sensors of one actor. @param {number} id */
  carriedBy(id) {
    if (this.carrier === id) return;
    this.carrier = id;
    this.buttons();
  }

  /** Return the sensors that have buttons: the agent's, those of the chosen actor, those without a carrier, open ones. */
  get offered() {
    return this.sensors.filter(({ name, parent }) => !parent || parent === this.carrier || this.open.has(name));
  }

  /** @param {Sensor[]} sensors */
  describe(sensors) {
    this.sensors = sensors;
    const names = new Set(sensors.map((sensor) => sensor.name));
    for (const name of [...this.open.keys()]) if (!names.has(name)) this.close(name);
    this.tell();
  }

  /** Say to the program which sensors this page shows. */
  tell() {
    if (this.sensors.length) this.send({ order: "sensors", names: [...this.open.keys()] });
    this.buttons();
  }

  buttons() {
    const nav = element("sensors");
    nav.hidden = !this.offered.length;
    nav.replaceChildren(
      ...this.offered.map(({ name, type }) => {
        const button = document.createElement("button");
        button.textContent = name;
        button.title = type;
        button.setAttribute("aria-pressed", String(this.open.has(name)));
        button.onclick = () => this.toggle(name);
        return button;
      }),
    );
  }

  /** Show the next sensor alone; after the last, none. */
  next() {
    const names = this.offered.map((sensor) => sensor.name);
    const at = names.findLastIndex((name) => this.open.has(name));
    for (const name of [...this.open.keys()]) this.close(name);
    if (at + 1 < names.length) this.show(names[at + 1]);
    this.tell();
  }

  /** @param {string} name */
  toggle(name) {
    if (this.open.has(name)) this.close(name);
    else this.show(name);
    this.tell();
  }

  /** @param {string} name */
  close(name) {
    this.open.get(name)?.remove();
    this.open.delete(name);
  }

  /** @param {string} name */
  show(name) {
    const type = this.sensors.find((sensor) => sensor.name === name)?.type ?? "";
    const pane = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const words = document.createElement("span");
    words.textContent = `${name}: ${type.replace(/^sensor\./, "")}`;
    const frame = document.createElement("span");
    frame.className = "frame soft";
    frame.textContent = "nothing measured yet";
    const close = document.createElement("button");
    close.textContent = "×";
    close.setAttribute("aria-label", `Close ${name}`);
    close.onclick = () => this.toggle(name);
    caption.append(words, frame, close);
    const content = document.createElement("div");
    pane.append(caption, content);
    element("panes").append(pane);
    this.open.set(name, pane);
  }

  /** Draw a measurement. @param {ArrayBuffer} buffer */
  take(buffer) {
    const length = new DataView(buffer).getUint32(4, true);
    /** @type {Head} */
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
    const pane = this.open.get(head.name);
    const content = /** @type {HTMLElement | null} */ (pane?.lastElementChild ?? null);
    if (pane === undefined || content === null) return;
    /** @type {HTMLElement} */ (pane.querySelector(".frame")).textContent = `frame ${head.frame}`;
    this.drawn.set(head.name, (this.drawn.get(head.name) ?? 0) + 1);
    if (head.kind === "lines") list(content, head.lines);
    else if (head.kind === "picture") drawPicture(canvasIn(content, head.width, head.height), new Uint8Array(buffer, 8 + length));
    else drawPoints(canvasIn(content, POINTS_PX, POINTS_PX), buffer, 8 + length, head.count);
  }
}

/** Return the context of a pane's canvas of a size. @param {HTMLElement} parent @param {number} width @param {number} height */
function canvasIn(parent, width, height) {
  let canvas = parent.querySelector("canvas");
  if (canvas === null) {
    canvas = document.createElement("canvas");
    parent.replaceChildren(canvas);
  }
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  return /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
}

/** @param {CanvasRenderingContext2D} context @param {Uint8Array} rgb */
function drawPicture(context, rgb) {
  const { width, height } = context.canvas;
  const image = context.createImageData(width, height);
  for (let from = 0, to = 0; to < image.data.length; from += 3, to += 4) {
    image.data[to] = rgb[from];
    image.data[to + 1] = rgb[from + 1];
    image.data[to + 2] = rgb[from + 2];
    image.data[to + 3] = 255;
  }
  context.putImageData(image, 0, 0);
}

/**
 * Draw points from above: ahead is up, the sensor is in the middle, rings show the distance.
 * @param {CanvasRenderingContext2D} context @param {ArrayBuffer} buffer @param {number} start @param {number} count
 */
function drawPoints(context, buffer, start, count) {
  const { width, height } = context.canvas;
  const places = new Int16Array(buffer, start, (count * POINT_BYTES) / 2);
  const bytes = new Uint8Array(buffer, start, count * POINT_BYTES);
  let farthest = 0;
  for (let at = 0; at < count; at++) farthest = Math.max(farthest, Math.abs(places[4 * at]), Math.abs(places[4 * at + 1]));
  const reach = RINGS_M.find((ring) => ring >= 0.007 * farthest) ?? RINGS_M[RINGS_M.length - 1];
  const scale = height / 2 / reach;
  context.fillStyle = "#181a1e";
  context.fillRect(0, 0, width, height);
  context.strokeStyle = "#4a4f57";
  context.fillStyle = "#a1abb6";
  context.font = "12px sans-serif";
  for (const ring of RINGS_M) {
    context.beginPath();
    context.arc(width / 2, height / 2, scale * ring, 0, 7);
    context.stroke();
    if (ring <= reach && ring >= 0.2 * reach) context.fillText(`${ring} m`, width / 2 + scale * ring - 34, height / 2 - 4);
  }
  for (let at = 0; at < count; at++) {
    const x = width / 2 + scale * 0.01 * places[4 * at + 1];
    const y = height / 2 - scale * 0.01 * places[4 * at];
    if (x < 0 || y < 0 || x > width || y > height) continue;
    context.fillStyle = `rgb(${bytes[POINT_BYTES * at + 4]} ${bytes[POINT_BYTES * at + 5]} ${bytes[POINT_BYTES * at + 6]})`;
    context.fillRect(x - 1, y - 1, 2, 2);
  }
  context.fillStyle = "#7fd79b";
  context.beginPath();
  context.moveTo(width / 2, height / 2 - 7);
  context.lineTo(width / 2 + 5, height / 2 + 6);
  context.lineTo(width / 2 - 5, height / 2 + 6);
  context.fill();
}
