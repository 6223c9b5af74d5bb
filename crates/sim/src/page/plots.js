// The plots beside the mission, over one common time axis.

const chart = byId("chart");
let chartSurface = { context: chart.getContext("2d"), width: 1, height: 1, ratio: 1 };
const chartBase = document.createElement("canvas");
const GUTTER = 44;
const RIGHT = 10;
const DASHES = [[], [6, 3], [2, 3], [8, 3, 2, 3]];
let rows = [];

const timeToPixel = (time) =>
  GUTTER + ((time - startTime) / Math.max(1e-9, endTime - startTime)) * (chartSurface.width - GUTTER - RIGHT);
const pixelToTime = (px) =>
  startTime + ((px - GUTTER) / Math.max(1, chartSurface.width - GUTTER - RIGHT)) * (endTime - startTime);

/// Lowest and highest value of all columns, with round limits and ticks.
function limits(columns, factor, fallback, withZero) {
  let low = withZero ? 0 : Infinity;
  let high = withZero ? 0 : -Infinity;
  for (const column of columns) {
    for (const value of column) {
      low = Math.min(low, value * factor);
      high = Math.max(high, value * factor);
    }
  }
  if (!(high > low)) [low, high] = [Math.min(0, low || 0), Math.max(fallback, high || 0)];
  const step = niceStep((high - low) / 4);
  return { low: Math.floor(low / step + 1e-9) * step, high: Math.ceil(high / step - 1e-9) * step, step };
}

function layout() {
  if (isPlan) {
    rows = planLayout();
    return;
  }
  const { height } = chartSurface;
  const gap = 26;
  const bars = robots.length + teams.length;
  const barHeight = Math.min(11, Math.max(5, 96 / Math.max(1, bars)));
  const stripes = bars * barHeight;
  const plot = Math.max(40, (height - stripes - 4 * gap - 20) / 3);
  const head = [
    { title: "Heading error, °", kind: "line", columns: teams.map((t) => t.heading_error), factor: DEGREES, fallback: 1 },
    { title: "Distance to the waypoint, m", kind: "line", columns: teams.map((t) => t.distance), factor: 1, fallback: 1 },
    { title: "Speed of the robots, m/s", kind: "speed", columns: robots.map((r) => r.speed), factor: 1, fallback: 0.1 },
  ];
  let top = gap;
  rows = head.map((row) => {
    const placed = { ...row, ...limits(row.columns, row.factor, row.fallback, true), top, bottom: top + plot };
    top += plot + gap;
    return placed;
  });
  rows.push({ title: "Roles", kind: "roles", top, bottom: top + stripes, barHeight });
}

const valueToPixel = (row, value) => row.bottom - ((value - row.low) / (row.high - row.low)) * (row.bottom - row.top);

function plotText(context, text, x, y, align, color = colors.muted, weight = 400, size = 11) {
  context.font = `${weight} ${size}px ${FONT}`;
  context.textAlign = align;
  context.textBaseline = "middle";
  context.fillStyle = color;
  context.fillText(text, x, y);
}

/// Highest and lowest value in each column of pixels, as one line.
function drawLine(context, row, values) {
  context.beginPath();
  let i = 0;
  while (i < count) {
    const px = Math.round(timeToPixel(times[i]));
    let [low, high] = [values[i], values[i]];
    const first = values[i];
    let last = first;
    for (; i < count && Math.round(timeToPixel(times[i])) === px; i++) {
      last = values[i];
      low = Math.min(low, last);
      high = Math.max(high, last);
    }
    for (const value of high - low > 0 ? [first, low, high, last] : [first]) {
      context.lineTo(px, valueToPixel(row, value * row.factor));
    }
  }
  context.stroke();
}

/// One robot's speed, averaged over two pixels, in the colour of what it does.
function drawSpeed(context, row, robot) {
  let previous = null;
  let i = 0;
  while (i < count) {
    const bin = Math.floor(timeToPixel(times[i]) / 2);
    const activity = robot.activity[i];
    let sum = 0;
    let number = 0;
    for (; i < count && Math.floor(timeToPixel(times[i]) / 2) === bin && robot.activity[i] === activity; i++) {
      sum += robot.speed[i];
      number++;
    }
    const point = [timeToPixel(times[i - 1]), valueToPixel(row, sum / number)];
    if (previous) {
      context.strokeStyle = activityColor(activity);
      context.beginPath();
      context.moveTo(...previous);
      context.lineTo(...point);
      context.stroke();
    }
    previous = point;
  }
}

