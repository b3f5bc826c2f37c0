// npm ci && npm run build: makes dist/ from src/ and the two libraries, and ../../live/page/dist.  Only a
// maintainer who changes a file here or there needs Node; dist/ is committed, and palpate's build embeds it.
import { createHash } from "node:crypto";
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const LIVE = "../../live/page";

/// tests/report/bundle_test.py computes the same, and so finds a bundle that was not made again.
function hashOf(folder) {
  const hash = createHash("sha256");
  const sources = readdirSync(`${folder}/src`).sort().map((name) => `${folder}/src/${name}`);
  for (const name of ["build.mjs", "package-lock.json", ...sources]) hash.update(readFileSync(name));
  return hash.digest("hex");
}

const licence = (name) => readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim();
const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`)).version;
const noticesOf = (libraries) =>
  libraries.map((one) => `${one} ${version(one)}\n\n${licence(one)}`).join("\n\n");

/// three.js is one file, THREE for the scripts beside it.
const sharedThree = {
  name: "shared-three",
  setup(bundle) {
    bundle.onResolve({ filter: /^three(\/|$)/ }, () => ({ path: "three", namespace: "shared" }));
    bundle.onLoad({ filter: /^/, namespace: "shared" }, () => ({ contents: "module.exports = THREE;" }));
  },
};

async function bundle(folder, name, { libraries = [], ...more } = {}) {
  const made = `made by src/report/page/build.mjs, sources sha256 ${hashOf(folder)}`;
  const holds = libraries.length ? `\n\nThis part of the page holds ${noticesOf(libraries)}\n*/` : " */";
  await build({
    entryPoints: [`${folder}/src/${name}.js`],
    outfile: `${folder}/dist/${name}.js`,
    bundle: true, minify: true, format: "iife", target: "es2020", charset: "ascii",
    legalComments: "none",  // the banner holds the licences whole
    loader: { ".css": "text" },
    banner: { js: `/* ${made}${holds}` },
    ...more,
  });
}

await bundle(".", "page", { libraries: ["uplot"], inject: ["src/pixel_ratio.js"] });
await bundle(".", "three", { libraries: ["three"], globalName: "THREE" });
await bundle(".", "view", { plugins: [sharedThree] });
writeFileSync("dist/LICENSES.txt",
  ["uplot", "three"].map((one) => `${one} ${version(one)}\n\n${licence(one)}\n`)
    .join(`\n${"-".repeat(78)}\n\n`));

mkdirSync(`${LIVE}/dist`, { recursive: true });
await bundle(LIVE, "viewer", { plugins: [sharedThree] });
for (const name of ["viewer.html", "viewer.css"]) copyFileSync(`${LIVE}/src/${name}`, `${LIVE}/dist/${name}`);
