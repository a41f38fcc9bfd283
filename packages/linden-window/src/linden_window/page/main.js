// @ts-check
/** The page: connects, keeps the timeline, and draws each picture in three dimensions or as a map. */

import { BufferGeometry, Line, LineBasicMaterial, Raycaster, Vector2, Vector3, WebGLRenderer } from "three";
import { Actors } from "./actors.js";
import { Cameras, VIEWS } from "./cameras.js";
import { Connection } from "./connection.js";
import { controlOf } from "./control.js";
import { DebugShapes } from "./debug.js";
import { DrivingInput } from "./input.js";
import { Map2d, colourOf, endsOf } from "./map2d.js";
import { Panes } from "./panes.js";
import { aboutActor, element, help, list, say, showReadings, showRuns, showScore, unsay } from "./panel.js";
import { Replay } from "./replay.js";
import { Timeline } from "./timeline.js";
import { World } from "./world.js";

/** @typedef {import("./timeline.js").Pose} Pose */

const NARROW_PX = 640;
const FIGURES_MS = 200;
const LOADS_MS = 50;
/** How much of an actor's path is shown, s of simulated time. */
const PATH_S = 60;
const NO_WEBGL = "This browser has no WebGL, so the page shows a map. Turn on hardware acceleration, or use another browser.";
const BUILDING = "The scenery of this map is being made, once on this machine; that takes some ten seconds.";

const parameters = new URLSearchParams(location.search);

class Page {
  /** @param {import("./frames3d.js").Gait} gait */
  constructor(gait) {
    const canvas = /** @type {HTMLCanvasElement} */ (element("picture"));
    this.timeline = new Timeline();
    this.world = new World();
    this.actors = new Actors(this.world.scene, gait);
    this.debug = new DebugShapes(this.world.scene);
    this.cameras = new Cameras(canvas);
    this.map = new Map2d(/** @type {HTMLCanvasElement} */ (element("map")));
    this.renderer = rendererOf(canvas);
    this.isFlat = this.renderer === null || parameters.has("flat") || innerWidth <= NARROW_PX;
    if (this.renderer !== null && !this.renderer.shadowMap.enabled) {
      this.world.saveWork();
      this.cameras.camera.far = 900;
    }
    if (this.renderer === null) say(NO_WEBGL, true, Infinity);
    this.replay = new Replay(this.timeline);
    this.spectator = 0;
    this.chosen = 0;
    this.ego = 0;
    this.weather = "";
    this.mapName = "";
    this.isSynchronous = false;
    /** @type {import("./panel.js").ScorePanel[]} */
    this.panels = [];
    /** @type {import("./panel.js").ScorePanel | null} */
    this.shownPanel = null;
    /** @type {import("./replay.js").Mark[]} */
    this.marks = [];
    /** @type {Pose[]} */
    this.poses = [];
    this.hasPlace = false;
    this.width = this.height = 0;
    this.pictures = 0;
    this.perSecond = 0;
    this.rate = { at: performance.now(), pictures: 0, bytes: 0, frames: 0 };
    this.frames = 0;
    this.bytesPerSecond = 0;
    this.firstPictureMs = 0;
    this.before = performance.now();
    /** @type {import("./panel.js").ReadingsNote | null} */
    this.readings = null;
    /** @type {LineBasicMaterial[]} of the lines of signs and lights */
    this.lines = [];
    this.path = new Line(new BufferGeometry(), new LineBasicMaterial({ color: 0xd0421b }));
    this.path.frustumCulled = false;
    this.world.scene.add(this.path);
    this.keepsPicture = false;
    this.isFilmed = parameters.has("film");
    this.panes = new Panes((order) => this.connection.send(order));
    this.connection = new Connection(
      (note) => this.note(note), (frame) => this.arrived(frame), (pane) => this.panes.take(pane), (sentence) => say(sentence, true),
      () => this.input.again(),
    );
    this.input = new DrivingInput((order) => this.connection.send(order));
    this.control = controlOf((order) => this.connection.send(order));
    this.world.onLoaded = () => unsay(BUILDING);
    this.buttons();
    canvas.addEventListener("click", (event) => this.click(event));
    element("map").addEventListener("click", (event) => this.clickMap(event));
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("keyup", (event) => this.cameras.keys.delete(event.code));
    document.body.classList.toggle("film", this.isFilmed);
    this.flat(this.isFlat);
    const view = parameters.get("view");
    if (view !== null && VIEWS.includes(view)) this.view(view);
    if (!this.isFilmed) setInterval(() => this.figures(), FIGURES_MS);
    requestAnimationFrame(() => this.draw());
  }

