// Colours of displacement, from a body at rest to the end of the range: kRamp of src/core/object_colours.h,
// the same in pictures and movies (tests/live/page/sources_test.py compares).
import { DataTexture, LinearFilter, RGBAFormat, UnsignedByteType, Vector3 } from "three";

export const RAMP = [
  "#d8d2c6", "#d4c7af", "#d1bc98", "#d0b080", "#cfa366", "#d0944c", "#d18534", "#d1741c", "#d16106",
  "#cd4f04", "#c73e10", "#bf2d1d", "#b41c28", "#a61133", "#960f3b", "#851040", "#731443"];

const channelsOf = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

/// A colour as the screen has it, each channel from 0 to 1.
export const screenColour = (hex) => new Vector3(...channelsOf(hex)).divideScalar(255);

export function rampTexture() {
  const data = Uint8Array.from(RAMP.flatMap((hex) => [...channelsOf(hex), 255]));
  const texture = new DataTexture(data, RAMP.length, 1, RGBAFormat, UnsignedByteType);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
