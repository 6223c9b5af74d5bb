// The mission or plan as data: columns decoded into typed arrays, and what is true at any time.

const byId = (id) => document.getElementById(id);
const replay = JSON.parse(byId("replay").textContent);

/// A plan has robots only, and its time runs in steps.
const isPlan = replay.kind === "plan";
const UNIT = isPlan ? "steps" : "s";
const ACTIVITIES = ["push", "prevent", "support", "reposition", "hold"];
const ACTIVITY_NAMES = ["Push", "Prevent", "Support", "Repositioning", "Hold"];
const HOLD = 4;
const PRIMITIVES = ["—", "Rotate left", "Rotate right", "Translate"];

function* varints(text) {
  const bytes = atob(text);
  let value = 0;
  let scale = 1;
  for (let i = 0; i < bytes.length; i++) {
    const byte = bytes.charCodeAt(i);
    value += (byte & 127) * scale;
    scale *= 128;
    if (byte < 128) {
      yield value;
      value = 0;
      scale = 1;
    }
  }
}

function deltas(column, count) {
  const values = new Float64Array(count);
  // one division instead of many: 12345 / 10000 is the nearest double of 1.2345, 12345 * 0.0001 is not
  const per = Math.round(1 / column.quantum);
  let sum = 0;
  let i = 0;
  for (const code of varints(column.deltas)) {
    sum += code % 2 ? -(code + 1) / 2 : code / 2;
    values[i++] = sum / per;
  }
  return values;
}

function runs(column, count) {
  const values = new Uint16Array(count);
  let length = null;
  let i = 0;
  for (const number of varints(column.runs)) {
    if (length === null) {
      length = number;
    } else {
      values.fill(number, i, i + length);
      i += length;
      length = null;
    }
  }
  return values;
}

let count = 0;
for (const _ of varints(replay.frames.time.deltas)) count++;
const times = deltas(replay.frames.time, count);
const startTime = count ? times[0] : 0;
const endTime = count ? times[count - 1] : 0;

const decode = (columns) =>
  Object.fromEntries(
    Object.entries(columns).map(([name, column]) => [name, column.runs === undefined ? deltas(column, count) : runs(column, count)]),
  );
const loads = replay.loads.map((load, i) => ({ ...load, ...decode(replay.frames.loads[i]) }));
const teams = replay.teams.map((team, i) => ({ ...team, ...decode(replay.frames.teams[i]) }));
const robots = replay.robots.map((robot, i) => {
  // robots of a plan have neither role nor speed
  const nothing = new Uint16Array(isPlan ? count : 0);
  const lacking = isPlan ? Object.fromEntries(["linear", "angular", "speed", "role", "phase", "stop"].map((name) => [name, nothing])) : {};
  const columns = { ...lacking, ...decode(replay.frames.robots[i]) };
  const activity = new Uint8Array(count);
  for (let k = 0; k < count; k++) {
    const { phase, role } = columns;
    if (replay.repositioning[phase[k]]) activity[k] = 3;
    else if (replay.phases[phase[k]] === "work" && role[k]) activity[k] = role[k] - 1;
    else activity[k] = HOLD;
  }
  // what is said about a plan counts its agents from 0
  return { ...robot, ...columns, activity, number: isPlan ? i : i + 1 };
});
const radiusOf = (load) => Math.max(0.05, ...load.polygon.map(([x, y]) => Math.hypot(x, y)));

/// Last frame at or before `time`, and how far the time has gone towards the next one, 0 to 1.
function frameAt(time) {
  let low = 0;
  let high = count - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle - 1;
  }
  const span = low + 1 < count ? times[low + 1] - times[low] : 0;
  return [low, span > 0 ? Math.min(1, Math.max(0, (time - times[low]) / span)) : 0];
}

const wrap = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

function poseAt(body, [i, share]) {
  const j = Math.min(i + 1, count - 1);
  const between = (values) => (share ? values[i] + share * (values[j] - values[i]) : values[i]);
  return { x: between(body.x), y: between(body.y), yaw: wrap(between(body.yaw)) };
}

/// Everything that is drawn at `time`.
function snapshot(time) {
  const at = frameAt(time);
  const i = at[0];
  return {
    time,
    loads: loads.map((load) => poseAt(load, at)),
    robots: robots.map((robot) => ({
      ...poseAt(robot, at),
      activity: robot.activity[i],
      role: robot.role[i] ? replay.roles[robot.role[i] - 1] : null,
      phase: replay.phases[robot.phase[i]],
      stop: robot.stop[i] === 1,
      linear: robot.linear[i],
      angular: robot.angular[i],
      speed: robot.speed[i],
    })),
    teams: teams.map((team) => ({
      primitive: team.primitive[i],
      waypoint: team.waypoint[i],
      headingError: team.heading_error[i],
      distance: team.distance[i],
    })),
  };
}

const DEGREES = 180 / Math.PI;
const words = (text) => text.replaceAll("_", " ");
const sentence = (text) => words(text).replace(/^./, (letter) => letter.toUpperCase());
/// A number with a true minus sign, and none before zero.
function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/// The nicest step (1, 2 or 5 times a power of ten) that is at least `least`.
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * ([1, 2, 5].find((k) => k * power >= least * 0.999) ?? 10);
}
const digitsOf = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));

let colors = {};
function readColors() {
  const style = getComputedStyle(document.documentElement);
  const names = "page card ink muted line grid accent push prevent support reposition hold load load-line obstacle obstacle-line trace waypoint badge conflict body-lightness";
  colors = Object.fromEntries(names.split(" ").map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}
const activityColor = (activity) => colors[ACTIVITIES[activity]];
const FONT = 'system-ui, -apple-system, "Segoe UI", "Noto Sans", "DejaVu Sans", sans-serif';

/// A canvas as large as its box, in CSS pixels whatever the screen is.
function fitCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height, ratio };
}