  // -- what arrives -------------------------------------------------------------------------------------------------

  /** @param {import("./timeline.js").Frame} frame */
  arrived(frame) {
    this.frames++;
    if (this.replay.isOn) return;
    if (frame.jumps) this.timeline.clear();
    this.timeline.arrive(frame, performance.now() / 1000);
  }

  /** @param {any} note */
  note(note) {
    const take = /** @type {Record<string, (note: any) => void>} */ ({
      scene: () => this.beginScene(note),
      actors: () => {
        this.spectator = note.spectator ?? 0;
        this.actors.describe(note.actors);
        this.panes.describeOf(note.actors);
      },
      weather: () => {
        this.world.setWeather(note.weather);
        this.weather = weatherOf(note.weather);
      },
      lights: () => this.world.setLights(note.states),
      lamps: () => this.world.setLamps(note.lamps),
      settings: () => {
        this.isSynchronous = note.synchronous;
      },
      debug: () => {
        this.debug.add(note);
        if (note.dropped) say(`A script draws more shapes at once than the page takes: ${note.dropped} are left out.`);
      },
      route: () => this.route(note),
      signals: () => this.showSignals(note.states),
      sensors: () => this.panes.describe(note.sensors),
      readings: () => {
        this.readings = note;
      },
      panel: () => this.panels.push(note),
      marks: () => this.mark(note.marks),
      record: () => this.record(note),
      says: () => say(note.text, Boolean(note.bad)),
      end: () => say(note.text, true, Infinity),
    });
    take[note.type]?.(note);
  }

  /** @param {any} note */
  beginScene(note) {
    this.world.begin(note);
    this.panes.named = "";
    if (note.error) say(note.error, true);
    if (!note.ready && !note.kept) say(BUILDING, false, Infinity);
    if (note.ready) {
      unsay(BUILDING);
      this.map.load(note.number);
      const [spawn] = note.spawn_points ?? [];
      if (!this.hasPlace && spawn) this.cameras.lookAt(new Vector3(spawn[0], spawn[2], spawn[1]));
    }
    if (this.map.signals.length) this.showSignals(this.map.signals);
    this.mapName = note.map;
    document.title = `${note.map} – window`;
    this.control.show(note.control);
    element("changes").hidden = !note.control;
  }

  /**
   * @param {{ego: number, points: number[][], controls: import("./map2d.js").Control[], half: number,
   *   stops: {name: string, x: number, y: number}[], drives?: boolean}} note
   */
  route(note) {
    this.ego = this.chosen = note.ego;
    this.map.route = note.points;
    this.map.controls = note.controls;
    this.map.half = note.half;
    this.map.stops = note.stops;
    this.lines = note.controls.map((control) => {
      const ends = endsOf(control, note.half).map(([x, y]) => new Vector3(x, control.z + 0.3, y));
      const material = new LineBasicMaterial({ color: colourOf(control, undefined) });
      this.world.scene.add(new Line(new BufferGeometry().setFromPoints(ends), material));
      return material;
    });
    if (note.points.length) {
      const places = note.points.map(([x, y, z]) => new Vector3(x, z + 0.25, y));
      const line = new Line(new BufferGeometry().setFromPoints(places), new LineBasicMaterial({ color: 0x4c9be8 }));
      line.frustumCulled = false;
      this.world.scene.add(line);
    }
    this.input.isOn = Boolean(note.drives);
    if (this.cameras.view === "orbit") this.view("chase");
  }

  /** @param {number[]} states of the route's lights, -1 for signs */
  showSignals(states) {
    this.map.signals = states;
    this.world.setSignals(new Map(this.map.controls.map(({ id }, index) => [id, states[index]])));
    this.lines.forEach((line, index) => line.color.set(colourOf(this.map.controls[index], states[index])));
  }

