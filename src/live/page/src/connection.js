// The WebSocket to the server, opened again with growing pauses after it was lost.
import { FRAME, GEOMETRY, SUBPROTOCOL, kindOf, readFrame, readGeometry } from "./messages.js";

const FIRST_PAUSE_S = 0.5, LONGEST_PAUSE_S = 8.0;
/// After the server has said that it ends, or has never answered for so long, nobody is expected back [s].
const PATIENCE_S = 120;
const GOING_AWAY = 1001;

export const token = new URLSearchParams(location.search).get("token") || "";
export const withToken = (path) => `${path}?token=${encodeURIComponent(token)}`;

/// `on` has scene(scene, shapes), frame(frame), state, notice, recorded (the messages), and
/// link("connected" | "waiting" | "ended", seconds until the next attempt).
export class Connection {
  constructor(on) {
    this.on = on;
    this.pause_s = FIRST_PAUSE_S;
    this.lost_at = 0;
    this.open();
  }

  open() {
    clearTimeout(this.timer);
    const address = new URL(withToken("socket"), location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(address, SUBPROTOCOL);
    this.socket.binaryType = "arraybuffer";
    this.scene = null;
    this.shapes = null;
    this.socket.onopen = () => {
      this.pause_s = FIRST_PAUSE_S;
      this.lost_at = 0;
      this.ended = false;
      this.on.link("connected");
    };
    this.socket.onmessage = ({ data }) => this.receive(data);
    this.socket.onclose = ({ code }) => this.closed(code);
  }

  receive(data) {
    if (typeof data !== "string") return this.receiveBinary(data);
    const message = JSON.parse(data);
    if (message.type === "scene") {
      this.scene = message;
      this.shapes = null;
    } else if (["state", "notice", "recorded"].includes(message.type)) this.on[message.type](message);
  }

  receiveBinary(buffer) {
    const kind = kindOf(buffer);
    if (kind === GEOMETRY && this.scene) {
      this.shapes = readGeometry(buffer, this.scene);
      this.on.scene(this.scene, this.shapes);
    } else if (kind === FRAME && this.shapes) this.on.frame(readFrame(buffer, this.scene));
  }

  closed(code) {
    const now = performance.now() / 1000;
    this.lost_at ||= now;
    this.ended ||= code === GOING_AWAY;
    if (now - this.lost_at > PATIENCE_S) return this.on.link("ended", Infinity);
    this.on.link(this.ended ? "ended" : "waiting", this.pause_s);
    this.timer = setTimeout(() => this.open(), 1000 * this.pause_s);
    this.pause_s = Math.min(LONGEST_PAUSE_S, 2 * this.pause_s);
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
