// @ts-check
/** Shapes that scripts draw with world.debug: points, lines, arrows, boxes and text. */

import {
  BufferGeometry, CanvasTexture, Color, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Matrix4,
  Points, PointsMaterial, Sprite, SpriteMaterial, Vector3,
} from "three";
import { poseMatrix } from "./frames3d.js";

/**
 * @typedef {{form: string, colour: number[], until: number | null, at: number[], from: number[], to: number[],
 *   half: number[], rotation: number[], text: string, size: number, tip: number, width: number}} Shape
 */

const MOST_KEPT = 20000;
const MOST_TEXTS = 300;

export class DebugShapes {
  /** @param {import("three").Scene} scene */
  constructor(scene) {
    this.group = new Group();
    scene.add(this.group);
    /** @type {Shape[]} */
    this.shapes = [];
    this.isStale = false;
    this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, depthTest: false, fog: false }));
    this.points = new Points(
      new BufferGeometry(), new PointsMaterial({ vertexColors: true, size: 7, sizeAttenuation: false, depthTest: false, fog: false }));
    this.lines.frustumCulled = this.points.frustumCulled = false;
    this.lines.renderOrder = this.points.renderOrder = 5;
    this.texts = new Group();
    this.group.add(this.lines, this.points, this.texts);
  }

  /** @param {{reset: boolean, shapes: Shape[]}} note */
  add(note) {
    if (note.reset) this.shapes = [];
    this.shapes.push(...note.shapes);
    if (this.shapes.length > MOST_KEPT) this.shapes.splice(0, this.shapes.length - MOST_KEPT);
    this.isStale = true;
  }

  /** Drop the expired shapes and draw the rest. @param {number} t simulated time in s */
  update(t) {
    const before = this.shapes.length;
    this.shapes = this.shapes.filter((shape) => shape.until === null || shape.until + 1e-6 >= t);
    if (this.isStale || this.shapes.length !== before) this.build();
    this.isStale = false;
  }

  build() {
    /** @type {number[]} */
    const ends = [];
    /** @type {number[]} */
    const endColours = [];
    /** @type {number[]} */
    const dots = [];
    /** @type {number[]} */
    const dotColours = [];
    for (const sprite of [...this.texts.children]) {
      /** @type {Sprite} */ (sprite).material.map?.dispose();
      /** @type {Sprite} */ (sprite).material.dispose();
      this.texts.remove(sprite);
    }
    const colour = new Color();
    for (const shape of this.shapes) {
      colour.setRGB(shape.colour[0] / 255, shape.colour[1] / 255, shape.colour[2] / 255, "srgb");
      const tint = [colour.r, colour.g, colour.b];
      if (shape.form === "point") {
        dots.push(shape.at[0], shape.at[2], shape.at[1]);
        dotColours.push(...tint);
      } else if (shape.form === "text") {
        if (this.texts.children.length < MOST_TEXTS) this.texts.add(textOf(shape));
      } else {
        const places = segmentsOf(shape);
        ends.push(...places);
        for (let count = 0; count < places.length / 3; count++) endColours.push(...tint);
      }
    }
    put(this.lines.geometry, ends, endColours);
    put(this.points.geometry, dots, dotColours);
  }
}

/** @param {BufferGeometry} geometry @param {number[]} places @param {number[]} colours */
function put(geometry, places, colours) {
  geometry.setAttribute("position", new Float32BufferAttribute(places, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
  geometry.setDrawRange(0, places.length / 3);
}

/** Return the ends of a shape's lines in the axes of three.js. @param {Shape} shape */
export function segmentsOf(shape) {
  if (shape.form === "box") return boxEdges(shape);
  const from = new Vector3(shape.from[0], shape.from[2], shape.from[1]);
  const to = new Vector3(shape.to[0], shape.to[2], shape.to[1]);
  const made = [...from, ...to];
  if (shape.form !== "arrow") return made;
  const way = to.clone().sub(from).normalize();
  const side = new Vector3(0, 1, 0).cross(way);
  if (side.lengthSq() < 1e-6) side.set(1, 0, 0);
  side.normalize();
  const size = Math.max(0.2, shape.tip);
  for (const turn of [1, -1]) {
    made.push(...to, ...to.clone().addScaledVector(way, -size).addScaledVector(side, turn * size * 0.5));
  }
  return made;
}

/** @param {Shape} shape */
function boxEdges(shape) {
  const [pitch, yaw, roll] = shape.rotation;
  const matrix = poseMatrix(new Matrix4(), shape.at[0], shape.at[1], shape.at[2], pitch, yaw, roll);
  const [a, b, c] = [shape.half[0], shape.half[2], shape.half[1]];
  /** @type {number[]} */
  const made = [];
  const corner = (/** @type {number} */ bits) =>
    new Vector3(bits & 1 ? a : -a, bits & 2 ? b : -b, bits & 4 ? c : -c).applyMatrix4(matrix);
  for (let from = 0; from < 8; from++) {
    for (const bit of [1, 2, 4]) if (!(from & bit)) made.push(...corner(from), ...corner(from | bit));
  }
  return made;
}

/** @param {Shape} shape */
function textOf(shape) {
  const canvas = document.createElement("canvas");
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const font = "bold 28px system-ui, sans-serif";
  context.font = font;
  canvas.width = Math.ceil(context.measureText(shape.text).width) + 12;
  canvas.height = 40;
  context.font = font;
  context.lineWidth = 5;
  context.strokeStyle = "rgba(0, 0, 0, .75)";
  context.strokeText(shape.text, 6, 29);
  context.fillStyle = `rgb(${shape.colour.join(",")})`;
  context.fillText(shape.text, 6, 29);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false, fog: false, sizeAttenuation: false }));
  sprite.position.set(shape.at[0], shape.at[2], shape.at[1]);
  sprite.scale.set((0.045 * canvas.width) / canvas.height, 0.045, 1);
  sprite.renderOrder = 6;
  return sprite;
}