  /** @param {import("./replay.js").Mark[]} marks */
  mark(marks) {
    const known = new Set(this.marks.map((each) => each.text + each.t));
    if (!this.replay.isOn) for (const each of marks) if (!known.has(each.text + each.t)) say(each.text, each.bad !== false);
    this.marks = marks;
    this.replay.showMarks(marks);
  }

  /** @param {{frames: string, facts: string, runs: import("./panel.js").RecordedRun[]}} note */
  async record(note) {
    if (this.replay.isOn) return;
    showRuns(note.runs);
    const [frames, facts] = await Promise.all([fetch(note.frames), fetch(note.facts)]);
    this.timeline.read(await frames.arrayBuffer());
    const told = await facts.json();
    this.panels = told.panels;
    for (const frame of this.timeline.frames) {
      const row = frame.row(this.ego);
      if (row >= 0) this.map.pass(frame.f32[row * 8 + 1], frame.f32[row * 8 + 2]);
    }
    this.replay.begin();
    this.mark(told.marks);
    if (told.notice) say(told.notice, true, Infinity);
    const at = Number(parameters.get("t"));
    if (at) this.replay.seek(at);
  }

  // -- what a person does -------------------------------------------------------------------------------------------

  buttons() {
    const nav = element("views");
    for (const name of VIEWS) {
      const button = document.createElement("button");
      button.textContent = name;
      button.dataset.view = name;
      button.onclick = () => this.view(name);
      nav.append(button);
    }
    const flat = document.createElement("button");
    flat.id = "flat";
    flat.onclick = () => this.flat(!this.isFlat);
    const keys = document.createElement("button");
    keys.textContent = "?";
    keys.setAttribute("aria-label", "Keys");
    keys.onclick = () => help(this.input.isOn);
    const changes = document.createElement("button");
    changes.id = "changes";
    changes.textContent = "Change";
    changes.hidden = true;
    changes.onclick = () => changes.setAttribute("aria-pressed", String(element("control").classList.toggle("open")));
    nav.append(changes, flat, keys);
    this.view("orbit");
  }

  /** @param {string} view */
  view(view) {
    this.cameras.choose(view);
    for (const button of document.querySelectorAll("#views [data-view]")) {
      button.setAttribute("aria-pressed", String(/** @type {HTMLElement} */ (button).dataset.view === view));
    }
    if ((view === "chase" || view === "driver") && !this.followed()) this.next(1);
  }

