// The mission seen from above.

const scene = byId("scene");
const stage = byId("stage");
let surface = { context: scene.getContext("2d"), width: 1, height: 1, ratio: 1 };
/// Centre of the view in the world, m, and pixels per metre.
let view = { x: 0, y: 0, scale: 100 };
let fitted = true;

/// Everything that the mission touches: [x_min, y_min, x_max, y_max], m.
const bounds = (() => {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const add = (x, y, margin = 0) => {
    box[0] = Math.min(box[0], x - margin);
    box[1] = Math.min(box[1], y - margin);
    box[2] = Math.max(box[2], x + margin);
    box[3] = Math.max(box[3], y + margin);
  };
  for (const load of loads) for (let i = 0; i < count; i++) add(load.x[i], load.y[i], radiusOf(load));
  for (const robot of robots) for (let i = 0; i < count; i++) add(robot.x[i], robot.y[i], robot.radius);
  for (const robot of robots) if (robot.goal) add(robot.goal[0], robot.goal[1], robot.radius);
  for (const team of teams) {
    for (const [x, y] of team.waypoints) add(x, y, Math.max(team.tolerance, 0.2));
    for (const [x, y] of team.path) add(x, y);
  }
  for (const corners of replay.obstacles) for (const [x, y] of corners) add(x, y);
  // the map of a plan
  for (const map of [replay.walls, isPlan ? replay.workspace : null]) {
    if (!map) continue;
    add(map[0], map[1]);
    add(map[2], map[3]);
  }
  if (!(box[0] <= box[2])) add(0, 0, 1);
  const margin = 0.03 * Math.max(box[2] - box[0], box[3] - box[1]) + 0.1;
  return [box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin];
})();
{
  const aspect = (bounds[2] - bounds[0]) / (bounds[3] - bounds[1]);
  stage.style.setProperty("--aspect", Math.min(2.6, Math.max(1.35, aspect)).toFixed(3));
}

/// Pixels per metre that show everything.
function fittedScale() {
  const [x0, y0, x1, y1] = bounds;
  return Math.min(surface.width / (x1 - x0), surface.height / (y1 - y0));
}

function fitView() {
  const [x0, y0, x1, y1] = bounds;
  view = {
    x: (x0 + x1) / 2,
    y: (y0 + y1) / 2,
    scale: fittedScale(),
  };
  fitted = true;
}

function resizeStage() {
  surface = fitCanvas(scene);
  if (fitted) fitView();
}

const toScreen = (x, y) => [
  surface.width / 2 + (x - view.x) * view.scale,
  surface.height / 2 - (y - view.y) * view.scale,
];
const toWorld = (px, py) => [
  view.x + (px - surface.width / 2) / view.scale,
  view.y - (py - surface.height / 2) / view.scale,
];

function zoomAt(px, py, factor) {
  const [x, y] = toWorld(px, py);
  view.scale = Math.min(5000, Math.max(Math.min(2, fittedScale()), view.scale * factor));
  view.x = x - (px - surface.width / 2) / view.scale;
  view.y = y + (py - surface.height / 2) / view.scale;
  fitted = false;
}

function outline(points, closed = true) {
  const { context } = surface;
  context.beginPath();
  points.forEach(([x, y], i) => (i ? context.lineTo(...toScreen(x, y)) : context.moveTo(...toScreen(x, y))));
  if (closed) context.closePath();
}

function circle(x, y, radius) {
  const { context } = surface;
  context.beginPath();
  context.arc(...toScreen(x, y), radius * view.scale, 0, 2 * Math.PI);
}

/// Text with a halo in the colour of the ground.
function label(text, px, py, { color = colors.ink, size = 11, align = "center", weight = 500 } = {}) {
  const { context } = surface;
  context.font = `${weight} ${size}px ${FONT}`;
  context.textAlign = align;
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = colors.card;
  context.strokeText(text, px, py);
  context.fillStyle = color;
  context.fillText(text, px, py);
}

