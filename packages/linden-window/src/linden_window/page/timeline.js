// @ts-check
/** Frames as the server packs them (poses.py), kept in order, and the pose of each actor between two of them. */

export const HEADER_BYTES = 24;
export const ROW_BYTES = 32;
const MAGIC = 0x31574c57;
const DEGREES = 180 / 32767;
const MOST_LIVE = 1800;

/** One frame: typed views of its rows, nothing copied. */
export class Frame {
  /** @param {ArrayBuffer} buffer @param {number} start byte at which the frame begins */
  constructor(buffer, start = 0) {
    const head = new DataView(buffer, start, HEADER_BYTES);
    if (head.getUint32(0, true) !== MAGIC) throw new Error("this page and the server are of different versions; load the page again");
    this.number = head.getUint32(4, true);
    this.t = head.getFloat64(8, true);
    this.count = head.getUint32(16, true);
    this.jumps = (head.getUint32(20, true) & 1) !== 0;
    this.clock = this.t;
    const at = start + HEADER_BYTES;
    const bytes = this.count * ROW_BYTES;
    this.end = at + bytes;
    this.u32 = new Uint32Array(buffer, at, bytes / 4);
    this.f32 = new Float32Array(buffer, at, bytes / 4);
    this.i16 = new Int16Array(buffer, at, bytes / 2);
    this.u16 = new Uint16Array(buffer, at, bytes / 2);
    this.u8 = new Uint8Array(buffer, at, bytes);
    this.i8 = new Int8Array(buffer, at, bytes);
    /** @type {Map<number, number> | null} */
    this.rows = null;
  }

  /** Return the row of an actor, -1 if the frame lacks it. @param {number} id */
  row(id) {
    if (this.rows === null) {
      this.rows = new Map();
      for (let row = 0; row < this.count; row++) this.rows.set(this.u32[row * 8], row);
    }
    return this.rows.get(id) ?? -1;
  }
}

/** The pose and state of one actor at a moment; m, degrees, m/s. */
export class Pose {
  constructor() {
    this.id = 0;
    this.x = this.y = this.z = 0;
    this.pitch = this.yaw = this.roll = 0;
    this.lights = this.state = this.limit = this.ghost = 0;
    this.speed = this.steer = this.throttle = this.brake = 0;
  }
}

/** @param {number} from @param {number} to degrees @param {number} share */
function between(from, to, share) {
  let way = to - from;
  if (way > 180) way -= 360;
  else if (way < -180) way += 360;
  return from + way * share;
}

/** Frames in the order of their clock: the time of arrival of a live world, the simulated time of a record. */
export class Timeline {
  constructor() {
    /** @type {Frame[]} */
    this.frames = [];
    this.interval = 0.05;
    this.pool = /** @type {Pose[]} */ ([]);
  }

  clear() {
    this.frames = [];
  }

  get first() {
    return this.frames.length ? this.frames[0].clock : 0;
  }

  get last() {
    return this.frames.length ? this.frames[this.frames.length - 1].clock : 0;
  }

  /** Add a frame of a live world. @param {Frame} frame @param {number} now in s */
  arrive(frame, now) {
    const before = this.frames[this.frames.length - 1];
    if (before !== undefined) {
      const passed = now - before.clock;
      if (passed < 1) this.interval += 0.1 * (passed - this.interval);
    }
    frame.clock = before === undefined ? now : Math.max(now, before.clock + 1e-4);
    this.frames.push(frame);
    if (this.frames.length > MOST_LIVE) this.frames.splice(0, MOST_LIVE / 4);
  }

  /** Take all frames of a record, which lie one behind the other. @param {ArrayBuffer} buffer */
  read(buffer) {
    let at = 0;
    while (at < buffer.byteLength) {
      const frame = new Frame(buffer, at);
      this.frames.push(frame);
      at = frame.end;
    }
  }

  /** Return the row of the last frame at or before a clock, -1 before the first. @param {number} clock */
  index(clock) {
    let low = 0;
    let high = this.frames.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.frames[middle].clock <= clock) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /** Return the simulated time at a clock. @param {number} clock */
  time(clock) {
    const at = this.index(clock);
    if (at < 0) return this.frames.length ? this.frames[0].t : 0;
    const a = this.frames[at];
    const b = this.frames[at + 1];
    if (b === undefined || b.jumps) return a.t;
    return a.t + ((b.t - a.t) * (clock - a.clock)) / (b.clock - a.clock);
  }

  /** Return where an actor was, oldest first, at most one place a metre. @param {number} id @param {number} lasts in s */
  path(id, lasts) {
    /** @type {number[][]} */
    const places = [];
    for (let at = this.frames.length - 1; at >= 0; at--) {
      const frame = this.frames[at];
      const row = frame.row(id);
      if (row < 0 || this.frames[this.frames.length - 1].t - frame.t > lasts) break;
      const place = [...frame.f32.subarray(row * 8 + 1, row * 8 + 4)];
      const last = places[places.length - 1];
      if (last === undefined || Math.hypot(place[0] - last[0], place[1] - last[1]) >= 1) places.push(place);
    }
    return places.reverse();
  }

  /** Return the poses of all actors at a clock; they are valid until the next call. @param {number} clock */
  poses(clock) {
    const at = Math.max(0, this.index(clock));
    const a = this.frames[at];
    if (a === undefined) return [];
    const next = this.frames[at + 1];
    const b = next === undefined || next.jumps ? a : next;
    const share = b === a ? 0 : Math.min(1, Math.max(0, (clock - a.clock) / (b.clock - a.clock)));
    while (this.pool.length < a.count) this.pool.push(new Pose());
    for (let row = 0; row < a.count; row++) fill(this.pool[row], a, row, b, share);
    return this.pool.slice(0, a.count);
  }
}

/** @param {Pose} pose @param {Frame} a @param {number} row @param {Frame} b @param {number} share */
function fill(pose, a, row, b, share) {
  const id = a.u32[row * 8];
  let other = row;
  if (b !== a && (row >= b.count || b.u32[row * 8] !== id)) other = b.row(id);
  const to = other < 0 ? a : b;
  if (other < 0) other = row;
  const p = row * 8 + 1;
  const q = other * 8 + 1;
  const far = Math.abs(to.f32[q] - a.f32[p]) + Math.abs(to.f32[q + 1] - a.f32[p + 1]) > 20;
  const s = far ? 0 : share;
  pose.id = id;
  pose.x = a.f32[p] + (to.f32[q] - a.f32[p]) * s;
  pose.y = a.f32[p + 1] + (to.f32[q + 1] - a.f32[p + 1]) * s;
  pose.z = a.f32[p + 2] + (to.f32[q + 2] - a.f32[p + 2]) * s;
  const i = row * 16 + 8;
  const j = other * 16 + 8;
  pose.pitch = between(a.i16[i] * DEGREES, to.i16[j] * DEGREES, s);
  pose.yaw = between(a.i16[i + 1] * DEGREES, to.i16[j + 1] * DEGREES, s);
  pose.roll = between(a.i16[i + 2] * DEGREES, to.i16[j + 2] * DEGREES, s);
  pose.lights = a.u16[i + 3];
  pose.speed = a.i16[i + 4] / 100;
  const k = row * 32;
  pose.steer = a.i8[k + 26] / 100;
  pose.throttle = a.u8[k + 27] / 255;
  pose.brake = a.u8[k + 28] / 255;
  pose.limit = a.u8[k + 29];
  pose.state = a.u8[k + 30];
  pose.ghost = a.u8[k + 31];
}
