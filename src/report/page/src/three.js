// The parts of three.js that the scripts of palpate use, as one global THREE: view.js of the report and
// viewer.js of `palpate touch` (src/live/page) share this file.  build.mjs takes their imports from it.
export {
  AmbientLight, BufferAttribute, BufferGeometry, Color, ConeGeometry, CylinderGeometry,
  DataTexture, DirectionalLight, DoubleSide, DynamicDrawUsage, FloatType, GLSL3, Group, LinearFilter, Matrix3,
  Mesh, MeshBasicMaterial, MeshLambertMaterial, NearestFilter, PerspectiveCamera, Quaternion, RGBAFormat,
  Scene, ShaderMaterial, TorusGeometry, UnsignedByteType, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
