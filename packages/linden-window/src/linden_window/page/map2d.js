// @ts-check
/** The map in two dimensions: edges of lanes, planned and driven path, actors; for telephones and browsers without WebGL. */

import { segmentsOf } from "./debug.js";

/** @typedef {import("./timeline.js").Pose} Pose */
/** @typedef {import("./actors.js").Actor} Actor */

const COLOURS = /** @type {Record<string, string>} */ ({ vehicle: "#1d5fa8", walker: "#a33b00", prop: "#7a7a7a" });
const FOCUS = "#d0421b";
const TRAIL_M = 1;
/** Colours of lines to stop at by the kind of sign, and of lights by CARLA's number of their state. */
const SIGNS = /** @type {Record<string, string>} */ ({ stop_sign: "#c8102e", yield_sign: "#d9a400" });
const LIGHTS = ["#d0021b", "#e8b400", "#1f9d45"];
const UNKNOWN = "#8a9099";

/** @typedef {{kind: string, id: string, x: number, y: number, z: number, yaw: number}} Control */

/** Return the colour of a line of the route. @param {Control} control @param {number | undefined} state of a light */
export function colourOf(control, state) {
  return SIGNS[control.kind] ?? LIGHTS[state ?? -1] ?? UNKNOWN;
}

/** Return both ends of a line across the lane. @param {Control} control @param {number} half width of the lane, m */
export function endsOf(control, half) {
  const x = -Math.sin(control.yaw) * half, y = Math.cos(control.yaw) * half;
  return [[control.x - x, control.y - y], [control.x + x, control.y + y]];
}

