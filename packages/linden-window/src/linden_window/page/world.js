// @ts-check
/** The scenery of a map: tiles, sky, sun, weather, traffic lights and lamps. */

import {
  AmbientLight, BufferGeometry, Color, DirectionalLight, Float32BufferAttribute, Fog, Group, HemisphereLight,
  LineBasicMaterial, LineSegments, MeshBasicMaterial, MeshLambertMaterial, PointLight, Scene, Vector3,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

/** @typedef {{name: string, low: number[], high: number[]}} TileBox */
/**
 * @typedef {{map: string, number: number, ready: boolean, kept: boolean, control: boolean, tiles?: TileBox[], error?: string,
 *   triangles?: number, spawn_points?: number[][], signals?: string[], lights?: number[][], lamps?: number[][]}} SceneNote
 */

const AT_ONCE = 4;
const TRAFFIC = /** @type {Record<number, number>} */ ({ 2: 0, 3: 1, 4: 2 });
const STREET_LAMP = 1;
const WINDOW_AT_NIGHT = 0xffd9a0;
const LAMPS_NEAR = 6;
const RAIN_DROPS = 3000;
const RAIN_BOX_M = 24;

export class World {
  constructor() {
    this.scene = new Scene();
    this.tiles = new Group();
    this.scene.add(this.tiles);
    this.loader = new GLTFLoader();
    this.sun = new DirectionalLight(0xffffff, 2.5);
    this.sun.shadow.mapSize.set(2048, 2048);
    const { camera } = this.sun.shadow;
    camera.left = camera.bottom = -70;
    camera.right = camera.top = 70;
    camera.far = 500;
    this.sun.shadow.bias = -0.0005;
    this.sun.shadow.normalBias = 0.05;
    this.sky = new HemisphereLight(0xbfd8f2, 0x66705c, 1.2);
    this.scene.add(this.sun, this.sun.target, this.sky, new AmbientLight(0xffffff, 0.15));
    this.fog = new Fog(0xc9d8e6, 300, 3000);
    this.scene.fog = this.fog;
    this.background = new Color(0xc9d8e6);
    this.scene.background = this.background;
    this.materials = {
      rough: new MeshLambertMaterial({ vertexColors: true, flatShading: true }),
      smooth: new MeshLambertMaterial({ vertexColors: true, flatShading: true }),
      window: new MeshLambertMaterial({ vertexColors: true, flatShading: true }),
      lamp: new MeshBasicMaterial({ vertexColors: true }),
    };
    this.lampLights = Array.from({ length: LAMPS_NEAR }, () => new PointLight(0xffd1a3, 0, 45, 1.6));
    this.scene.add(...this.lampLights);
    this.rain = rainOf();
    this.scene.add(this.rain);
    /** @type {TileBox[]} */
    this.waiting = [];
    this.loading = 0;
    this.loaded = 0;
    /** Tiles of the scene, -1 before they are known. */
    this.total = -1;
    this.number = -1;
    this.isNight = false;
    this.precipitation = 0;
    /** @type {number[]} */
    this.lightStates = [];
    /** @type {number[][]} */
    this.lampStates = [];
    /** @type {Map<string, number>} by the id of a signal in OpenDRIVE */
    this.lightOfSignal = new Map();
    /** @type {Map<number, number>} */
    this.lightOfBox = new Map();
    /** @type {Map<number, number>} */
    this.lampOfBox = new Map();
    /** @type {{marks: Float32Array, base: Float32Array, geometry: BufferGeometry}[]} */
    this.switched = [];
    /** @type {{at: Vector3, lamp: number}[]} */
    this.lampPlaces = [];
    this.onLoaded = () => {};
    this.farthest = 3500;
  }

  /** Draw less far, without shadows: for a browser that draws by the processor. */
  saveWork() {
    this.farthest = 450;
    this.lampLights.splice(2).forEach((light) => this.scene.remove(light));
  }

  /** Begin a scene, or fill it once its tiles are ready. @param {SceneNote} note */
  begin(note) {
    if (note.number !== this.number) {
      this.tiles.clear();
      this.switched = [];
      this.lampPlaces = [];
      this.loaded = 0;
      this.waiting = [];
      this.total = -1;
      this.number = note.number;
    }
    if (!note.ready || this.waiting.length || this.loaded) return;
    this.lightOfSignal = new Map((note.signals ?? []).map((id, light) => [id, light]));
    this.lightOfBox = new Map(/** @type {[number, number][]} */ (note.lights ?? []));
    this.lampOfBox = new Map(/** @type {[number, number][]} */ (note.lamps ?? []));
    this.waiting = [...(note.tiles ?? [])];
    this.total = this.waiting.length;
  }

  /** Load the tiles nearest to a place. @param {Vector3} near */
  load(near) {
    this.near = near;
    while (this.loading < AT_ONCE && this.waiting.length) {
      let best = 0;
      let nearest = Infinity;
      this.waiting.forEach((tile, index) => {
        const x = Math.max(tile.low[0] - near.x, 0, near.x - tile.high[0]);
        const y = Math.max(tile.low[1] - near.z, 0, near.z - tile.high[1]);
        const away = x * x + y * y;
        if (away < nearest) [nearest, best] = [away, index];
      });
      const [tile] = this.waiting.splice(best, 1);
      this.loading++;
      this.fetch(tile, this.number).finally(() => {
        this.loading--;
        this.load(/** @type {Vector3} */ (this.near));
      });
    }
  }

  /** @param {TileBox} tile @param {number} number */
  async fetch(tile, number) {
    const gltf = await this.loader.loadAsync(`scene/${number}/${tile.name}`);
    if (number !== this.number) return;
    gltf.scene.traverse((child) => {
      const mesh = /** @type {import("three").Mesh} */ (child);
      if (!mesh.isMesh) return;
      const look = /** @type {import("three").Material} */ (mesh.material).name;
      mesh.material = this.materials[/** @type {keyof World["materials"]} */ (look)] ?? this.materials.rough;
      mesh.receiveShadow = look !== "lamp";
      mesh.castShadow = look !== "lamp";
      mesh.matrixAutoUpdate = false;
      if (look === "lamp") this.keepLamps(mesh);
    });
    gltf.scene.updateMatrixWorld(true);
    gltf.scene.matrixWorldAutoUpdate = false;
    this.tiles.add(gltf.scene);
    this.loaded++;
    this.onLoaded();
  }

  /** @param {import("three").Mesh} mesh */
  keepLamps(mesh) {
    const { geometry } = mesh;
    const marks = geometry.getAttribute("_lamp");
    const packed = geometry.getAttribute("color");
    const base = new Float32Array(packed.count * 3);
    const told = new Float32Array(packed.count * 2);
    mesh.updateWorldMatrix(true, false);
    const places = geometry.getAttribute("position");
    /** @type {Set<number>} */
    const seen = new Set();
    for (let row = 0; row < packed.count; row++) {
      base.set([packed.getX(row), packed.getY(row), packed.getZ(row)], row * 3);
      told.set([marks.getX(row), marks.getY(row)], row * 2);
      const box = marks.getY(row);
      if (marks.getX(row) === STREET_LAMP && !seen.has(box)) {
        seen.add(box);
        const at = new Vector3(places.getX(row), places.getY(row), places.getZ(row)).applyMatrix4(mesh.matrixWorld);
        this.lampPlaces.push({ at, lamp: this.lampOfBox.get(box - 1) ?? -1 });
      }
    }
    geometry.setAttribute("color", new Float32BufferAttribute(base.slice(), 3));
    const kept = { marks: told, base, geometry };
    this.switched.push(kept);
    this.switchLamps(kept);
  }

  /** @param {{marks: Float32Array, base: Float32Array, geometry: BufferGeometry}} kept */
  switchLamps({ marks, base, geometry }) {
    const colours = geometry.getAttribute("color");
    for (let row = 0; row < colours.count; row++) {
      const kind = marks[row * 2];
      const box = marks[row * 2 + 1] - 1;
      let on = false;
      if (kind in TRAFFIC) on = this.lightStates[this.lightOfBox.get(box) ?? -1] === TRAFFIC[kind];
      else if (kind === STREET_LAMP) on = Boolean(this.lampStates[this.lampOfBox.get(box) ?? -1]?.[0]);
      const share = on ? 1.3 : kind in TRAFFIC ? 0.12 : 0.45;
      colours.setXYZ(row, base[row * 3] * share, base[row * 3 + 1] * share, base[row * 3 + 2] * share);
    }
    colours.needsUpdate = true;
  }

  /** @param {number[]} states of traffic lights */
  setLights(states) {
    this.lightStates = states;
    this.switched.forEach((kept) => this.switchLamps(kept));
  }

  /** Let some traffic lights shine. @param {Map<string, number>} states of signals, by their ids in OpenDRIVE */
  setSignals(states) {
    /** @type {number[]} */
    const lights = [];
    for (const [id, light] of this.lightOfSignal) if (states.has(id)) lights[light] = states.get(id) ?? -1;
    this.setLights(lights);
  }

  /** @param {number[][]} states of street lamps: on, red, green, blue */
  setLamps(states) {
    this.lampStates = states;
    this.switched.forEach((kept) => this.switchLamps(kept));
  }

  /** @param {Record<string, number>} weather CARLA's parameters */
  setWeather(weather) {
    const isOwn = weather.cloudiness < 0;
    const altitude = isOwn ? 45 : weather.sun_altitude_angle;
    const cloud = isOwn ? 0.1 : weather.cloudiness / 100;
    const rain = Math.max(0, weather.precipitation) / 100;
    const wet = Math.max(0, weather.wetness, weather.precipitation_deposits) / 100;
    const haze = Math.max(0, weather.fog_density) / 100;
    const day = Math.min(1, Math.max(0, (altitude + 6) / 16));
    const low = Math.min(1, Math.max(0, (25 - altitude) / 25)) * day;
    this.isNight = altitude < 0;
    this.precipitation = rain;
    const azimuth = ((weather.sun_azimuth_angle || 0) * Math.PI) / 180;
    const height = (Math.max(altitude, 8) * Math.PI) / 180;
    this.sunWay = new Vector3(Math.cos(height) * Math.cos(azimuth), Math.sin(height), Math.cos(height) * Math.sin(azimuth));
    this.sun.color.setRGB(1, 1 - 0.25 * low, 1 - 0.5 * low);
    this.sun.intensity = 0.12 * (1 - day) + day * 2.9 * (1 - 0.8 * cloud);
    this.sky.intensity = 0.14 + day * (0.9 + 0.5 * cloud);
    const clear = new Color(0x8fbce8).lerp(new Color(0xe8b88a), 0.5 * low);
    const sky = clear.lerp(new Color(0x9aa4ad), Math.max(cloud, haze) * 0.9).multiplyScalar(0.02 + 0.98 * day);
    this.background.copy(sky);
    this.fog.color.copy(sky);
    const clearView = Math.min(this.farthest, 3500 - 2500 * rain);
    this.fog.far = haze > 0 ? Math.min(clearView, 80 + 1200 * (1 - haze) ** 2) : clearView;
    this.fog.near = haze > 0 ? Math.min(20, Math.max(0, weather.fog_distance || 0)) : this.fog.far * 0.15;
    this.materials.rough.color.setScalar(1 - 0.35 * wet);
    this.materials.window.emissive.set(this.isNight ? WINDOW_AT_NIGHT : 0);
    this.materials.window.emissiveIntensity = this.isNight ? 0.8 : 0;
    this.rain.visible = rain > 0.02;
    this.rain.geometry.setDrawRange(0, 2 * Math.round(RAIN_DROPS * rain));
  }

  /** Follow the view with sun, rain and the nearest lamps. @param {Vector3} focus @param {Vector3} eye @param {number} t */
  update(focus, eye, t) {
    const way = this.sunWay ?? new Vector3(0.5, 0.7, 0.3).normalize();
    this.sun.target.position.copy(focus);
    this.sun.position.copy(focus).addScaledVector(way, 250);
    if (this.rain.visible) {
      this.rain.position.copy(eye);
      this.rain.material.opacity = 0.35;
      const falls = (t * 9) % RAIN_BOX_M;
      this.rain.position.y += RAIN_BOX_M / 2 - falls;
    }
    if (this.isNight) this.lightNear(focus);
    else for (const light of this.lampLights) light.intensity = 0;
  }

  /** Put the lights at the lit lamps nearest to a place. @param {Vector3} focus */
  lightNear(focus) {
    const lit = this.lampPlaces.filter(({ lamp }) => this.lampStates[lamp]?.[0]);
    lit.sort((a, b) => a.at.distanceToSquared(focus) - b.at.distanceToSquared(focus));
    this.lampLights.forEach((light, index) => {
      const lamp = lit[index];
      light.intensity = lamp ? 220 : 0;
      if (!lamp) return;
      light.position.copy(lamp.at);
      const [, r, g, b] = this.lampStates[lamp.lamp];
      light.color.setRGB(r / 255, g / 255, b / 255, "srgb");
    });
  }
}

/** Return drops in a box that repeats itself downwards. */
function rainOf() {
  const places = new Float32Array(RAIN_DROPS * 12);
  let seed = 7;
  const draw = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let drop = 0; drop < RAIN_DROPS; drop++) {
    const x = (draw() - 0.5) * RAIN_BOX_M * 1.5;
    const y = (draw() - 0.5) * RAIN_BOX_M * 2;
    const z = (draw() - 0.5) * RAIN_BOX_M * 1.5;
    places.set([x, y, z, x, y + 0.45, z], drop * 6);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(places, 3));
  const rain = new LineSegments(geometry, new LineBasicMaterial({ color: 0xaab8c6, transparent: true, opacity: 0.35 }));
  rain.frustumCulled = false;
  rain.visible = false;
  return rain;
}
