// @ts-check
/** Views: orbit, chase, driver, free, map from above, and the spectator that scripts move. */

import { Matrix4, PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { poseMatrix } from "./frames3d.js";

/** @typedef {import("./timeline.js").Pose} Pose */

export const VIEWS = ["orbit", "chase", "driver", "free", "map", "spectator"];
const UP = new Vector3(0, 1, 0);
const FLY_MPS = 25;
const EASE_1PS = 6;

export class Cameras {
  /** @param {HTMLElement} element that pointers move over */
  constructor(element) {
    this.camera = new PerspectiveCamera(60, 1, 0.2, 6000);
    this.camera.position.set(0, 60, 60);
    this.controls = new OrbitControls(this.camera, element);
    this.controls.enableDamping = true;
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.minDistance = 2;
    this.controls.maxDistance = 3500;
    this.view = "orbit";
    this.focus = new Vector3();
    this.height = 140;
    this.yaw = 0;
    this.pitch = -0.2;
    /** @type {Set<string>} */
    this.keys = new Set();
    this.matrix = new Matrix4();
    this.isFresh = true;
    this.followed = 0;
    element.addEventListener("pointermove", (event) => {
      if (this.view !== "free" || !(event.buttons & 1)) return;
      this.yaw -= event.movementX * 0.004;
      this.pitch = Math.max(-1.5, Math.min(1.5, this.pitch - event.movementY * 0.004));
    });
    element.addEventListener("wheel", (event) => {
      if (this.view === "map") this.height = Math.max(20, Math.min(4000, this.height * 1.001 ** event.deltaY));
    }, { passive: true });
  }

  /** @param {string} view */
  choose(view) {
    if (view === "free") {
      const way = this.camera.getWorldDirection(new Vector3());
      this.yaw = Math.atan2(-way.x, -way.z);
      this.pitch = Math.asin(way.y);
    }
    this.view = view;
    this.isFresh = true;
    this.controls.enabled = view === "orbit";
    this.camera.up.copy(UP);
  }

  /** Look at a place from behind and above. @param {Vector3} place @param {number} distance in m */
  lookAt(place, distance = 45) {
    this.focus.copy(place);
    this.controls.target.copy(place);
    this.camera.position.set(place.x - distance * 0.75, place.y + distance * 0.5, place.z + distance * 0.55);
    this.camera.lookAt(place);
  }

  /**
   * Move the camera for a picture. @param {number} dt in s
   * @param {Pose | null} pose of the followed actor @param {number} eye height of the driver's eyes in m
   * @param {number} ahead how far in front of the origin the driver's eyes are, in m
   * @param {Pose | null} spectator
   */
  update(dt, pose, eye, ahead, spectator) {
    const view = pose === null && (this.view === "chase" || this.view === "driver") ? "orbit" : this.view;
    this.controls.enabled = view === "orbit";
    if (view === "free") this.fly(dt);
    else if (view === "spectator" && spectator !== null) this.from(spectator, 0, 0);
    else if (view === "driver" && pose !== null) this.from(pose, eye, ahead);
    else if (view === "chase" && pose !== null) this.chase(dt, pose);
    else if (view === "map") this.above(pose);
    else this.orbit(pose);
    if (pose !== null && view !== "free") this.focus.set(pose.x, pose.z, pose.y);
    else if (view === "orbit") this.focus.copy(this.controls.target);
    else if (view !== "map") this.focus.copy(this.camera.position);
    this.isFresh = false;
  }

  /** @param {Pose | null} pose */
  orbit(pose) {
    if (pose !== null) {
      const { target } = this.controls;
      const to = new Vector3(pose.x, pose.z + 1.2, pose.y);
      const move = to.clone().sub(target);
      if (this.followed !== pose.id || move.length() > 100) {
        if (this.camera.position.distanceTo(to) > 400) this.lookAt(to);
        this.followed = pose.id;
      }
      target.add(move);
      if (move.length() < 100) this.camera.position.add(move);
    }
    this.controls.update();
  }

  /** @param {number} dt @param {Pose} pose */
  chase(dt, pose) {
    const yaw = (pose.yaw * Math.PI) / 180;
    const wanted = new Vector3(pose.x - 9 * Math.cos(yaw), pose.z + 4.2, pose.y - 9 * Math.sin(yaw));
    const jump = this.isFresh || this.camera.position.distanceTo(wanted) > 60;
    this.camera.position.lerp(wanted, jump ? 1 : 1 - Math.exp(-EASE_1PS * dt));
    this.camera.lookAt(pose.x + 4 * Math.cos(yaw), pose.z + 1.4, pose.y + 4 * Math.sin(yaw));
  }

  /** @param {Pose} pose @param {number} up in m @param {number} ahead in m */
  from(pose, up, ahead) {
    poseMatrix(this.matrix, pose.x, pose.y, pose.z, pose.pitch, pose.yaw, pose.roll);
    const eye = new Vector3(ahead, up, 0).applyMatrix4(this.matrix);
    const to = new Vector3(ahead + 10, up, 0).applyMatrix4(this.matrix);
    const top = new Vector3(0, 1, 0).transformDirection(this.matrix);
    this.camera.position.copy(eye);
    this.camera.up.copy(top);
    this.camera.lookAt(to);
  }

  /** @param {Pose | null} pose */
  above(pose) {
    if (pose !== null) this.focus.set(pose.x, pose.z, pose.y);
    this.camera.up.set(0, 0, -1);
    this.camera.position.set(this.focus.x, this.focus.y + this.height, this.focus.z);
    this.camera.lookAt(this.focus);
  }

  /** @param {number} dt */
  fly(dt) {
    const way = new Vector3(
      -Math.sin(this.yaw) * Math.cos(this.pitch), Math.sin(this.pitch), -Math.cos(this.yaw) * Math.cos(this.pitch));
    const side = new Vector3().crossVectors(way, UP).normalize();
    const step = FLY_MPS * dt * (this.keys.has("ShiftLeft") ? 5 : 1);
    const { position } = this.camera;
    if (this.keys.has("KeyW") || this.keys.has("ArrowUp")) position.addScaledVector(way, step);
    if (this.keys.has("KeyS") || this.keys.has("ArrowDown")) position.addScaledVector(way, -step);
    if (this.keys.has("KeyD") || this.keys.has("ArrowRight")) position.addScaledVector(side, step);
    if (this.keys.has("KeyA") || this.keys.has("ArrowLeft")) position.addScaledVector(side, -step);
    if (this.keys.has("KeyE")) position.y += step;
    if (this.keys.has("KeyC")) position.y -= step;
    this.camera.up.copy(UP);
    this.camera.lookAt(position.clone().add(way));
  }
}
