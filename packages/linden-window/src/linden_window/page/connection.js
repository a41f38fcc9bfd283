// @ts-check
/** The WebSocket to the program: notes as JSON, frames and measurements as bytes, orders back. */

import { PANE_MAGIC } from "./panes.js";
import { Frame } from "./timeline.js";

/** @typedef {Record<string, any> & {type: string}} Note */

const AGAIN_MS = 2000;
/** Codes with which the program refuses a page: policy violation, and try again later. */
const REFUSED = [1008, 1013];

export class Connection {
  /**
   * @param {(note: Note) => void} onNote @param {(frame: Frame) => void} onFrame
   * @param {(pane: ArrayBuffer) => void} onPane @param {(sentence: string) => void} onLost @param {() => void} onOpen
   */
  constructor(onNote, onFrame, onPane, onLost, onOpen) {
    this.onNote = onNote;
    this.onFrame = onFrame;
    this.onPane = onPane;
    this.onLost = onLost;
    this.onOpen = onOpen;
    this.bytes = 0;
    this.hasEnded = false;
    this.open();
  }

  open() {
    const url = new URL("live", location.href);
    url.protocol = "ws:";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => {
      if (typeof data === "string") {
        this.bytes += data.length;
        const note = JSON.parse(data);
        this.hasEnded ||= note.type === "end";
        this.onNote(note);
      } else {
        this.bytes += data.byteLength;
        if (new DataView(data).getUint32(0, true) === PANE_MAGIC) this.onPane(data);
        else this.onFrame(new Frame(data));
      }
    };
    socket.onopen = () => this.onOpen();
    socket.onclose = ({ code, reason }) => {
      if (this.hasEnded) return;
      const isRefused = REFUSED.includes(code);
      this.onLost(isRefused ? reason : "The connection to the program is lost. This page tries to connect again.");
      if (!isRefused) setTimeout(() => this.open(), AGAIN_MS);
    };
    this.socket = socket;
  }

  /** @param {Record<string, unknown>} order */
  send(order) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(order));
  }
}
