/** Scenes for the mock: views made from a document's plain data, and plans that only look like it. */

/** A fleet in rows: each vehicle crosses to a goal some way off. */
export function fleet(count) {
  const columns = Math.ceil(Math.sqrt(count));
  const vehicles = [];
  for (let i = 0; i < count; i += 1) {
    const x = 12 * (i % columns);
    const y = 12 * Math.floor(i / columns);
    const angle = i * 2.4;
    const goal = [x + 30 * Math.cos(angle), y + 30 * Math.sin(angle)];
    vehicles.push({ name: `v${i}`, start: [x, y], goal: { center: goal, half_width: 0.5 } });
  }
  const size = 12 * columns;
  const obstacles = [];
  for (let i = 0; i < 40; i += 1) {
    const x = ((i * 37) % 97) / 97;
    const y = ((i * 61) % 89) / 89;
    obstacles.push({ name: `block ${i}`, min: [x * size, y * size], max: [x * size + 9, y * size + 5] });
  }
  return {
    format: "radmpc/scenario/1", name: `fleet of ${count}`, dt: 1, horizon: 20, risk_bound: 0.05,
    workspace: { min: [-40, -40], max: [size + 40, size + 40] }, obstacles,
    defaults: { radius: 0.6, control_limit: 2 }, vehicles,
  };
}

const paths = (base, keys, axis) => keys.map((key) => [...base, ...key, axis]);

function handle(at, base, keys) {
  return { at, x: paths(base, keys, 0), y: paths(base, keys, 1), z: [] };
}

