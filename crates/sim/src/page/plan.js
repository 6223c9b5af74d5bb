// What a page shows of a plan and a mission does not have: bodies of every colour, goals, ways, violations.

const isGrid = replay.world === "grid";
const ARRIVED = 0;
const WAITING = 1;
const DRIVING = 2;
const MOVES = ["arrived", "waiting", "driving"];
/// A violation is shown from this long before it to as long after it, steps.
const CONFLICT_SPAN = 1;

/// What each robot does from each frame to the next.
const moves = !isPlan ? [] : robots.map((robot) => {
  const values = new Uint8Array(count).fill(ARRIVED);
  const isSame = (i) => robot.x[i] === robot.x[i + 1] && robot.y[i] === robot.y[i + 1] && robot.yaw[i] === robot.yaw[i + 1];
  let hasArrived = true;
  for (let i = count - 2; i >= 0; i--) {
    if (!isSame(i)) {
      values[i] = DRIVING;
      hasArrived = false;
    } else if (!hasArrived) values[i] = WAITING;
  }
  return values;
});
const underway = new Float64Array(count);
for (const values of moves) values.forEach((move, i) => (underway[i] += move === ARRIVED ? 0 : 1));

/// The ways, corner by corner: frame numbers.
const ways = !isPlan ? [] : robots.map(({ x, y }) => {
  const kept = [];
  for (let i = 0; i < count; i++) {
    const b = kept[kept.length - 1];
    const a = kept[kept.length - 2];
    if (b !== undefined && x[i] === x[b] && y[i] === y[b]) continue;
    // a point on a straight way says nothing
    if (a !== undefined) {
      const [ux, uy, vx, vy] = [x[b] - x[a], y[b] - y[a], x[i] - x[b], y[i] - y[b]];
      if (Math.abs(ux * vy - uy * vx) < 1e-9 && ux * vx + uy * vy > 0) kept.pop();
    }
    kept.push(i);
  }
  return kept;
});

/// Hues that lie far apart for neighbours in number, none of them the red of violations; the drawing has the same.
const hueOf = (i) => 25 + 310 * ((0.58 + 0.61803398875 * i) % 1);
const robotColor = (i) => `hsl(${hueOf(i).toFixed(1)} 62% ${colors["body-lightness"]})`;

const conflictsAt = (time) => replay.conflicts.filter((conflict) => Math.abs(conflict.time - time) <= CONFLICT_SPAN);
const robotsIn = (conflicts) => new Set(conflicts.flatMap((conflict) => conflict.robots));

function drawWays() {
  const { context } = surface;
  context.lineJoin = context.lineCap = "round";
  context.lineWidth = 1.5;
  context.globalAlpha = robots.length > 40 ? 0.35 : 0.5;
  robots.forEach((robot, k) => {
    outline(ways[k].map((i) => [robot.x[i], robot.y[i]]), false);
    context.strokeStyle = robotColor(k);
    context.stroke();
  });
  context.globalAlpha = 1;
}

function drawGoals() {
  const { context } = surface;
  context.lineWidth = 1.6;
  context.setLineDash([4, 2.5]);
  robots.forEach((robot, k) => {
    if (!robot.goal) return;
    const [x, y, yaw] = robot.goal;
    outline(robot.polygon.map((corner) => place({ x, y, yaw }, corner)));
    context.strokeStyle = robotColor(k);
    context.stroke();
  });
  context.setLineDash([]);
}

function drawBodies(now) {
  const { context } = surface;
  const conflicts = conflictsAt(now.time);
  const wrong = robotsIn(conflicts);
  robots.forEach((robot, k) => {
    const pose = now.robots[k];
    const at = (corner) => place(pose, corner);
    outline(robot.polygon.map(at));
    context.fillStyle = wrong.has(k) ? colors.conflict : robotColor(k);
    context.fill();
    context.lineWidth = 1;
    context.strokeStyle = colors.card;
    context.stroke();
    const [front, side] = [0, 1].map((axis) => Math.max(0, ...robot.polygon.map((corner) => corner[axis])));
    if (!isGrid && side * view.scale > 4) {
      outline([[0.5 * front, -0.75 * side], [0.9 * front, 0], [0.5 * front, 0.75 * side]].map(at), false);
      context.lineWidth = 1.6;
      context.stroke();
    }
    const size = Math.min(15, side * view.scale * 1.1);
    if (size >= 8) {
      const [px, py] = toScreen(...at([isGrid ? 0 : 0.1 * front, 0]));
      context.font = `650 ${robot.number > 99 ? size * 0.7 : size}px ${FONT}`;
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.fillStyle = colors.badge;
      context.fillText(String(robot.number), px, py + 0.5);
    }
  });
  for (const conflict of conflicts) {
    const poses = conflict.robots.map((k) => now.robots[k]).filter(Boolean);
    if (!poses.length) continue;
    const [x, y] = ["x", "y"].map((axis) => poses.reduce((sum, pose) => sum + pose[axis], 0) / poses.length);
    const reach = Math.max(...poses.map((pose) => Math.hypot(pose.x - x, pose.y - y)));
    circle(x, y, reach + robots[conflict.robots[0]].radius + 5 / view.scale);
    context.lineWidth = 2.2;
    context.strokeStyle = colors.conflict;
    context.stroke();
  }
}

