/**
 * A stand-in for the server: `node bench/mock.mjs [--port P] [--vehicles N] [SCENARIO.json]`.
 *
 * It keeps documents and changes them as the server does, and draws up plans out of thin air, so
 * that the page can be looked at and measured without a planner. It has no security whatever.
 */

import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { planView, scenarioView, fleet } from "./scenes.mjs";
import { accept } from "./socket.mjs";

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const bundle = path.join(import.meta.dirname, "../../src/radmpc/serving/bundle");

const documents = new Map();
const plans = new Map();

function add(content) {
  const id = `d${documents.size + 1}`;
  documents.set(id, { id, past: [], content, future: [], revision: 1, plans: [], searches: [] });
  return id;
}

function state(doc) {
  const { content } = doc;
  const remarks = (content.vehicles ?? []).flatMap((vehicle, i) =>
    (vehicle.radius ?? content.defaults?.radius ?? 0) > 0
      ? []
      : [{
          severity: "error", text: `vehicles[${i}].radius: must be > 0 m, got ${vehicle.radius}`,
          path: ["vehicles", i, "radius"], vehicles: [vehicle.name], at: null,
          cures: [{ label: "Radius 0.5 m", changes: [{ path: ["vehicles", i, "radius"], value: 0.5 }] }],
        }],
  );
  return {
    document: doc.id, revision: doc.revision, content, view: scenarioView(content), remarks,
    canUndo: doc.past.length > 0, canRedo: doc.future.length > 0, file: "mock.yaml",
    isSaved: doc.past.length === 0, plans: doc.plans.map((plan) => plans.get(plan).summary),
    searches: doc.searches, flights: [],
  };
}

function changed(content, changes) {
  const copy = structuredClone(content);
  for (const { path: at, value } of changes) {
    const parent = at.slice(0, -1).reduce((node, key) => (node[key] ??= {}), copy);
    const key = at.at(-1);
    if (value !== undefined) parent[key] = value;
    else if (Array.isArray(parent)) parent.splice(key, 1);
    else delete parent[key];
  }
  return copy;
}

function newest(args) {
  const doc = documents.get(args.document);
  if (args.revision !== undefined && args.revision !== doc.revision) {
    throw { kind: "stale", text: "changed elsewhere", path: null };
  }
  return doc;
}

function step(doc, from, to) {
  to.push(doc.content);
  doc.content = from.pop();
  doc.revision += 1;
  return state(doc);
}

function plan(args, send) {
  const doc = newest(args);
  const search = {
    search: `s${Date.now()}`, document: doc.id, revision: doc.revision, planner: args.planner,
    state: "running", seconds: 0, limit: args.seconds, stage: "sets", cost: null, bound: null, gap: null,
    found: 0, note: null,
  };
  doc.searches = [search];
  const timer = setInterval(() => {
    const id = `p${plans.size + 1}`;
    const view = planView(id, doc.content, doc.revision);
    plans.set(id, view);
    doc.plans.push(id);
    const found = search.found + 1;
    Object.assign(search, {
      seconds: found * 0.4, cost: view.summary.cost, bound: 9.9, gap: view.summary.cost / 9.9 - 1, found,
      state: found < 3 ? "running" : "ended", note: found < 3 ? null : "Made up: this is the mock.",
    });
    send({ event: "plan", document: doc.id, summary: view.summary, search: search.search });
    send({ event: "search", state: { ...search } });
    if (found === 3) clearInterval(timer);
  }, 400);
  return { ...search };
}

const calls = {
  hello: () => ({
    version: "0", planners: [{ name: "certified", text: "with a gap" }, { name: "uniform", text: "equal shares" }],
    exports: [], folder: "mock", document: "d1",
    templates: [{ name: "harbor", text: "Five vehicles in a harbor" }, { name: "in-space", text: "Four drones in space" }],
    documents: [...documents.values()].map((doc) => ({ document: doc.id, name: doc.content.name })),
  }),
  files: () => [
    { path: "harbor.yaml", kind: "scenario", bytes: 2310 },
    { path: "charts/coast.geojson", kind: "chart", bytes: 81212 },
    { path: "harbor.plan.json", kind: "plan", bytes: 18112 },
  ],
  state: (args) => state(newest(args)),
  new: () => state(documents.get(add({
    format: "radmpc/scenario/1", name: "unnamed", dt: 1, horizon: 12, risk_bound: 0.05,
    workspace: { min: [0, 0], max: [24, 16] }, vehicles: [],
  }))),
  open: () => state(documents.get("d1")),
  drop: (args) => state(documents.get(add(JSON.parse(args.content)))),
  change: (args) => {
    const doc = newest(args);
    const content = changed(doc.content, args.changes);
    scenarioView(content);
    doc.past.push(doc.content);
    doc.future = [];
    Object.assign(doc, { content, revision: doc.revision + 1 });
    return state(doc);
  },
  undo: (args) => step(newest(args), newest(args).past, newest(args).future),
  redo: (args) => step(newest(args), newest(args).future, newest(args).past),
  save: (args) => ({ ...state(newest(args)), isSaved: true }),
  view: (args) => plans.get(args.plan),
  plan,
};

const options = process.argv.slice(2);
const option = (name, otherwise) => {
  const at = options.indexOf(name);
  return at < 0 ? otherwise : options.splice(at, 2)[1];
};
const port = Number(option("--port", "8765"));
const vehicles = Number(option("--vehicles", "64"));
add(options[0] === undefined ? fleet(vehicles) : JSON.parse(await readFile(options[0], "utf8")));

const server = createServer((request, response) => {
  const name = new URL(request.url, "http://localhost").pathname.slice(1) || "index.html";
  readFile(path.join(bundle, path.basename(name))).then(
    (content) => response.writeHead(200, { "content-type": TYPES[path.extname(name)] ?? "" }).end(content),
    () => response.writeHead(404).end(),
  );
});
server.on("upgrade", (request, socket) => {
  accept(request, socket, (text, send) => {
    const { id, call, args } = JSON.parse(text);
    try {
      send({ id, result: calls[call](args, send) ?? null });
    } catch (error) {
      const failure = error.kind ? error : { kind: "refused", text: `mock: ${call}: ${error.message}`, path: null };
      send({ id, failure });
    }
  });
});
server.listen(port, "127.0.0.1", () => console.log(`http://127.0.0.1:${port}/#token=mock`));