  /** @param {boolean} isFlat */
  flat(isFlat) {
    this.isFlat = isFlat || this.renderer === null;
    element("picture").hidden = this.isFlat;
    element("map").hidden = !this.isFlat;
    const button = element("flat");
    button.textContent = this.isFlat ? "3D" : "2D";
    button.hidden = this.renderer === null;
    for (const each of document.querySelectorAll("#views [data-view]")) /** @type {HTMLElement} */ (each).hidden = this.isFlat;
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target instanceof HTMLSelectElement || event.target instanceof HTMLInputElement) return;
    if (event.key === "?" || (event.code === "KeyH" && this.input.isOn)) return help(this.input.isOn);
    if (this.input.takes(event.code)) return;
    this.cameras.keys.add(event.code);
    if (this.replay.key(event.code)) return event.preventDefault();
    const digit = Number(event.key);
    if (digit >= 1 && digit <= VIEWS.length) this.view(VIEWS[digit - 1]);
    else if (event.code === "KeyV") this.view(VIEWS[(VIEWS.indexOf(this.cameras.view) + 1) % VIEWS.length]);
    else if (event.code === "KeyF") this.next(event.shiftKey ? -1 : 1);
    else if (event.code === "KeyM") this.flat(!this.isFlat);
    else if (event.code === "KeyN") this.panes.next();
    else if (event.code === "KeyI") document.body.classList.toggle("bare");
    else if (event.code === "KeyK") this.keepsPicture = true;
  }

  /** Follow another vehicle, or a walker where there is no vehicle. @param {number} step */
  next(step) {
    const of = (/** @type {string} */ kind) => this.poses.filter((pose) => this.actors.known.get(pose.id)?.kind === kind);
    const found = [...of("vehicle"), ...of("walker")].map((pose) => pose.id).sort((a, b) => a - b);
    if (!found.length) return;
    const at = found.indexOf(this.chosen);
    this.chosen = found[(at + step + found.length) % found.length];
  }

  /** @param {MouseEvent} event */
  click(event) {
    const { camera } = this.cameras;
    const at = new Vector2((event.clientX / innerWidth) * 2 - 1, 1 - (event.clientY / innerHeight) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, camera);
    if (this.control.wantsGoal) {
      const [hit] = ray.intersectObject(this.world.tiles, true);
      if (hit) this.control.sendTo(hit.point.x, hit.point.z);
      return;
    }
    let best = 0;
    let nearest = Infinity;
    for (const pose of this.poses) {
      const actor = this.actors.known.get(pose.id);
      if (actor === undefined || !["vehicle", "walker", "prop"].includes(actor.kind)) continue;
      const middle = new Vector3(pose.x, pose.z + actor.box[2], pose.y);
      const away = ray.ray.distanceToPoint(middle);
      const depth = middle.distanceTo(camera.position);
      const radius = Math.max(0.6, Math.hypot(actor.box[3], actor.box[4]) * 0.8, depth * 0.012);
      if (away < radius && depth < nearest) [nearest, best] = [depth, pose.id];
    }
    if (best === 0 && this.control.wantsPlace) {
      const [hit] = ray.intersectObject(this.world.tiles, true);
      if (hit) this.control.spawn([hit.point.x, hit.point.z, hit.point.y], yawOf(camera));
    } else this.chosen = best || this.ego;
  }

  /** @param {MouseEvent} event */
  clickMap(event) {
    const x = this.map.centre[0] + (event.clientX - innerWidth / 2) * this.map.metresPerPixel;
    const y = this.map.centre[1] + (event.clientY - innerHeight / 2) * this.map.metresPerPixel;
    if (this.control.wantsGoal) return this.control.sendTo(x, y);
    if (this.control.wantsPlace) return this.control.spawn([x, y, null], 0);
    const reach = Math.max(3, 14 * this.map.metresPerPixel);
    const near = this.poses
      .filter((pose) => ["vehicle", "walker"].includes(this.actors.known.get(pose.id)?.kind ?? ""))
      .map((pose) => ({ id: pose.id, away: Math.hypot(pose.x - x, pose.y - y) }))
      .filter(({ away }) => away < reach)
      .sort((a, b) => a.away - b.away);
    this.chosen = near[0]?.id ?? this.ego;
  }

  // -- pictures -----------------------------------------------------------------------------------------------------

  /** Return the pose of the followed actor. @returns {Pose | null} */
  followed() {
    return this.poses.find((pose) => pose.id === this.chosen) ?? null;
  }

  draw() {
    if (this.isFilmed) return;
    requestAnimationFrame(() => this.draw());
    const now = performance.now();
    const dt = Math.min(0.2, (now - this.before) / 1000);
    this.before = now;
    this.picture(now, dt);
  }

  /**
   * Draw one moment of a record for a film, with all that is seen in it. Nothing else is drawn, so the pictures depend
   * on simulated time only. @param {number} t @param {number} dt since the last picture, in s
   */
  async show(t, dt) {
    const isLoading = () => !this.isFlat && (this.world.waiting.length + this.world.loading > 0 || this.actors.isLoading);
    this.replay.seek(t);
    this.picture(performance.now(), dt);
    if (isLoading()) {
      while (isLoading()) await new Promise((done) => setTimeout(done, LOADS_MS));
      this.picture(performance.now(), 0);
    }
    this.figures();
    await new Promise((done) => requestAnimationFrame(done));
  }

  /** @param {number} now in ms @param {number} dt since the last picture, in s */
  picture(now, dt) {
    const clock = this.replay.isOn ? this.replay.advance(dt) : now / 1000 - 1.6 * this.timeline.interval;
    const t = this.timeline.time(clock);
    this.poses = this.timeline.poses(clock);
    if (!this.chosen && ["chase", "driver"].includes(this.cameras.view)) this.next(1);
    const pose = this.followed();
    this.place(pose);
    this.debug.update(t);
    if (this.isFlat) this.map.draw(this.poses, this.actors.known, pose, this.marks, this.debug.shapes);
    else this.draw3d(dt, t, pose);
    if (this.keepsPicture) this.keepPicture();
    const driven = this.replay.isOn ? undefined : this.poses.find((each) => each.id === this.ego);
    if (driven !== undefined) this.map.pass(driven.x, driven.y);
    this.pictures++;
    if (!this.firstPictureMs && (this.world.loaded || (this.isFlat && this.map.edges))) this.firstPictureMs = now;
  }

  /** Keep the picture that was just drawn as a file; WebGL forgets it with the next one. */
  keepPicture() {
    this.keepsPicture = false;
    const canvas = /** @type {HTMLCanvasElement} */ (element(this.isFlat ? "map" : "picture"));
    canvas.toBlob((blob) => {
      if (blob === null) return;
      const link = document.createElement("a");
      link.href = URL.createObjectURL(blob);
      link.download = `${this.mapName || "window"}.png`;
      link.click();
      URL.revokeObjectURL(link.href);
      say(`The picture is kept as ${link.download}.`);
    });
  }

  /** Look at where something happens, once. @param {Pose | null} pose */
  place(pose) {
    if (this.hasPlace || !this.poses.length) return;
    const vehicle = pose ?? this.poses.find((each) => this.actors.known.get(each.id)?.kind === "vehicle");
    const seen = vehicle ?? this.poses.find((each) => each.id === this.spectator && (each.x || each.y));
    if (seen === undefined) return;
    this.hasPlace = vehicle !== undefined;
    if (!this.hasPlace && !this.isFlat) return; // in three dimensions the view `spectator` shows what it sees
    this.cameras.lookAt(new Vector3(seen.x, seen.z, seen.y), 30);
    this.map.centre = [seen.x, seen.y];
  }

  /** @param {number} dt @param {number} t @param {Pose | null} pose */
  draw3d(dt, t, pose) {
    const renderer = /** @type {WebGLRenderer} */ (this.renderer);
    const width = innerWidth, height = innerHeight;
    if (renderer.domElement.clientWidth !== this.width || height !== this.height) {
      this.width = width;
      this.height = height;
      renderer.setSize(width, height, false);
      this.cameras.camera.aspect = width / height;
      this.cameras.camera.updateProjectionMatrix();
    }
    const spectator = this.poses.find((each) => each.id === this.spectator) ?? null;
    const actor = pose === null ? undefined : this.actors.known.get(pose.id);
    const [, , middle, half, , up] = actor?.box ?? [0, 0, 0, 2, 1, 0.8];
    const isWalker = actor?.kind === "walker";
    this.cameras.update(dt, pose, isWalker ? up * 0.85 : middle + up * 0.45, isWalker ? 0.2 : half * 0.25, spectator);
    this.world.load(this.cameras.focus);
    this.actors.update(this.poses, t, this.cameras.view === "driver" ? this.chosen : 0);
    this.world.update(this.cameras.focus, this.cameras.camera.position, t);
    renderer.render(this.world.scene, this.cameras.camera);
  }

  figures() {
    const now = performance.now();
    const { at, pictures, bytes } = this.rate;
    if (now - at > 1000) {
      this.perSecond = ((this.pictures - pictures) * 1000) / (now - at);
      this.bytesPerSecond = ((this.connection.bytes - bytes) * 1000) / (now - at);
      this.rate = { at: now, pictures: this.pictures, bytes: this.connection.bytes, frames: this.frames };
    }
    element("title").textContent = this.mapName || "Window";
    const kinds = [...this.poses].map((pose) => this.actors.known.get(pose.id)?.kind);
    const count = (/** @type {string} */ kind) => kinds.filter((each) => each === kind).length;
    const clock = this.replay.isOn ? this.replay.clock : this.timeline.last;
    const lines = [{ name: "time", value: `${this.timeline.time(clock).toFixed(1)} s` }];
    if (this.readings === null) lines.push({ name: "vehicles, walkers", value: `${count("vehicle")}, ${count("walker")}` });
    if (this.weather && this.readings === null) lines.push({ name: "weather", value: this.weather });
    if (!this.isFilmed) lines.push({ name: "pictures/s", value: this.perSecond.toFixed(0) });
    if (!this.replay.isOn) lines.push({ name: "data", value: `${(this.bytesPerSecond / 1000).toFixed(0)} kB/s` });
    list(element("figures"), lines);
    this.actorFigures();
    this.scoreFigures(this.timeline.time(clock));
    this.replay.show();
  }

  actorFigures() {
    const box = element("actor");
    const pose = this.followed();
    const actor = pose === null ? undefined : this.actors.known.get(pose.id);
    box.hidden = actor === undefined;
    this.panes.carriedBy(this.chosen);
    const isStreet = actor !== undefined && pose !== null && ["vehicle", "walker", "prop"].includes(actor.kind);
    this.control.choose(isStreet ? { id: pose.id, x: pose.x, y: pose.y, yaw: pose.yaw, isVehicle: actor.kind === "vehicle" } : null);
    this.showPath(pose);
    if (actor === undefined || pose === null) return;
    if (this.readings !== null && pose.id === this.ego && !this.replay.isOn) return showReadings(box, this.readings);
    box.className = "";
    const heading = document.createElement("h2");
    heading.textContent = actor.type;
    const lines = document.createElement("div");
    const sensors = [...this.actors.known.values()].filter((each) => each.kind === "sensor" && each.parent === actor.id);
    list(lines, aboutActor(actor, pose, sensors));
    box.replaceChildren(heading, lines);
  }

  /** Show the way that an actor has come, of the vehicle under test from the beginning. @param {Pose | null} pose */
  showPath(pose) {
    const points = pose === null || pose.id === this.ego ? [] : this.timeline.path(pose.id, PATH_S);
    this.map.chosenPath = points;
    this.path.geometry.dispose();
    this.path.geometry = new BufferGeometry().setFromPoints(points.map(([x, y, z]) => new Vector3(x, z + 0.3, y)));
    this.path.visible = points.length > 1;
  }

  /** @param {number} t */
  scoreFigures(t) {
    const at = this.replay.isOn ? this.panels.findLast((panel) => panel.t <= t + 1e-6) : this.panels[this.panels.length - 1];
    if (at === undefined || at === this.shownPanel) return;
    this.shownPanel = at;
    showScore(at);
    if (!this.replay.isOn && this.panels.length > 50) this.panels.splice(0, 40);
  }
}

