// @ts-check
/** The map in two dimensions: edges of lanes, planned and driven path, actors; for telephones and browsers without WebGL. */

/** @typedef {import("./timeline.js").Pose} Pose */
/** @typedef {import("./actors.js").Actor} Actor */

const COLOURS = /** @type {Record<string, string>} */ ({ vehicle: "#1d5fa8", walker: "#a33b00", prop: "#7a7a7a" });
const FOCUS = "#d0421b";

export class Map2d {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    /** @type {Path2D | null} */
    this.edges = null;
    /** @type {number[][]} */
    this.route = [];
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
    const path = new Path2D();
    for (const line of lines) {
      path.moveTo(line[0], line[1]);
      for (let at = 2; at < line.length; at += 2) path.lineTo(line[at], line[at + 1]);
    }
    this.edges = path;
  }

  /**
   * @param {Pose[]} poses @param {Map<number, Actor>} actors @param {Pose | null} focus
   * @param {{x: number, y: number, text: string}[]} marks
   */
  draw(poses, actors, focus, marks) {
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
    if (this.edges !== null) context.stroke(this.edges);
    if (this.route.length) {
      context.strokeStyle = style.getPropertyValue("--planned");
      context.lineWidth = Math.max(1.2, 4 * this.metresPerPixel);
      context.lineJoin = "round";
      context.beginPath();
      this.route.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
      context.stroke();
    }
    for (const pose of poses) this.actor(pose, actors.get(pose.id), pose.id === focus?.id);
    for (const mark of marks) {
      context.fillStyle = style.getPropertyValue("--alarm");
      context.beginPath();
      context.arc(mark.x, mark.y, 5 * this.metresPerPixel, 0, 7);
      context.fill();
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
    context.fillStyle = isFocus ? FOCUS : colour;
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
