/** Pictures of the page to look at: `node bench/shots.mjs ADDRESS FOLDER`. */

import { mkdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { launch } from "./chromium.mjs";

const [address, folder = "out/shots"] = process.argv.slice(2);
await mkdir(folder, { recursive: true });
const browser = await launch();
try {
  for (const [width, height] of [[1440, 900], [390, 844]]) {
    for (const isDark of [false, true]) {
      const page = await browser.page({ width, height, isDark, isTouch: width < 700, ratio: width < 700 ? 2 : 1 });
      await page.go(address);
      await page.until("document.querySelector('.outline li, .welcome') !== null");
      await page.evaluate("new Promise((resolve) => setTimeout(resolve, 300))");
      const name = `${width}-${isDark ? "dark" : "light"}.png`;
      await writeFile(path.join(folder, name), await page.screenshot());
      if (page.messages.length > 0) console.log(name, page.messages.join("\n"));
    }
  }
} finally {
  await browser.close();
}
