// The view: it turns about a point, with the scene's up direction upright.
import { PerspectiveCamera, Vector3 } from "three";

const OPENING_DEG = 32, STEEPEST = 1.5;
/// First view: from the side of the approach, so that a drag presses, and a little from above.
const FIRST_TURN = 1.0, FIRST_ELEVATION = 0.22;

export class Camera {
  constructor() {
    this.lens = new PerspectiveCamera(OPENING_DEG, 1, 1e-3, 1e3);
    this.target = new Vector3();
    this.radius_m = 1;  // of the sphere that fills the view
    this.azimuth = 0;
    this.elevation = FIRST_ELEVATION;
    this.setUp(new Vector3(0, 0, 1));
  }

  setUp(up) {
    this.up = up.clone().normalize();
    const other = Math.abs(this.up.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
    this.east = other.addScaledVector(this.up, -other.dot(this.up)).normalize();
    this.north = this.up.clone().cross(this.east);
    this.lens.up.copy(this.up);
  }

  /// Looks at a sphere of `radius_m` about `target`, obliquely along `approach` where that is not vertical.
  lookAt(target, radius_m, approach) {
    this.target.copy(target);
    this.radius_m = radius_m;
    const east = approach.dot(this.east), north = approach.dot(this.north);
    this.azimuth = (Math.hypot(east, north) > 0.3 ? Math.atan2(-north, -east) : -0.6 * Math.PI) + FIRST_TURN;
    this.elevation = FIRST_ELEVATION;
    this.update();
  }

  update() {
    const { lens } = this, flat = Math.cos(this.elevation);
    const out = this.up.clone().multiplyScalar(Math.sin(this.elevation))
      .addScaledVector(this.east, flat * Math.cos(this.azimuth))
      .addScaledVector(this.north, flat * Math.sin(this.azimuth));
    const half = Math.tan((OPENING_DEG * Math.PI) / 360) * Math.min(1, lens.aspect);
    const distance = this.radius_m / Math.sin(Math.atan(half));
    lens.position.copy(this.target).addScaledVector(out, distance);
    lens.near = Math.max(1e-4, 0.02 * distance);
    lens.far = 60 * distance;
    lens.lookAt(this.target);
    lens.updateProjectionMatrix();
    lens.updateMatrixWorld();
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    this.lens.aspect = width / height;
    this.update();
  }

  orbit(right, down) {
    this.azimuth -= right;
    this.elevation = Math.min(STEEPEST, Math.max(-STEEPEST, this.elevation + down));
    this.update();
  }

  zoom(factor) {
    this.radius_m *= factor;
    this.update();
  }

  pan(right_px, down_px) {
    const { right, up } = this.axes(), size = this.metresPerPixel(this.target);
    this.target.addScaledVector(right, -size * right_px).addScaledVector(up, size * down_px);
    this.update();
  }

  /// Unit vectors of the screen in the world; `into` points away from the eye.
  axes() {
    const { matrixWorld } = this.lens;
    const [right, up, back] = [0, 1, 2].map((k) => new Vector3().setFromMatrixColumn(matrixWorld, k));
    return { right, up, into: back.negate() };
  }

  /// Size of a pixel in the plane of the view through a point.
  metresPerPixel(point) {
    const depth = Math.max(this.lens.near, point.clone().sub(this.lens.position).dot(this.axes().into));
    return (2 * depth * Math.tan((OPENING_DEG * Math.PI) / 360)) / this.height;
  }

  /// Where a point appears, in pixels from the view's top left corner.
  onScreen(point) {
    const seen = point.clone().project(this.lens);
    return { x: (0.5 + 0.5 * seen.x) * this.width, y: (0.5 - 0.5 * seen.y) * this.height };
  }
}
