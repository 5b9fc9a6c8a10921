/** Runs the tests of `tests/`, of what needs no browser: `node test.mjs`. */

import { spawnSync } from "node:child_process";
import { mkdtemp, readdir, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import * as esbuild from "esbuild";

const here = import.meta.dirname;
const names = (await readdir(path.join(here, "tests"))).filter((name) => name.endsWith(".test.mjs"));
const folder = await mkdtemp(path.join(tmpdir(), "page-tests-"));
try {
  await esbuild.build({
    absWorkingDir: here,
    entryPoints: names.map((name) => path.join("tests", name)),
    outdir: folder,
    outExtension: { ".js": ".mjs" },
    bundle: true,
    format: "esm",
    platform: "node",
    jsx: "automatic",
    jsxImportSource: "preact",
    logLevel: "warning",
  });
  const built = names.map((name) => path.join(folder, name));
  const { status } = spawnSync(process.execPath, ["--test", "--test-reporter=dot", ...built], { stdio: "inherit" });
  process.exitCode = status ?? 1;
} finally {
  await rm(folder, { recursive: true });
}
