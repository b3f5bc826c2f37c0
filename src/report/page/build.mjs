// npm ci && npm run build: makes dist/ from src/ and the two libraries.  Only a maintainer who changes a file
// here needs Node; dist/ is committed, and the build of palpate embeds it.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

// tests/report/bundle_test.py computes the same, and so finds a bundle that was not made again.
const hash = createHash("sha256");
const sources = readdirSync("src").sort().map((name) => `src/${name}`);
for (const name of ["build.mjs", "package-lock.json", ...sources]) hash.update(readFileSync(name));
const made = `made by src/report/page/build.mjs, sources sha256 ${hash.digest("hex")}`;

const licence = (name) => readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim();
const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`)).version;
const bundled = { page: ["uplot"], view: ["three"] };

for (const [name, libraries] of Object.entries(bundled)) {
  const notices = libraries.map((one) => `${one} ${version(one)}\n\n${licence(one)}`).join("\n\n");
  await build({
    entryPoints: [`src/${name}.js`],
    outfile: `dist/${name}.js`,
    bundle: true, minify: true, format: "iife", target: "es2020", charset: "ascii",
    legalComments: "none",  // the banner holds the licences whole
    loader: { ".css": "text" },
    inject: name === "page" ? ["src/pixel_ratio.js"] : [],
    banner: { js: `/* ${made}\n\nThis part of the page holds ${notices}\n*/` },
  });
}
const all = Object.values(bundled).flat();
writeFileSync("dist/LICENSES.txt",
  all.map((one) => `${one} ${version(one)}\n\n${licence(one)}\n`).join(`\n${"-".repeat(78)}\n\n`));
