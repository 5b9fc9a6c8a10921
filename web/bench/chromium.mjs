/** Chromium without a window, driven through a pipe by its own protocol. */

import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";

const ARGUMENTS = [
  "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync",
  "--hide-scrollbars", "--remote-debugging-pipe",
];

/** Start a browser; `CHROMIUM` in the environment tells where it is. */
export async function launch() {
  const home = await mkdtemp(path.join(tmpdir(), "chromium-"));
  const child = spawn(process.env.CHROMIUM ?? "chromium", [...ARGUMENTS, `--user-data-dir=${home}`, "about:blank"], {
    stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
  });
  const [, , , into, out] = child.stdio;
  const waiting = new Map();
  const listeners = [];
  let last = 0;
  let text = "";
  out.setEncoding("utf8");
  out.on("data", (chunk) => {
    const parts = (text + chunk).split("\0");
    text = parts.pop();
    for (const part of parts) {
      const message = JSON.parse(part);
      if (message.id === undefined) for (const listener of listeners) listener(message);
      else {
        const { resolve, reject } = waiting.get(message.id);
        waiting.delete(message.id);
        if (message.error) reject(new Error(message.error.message));
        else resolve(message.result);
      }
    }
  });
  const send = (method, params = {}, sessionId = undefined) =>
    new Promise((resolve, reject) => {
      last += 1;
      waiting.set(last, { resolve, reject });
      into.write(`${JSON.stringify({ id: last, method, params, sessionId })}\0`);
    });
  const close = async () => {
    const gone = new Promise((resolve) => child.once("exit", resolve));
    await send("Browser.close").catch(() => child.kill());
    await gone;
    await rm(home, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 });
  };
  return { page: (options) => open(send, listeners, options), close };
}

async function open(send, listeners, { width, height, isDark = false, isTouch = false, ratio = 1 }) {
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
  const command = (method, params) => send(method, params, sessionId);
  const messages = [];
  listeners.push((message) => {
    if (message.sessionId !== sessionId) return;
    if (message.method === "Runtime.exceptionThrown") {
      const { exceptionDetails: details } = message.params;
      messages.push(details.exception?.description ?? details.text);
    }
    if (message.method === "Runtime.consoleAPICalled") {
      messages.push(message.params.args.map((each) => each.value ?? each.description).join(" "));
    }
    if (message.method === "Log.entryAdded") messages.push(message.params.entry.text);
  });
  await Promise.all([command("Page.enable"), command("Runtime.enable"), command("Log.enable")]);
  await command("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: ratio, mobile: isTouch });
  await command("Emulation.setEmulatedMedia", {
    features: [{ name: "prefers-color-scheme", value: isDark ? "dark" : "light" }],
  });
  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await command("Runtime.evaluate", {
      expression, awaitPromise: true, returnByValue: true,
    });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  return {
    messages, command, evaluate,
    go: (url) => command("Page.navigate", { url }),
    until: async (expression, seconds = 20) => {
      const end = Date.now() + seconds * 1000;
      while (!(await evaluate(expression).catch(() => false))) {
        if (Date.now() > end) throw new Error(`not within ${seconds} s: ${expression}\n${messages.join("\n")}`);
        await new Promise((resolve) => setTimeout(resolve, 50));
      }
    },
    mouse: (type, x, y, more = {}) =>
      command("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseMoved" ? 0 : 1, clickCount: 1, ...more }),
    key: async (key, more = {}) => {
      const text = key.length === 1 && !more.modifiers ? key : undefined;
      const CODES = { Enter: 13, Escape: 27, Delete: 46, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Tab: 9 };
      const code = { windowsVirtualKeyCode: CODES[key] ?? key.toUpperCase().charCodeAt(0) };
      await command("Input.dispatchKeyEvent", { type: "keyDown", key, text, ...code, ...more });
      await command("Input.dispatchKeyEvent", { type: "keyUp", key, ...code, ...more });
    },
    screenshot: async () => Buffer.from((await command("Page.captureScreenshot", { format: "png" })).data, "base64"),
  };
}
