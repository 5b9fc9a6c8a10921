/**
 * Builds the page: `node build.mjs [--watch] [--out DIR]`.
 *
 * Entries are `src/main.tsx`, the page; `src/space/space.ts`, scenes of three dimensions, which page
 * and notebooks load on demand as it is; and `src/widget.tsx`, the same view in notebooks, whose front
 * ends load one module and nothing beside it.
 */

import { cp, mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import * as esbuild from "esbuild";
import { notice } from "./notice.mjs";

const here = import.meta.dirname;
const isWatching = process.argv.includes("--watch");
const at = process.argv.indexOf("--out");
const bundle = at < 0 ? path.join(here, "../src/radmpc/serving/bundle") : path.resolve(process.argv[at + 1]);

/** `import("…/space/space")` stays an import of space.js, which is built once. */
const spaceApart = {
  name: "space-apart",
  setup: ({ onResolve }) =>
    onResolve({ filter: /\/space$/ }, ({ kind }) =>
      kind === "dynamic-import" ? { path: "./space.js", external: true } : undefined,
    ),
};

/** A notebook has a root of its own: the view's theme is that of its frame. */
const themeOfView = {
  name: "theme-of-view",
  setup: ({ onLoad }) =>
    onLoad({ filter: /(theme|base|panels)\.css$/ }, async ({ path: file }) => ({
      contents: (await readFile(file, "utf8")).replaceAll(":root", ".radmpc-view"),
      loader: "css",
    })),
};

const options = {
  absWorkingDir: here,
  outdir: bundle,
  bundle: true,
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
  plugins: [spaceApart],
};

const entries = [
  {
    ...options,
    entryPoints: [{ in: "src/main.tsx", out: "page" }, { in: "src/style/page.css", out: "page" }],
    splitting: true,
  },
  { ...options, entryPoints: [{ in: "src/space/space.ts", out: "space" }] },
  { ...options, entryPoints: [{ in: "src/widget.tsx", out: "widget" }] },
  { ...options, entryPoints: [{ in: "src/style/notebook.css", out: "widget" }], plugins: [themeOfView] },
];

await rm(bundle, { recursive: true, force: true });
await mkdir(bundle, { recursive: true });
await cp(path.join(here, "static"), bundle, { recursive: true });
if (isWatching) {
  for (const entry of entries) await (await esbuild.context(entry)).watch();
  console.log(`watching; writes to ${path.relative(process.cwd(), bundle)}`);
} else {
  const metafiles = (await Promise.all(entries.map((entry) => esbuild.build(entry)))).map(({ metafile }) => metafile);
  await writeFile(path.join(bundle, "NOTICE"), await notice(here, metafiles));
  const outputs = metafiles.flatMap((metafile) => Object.values(metafile.outputs));
  const total = outputs.reduce((sum, { bytes }) => sum + bytes, 0);
  console.log(`${(await readdir(bundle)).length} files, ${Math.round(total / 1000)} kB`);
}
