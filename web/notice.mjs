/**
 * What the bundle holds of others, with their licenses: a bundle carries no package folders, so that
 * their notices must come along in a file of their own.
 */

import { readdir, readFile } from "node:fs/promises";
import path from "node:path";

/** Licenses that ask for nothing but their notice. */
const ALLOWED = new Set(["MIT", "ISC", "BSD-2-Clause", "BSD-3-Clause", "Apache-2.0", "0BSD"]);

/** The text of NOTICE, of the metafiles of all builds. */
export async function notice(here, metafiles) {
  const folders = new Set(metafiles.flatMap(({ outputs }) => Object.values(outputs)).flatMap(packages));
  const parts = await Promise.all([...folders].sort().map((folder) => part(path.join(here, folder))));
  const head = "The page of radmpc holds parts of these packages.\n";
  return [head, ...parts].join(`\n${"-".repeat(78)}\n\n`);
}

/** Folders of the packages that something of is in an output. */
function packages({ inputs }) {
  return Object.entries(inputs)
    .filter(([, { bytesInOutput }]) => bytesInOutput > 0)
    .map(([file]) => /^.*node_modules\/(?:@[^/]+\/)?[^/]+/u.exec(file)?.[0])
    .filter((folder) => folder !== undefined);
}

async function part(folder) {
  const { name, version, license } = JSON.parse(await readFile(path.join(folder, "package.json"), "utf8"));
  if (!ALLOWED.has(license)) throw new Error(`${name} ${version}: license ${license} is not one of ours`);
  const file = (await readdir(folder)).find((candidate) => /^licen[cs]e/iu.test(candidate));
  if (file === undefined) throw new Error(`${name} ${version}: no file with its license`);
  const text = await readFile(path.join(folder, file), "utf8");
  return `${name} ${version}: ${license}\n\n${text.trim()}\n`;
}