/// An arrow on the screen, from one pixel to another.
function arrow(px, py, qx, qy, color, width, head) {
  const { context } = surface;
  const angle = Math.atan2(qy - py, qx - px);
  const [bx, by] = [qx - head * 0.8 * Math.cos(angle), qy - head * 0.8 * Math.sin(angle)];
  context.strokeStyle = context.fillStyle = color;
  context.lineWidth = width;
  context.lineCap = "round";
  context.beginPath();
  context.moveTo(px, py);
  context.lineTo(bx, by);
  context.stroke();
  context.beginPath();
  context.moveTo(qx, qy);
  context.lineTo(qx - head * Math.cos(angle - 0.45), qy - head * Math.sin(angle - 0.45));
  context.lineTo(qx - head * Math.cos(angle + 0.45), qy - head * Math.sin(angle + 0.45));
  context.fill();
}

function drawGround() {
  const { context, width, height } = surface;
  context.fillStyle = colors.card;
  // to the end of the last pixel, which the box may cover in part
  context.fillRect(0, 0, width + 1, height + 1);
  const step = niceStep(70 / view.scale);
  const digits = digitsOf(step);
  const [x0, y1] = toWorld(0, 0);
  const [x1, y0] = toWorld(width, height);
  context.strokeStyle = colors.grid;
  context.lineWidth = 1;
  context.beginPath();
  for (let k = Math.ceil(x0 / step); k * step <= x1; k++) {
    const px = Math.round(toScreen(k * step, 0)[0]) + 0.5;
    context.moveTo(px, 0);
    context.lineTo(px, height);
  }
  for (let k = Math.ceil(y0 / step); k * step <= y1; k++) {
    const py = Math.round(toScreen(0, k * step)[1]) + 0.5;
    context.moveTo(0, py);
    context.lineTo(width, py);
  }
  context.stroke();
  return () => {
    for (let k = Math.ceil(x0 / step); k * step <= x1; k++) {
      const px = toScreen(k * step, 0)[0];
      if (px > 40 && px < width - scaleLength() - 46) label(fixed(k * step, digits), px, height - 9, { color: colors.muted, size: 10 });
    }
    for (let k = Math.ceil(y0 / step); k * step <= y1; k++) {
      const py = toScreen(0, k * step)[1];
      if (py > 50 && py < height - 24) label(fixed(k * step, digits), 5, py, { color: colors.muted, size: 10, align: "left" });
    }
  };
}

