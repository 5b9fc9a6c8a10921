/**
 * Builds the page: `node build.mjs [--watch] [--out DIR]`.
 *
 * Entries are `src/main.tsx`, the page, and `src/widget.ts`, the same view in notebooks; what is
 * loaded on demand becomes a chunk of its own.
 */

import { cp, mkdir, readdir, rm } from "node:fs/promises";
import { existsSync } from "node:fs";
import path from "node:path";
import * as esbuild from "esbuild";

const here = import.meta.dirname;
const isWatching = process.argv.includes("--watch");
const at = process.argv.indexOf("--out");
const bundle = at < 0 ? path.join(here, "../src/radmpc/serving/bundle") : path.resolve(process.argv[at + 1]);

const options = {
  absWorkingDir: here,
  entryPoints: [{ in: "src/main.tsx", out: "page" }, { in: "src/style/page.css", out: "page" }],
  outdir: bundle,
  bundle: true,
  splitting: true,
  format: "esm",
  target: "es2022",
  jsx: "automatic",
  jsxImportSource: "preact",
  minify: !isWatching,
  sourcemap: isWatching ? "inline" : false,
  legalComments: "none",
  chunkNames: "chunk-[hash]",
  logLevel: "warning",
  metafile: true,
};

// A notebook's front end loads one module and nothing beside it.
const widget = { ...options, entryPoints: [{ in: "src/widget.ts", out: "widget" }], splitting: false };

await rm(bundle, { recursive: true, force: true });
await mkdir(bundle, { recursive: true });
await cp(path.join(here, "static"), bundle, { recursive: true });
const entries = existsSync(path.join(here, "src/widget.ts")) ? [options, widget] : [options];
if (isWatching) {
  for (const entry of entries) await (await esbuild.context(entry)).watch();
  console.log(`watching; writes to ${path.relative(process.cwd(), bundle)}`);
} else {
  const results = await Promise.all(entries.map((entry) => esbuild.build(entry)));
  const bytes = results.flatMap((result) => Object.values(result.metafile.outputs));
  const total = bytes.reduce((sum, output) => sum + output.bytes, 0);
  console.log(`${(await readdir(bundle)).length} files, ${Math.round(total / 1000)} kB`);
}
