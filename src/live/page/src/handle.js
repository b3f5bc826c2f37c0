// The target of the chosen hand's handle, moved by whatever device the page has, and sent to the server while
// the handles are held.
import { Quaternion, Vector3 } from "three";

/// At most 125 messages per second; the server accepts 240.
const PERIOD_MS = 8;

export class Handle {
  constructor(send) {
    this.send = send;
    this.holder = "nobody";
    this.hand = 0;  // -1: the scene has none
    this.hands = [];
    this.position = new Vector3();
    this.rotation = new Quaternion();
    this.known = false;  // whether position and rotation are those of the scene's handle
    this.wanted = false;  // asked for, not yet granted
    this.sent_ms = 0;
  }

  /// Whether the viewer holds the handles and may move the chosen one.
  get held() { return this.holder === "you" && this.canMove; }

  /// Whether the page may move the chosen hand: otherwise a device does, or there is none.
  get canMove() { return this.hands[this.hand]?.live === true; }

  /// Sets what the handles can do; the chosen hand remains where it can be moved.
  setHands(hands) {
    this.hands = hands;
    this.known = this.wanted = false;
    if (!this.canMove) this.hand = hands.findIndex((one) => one.live);
  }

  choose(hand) {
    if (hand === this.hand || !this.hands[hand]) return;
    this.hand = hand;
    this.known = false;  // its handle stays where it is
  }

  /// The server's pose, which the target starts from.
  follow(frame) {
    this.now = frame.hands[this.hand];
    if (this.now && !(this.held && this.known) && !this.wanted) this.adopt();
  }

  adopt() {
    const [x, y, z, w, i, j, k] = this.now.pose;
    this.position.set(x, y, z);
    this.rotation.set(i, j, k, w);
    this.known = true;
  }

  take() {
    if (!this.canMove || this.holder !== "nobody") return;
    this.wanted = true;
    this.send({ type: "take" });
  }

  drop() {
    this.wanted = false;
    this.send({ type: "drop" });
  }

  setHolder(holder) {
    const granted = holder === "you" && this.holder !== "you";
    this.holder = holder;
    if (holder !== "nobody") this.wanted = false;
    if (granted) this.sendPose();
  }

  moveBy(vector) {
    this.position.add(vector);
    const space = this.hands[this.hand]?.workspace;
    if (space) {
      const centre = new Vector3(...space.center), out = this.position.clone().sub(centre);
      if (out.length() > space.radius) this.position.copy(centre).add(out.setLength(space.radius));
    }
    this.changed();
  }

  turnBy(axis, angle) {
    this.rotation.premultiply(new Quaternion().setFromAxisAngle(axis, angle)).normalize();
    this.changed();
  }

  changed() {
    if (!this.held || this.timer) return;
    const wait = this.sent_ms + PERIOD_MS - performance.now();
    if (wait <= 0) this.sendPose();
    else this.timer = setTimeout(() => this.sendPose(), wait);
  }

  sendPose() {
    clearTimeout(this.timer);
    this.timer = 0;
    if (!this.held || !this.known) return;
    this.sent_ms = performance.now();
    const { x, y, z } = this.position, { x: i, y: j, z: k, w } = this.rotation;
    this.send({ type: "handle", hand: this.hand, position: [x, y, z], rotation: [w, i, j, k], switches: 0 });
  }
}
