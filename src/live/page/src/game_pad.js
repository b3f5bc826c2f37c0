// The first game pad of the standard layout (W3C Gamepad).

/// Buttons: the lowest and the right one of the right hand, the left shoulder.
const DEAD = 0.12, TAKES = 0, CHOOSES = 1, TURNS = 4;
const RUMBLE_MS = 90;

/// The force of a stick grows with the square of its way, beyond the middle where it does not rest exactly.
function shaped(value) {
  const size = Math.max(0, (Math.abs(value) - DEAD) / (1 - DEAD));
  return Math.sign(value) * size * size;
}

let down = new Set();

/// {left: [right, up], right: [right, up], takes, chooses: whether that button was just pressed, turns,
/// actuator}
export function readGamePad() {
  const pad = [...navigator.getGamepads()].find((one) => one && one.connected && one.axes.length >= 4);
  if (!pad) return null;
  const [a, b, c, d] = pad.axes.map(shaped), before = down;
  down = new Set([TAKES, CHOOSES, TURNS].filter((one) => pad.buttons[one]?.pressed));
  const begins = (button) => down.has(button) && !before.has(button);
  return { left: [a, -b], right: [c, -d], takes: begins(TAKES), chooses: begins(CHOOSES),
    turns: down.has(TURNS), actuator: pad.vibrationActuator };
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
