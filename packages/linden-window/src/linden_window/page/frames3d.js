// @ts-check
/** Matrices of actors and of their parts, in the axes of three.js: x east, y up, z south. */

import { Matrix4 } from "three";

const RADIANS = Math.PI / 180;

/**
 * @typedef {{vehicle_frames: string[], walker_bones: string[], names: string[], parents: number[],
 *   offsets: number[][], feet: number[], standing: number[], stride: number, share: number[],
 *   angles_deg: Record<string, number[]>, full_swing_mps: number}} Gait
 */

/**
 * Write the matrix of a pose in CARLA's axes; like linden.geometry.rotation_matrix, with y and z exchanged.
 * @param {Matrix4} out @param {number} x @param {number} y @param {number} z in m
 * @param {number} pitch @param {number} yaw @param {number} roll in degrees
 */
export function poseMatrix(out, x, y, z, pitch, yaw, roll) {
  const sp = Math.sin(pitch * RADIANS), cp = Math.cos(pitch * RADIANS);
  const sy = Math.sin(yaw * RADIANS), cy = Math.cos(yaw * RADIANS);
  const sr = Math.sin(roll * RADIANS), cr = Math.cos(roll * RADIANS);
  return out.set(
    cp * cy, -cy * sp * cr - sy * sr, cy * sp * sr - sy * cr, x,
    sp, cp * cr, -cp * sr, z,
    cp * sy, -sy * sp * cr + cy * sr, sy * sp * sr + cy * cr, y,
    0, 0, 0, 1,
  );
}

/**
 * Write the matrices of a vehicle's frames: body, four wheels, fork.
 * @param {Matrix4[]} out @param {number[][]} hubs x, y, radius of each wheel in m
 * @param {number} steer in rad to the right @param {number} rolled in m
 */
export function vehicleFrames(out, hubs, steer, rolled) {
  out[0].identity();
  for (let wheel = 0; wheel < 5; wheel++) {
    const [x, y, radius] = hubs[Math.min(wheel % 4, hubs.length - 1)];
    const isFork = wheel === 4;
    const steers = isFork || (hubs.length > 2 ? wheel < 2 : wheel === 0);
    const turn = isFork || radius === 0 ? 0 : (-rolled / radius / RADIANS) % 360;
    poseMatrix(out[wheel + 1], x, y, radius, turn, steers ? steer / RADIANS : 0, 0);
  }
}

/** @param {Gait} gait @param {string} joint @param {number} share */
function bend(gait, joint, share) {
  const shares = gait.share;
  const angles = gait.angles_deg[joint];
  const at = share - Math.floor(share);
  let next = shares.findIndex((value) => value > at);
  const last = shares.length - 1;
  const from = next <= 0 ? last : next - 1;
  if (next < 0) next = 0;
  let span = shares[next] - shares[from];
  let way = at - shares[from];
  if (span <= 0) span += 1;
  if (way < 0) way += 1;
  return angles[from] + ((angles[next] - angles[from]) * way) / span;
}

/** Poses of walkers: what linden.scenery.actors.posing.walker_frames says. */
export class WalkerPoser {
  /** @param {Gait} gait */
  constructor(gait) {
    this.gait = gait;
    this.shown = gait.walker_bones.map((name) => gait.names.indexOf(name));
    const count = gait.names.length;
    this.turn = new Float64Array(count);
    this.place = new Float64Array(count * 3);
    this.joints = Object.keys(gait.angles_deg).flatMap((joint) =>
      [["R", 0], ["L", 0.5]].map(([side, ahead]) => ({
        joint, ahead: Number(ahead), row: gait.names.indexOf(`crl_${joint}__${side}`),
      })),
    );
  }

  /** @param {Matrix4[]} out @param {number} stature @param {number} walked in m @param {number} speed in m/s */
  frames(out, stature, walked, speed) {
    const { gait, turn, place } = this;
    const swing = Math.min(1, speed / gait.full_swing_mps);
    const share = walked / (gait.stride * stature);
    turn.fill(0);
    for (const { joint, ahead, row } of this.joints) {
      const angle = bend(gait, joint, share + ahead) * swing * RADIANS;
      turn[row] = joint === "leg" ? -angle : angle;
    }
    for (let row = 0; row < turn.length; row++) {
      const parent = gait.parents[row];
      const [x, y, z] = gait.offsets[row];
      if (parent < 0) {
        place.set([x * stature, y * stature, z * stature], row * 3);
        continue;
      }
      const c = Math.cos(turn[parent]), s = Math.sin(turn[parent]);
      place[row * 3] = place[parent * 3] + (c * x - s * z) * stature;
      place[row * 3 + 1] = place[parent * 3 + 1] + y * stature;
      place[row * 3 + 2] = place[parent * 3 + 2] + (s * x + c * z) * stature;
      turn[row] += turn[parent];
    }
    let sinks = Infinity;
    gait.feet.forEach((row, foot) => {
      sinks = Math.min(sinks, place[row * 3 + 2] - gait.standing[foot] * stature);
    });
    out[0].identity();
    this.shown.forEach((row, bone) => {
      const pitch = turn[row] / RADIANS;
      poseMatrix(out[bone + 1], place[row * 3], place[row * 3 + 1], place[row * 3 + 2] - sinks - 0.5 * stature, pitch, 0, 0);
    });
  }
}