function boxHandles(box, base) {
  const corners = [["min", "min"], ["max", "min"], ["max", "max"], ["min", "max"]];
  const middle = [(box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2];
  return [
    handle(middle, base, [["min"], ["max"]]),
    ...corners.map(([x, y]) => ({
      at: [box[x][0], box[y][1]], x: [[...base, x, 0]], y: [[...base, y, 1]], z: [],
    })),
  ];
}

function goalView(goal, path, label) {
  if (goal.center === undefined) {
    return { box: goal, path, label, handles: boxHandles(goal, path) };
  }
  const half = goal.half_width ?? 0;
  const box = { min: goal.center.map((c) => c - half), max: goal.center.map((c) => c + half) };
  return { box, path, label, handles: [handle(goal.center, path, [["center"]])] };
}

function obstacleView(obstacle, i, horizon) {
  const path = ["obstacles", i];
  const view = {
    name: obstacle.name, path, kind: "polygon", rings: [], corners: [], triangles: [],
    moving: null, uncertain: null, only: null, handles: [],
  };
  if (obstacle.min !== undefined) {
    const { min, max } = obstacle;
    const ring = [min, [max[0], min[1]], max, [min[0], max[1]]];
    return { ...view, rings: [ring], handles: boxHandles(obstacle, path) };
  }
  if (obstacle.moving !== undefined) return movingView(view, obstacle.moving, horizon);
  const key = obstacle.line === undefined ? "vertices" : "line";
  const holes = obstacle.holes ?? [];
  const outlines = [[[key], obstacle[key]], ...holes.map((hole, k) => [["holes", k], hole])];
  const all = outlines.flatMap(([at, ring]) => ring.map((_, k) => [...at, k]));
  const corners = outlines.flatMap(([at, ring]) =>
    ring.map((corner, k) => handle(corner, path, [[...at, k]])),
  );
  const first = outlines[0][1];
  const middle = [0, 1].map((axis) => first.reduce((sum, c) => sum + c[axis], 0) / first.length);
  return {
    ...view, kind: key === "line" ? "line" : "polygon", rings: outlines.map(([, ring]) => ring),
    handles: [handle(middle, path, all), ...corners],
  };
}

function movingView(view, moving, horizon) {
  const steps = Array.from({ length: horizon + 1 }, (_, k) => k);
  const [x, y, vx, vy] = moving.start;
  const ring = moving.outline.map((c) => [c[0] + x, c[1] + y]);
  return {
    ...view, rings: [ring],
    moving: steps.map((k) => ring.map(() => [k * vx, k * vy])),
    uncertain: steps.map((k) => ({ axes: [0.3 + 0.08 * k, 0.2 + 0.02 * k], angle: 0.3, rotation: null })),
    handles: [handle([x, y], view.path, [["moving", "start"]])],
  };
}

/** The view of a document. */
export function scenarioView(content) {
  const vehicles = content.vehicles.map((own, i) => {
    const vehicle = { ...content.defaults, ...own };
    const path = ["vehicles", i];
    return {
      name: vehicle.name, path, radius: vehicle.radius, start: vehicle.start.slice(0, 2),
      startHandle: handle(vehicle.start, path, [["start"]]),
      goal: goalView(vehicle.goal, [...path, "goal"], `goal of ${vehicle.name}`),
      via: (vehicle.via ?? []).map((via, k) => goalView(via, [...path, "via", k], `visit ${k + 1}`)),
    };
  });
  const obstacles = (content.obstacles ?? []).map((each, i) => obstacleView(each, i, content.horizon));
  const places = [
    ...(content.workspace ? [content.workspace.min, content.workspace.max] : []),
    ...vehicles.flatMap((vehicle) => [vehicle.start, vehicle.goal.box.min, vehicle.goal.box.max]),
    ...obstacles.flatMap((obstacle) => obstacle.rings.flat()),
  ];
  if (places.length === 0) places.push([0, 0], [20, 20]);
  const extent = {
    min: [0, 1].map((axis) => Math.min(...places.map((place) => place[axis]))),
    max: [0, 1].map((axis) => Math.max(...places.map((place) => place[axis]))),
  };
  return {
    name: content.name, dimension: 2, dt: content.dt, horizon: content.horizon,
    riskBound: content.risk_bound, avoidance: content.avoidance ?? "intervals",
    workspace: content.workspace ?? null,
    workspaceHandles: content.workspace ? boxHandles(content.workspace, ["workspace"]) : [],
    vehicles, obstacles, ranges: [], extent,
  };
}

const PER_STEP = 4;

/** A plan along smooth curves, of which nobody certified anything. */
export function planView(plan, content, revision) {
  const scenario = scenarioView(content);
  const { horizon } = scenario;
  const tracks = scenario.vehicles.map((vehicle, i) => {
    const { min, max } = vehicle.goal.box;
    const end = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2];
    const bend = ((i % 5) - 2) * 0.12;
    const at = (s) => {
      const share = s * s * s * (10 - 15 * s + 6 * s * s);
      const side = bend * Math.sin(Math.PI * share);
      const [dx, dy] = [end[0] - vehicle.start[0], end[1] - vehicle.start[1]];
      return [vehicle.start[0] + share * dx - side * dy, vehicle.start[1] + share * dy + side * dx];
    };
    const count = horizon * PER_STEP;
    return {
      name: vehicle.name,
      path: Array.from({ length: count + 1 }, (_, k) => at(k / count)),
      ellipses: Array.from({ length: horizon + 1 }, (_, k) => ({
        axes: [0.05 + 0.02 * k, 0.05 + 0.012 * k], angle: i * 0.7, rotation: null,
      })),
      speed: Array.from({ length: horizon + 1 }, (_, k) => Math.sin((Math.PI * k) / horizon)),
    };
  });
  const ledger = scenario.vehicles.slice(0, 12).map((vehicle, i) => ({
    cause: ["pair", "obstacle", "workspace"][i % 3], vehicle: vehicle.name,
    other: i % 3 === 2 ? null : (scenario.obstacles[0]?.name ?? null), step: 1 + (i % horizon),
    risk: scenario.riskBound * 0.04 * (1 + (i % 5)), at: tracks[i].path[PER_STEP * (1 + (i % horizon))],
  }));
  const spent = ledger.reduce((sum, line) => sum + line.risk, 0);
  const summary = {
    plan, revision, planner: "certified", status: "feasible", riskBound: scenario.riskBound,
    cost: 12.3 - Number(plan.slice(1)) * 0.2, bound: 9.9, certified: spent, holds: true, seconds: 1.5,
    price: -4.2, explanation: null,
  };
  return {
    plan, summary, scenario, perStep: PER_STEP, tracks, ledger, left: scenario.riskBound - spent,
    saturation: 1e-6, sets: [], couplings: [], sigmas: 3, level: 0.989,
    report: ["Feasible.", "Made up: this is the mock."], remarks: [],
  };
}
