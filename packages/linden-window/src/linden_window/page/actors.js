// @ts-check
/** Draws actors by their models, all actors of a model by instances. */

import {
  BufferGeometry, BoxGeometry, Color, DynamicDrawUsage, Float32BufferAttribute, Group, InstancedMesh, Matrix4,
  MeshBasicMaterial, MeshLambertMaterial, Vector3,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { poseMatrix, vehicleFrames, WalkerPoser } from "./frames3d.js";

/** @typedef {import("./timeline.js").Pose} Pose */
/**
 * @typedef {{id: number, type: string, choice: string, kind: string, parent: number, role: string,
 *   colour: number[], box: number[], fov: string}} Actor
 */
/** @typedef {{geometry: BufferGeometry, frame: number, look: string, colour: number[] | null, lamp: number}} Piece */

const STREET_KINDS = ["vehicle", "walker", "prop"];
const DEAD = 1;
const REVERSES = 2;
const UNPAINTED = [128, 128, 128];
/** Which lamps shine for each bit of VehicleLightState: linden.sensors.runtime.visible_actors. */
const LAMPS_OF_BIT = /** @type {[number, number[]][]} */ ([
  [0x001, [6]], [0x002, [5, 6]], [0x004, [5, 6]], [0x008, [6, 11]], [0x010, [8]], [0x020, [7]], [0x040, [9]], [0x200, [12]],
]);
const BLINKING = [7, 8];
const BLINKS_HZ = 1.5;
const WHITE = new Color(1, 1, 1);

/** One model: its pieces, where its wheels are, and the instances of each piece. */
class Model {
  /** @param {Piece[]} pieces @param {number[][]} hubs @param {Group} group @param {boolean} isGhost */
  constructor(pieces, hubs, group, isGhost) {
    this.pieces = pieces;
    this.hubs = hubs;
    this.group = group;
    this.isGhost = isGhost;
    /** @type {InstancedMesh[]} */
    this.meshes = [];
    this.capacity = 0;
    this.count = 0;
  }

  /** @param {number} count */
  reserve(count) {
    if (count <= this.capacity) return;
    this.capacity = Math.max(4, 2 * count);
    for (const mesh of this.meshes) {
      this.group.remove(mesh);
      mesh.dispose();
    }
    this.meshes = this.pieces.map((piece) => {
      const mesh = new InstancedMesh(piece.geometry, materialOf(piece.look, this.isGhost), this.capacity);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.castShadow = !this.isGhost;
      mesh.setColorAt(0, WHITE);
      this.group.add(mesh);
      return mesh;
    });
  }
}

/** @type {Map<string, MeshLambertMaterial | MeshBasicMaterial>} */
const materials = new Map();

/** @param {string} look @param {boolean} isGhost */
function materialOf(look, isGhost) {
  const key = `${look} ${isGhost}`;
  let made = materials.get(key);
  if (made === undefined) {
    const options = { vertexColors: look !== "box", transparent: isGhost, opacity: isGhost ? 0.4 : 1 };
    made = look === "lamp" ? new MeshBasicMaterial(options) : new MeshLambertMaterial({ ...options, flatShading: true });
    materials.set(key, made);
  }
  return made;
}

/** All actors of the world. */
export class Actors {
  /** @param {import("three").Scene} scene @param {import("./frames3d.js").Gait} gait */
  constructor(scene, gait) {
    this.group = new Group();
    scene.add(this.group);
    this.poser = new WalkerPoser(gait);
    this.loader = new GLTFLoader();
    /** @type {Map<number, Actor>} */
    this.known = new Map();
    /** @type {Map<string, Model | null>} null while it is loaded */
    this.models = new Map();
    /** @type {Map<string, Promise<{pieces: Piece[], hubs: number[][]}>>} */
    this.loading = new Map();
    /** @type {Map<number, {moved: number, t: number}>} */
    this.motion = new Map();
    this.frames = Array.from({ length: 16 }, () => new Matrix4());
    this.matrix = new Matrix4();
    this.place = new Matrix4();
    this.colour = new Color();
  }

  /** Whether a model is on its way; it has no picture before. */
  get isLoading() {
    return [...this.models.values()].includes(null);
  }

  /** @param {Actor[]} actors */
  describe(actors) {
    this.known = new Map(actors.map((actor) => [actor.id, actor]));
  }

  /**
   * Move all instances to their poses. @param {Pose[]} poses @param {number} t simulated time in s
   * @param {number} hidden id of an actor that is not drawn, such as the one with the driver's eyes
   */
  update(poses, t, hidden) {
    /** @type {Map<Model, Pose[]>} */
    const groups = new Map();
    for (const pose of poses) {
      const actor = this.known.get(pose.id);
      if (actor === undefined || pose.id === hidden || !STREET_KINDS.includes(actor.kind)) continue;
      const model = this.model(actor, pose.ghost > 0);
      if (model === null) continue;
      const group = groups.get(model);
      if (group === undefined) groups.set(model, [pose]);
      else group.push(pose);
    }
    for (const model of this.models.values()) {
      if (model !== null && !groups.has(model)) for (const mesh of model.meshes) mesh.visible = false;
    }
    for (const [model, group] of groups) this.draw(model, group, t);
  }

  /** @param {Model} model @param {Pose[]} poses @param {number} t */
  draw(model, poses, t) {
    model.reserve(poses.length);
    poses.forEach((pose, index) => {
      const actor = /** @type {Actor} */ (this.known.get(pose.id));
      poseMatrix(this.place, pose.x, pose.y, pose.z, pose.pitch, pose.yaw, pose.roll);
      const moved = this.moved(pose, t);
      const isBox = model.pieces[0].look === "box";
      if (actor.kind === "vehicle" && model.hubs.length) vehicleFrames(this.frames, model.hubs, pose.steer, moved);
      else if (actor.kind === "walker" && !isBox) {
        this.poser.frames(this.frames, 2 * (actor.box[5] || 0.93), moved, pose.state & DEAD ? 0 : pose.speed);
      } else for (const frame of this.frames) frame.identity();
      model.pieces.forEach((piece, part) => {
        const mesh = model.meshes[part];
        this.matrix.multiplyMatrices(this.place, this.frames[Math.min(piece.frame, 15)]);
        if (isBox) {
          const [x, y, z, a, b, c] = actor.box;
          this.matrix.multiply(new Matrix4().makeTranslation(x, z, y)).scale(new Vector3(2 * a, 2 * c, 2 * b));
        }
        mesh.setMatrixAt(index, this.matrix);
        mesh.setColorAt(index, this.tint(piece, actor, pose, t));
      });
    });
    for (const mesh of model.meshes) {
      mesh.count = poses.length;
      mesh.visible = true;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  }

  /** @param {Piece} piece @param {Actor} actor @param {Pose} pose @param {number} t */
  tint(piece, actor, pose, t) {
    if (piece.look === "lamp") return this.colour.setScalar(shines(piece.lamp, pose.lights, t) ? 1.5 : 0.22);
    if (piece.look === "painted" || piece.look === "box") {
      const [r, g, b] = piece.colour ?? actor.colour ?? UNPAINTED;
      return this.colour.setRGB(r / 255, g / 255, b / 255, "srgb");
    }
    return WHITE;
  }

  /** Return how far an actor has moved since it was first seen, in m. @param {Pose} pose @param {number} t */
  moved(pose, t) {
    let motion = this.motion.get(pose.id);
    if (motion === undefined) this.motion.set(pose.id, (motion = { moved: 0, t }));
    const passed = t - motion.t;
    motion.t = t;
    if (Math.abs(passed) < 1) motion.moved += passed * pose.speed * (pose.state & REVERSES ? -1 : 1);
    return motion.moved;
  }

  /** Return the model of an actor; null while it is on its way. @param {Actor} actor @param {boolean} isGhost */
  model(actor, isGhost) {
    const key = `${actor.type}|${actor.choice}|${isGhost}`;
    const found = this.models.get(key);
    if (found !== undefined) return found;
    this.models.set(key, null);
    const file = `${actor.type}|${actor.choice}`;
    let loading = this.loading.get(file);
    if (loading === undefined) this.loading.set(file, (loading = this.load(actor)));
    loading.then(({ pieces, hubs }) => {
      this.models.set(key, pieces.length ? new Model(pieces, hubs, this.group, isGhost) : null);
    });
    return null;
  }

  /** @param {Actor} actor @returns {Promise<{pieces: Piece[], hubs: number[][]}>} */
  async load(actor) {
    try {
      const url = `model/${encodeURIComponent(actor.type)}.glb?choice=${encodeURIComponent(actor.choice)}`;
      const gltf = await this.loader.loadAsync(url);
      return piecesOf(gltf.scene);
    } catch {
      // no model of that name: a simulator with blueprints of its own
      return { pieces: [{ geometry: new BoxGeometry(1, 1, 1), frame: 0, look: "box", colour: null, lamp: 0 }], hubs: [] };
    }
  }
}

/** @param {number} lamp @param {number} lights bits of VehicleLightState @param {number} t */
function shines(lamp, lights, t) {
  if (BLINKING.includes(lamp) && Math.floor(t * 2 * BLINKS_HZ) % 2) return false;
  return LAMPS_OF_BIT.some(([bit, lamps]) => (lights & bit) !== 0 && lamps.includes(lamp));
}

/** @param {import("three").Object3D} scene @returns {{pieces: Piece[], hubs: number[][]}} */
function piecesOf(scene) {
  /** @type {Piece[]} */
  const pieces = [];
  /** @type {number[][]} */
  let hubs = [];
  for (const node of scene.children) {
    const { frame, colour, low, step } = node.userData;
    hubs = node.userData.hubs;
    node.traverse((child) => {
      const mesh = /** @type {import("three").Mesh} */ (child);
      if (!mesh.isMesh) return;
      const look = /** @type {import("three").Material} */ (mesh.material).name;
      const geometry = unpacked(mesh.geometry, low, step);
      if (look !== "lamp") pieces.push({ geometry, frame, look, colour, lamp: 0 });
      else for (const [lamp, part] of byLamp(geometry, mesh.geometry)) pieces.push({ geometry: part, frame, look, colour, lamp });
    });
  }
  return { pieces, hubs };
}

/** Return a geometry in metres. @param {BufferGeometry} packed @param {number[]} low @param {number} step */
function unpacked(packed, low, step) {
  const geometry = new BufferGeometry();
  const from = packed.getAttribute("position");
  const places = new Float32Array(from.count * 3);
  for (let row = 0; row < from.count; row++) {
    places[row * 3] = from.getX(row) * step + low[0];
    places[row * 3 + 1] = from.getY(row) * step + low[1];
    places[row * 3 + 2] = from.getZ(row) * step + low[2];
  }
  geometry.setAttribute("position", new Float32BufferAttribute(places, 3));
  geometry.setAttribute("color", packed.getAttribute("color"));
  geometry.setIndex(packed.getIndex());
  return geometry;
}

/** Return the triangles of each kind of lamp. @param {BufferGeometry} geometry @param {BufferGeometry} packed */
function byLamp(geometry, packed) {
  const marks = packed.getAttribute("_lamp");
  const index = /** @type {import("three").BufferAttribute} */ (geometry.getIndex());
  /** @type {Map<number, number[]>} */
  const rows = new Map();
  for (let at = 0; at < index.count; at += 3) {
    const lamp = marks.getX(index.getX(at));
    const list = rows.get(lamp) ?? [];
    list.push(index.getX(at), index.getX(at + 1), index.getX(at + 2));
    rows.set(lamp, list);
  }
  return [...rows].map(([lamp, list]) => {
    const part = new BufferGeometry();
    part.setAttribute("position", geometry.getAttribute("position"));
    part.setAttribute("color", geometry.getAttribute("color"));
    part.setIndex(list);
    return /** @type {[number, BufferGeometry]} */ ([lamp, part]);
  });
}
