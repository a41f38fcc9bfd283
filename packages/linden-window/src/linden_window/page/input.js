// @ts-check
/** Keyboard, gamepad and steering wheel of a person who drives: sent to the program as they are. */

/** Keys that work while they are down, as the program names them: basu_window.manual.inputs.Held. */
const HELD = /** @type {Record<string, string>} */ ({
  KeyW: "throttle", ArrowUp: "throttle", KeyS: "brake", ArrowDown: "brake", KeyA: "left", ArrowLeft: "left",
  KeyD: "right", ArrowRight: "right", Space: "hand_brake",
});
/** Keys that work once: basu_window.manual.inputs.Strike. */
const STRUCK = /** @type {Record<string, string>} */ ({ KeyQ: "reverse", KeyP: "autopilot", Escape: "quit" });
const EACH_MS = 33;

export class DrivingInput {
  /** @param {(order: Record<string, unknown>) => void} send */
  constructor(send) {
    this.send = send;
    this.isOn = false;
    /** @type {Set<string>} */
    this.held = new Set();
    /** @type {string[]} */
    this.strikes = [];
    this.last = "";
    addEventListener("keydown", (event) => this.key(event, true));
    addEventListener("keyup", (event) => this.key(event, false));
    addEventListener("blur", () => this.held.clear());
    setInterval(() => this.tell(), EACH_MS);
  }

  /** Return whether a key belongs to driving. @param {string} code */
  takes(code) {
    return this.isOn && (code in HELD || code in STRUCK);
  }

  /** @param {KeyboardEvent} event @param {boolean} isDown */
  key(event, isDown) {
    if (!this.isOn || event.ctrlKey || event.metaKey || event.altKey || event.target instanceof HTMLInputElement) return;
    const held = HELD[event.code];
    const struck = STRUCK[event.code];
    if (held !== undefined) {
      event.preventDefault();
      if (isDown) this.held.add(held);
      else this.held.delete(held);
    } else if (struck !== undefined && isDown && !event.repeat) {
      event.preventDefault();
      this.strikes.push(struck);
    } else return;
    this.tell();
  }

  /** Send what is held now to a program that does not know it. */
  again() {
    this.last = "";
    this.tell();
  }

  /** Send what is held now, if it has changed; a stick or a pedal changes all the time. */
  tell() {
    if (!this.isOn) return;
    const order = { order: "drive", held: [...this.held].sort(), strikes: this.strikes, pad: padOf() };
    const text = JSON.stringify(order);
    if (text === this.last && !this.strikes.length) return;
    this.last = JSON.stringify({ ...order, strikes: [] });
    this.strikes = [];
    this.send(order);
  }
}

/** Return name, axes and buttons of the first gamepad or wheel; null without one. */
function padOf() {
  const pad = navigator.getGamepads?.().find((each) => each !== null && each.connected);
  if (!pad) return null;
  const round = (/** @type {number} */ value) => Math.round(value * 100) / 100;
  return {
    name: pad.id.slice(0, 100),
    standard: pad.mapping === "standard",
    axes: pad.axes.map(round).slice(0, 16),
    buttons: pad.buttons.map((button) => round(button.value)).slice(0, 32),
  };
}
