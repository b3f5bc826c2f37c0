// The first game pad of the standard layout (W3C Gamepad).

const DEAD = 0.12, TAKES = 0, TURNS = 4;  // the lowest button of the right hand; the left shoulder
const RUMBLE_MS = 90;

/// The force of a stick grows with the square of its way, beyond the middle where it does not rest exactly.
function shaped(value) {
  const size = Math.max(0, (Math.abs(value) - DEAD) / (1 - DEAD));
  return Math.sign(value) * size * size;
}

let wasPressed = false;

/// {left: [right, up], right: [right, up], pressed: the take button was just pressed, turns, actuator}
export function readGamePad() {
  const pad = [...navigator.getGamepads()].find((one) => one && one.connected && one.axes.length >= 4);
  if (!pad) return null;
  const [a, b, c, d] = pad.axes.map(shaped), isPressed = Boolean(pad.buttons[TAKES]?.pressed);
  const pressed = isPressed && !wasPressed;
  wasPressed = isPressed;
  return { left: [a, -b], right: [c, -d], pressed, turns: Boolean(pad.buttons[TURNS]?.pressed),
    actuator: pad.vibrationActuator };
}

let rumbled_ms = 0;

/// Rumbles with a strength from 0 to 1.
export function rumble({ actuator }, strength) {
  const now = performance.now();
  if (!actuator?.playEffect || strength < 0.02 || now - rumbled_ms < 0.8 * RUMBLE_MS) return;
  rumbled_ms = now;
  actuator.playEffect("dual-rumble", { duration: RUMBLE_MS, weakMagnitude: Math.min(1, strength),
    strongMagnitude: Math.min(1, strength * strength) }).catch(() => {});  // a pad without motors
}