export class Map2d {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    /** @type {{low: number[], high: number[], path: Path2D}[] | null} by parts, so that only those in view are drawn */
    this.edges = null;
    /** @type {number[][]} */
    this.route = [];
    /** @type {number[][]} the way that the vehicle under test has driven */
    this.trail = [];
    /** @type {number[][]} the way that the chosen actor has come */
    this.chosenPath = [];
    /** @type {Control[]} */
    this.controls = [];
    /** @type {number[]} */
    this.signals = [];
    /** @type {{name: string, x: number, y: number}[]} */
    this.stops = [];
    this.half = 1.7;
    this.centre = [0, 0];
    this.metresPerPixel = 0.35;
    this.hasFocus = false;
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(1.0015 ** event.deltaY);
    }, { passive: false });
    /** @type {Map<number, number[]>} */
    const touches = new Map();
    canvas.addEventListener("pointerdown", (event) => touches.set(event.pointerId, [event.clientX, event.clientY]));
    for (const kind of ["pointerup", "pointercancel", "pointerleave"]) {
      canvas.addEventListener(kind, (event) => touches.delete(/** @type {PointerEvent} */ (event).pointerId));
    }
    canvas.addEventListener("pointermove", (event) => {
      const before = touches.get(event.pointerId);
      if (before === undefined) return;
      if (touches.size === 1 && !this.hasFocus) {
        this.centre[0] -= (event.clientX - before[0]) * this.metresPerPixel;
        this.centre[1] -= (event.clientY - before[1]) * this.metresPerPixel;
      } else if (touches.size === 2) {
        const other = [...touches].find(([id]) => id !== event.pointerId);
        if (other !== undefined) {
          const was = Math.hypot(before[0] - other[1][0], before[1] - other[1][1]);
          const is = Math.hypot(event.clientX - other[1][0], event.clientY - other[1][1]);
          if (is > 0) this.zoom(was / is);
        }
      }
      touches.set(event.pointerId, [event.clientX, event.clientY]);
    });
  }

  /** Remember where the vehicle under test was. @param {number} x @param {number} y */
  pass(x, y) {
    const before = this.trail[this.trail.length - 1];
    if (before === undefined || Math.hypot(x - before[0], y - before[1]) >= TRAIL_M) this.trail.push([x, y]);
  }

  /** @param {number[][]} points @param {string} colour @param {number} width in m */
  path(points, colour, width) {
    const { context } = this;
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.lineJoin = "round";
    context.beginPath();
    points.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.stroke();
  }

  /** Draw the planned and the driven path, lines to stop at, and stops. @param {CSSStyleDeclaration} style */
  drawRoute(style) {
    const { context } = this;
    const pixel = this.metresPerPixel;
    if (this.route.length) this.path(this.route, style.getPropertyValue("--planned"), Math.max(1.2, 4 * pixel));
    if (this.trail.length) this.path(this.trail, style.getPropertyValue("--driven"), Math.max(0.4, 2 * pixel));
    if (this.chosenPath.length > 1) this.path(this.chosenPath, FOCUS, Math.max(0.3, 1.5 * pixel));
    this.controls.forEach((control, index) => {
      this.path(endsOf(control, this.half), colourOf(control, this.signals[index]), Math.max(0.5, 4 * pixel));
    });
    context.fillStyle = style.getPropertyValue("--second");
    context.font = `${13 * pixel}px sans-serif`;
    for (const stop of this.stops) {
      context.beginPath();
      context.arc(stop.x, stop.y, 6 * pixel, 0, 7);
      context.fill();
      context.fillText(stop.name, stop.x + 9 * pixel, stop.y + 4 * pixel);
    }
  }

  /** @param {number} factor */
  zoom(factor) {
    this.metresPerPixel = Math.max(0.03, Math.min(10, this.metresPerPixel * factor));
  }

  /** Load the edges of a scene's lanes. @param {number} number of the scene */
  async load(number) {
    const answer = await fetch(`scene/${number}/outline.json`);
    if (!answer.ok) return;
    /** @type {number[][]} */
    const lines = await answer.json();
    this.edges = lines.map((line) => {
      const path = new Path2D();
      const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
      for (let at = 0; at < line.length; at += 2) {
        path.lineTo(line[at], line[at + 1]);
        for (const axis of [0, 1]) {
          low[axis] = Math.min(low[axis], line[at + axis]);
          high[axis] = Math.max(high[axis], line[at + axis]);
        }
      }
      return { low, high, path };
    });
  }

  /**
   * @param {Pose[]} poses @param {Map<number, Actor>} actors @param {Pose | null} focus
   * @param {{x: number, y: number, text: string}[]} marks @param {import("./debug.js").Shape[]} shapes
   */
  draw(poses, actors, focus, marks, shapes) {
    const { canvas, context } = this;
    const ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    this.hasFocus = focus !== null;
    if (focus !== null) this.centre = [focus.x, focus.y];
    const style = getComputedStyle(document.documentElement);
    const scale = ratio / this.metresPerPixel;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = style.getPropertyValue("--paper");
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.setTransform(scale, 0, 0, scale, canvas.width / 2 - this.centre[0] * scale, canvas.height / 2 - this.centre[1] * scale);
    context.lineWidth = 1.2 * this.metresPerPixel;
    context.strokeStyle = style.getPropertyValue("--soft");
    const half = [(width / 2) * this.metresPerPixel, (height / 2) * this.metresPerPixel];
    for (const { low, high, path } of this.edges ?? []) {
      if ([0, 1].every((axis) => Math.abs(this.centre[axis] - Math.min(high[axis], Math.max(low[axis], this.centre[axis]))) < half[axis])) {
        context.stroke(path);
      }
    }
    this.drawRoute(style);
    this.drawShapes(shapes);
    for (const pose of poses) this.actor(pose, actors.get(pose.id), pose.id === focus?.id);
    for (const mark of marks) {
      context.fillStyle = style.getPropertyValue("--alarm");
      context.beginPath();
      context.arc(mark.x, mark.y, 5 * this.metresPerPixel, 0, 7);
      context.fill();
    }
  }

  /** Draw what scripts draw with world.debug, from above. @param {import("./debug.js").Shape[]} shapes */
  drawShapes(shapes) {
    const { context } = this;
    const pixel = this.metresPerPixel;
    /** @type {Map<string, number>} texts at one place stand below each other */
    const texts = new Map();
    for (const shape of shapes) {
      const colour = `rgb(${shape.colour.join(",")})`;
      context.fillStyle = colour;
      if (shape.form === "point") {
        context.beginPath();
        context.arc(shape.at[0], shape.at[1], 3 * pixel, 0, 7);
        context.fill();
      } else if (shape.form === "text") {
        context.font = `bold ${12 * pixel}px sans-serif`;
        context.lineWidth = 3 * pixel;
        context.strokeStyle = "rgba(0, 0, 0, .75)";
        const place = shape.at.slice(0, 2).map(Math.round).join();
        const line = texts.get(place) ?? 0;
        texts.set(place, line + 1);
        context.strokeText(shape.text, shape.at[0], shape.at[1] + 13 * pixel * line);
        context.fillText(shape.text, shape.at[0], shape.at[1] + 13 * pixel * line);
      } else {
        const ends = segmentsOf(shape);
        context.strokeStyle = colour;
        context.lineWidth = 2 * pixel;
        context.beginPath();
        for (let at = 0; at < ends.length; at += 6) {
          context.moveTo(ends[at], ends[at + 2]);
          context.lineTo(ends[at + 3], ends[at + 5]);
        }
        context.stroke();
      }
    }
  }

  /** @param {Pose} pose @param {Actor | undefined} actor @param {boolean} isFocus */
  actor(pose, actor, isFocus) {
    const colour = COLOURS[actor?.kind ?? ""];
    if (actor === undefined || colour === undefined) return;
    const { context } = this;
    context.save();
    context.translate(pose.x, pose.y);
    context.rotate((pose.yaw * Math.PI) / 180);
    const least = 2.5 * this.metresPerPixel;
    const a = Math.max(actor.box[3], least), b = Math.max(actor.box[4], least);
    context.globalAlpha = pose.ghost ? 0.5 : 1;
    context.fillStyle = isFocus ? FOCUS : pose.ghost ? `rgb(${actor.colour.join(",")})` : colour;
    context.beginPath();
    context.moveTo(actor.box[0] + a + 0.25 * b, 0);
    context.lineTo(actor.box[0] + a * 0.8, b);
    context.lineTo(actor.box[0] - a, b);
    context.lineTo(actor.box[0] - a, -b);
    context.lineTo(actor.box[0] + a * 0.8, -b);
    context.fill();
    context.restore();
  }
}
