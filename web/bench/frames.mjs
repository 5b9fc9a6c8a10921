/**
 * Frames a second while a large fleet is panned, zoomed and scrubbed.
 *
 *     node bench/frames.mjs [--vehicles N] [--seconds S] [--least F]
 *
 * The map is moved by one step in each frame for some seconds. Frames a second are what an operator
 * sees on this machine as busy as it is; CPU time per frame, of all of the browser's processes, can
 * be compared between machines that do other things besides. With `--least`, fewer frames fail.
 */

import { spawn } from "node:child_process";
import { readFile, readdir } from "node:fs/promises";
import path from "node:path";
import { launch } from "./chromium.mjs";

const options = process.argv.slice(2);
const option = (name, otherwise) => {
  const at = options.indexOf(name);
  return at < 0 ? otherwise : Number(options[at + 1]);
};
const vehicles = option("--vehicles", 1000);
const seconds = option("--seconds", 4);
const least = option("--least", 0);
const port = 8790;

const mock = spawn(process.execPath, [
  path.join(import.meta.dirname, "mock.mjs"), "--port", String(port), "--vehicles", String(vehicles),
]);
await new Promise((resolve) => mock.stdout.once("data", resolve));

const TICK = 1000 / 100; // [ms] of the kernel's clock

/** CPU time of this process's descendants so far [ms]. */
async function cpu() {
  const stats = await Promise.all(
    (await readdir("/proc")).filter((name) => /^\d+$/.test(name)).map((name) =>
      readFile(`/proc/${name}/stat`, "utf8").catch(() => null),
    ),
  );
  const rows = stats.filter((text) => text !== null).map((text) => {
    const fields = text.slice(text.lastIndexOf(")") + 2).split(" ");
    return { id: Number(text.split(" ", 1)[0]), parent: Number(fields[1]), ticks: Number(fields[11]) + Number(fields[12]) };
  });
  const family = new Set([process.pid]);
  for (let size = 0; size < family.size; ) {
    size = family.size;
    for (const row of rows) if (family.has(row.parent)) family.add(row.id);
  }
  family.delete(process.pid);
  return rows.filter((row) => family.has(row.id)).reduce((sum, row) => sum + row.ticks, 0) * TICK;
}

const GESTURES = {
  pan: "map.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, clientX: 500 + 120 * Math.sin(k / 9), clientY: 400 + 80 * Math.cos(k / 7), bubbles: true }))",
  zoom: "map.dispatchEvent(new WheelEvent('wheel', { deltaY: 60 * Math.sin(k / 12), clientX: 500, clientY: 400, bubbles: true, cancelable: true }))",
  scrub: "radmpc.seek((k * 0.07) % 20)",
};

const run = (gesture) => `new Promise((resolve) => {
  const map = document.querySelectorAll('.flat canvas')[1];
  map.setPointerCapture = () => undefined;
  const press = (type) => map.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX: 2, clientY: 2, bubbles: true }));
  if (${gesture === "pan"}) press('pointerdown');
  let k = 0;
  let slowest = 0;
  let before = performance.now();
  const start = before;
  const frame = (now) => {
    slowest = Math.max(slowest, now - before);
    before = now;
    k += 1;
    ${GESTURES[gesture]};
    if (now - start < ${1000 * seconds}) requestAnimationFrame(frame);
    else { if (${gesture === "pan"}) press('pointercancel'); resolve({ frames: k, slowest, seconds: (now - start) / 1000 }); }
  };
  requestAnimationFrame(frame);
})`;

const browser = await launch();
let isEnough = true;
try {
  const page = await browser.page({ width: 1440, height: 900 });
  await page.go(`http://127.0.0.1:${port}/#token=mock`);
  await page.until("window.radmpc !== undefined && document.querySelector('.outline li') !== null", 60);
  await page.evaluate("radmpc.plan()");
  await page.until("radmpc.tracks() > 0", 60);
  for (const gesture of Object.keys(GESTURES)) {
    const before = await cpu();
    const { frames, slowest, seconds: took } = await page.evaluate(run(gesture));
    const each = ((await cpu()) - before) / frames;
    const rate = frames / took;
    isEnough &&= rate >= least;
    console.log(
      `${gesture.padEnd(6)} ${rate.toFixed(1).padStart(5)} frames/s, slowest ${slowest.toFixed(0).padStart(4)} ms, ` +
        `${each.toFixed(1).padStart(5)} ms CPU a frame`,
    );
  }
  if (page.messages.length > 0) console.log(page.messages.join("\n"));
} finally {
  await browser.close();
  mock.kill();
}
process.exitCode = isEnough ? 0 : 1;