function drawSurroundings() {
  const { context } = surface;
  const rectangle = ([x0, y0, x1, y1]) => outline([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
  if (replay.workspace) {
    rectangle(replay.workspace);
    context.setLineDash([2, 5]);
    context.lineWidth = 1.5;
    context.strokeStyle = colors.muted;
    context.stroke();
    context.setLineDash([]);
  }
  if (replay.walls) {
    rectangle(replay.walls);
    context.lineWidth = 5;
    context.lineJoin = "miter";
    context.strokeStyle = colors["obstacle-line"];
    context.stroke();
  }
  for (const corners of replay.obstacles) {
    outline(corners);
    context.fillStyle = colors.obstacle;
    context.fill();
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    context.strokeStyle = colors["obstacle-line"];
    context.stroke();
  }
}

/// The load's way in points at least a centimetre apart: frame numbers.
const traces = loads.map((load) => {
  const kept = count ? [0] : [];
  for (let i = 1; i < count; i++) {
    const last = kept[kept.length - 1];
    if (Math.hypot(load.x[i] - load.x[last], load.y[i] - load.y[last]) > 0.01) kept.push(i);
  }
  return kept;
});

function drawTraces(now) {
  const { context } = surface;
  context.lineJoin = context.lineCap = "round";
  for (const team of teams) {
    const load = loads[team.load];
    if (!load || !count) continue;
    const path = team.path.length ? team.path : [[load.x[0], load.y[0]], ...team.waypoints];
    outline(path, false);
    context.setLineDash([6, 6]);
    context.lineWidth = 1.5;
    context.strokeStyle = colors["obstacle-line"];
    context.stroke();
    context.setLineDash([]);
  }
  const [frame] = frameAt(now.time);
  loads.forEach((load, index) => {
    const all = traces[index].map((i) => [load.x[i], load.y[i]]);
    context.strokeStyle = colors.trace;
    context.globalAlpha = 0.3;
    context.lineWidth = 1.5;
    outline(all, false);
    context.stroke();
    context.globalAlpha = 1;
    context.lineWidth = 2.5;
    let past = traces[index].findIndex((i) => i > frame);
    if (past < 0) past = all.length;
    outline([...all.slice(0, past), [now.loads[index].x, now.loads[index].y]], false);
    context.stroke();
  });
}

function drawWaypoints(now) {
  const { context } = surface;
  teams.forEach((team, index) => {
    team.waypoints.forEach(([x, y], i) => {
      const goal = i === team.waypoints.length - 1;
      const current = now.teams[index].waypoint;
      context.strokeStyle = context.fillStyle = colors.waypoint;
      circle(x, y, team.tolerance);
      context.globalAlpha = i === current ? 0.16 : 0.06;
      context.fill();
      context.globalAlpha = 1;
      context.lineWidth = i === current ? 2 : 1.2;
      context.setLineDash(goal ? [] : [3, 3]);
      context.stroke();
      context.setLineDash([]);
      const [px, py] = toScreen(x, y);
      if (goal) {
        context.lineWidth = 1.8;
        context.beginPath();
        context.moveTo(px, py + 2);
        context.lineTo(px, py - 16);
        context.stroke();
        context.beginPath();
        context.moveTo(px, py - 16);
        context.lineTo(px + 12, py - 12);
        context.lineTo(px, py - 8);
        context.fill();
      } else {
        context.beginPath();
        context.arc(px, py, 3, 0, 2 * Math.PI);
        if (i < current) context.fill();
        else context.stroke();
      }
      const offset = Math.max(team.tolerance * view.scale, goal ? 12 : 6) + 9;
      const name = goal ? "goal" : String(i + 1);
      label(teams.length > 1 ? `${team.id} ${name}` : name, px, py + offset, { color: colors.waypoint, size: 11 });
    });
  });
}

function drawSlots(now) {
  const { context } = surface;
  context.strokeStyle = colors.muted;
  context.lineWidth = 1;
  context.setLineDash([2, 3]);
  for (const robot of robots) {
    const pose = now.loads[teams[robot.team]?.load];
    if (!robot.slot || !pose) continue;
    const [x, y] = place(pose, robot.slot);
    circle(x, y, robot.radius);
    context.stroke();
  }
  context.setLineDash([]);
}

/// A point of a body's frame in the world.
function place({ x, y, yaw }, [u, v]) {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return [x + c * u - s * v, y + s * u + c * v];
}

function drawLoads(now) {
  const { context } = surface;
  loads.forEach((load, i) => {
    const pose = now.loads[i];
    outline(load.polygon.map((corner) => place(pose, corner)));
    context.fillStyle = colors.load;
    context.fill();
    context.lineWidth = 1.8;
    context.lineJoin = "round";
    context.strokeStyle = colors["load-line"];
    context.stroke();
    const reach = radiusOf(load) * 0.62;
    const [px, py] = toScreen(pose.x, pose.y);
    arrow(px, py, ...toScreen(...place(pose, [reach, 0])), colors["load-line"], 2, 9);
    context.beginPath();
    context.arc(px, py, 3.2, 0, 2 * Math.PI);
    context.fill();
    if (loads.length > 1) label(load.id, px, py + 13, { color: colors["load-line"], size: 11 });
  });
}

function drawRobots(now) {
  const { context } = surface;
  robots.forEach((robot, i) => {
    const pose = now.robots[i];
    const color = activityColor(pose.activity);
    const [px, py] = toScreen(pose.x, pose.y);
    const radius = Math.max(3, robot.radius * view.scale);
    // nose: where it drives to
    context.fillStyle = color;
    context.beginPath();
    for (const [angle, reach] of [[0.62, 0.98], [0, 1.5], [-0.62, 0.98]]) {
      context.lineTo(px + reach * radius * Math.cos(pose.yaw + angle), py - reach * radius * Math.sin(pose.yaw + angle));
    }
    context.fill();
    context.beginPath();
    context.arc(px, py, radius - 0.75, 0, 2 * Math.PI);
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = colors.card;
    context.stroke();
    if (pose.activity === HOLD) {
      context.beginPath();
      context.arc(px, py, radius * 0.74, 0, 2 * Math.PI);
      context.fillStyle = colors.card;
      context.fill();
    }
    if (pose.stop) {
      context.beginPath();
      context.arc(px, py, radius + 4, 0, 2 * Math.PI);
      context.strokeStyle = color;
      context.lineWidth = 2;
      context.setLineDash([4, 3]);
      context.stroke();
      context.setLineDash([]);
    }
    if (radius >= 7) {
      const size = Math.min(18, Math.max(9, radius * 0.95)) * (robot.number > 9 ? 0.8 : 1);
      context.font = `650 ${size}px ${FONT}`;
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.fillStyle = pose.activity === HOLD ? colors.ink : colors.badge;
      context.fillText(String(robot.number), px, py + 0.5);
    } else {
      label(String(robot.number), px + radius + 6, py - radius - 3, { size: 10 });
    }
  });
}

/// A panel under what does not belong to the map.
function plate(x, y, width, height) {
  const { context } = surface;
  context.beginPath();
  context.roundRect(x, y, width, height, 6);
  context.globalAlpha = 0.92;
  context.fillStyle = colors.card;
  context.fill();
  context.globalAlpha = 1;
  context.lineWidth = 1;
  context.strokeStyle = colors.line;
  context.stroke();
}

/// Of the scale bar, pixels.
const scaleLength = () => niceStep(60 / view.scale) * view.scale;

function drawScale() {
  const { context, width, height } = surface;
  const length = scaleLength();
  const step = length / view.scale;
  const [x, y] = [width - 19, height - 18];
  plate(x - length - 9, y - 22, length + 18, 30);
  context.beginPath();
  context.moveTo(x - length, y - 4);
  context.lineTo(x - length, y);
  context.lineTo(x, y);
  context.lineTo(x, y - 4);
  context.lineCap = "square";
  context.strokeStyle = colors.ink;
  context.lineWidth = 1.6;
  context.stroke();
  const unit = isGrid ? (step === 1 ? "cell" : "cells") : "m";
  label(step < 1 && !isGrid ? `${fixed(step * 100, 0)} cm` : `${fixed(step, digitsOf(step))} ${unit}`, x - length / 2, y - 11, { size: 11 });
}

function drawUphill() {
  const { context, width } = surface;
  if (Math.abs(replay.slope_deg) < 1e-9) return;
  // a negative slope rises the other way
  const angle = replay.uphill_deg / DEGREES + (replay.slope_deg < 0 ? Math.PI : 0);
  const [x, y, reach] = [width - 48, 38, 19];
  plate(x - 38, 10, 76, 70);
  const [c, s] = [reach * Math.cos(angle), -reach * Math.sin(angle)];
  arrow(x - c, y - s, x + c, y + s, colors.ink, 2.2, 10);
  label(`uphill ${fixed(Math.abs(replay.slope_deg), 1).replace(/\.0$/, "")}°`, x, y + 32, { size: 11 });
}

function drawStage(now) {
  const { context } = surface;
  // line caps and dashes of one instant must not reach the next
  context.save();
  const ticks = drawGround();
  drawSurroundings();
  if (isPlan) {
    drawWays();
    drawGoals();
    ticks();
    drawBodies(now);
  } else {
    drawTraces(now);
    drawLoads(now);
    drawWaypoints(now);
    drawSlots(now);
    ticks();
    drawRobots(now);
  }
  drawScale();
  drawUphill();
  context.restore();
}