function drawRoles(context, row) {
  const bar = (index, values, color) => {
    const y = row.top + index * row.barHeight;
    for (let i = 0; i < count; ) {
      const start = i;
      while (i < count && values[i] === values[start]) i++;
      const from = timeToPixel(times[start]);
      const to = timeToPixel(i < count ? times[i] : endTime);
      const fill = color(values[start]);
      if (!fill) continue;
      context.fillStyle = fill;
      context.fillRect(from, y + 0.5, Math.max(0.6, to - from), row.barHeight - 1);
    }
  };
  robots.forEach((robot, i) => {
    bar(i, robot.activity, activityColor);
    if (row.barHeight >= 8) plotText(context, String(robot.number), GUTTER - 6, row.top + (i + 0.5) * row.barHeight, "right", colors.muted, 400, 9);
  });
  // rotations dark, translations light
  teams.forEach((team, i) => {
    bar(robots.length + i, team.primitive, (primitive) => [null, colors.ink, colors.ink, colors.line][primitive]);
    if (row.barHeight >= 8) plotText(context, "turns", GUTTER - 6, row.top + (robots.length + i + 0.5) * row.barHeight, "right", colors.muted, 400, 9);
  });
}

function paintChart() {
  chartSurface = fitCanvas(chart);
  const { width, ratio } = chartSurface;
  chartBase.width = chart.width;
  chartBase.height = chart.height;
  const context = chartBase.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  layout();
  const step = niceStep(Math.max(1e-3, ((endTime - startTime) * 52) / Math.max(1, width - GUTTER - RIGHT)));
  context.lineJoin = "round";
  for (const row of rows) {
    plotText(context, row.title, 0, row.top - 13, "left", colors.muted, 500);
    context.lineWidth = 1;
    context.strokeStyle = colors.grid;
    context.beginPath();
    for (let t = Math.ceil(startTime / step) * step; t <= endTime + 1e-9; t += step) {
      const px = Math.round(timeToPixel(t)) + 0.5;
      context.moveTo(px, row.top);
      context.lineTo(px, row.bottom);
    }
    if (row.kind === "roles") {
      context.stroke();
      if (isPlan) drawMoves(context, row);
      else drawRoles(context, row);
      continue;
    }
    const ticks = Math.round((row.high - row.low) / row.step);
    for (let k = 0; k <= ticks; k++) {
      const value = row.low + k * row.step;
      const py = Math.round(valueToPixel(row, value)) + 0.5;
      context.moveTo(GUTTER, py);
      context.lineTo(width - RIGHT, py);
      if (ticks < 6 || k % 2 === 0) plotText(context, fixed(value, digitsOf(row.step)), GUTTER - 6, py, "right");
    }
    context.stroke();
    if (row.low < 0 && row.high > 0) {
      context.strokeStyle = colors["obstacle-line"];
      context.beginPath();
      context.moveTo(GUTTER, Math.round(valueToPixel(row, 0)) + 0.5);
      context.lineTo(width - RIGHT, Math.round(valueToPixel(row, 0)) + 0.5);
      context.stroke();
    }
    context.lineWidth = 1.5;
    if (row.kind === "speed") {
      context.lineWidth = 1.2;
      robots.forEach((robot) => drawSpeed(context, row, robot));
    } else {
      row.columns.forEach((values, i) => {
        context.strokeStyle = colors.ink;
        context.setLineDash(DASHES[i % DASHES.length]);
        drawLine(context, row, values);
        context.setLineDash([]);
      });
    }
  }
  const last = rows[rows.length - 1];
  for (let t = Math.ceil(startTime / step) * step; t <= endTime + 1e-9; t += step) {
    plotText(context, fixed(t, digitsOf(step)), timeToPixel(t), last.bottom + 10, t - startTime < step / 2 ? "left" : "center");
  }
  plotText(context, isPlan ? "step" : "time, s", 0, last.bottom + 10, "left");
}

function drawChart(now) {
  const { context, width, height } = chartSurface;
  context.clearRect(0, 0, width, height);
  context.drawImage(chartBase, 0, 0, width, height);
  const px = timeToPixel(now.time);
  context.strokeStyle = colors.accent;
  context.lineWidth = 1.5;
  for (const row of rows) {
    context.beginPath();
    context.moveTo(px, row.top - 3);
    context.lineTo(px, row.bottom + 3);
    context.stroke();
  }
  const dot = (row, value, color) => {
    context.beginPath();
    context.arc(px, valueToPixel(row, value), 3, 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
  };
  if (!count) return;
  if (isPlan) {
    dot(rows[0], underway[frameAt(now.time)[0]], colors.accent);
    return;
  }
  const [heading, distance, speed] = rows;
  now.teams.forEach((team) => {
    dot(heading, team.headingError * DEGREES, colors.accent);
    dot(distance, team.distance, colors.accent);
  });
  now.robots.forEach((robot) => dot(speed, robot.speed, activityColor(robot.activity)));
}