/** Return a renderer, null if the browser has no WebGL. @param {HTMLCanvasElement} canvas */
function rendererOf(canvas) {
  try {
    const isSoft = drawsByProcessor();
    const renderer = new WebGLRenderer({ canvas, antialias: !isSoft, powerPreference: "high-performance" });
    renderer.setPixelRatio(isSoft ? 1 : Math.min(devicePixelRatio || 1, 2));
    renderer.shadowMap.enabled = !isSoft;
    return renderer;
  } catch {
    return null;
  }
}

/** Return whether WebGL is computed by the processor, which is slow. */
function drawsByProcessor() {
  const context = document.createElement("canvas").getContext("webgl2");
  const about = context?.getExtension("WEBGL_debug_renderer_info");
  const name = about ? String(context?.getParameter(about.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** @param {import("three").Camera} camera */
function yawOf(camera) {
  const way = camera.getWorldDirection(new Vector3());
  return (Math.atan2(way.z, way.x) * 180) / Math.PI;
}

/** @param {Record<string, number>} weather */
function weatherOf(weather) {
  if (weather.cloudiness < 0) return "the map's own";
  const parts = [weather.sun_altitude_angle < 0 ? "night" : weather.sun_altitude_angle < 15 ? "low sun" : "day"];
  if (weather.precipitation > 5) parts.push("rain");
  else if (weather.cloudiness > 60) parts.push("cloudy");
  if (weather.fog_density > 20) parts.push("fog");
  return parts.join(", ");
}

/** @returns {Promise<void>} */
async function begin() {
  try {
    const answer = await fetch("model/gait.json");
    const page = new Page(await answer.json());
    page.world.sun.castShadow = Boolean(page.renderer?.shadowMap.enabled);
    Object.assign(globalThis, { page });
  } catch (error) {
    say(`The page cannot begin: ${error}. Load it again.`, true, Infinity);
  }
}

begin();