function planLayout() {
  const { height } = chartSurface;
  const gap = 26;
  const stripes = Math.min(22 * robots.length, Math.max(0.6 * height, 40));
  const plot = Math.max(50, height - stripes - 3 * gap);
  const top = gap + plot + gap;
  const barHeight = Math.max(1, (height - top - gap) / Math.max(1, robots.length));
  const line = { title: `${isGrid ? "Agents" : "Robots"} on their way`, kind: "line", columns: [underway], factor: 1 };
  return [
    { ...line, ...limits([underway], 1, 1, true), top: gap, bottom: gap + plot },
    { title: "Driving (full), waiting (light), violations (red)", kind: "roles", top, bottom: top + robots.length * barHeight, barHeight },
  ];
}

/// One stripe for each robot.
function drawMoves(context, row) {
  moves.forEach((values, k) => {
    const y = row.top + k * row.barHeight;
    const height = Math.max(0.8, row.barHeight - (row.barHeight > 3 ? 1 : 0));
    context.fillStyle = robotColor(k);
    for (let i = 0; i < count; ) {
      const start = i;
      while (i < count && values[i] === values[start]) i++;
      if (values[start] === ARRIVED) continue;
      const from = timeToPixel(times[start]);
      context.globalAlpha = values[start] === DRIVING ? 1 : 0.3;
      context.fillRect(from, y, Math.max(0.6, timeToPixel(i < count ? times[i] : endTime) - from), height);
    }
    context.globalAlpha = 1;
    if (row.barHeight >= 9) plotText(context, String(robots[k].number), GUTTER - 6, y + row.barHeight / 2, "right", colors.muted, 400, 9);
  });
  context.fillStyle = colors.conflict;
  for (const conflict of replay.conflicts) {
    for (const k of conflict.robots) {
      context.fillRect(timeToPixel(conflict.time) - 1.5, row.top + k * row.barHeight, 3, Math.max(2, row.barHeight));
    }
  }
}

/// What is written above the plots.
const planFields = !isPlan ? null : (() => {
  const row = document.createElement("div");
  row.className = "team";
  const fields = {};
  for (const name of ["Driving", "Waiting", "Arrived", "In violations"]) {
    const box = document.createElement("div");
    const caption = document.createElement("small");
    caption.textContent = name;
    fields[name] = document.createElement("strong");
    box.append(caption, fields[name]);
    row.append(box);
  }
  byId("now").append(row);
  return fields;
})();

function showPlanNow(time) {
  const [i] = frameAt(time);
  const number = (move) => String(moves.reduce((sum, values) => sum + (values[i] === move ? 1 : 0), 0));
  planFields.Driving.textContent = number(DRIVING);
  planFields.Waiting.textContent = number(WAITING);
  planFields.Arrived.textContent = number(ARRIVED);
  const wrong = robotsIn(conflictsAt(time)).size;
  planFields["In violations"].textContent = String(wrong);
  planFields["In violations"].className = wrong ? "wrong" : "";
}

/// The robot of a plan that covers a point of the screen.
function planBodyUnder(px, py, now) {
  for (let k = robots.length - 1; k >= 0; k--) {
    const [robot, pose] = [robots[k], now.robots[k]];
    outline(robot.polygon.map((corner) => place(pose, corner)));
    // the path is in CSS pixels, the test in those of the screen
    if (!surface.context.isPointInPath(px * surface.ratio, py * surface.ratio)) continue;
    const rows = [
      ["State", sentence(MOVES[moves[k][frameAt(now.time)[0]]])],
      ["Position", `${fixed(pose.x, isGrid ? 0 : 3)}, ${fixed(pose.y, isGrid ? 0 : 3)}${isGrid ? "" : " m"}`],
    ];
    if (!isGrid) rows.push(["Yaw", `${fixed(pose.yaw * DEGREES, 1)}°`]);
    if (robot.goal) rows.push(["Goal", `${robot.goal.slice(0, 2).map((v) => fixed(v, isGrid ? 0 : 2)).join(", ")}`]);
    for (const conflict of conflictsAt(now.time).filter((c) => c.robots.includes(k))) rows.push([sentence(conflict.kind), conflict.text]);
    return { name: `${robot.number} · ${robot.name}`, rows };
  }
  return null;
}

const planSymbols = () => [
  [isGrid ? "Agent" : "Body", `<path d="M2 4h14v10H2z" fill="${robotColor(0)}"/>`],
  ["Goal", `<path d="M2 4h14v10H2z" fill="none" stroke="${robotColor(0)}" stroke-width="1.5" stroke-dasharray="3 2"/>`],
  ["Way", `<path d="M0 9h18" stroke="${robotColor(0)}" stroke-width="2"/>`],
  ["Obstacle", '<path d="M2 4h14v10H2z" fill="var(--obstacle)" stroke="var(--obstacle-line)"/>'],
  ...(replay.conflicts.length ? [["In violation", '<path d="M2 4h14v10H2z" fill="var(--conflict)"/>']] : []),
];
