// The result of a run in three dimensions: it turns, and it plays.
import {
  AmbientLight, DirectionalLight, Mesh, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { makeMotion } from "./motion.js";
import { shortNumber } from "./numbers.js";
import { makePlayer } from "./player.js";

const HEIGHT_OF_WIDTH = 0.62;

function hasWebGl() {
  const canvas = document.createElement("canvas");
  return Boolean(canvas.getContext("webgl2"));
}

function lights(scene, camera) {
  scene.add(new AmbientLight(0xffffff, 1.3));
  const lamp = new DirectionalLight(0xffffff, 2.2);
  lamp.position.set(0.4, 0.8, 1);
  camera.add(lamp);  // it stays beside the reader's eye
  scene.add(camera);
}

/// Arrow keys turn, plus and minus come closer and go back.
function turnByKeys(canvas, camera, controls, draw) {
  const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
  const scales = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 };
  canvas.addEventListener("keydown", (event) => {
    const turn = turns[event.key], scale = scales[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || !(turn || scale)) return;
    const arm = camera.position.clone().sub(controls.target);
    const radius = arm.length() * (scale || 1), [around, down] = turn || [0, 0];
    const angle = Math.atan2(arm.y, arm.x) + around;
    const polar = Math.min(Math.PI - 0.02, Math.max(0.02, Math.acos(arm.z / arm.length()) + down));
    arm.set(Math.sin(polar) * Math.cos(angle), Math.sin(polar) * Math.sin(angle), Math.cos(polar));
    camera.position.copy(controls.target).addScaledVector(arm, radius);
    controls.update();
    draw();
    event.preventDefault();
  });
}

/// What the colours mean, under the view.
function colourScale(data) {
  const scale = document.createElement("div"), bar = document.createElement("i");
  scale.className = "scale";
  bar.style.background = `linear-gradient(to right, ${data.ramp.join(", ")})`;
  const most_mm = 1000 * data.most_displacement_m;
  const free = data.parts.some((part) => part.motions) ? " without rigid motion" : "";
  scale.append(`displacement${free} [mm]: 0`, bar, shortNumber(most_mm));
  return scale;
}

function makeView(holder) {
  const data = JSON.parse(holder.querySelector("script.view-data").textContent);
  const renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "the bodies in three dimensions: drag or arrow keys turn, wheel or " +
    "plus and minus zoom, space plays");
  holder.querySelector(".stage").append(canvas);
  const scene = new Scene(), camera = new PerspectiveCamera(32, 1 / HEIGHT_OF_WIDTH, 1e-3, 1e3);
  camera.up.set(...data.up).normalize();
  camera.zoom = data.zoom;
  lights(scene, camera);
  const motion = makeMotion(data);
  for (const { geometry, material } of motion.parts) scene.add(new Mesh(geometry, material));

  const controls = new OrbitControls(camera, canvas), radius = motion.radius_m;
  controls.target.set(...(data.target_m || motion.centre_m));
  camera.position.copy(controls.target).addScaledVector(new Vector3(...data.from).normalize(), 3.1 * radius);
  camera.near = 0.01 * radius;
  camera.far = 100 * radius;
  controls.update();

  // The wheel and a finger that goes up or down scroll the page, unless the view was clicked.
  controls.enableZoom = false;
  canvas.style.touchAction = "pan-y";
  canvas.addEventListener("pointerdown", () => canvas.focus({ preventScroll: true }));
  canvas.addEventListener("focus", () => { controls.enableZoom = true; });
  canvas.addEventListener("blur", () => { controls.enableZoom = false; });

  const draw = () => renderer.render(scene, camera);
  const resize = () => {
    const width = holder.querySelector(".stage").clientWidth;
    if (width === 0) return;
    renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
    renderer.setSize(width, Math.round(HEIGHT_OF_WIDTH * width));
    camera.updateProjectionMatrix();
    draw();
  };
  controls.addEventListener("change", draw);
  turnByKeys(canvas, camera, controls, draw);
  makePlayer(holder, canvas, motion, draw);
  holder.querySelector(".player").after(colourScale(data));
  holder.hidden = false;
  new ResizeObserver(resize).observe(holder);
  resize();
}

for (const holder of document.querySelectorAll(".view")) {
  if (hasWebGl()) makeView(holder);
  else {
    holder.hidden = false;
    holder.textContent = "The view in three dimensions needs WebGL 2, which this browser does not offer.";
  }
}
