// Time, controls and what is written beside the mission.

const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 20, 50, 100];
const slider = byId("slider");
let time = startTime;
let playing = false;
// the whole mission in some 40 s; a plan has less to look at
let speed = SPEEDS.find((s) => s >= (endTime - startTime) / (isPlan ? 20 : 40)) ?? SPEEDS[SPEEDS.length - 1];
let shown = snapshot(time);
let pointer = null;

function element(name, text, properties = {}) {
  const made = document.createElement(name);
  if (text !== null) made.textContent = text;
  return Object.assign(made, properties);
}

function show() {
  if (count) shown = snapshot(time);
  drawStage(shown);
  drawChart(shown);
  slider.value = String(time);
  byId("clock").replaceChildren(fixed(time, 1), element("span", ` / ${fixed(endTime, isPlan ? 0 : 1)} ${UNIT}`));
  slider.setAttribute("aria-valuetext", `${fixed(time, 1)} ${isPlan ? "steps" : "seconds"}`);
  showNow();
  showTip();
  for (const item of byId("events").children) item.classList.toggle("past", Number(item.dataset.time) <= time + 1e-6);
}

function seek(to) {
  time = Math.min(endTime, Math.max(startTime, Number(to) || 0));
  show();
}

let lastTick = null;
function tick(stamp) {
  if (!playing) return;
  const elapsed = lastTick === null ? 0 : Math.min(0.25, (stamp - lastTick) / 1000);
  lastTick = stamp;
  const next = time + elapsed * speed;
  seek(next);
  if (next >= endTime) pause();
  else requestAnimationFrame(tick);
}

function showPlaying() {
  byId("play-icon").setAttribute("d", playing ? "M3 2h4v12H3zM9 2h4v12H9z" : "M4 2l10 6-10 6z");
  byId("play").setAttribute("aria-label", playing ? "Pause" : "Play");
}

function play() {
  if (playing || count < 2) return;
  if (time >= endTime) seek(startTime);
  playing = true;
  lastTick = null;
  showPlaying();
  requestAnimationFrame(tick);
}

function pause() {
  playing = false;
  showPlaying();
}

function setSpeed(to) {
  speed = to;
  byId("speed").value = String(to);
}

const stepSpeed = (by) => setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(speed) + by))]);

/// One field of the readout; made once, written at every instant.
const readouts = teams.map((team) => {
  const row = element("div", null, { className: "team" });
  const field = (name) => {
    const box = element("div", null);
    const value = element("strong", "");
    box.append(element("small", name), value);
    row.append(box);
    return value;
  };
  if (teams.length > 1) field("Team").textContent = team.id;
  const fields = { primitive: field("Motion"), phase: field("Phase"), waypoint: field("Waypoint"), heading: field("Heading error"), distance: field("Distance") };
  byId("now").append(row);
  return fields;
});

function showNow() {
  if (!count) return;
  if (isPlan) {
    showPlanNow(time);
    return;
  }
  readouts.forEach((fields, i) => {
    const team = shown.teams[i];
    const last = teams[i].waypoints.length - 1;
    const members = teams[i].robots.filter((k) => shown.robots[k]);
    const busy = members.filter((k) => replay.repositioning[replay.phases.indexOf(shown.robots[k].phase)]);
    fields.primitive.textContent = PRIMITIVES[team.primitive];
    fields.phase.textContent = busy.length
      ? busy.map((k) => `${k + 1}: ${words(shown.robots[k].phase)}`).join(", ")
      : members.length && members.every((k) => shown.robots[k].phase === "done") ? "Done" : "Work";
    fields.waypoint.textContent = team.waypoint >= last ? "goal" : `${team.waypoint + 1} of ${last + 1}`;
    fields.heading.textContent = `${fixed(team.headingError * DEGREES, 1)}°`;
    fields.distance.textContent = `${fixed(team.distance, 3)} m`;
  });
}

/// What stands under the pointer.
function showTip() {
  const tip = byId("tip");
  const hit = pointer && count ? bodyUnder(pointer) : null;
  tip.hidden = !hit;
  if (!hit) return;
  const table = element("table", null);
  for (const [name, value] of hit.rows) {
    const row = element("tr", null);
    row.append(element("td", name), element("td", value));
    table.append(row);
  }
  tip.replaceChildren(element("b", hit.name), table);
  const { offsetWidth, offsetHeight } = tip;
  const right = pointer.x + 16 + offsetWidth < surface.width;
  const x = right ? pointer.x + 16 : pointer.x - 16 - offsetWidth;
  tip.style.left = `${Math.max(4, x)}px`;
  tip.style.top = `${Math.max(4, Math.min(pointer.y + 12, surface.height - offsetHeight - 4))}px`;
}

function bodyUnder({ x: px, y: py }) {
  if (isPlan) return planBodyUnder(px, py, shown);
  const [x, y] = toWorld(px, py);
  const poseRows = (pose) => [
    ["Position", `${fixed(pose.x, 3)}, ${fixed(pose.y, 3)} m`],
    ["Yaw", `${fixed(pose.yaw * DEGREES, 1)}°`],
  ];
  for (let i = robots.length - 1; i >= 0; i--) {
    const [robot, pose] = [robots[i], shown.robots[i]];
    if (Math.hypot(pose.x - x, pose.y - y) > Math.max(robot.radius, 7 / view.scale)) continue;
    return {
      name: `${robot.number} · ${robot.name}`,
      rows: [
        ...(teams.length > 1 ? [["Team", teams[robot.team]?.id ?? "—"]] : []),
        ["Role", pose.role ? sentence(pose.role) : "—"],
        ["Phase", sentence(pose.phase)],
        ["Command", `${fixed(pose.linear, 3)} m/s, ${fixed(pose.angular, 2)} rad/s`],
        ["Speed", `${fixed(pose.speed, 3)} m/s`],
        ["Stop flag", pose.stop ? "up" : "down"],
        ...poseRows(pose),
      ],
    };
  }
  for (let i = 0; i < loads.length; i++) {
    const pose = shown.loads[i];
    outline(loads[i].polygon.map((corner) => place(pose, corner)));
    // the path is in CSS pixels, the test in those of the screen
    if (surface.context.isPointInPath(px * surface.ratio, py * surface.ratio)) {
      return { name: `Load · ${loads[i].id}`, rows: poseRows(pose) };
    }
  }
  return null;
}

function writePage() {
  if (isPlan) {
    // the template speaks of missions
    for (const spoken of document.querySelectorAll("[data-plan]")) spoken.textContent = spoken.dataset.plan;
    for (const [id, name] of [["view", "Plan"], ["scene", "Bodies seen from above"], ["chart", "Who drives and who waits over time; a click seeks"]]) {
      byId(id).setAttribute("aria-label", name);
    }
  }
  byId("title").textContent = replay.title;
  byId("description").textContent = replay.description;
  const violations = `${replay.conflicts.length} ${replay.conflicts.length === 1 ? "violation" : "violations"}`;
  const facts = isPlan ? [
    [replay.success ? "✓ Certified" : `✗ ${violations}`, replay.success ? "good" : "bad"],
    [`cohaul ${replay.version}`, ""],
  ] : [
    [replay.success ? "✓ Succeeded" : "✗ Failed", replay.success ? "good" : "bad"],
    [`${sentence(replay.world)} world`, ""],
    [`${robots.length} ${robots.length === 1 ? "robot" : "robots"}`, ""],
    [`seed ${replay.seed}`, ""],
    [`cohaul ${replay.version}`, ""],
  ];
  byId("facts").replaceChildren(...facts.map(([text, className]) => element("li", text, { className })));
  for (const [name, value] of replay.outcome) {
    const row = element("div", null);
    row.append(element("dt", name), element("dd", value));
    byId("outcome").append(row);
  }
  byId("outcome-card").hidden = !replay.outcome.length;
  const events = isPlan ? replay.conflicts.map((c) => [c.time, `${sentence(c.kind)}: ${c.text}`]) : replay.events;
  byId("events-card").hidden = !events.length;
  byId("events-card").classList.toggle("wrong", isPlan);
  for (const [at, text] of events) {
    const item = element("li", null);
    item.dataset.time = at;
    const button = element("button", null, { type: "button", onclick: () => seek(at) });
    button.append(element("time", isPlan ? `step ${fixed(at, 1)}` : `${fixed(at, 1)} s`), element("span", text));
    item.append(button);
    byId("events").append(item);
    const mark = element("i", null, { title: text });
    mark.style.left = `${(100 * (at - startTime)) / Math.max(1e-9, endTime - startTime)}%`;
    byId("marks").append(mark);
  }
  writeLegend();
  for (const s of SPEEDS) byId("speed").append(element("option", `${s}×`, { value: String(s) }));
  slider.min = String(startTime);
  slider.max = String(endTime);
  setSpeed(speed);
}

function writeLegend() {
  const symbols = isPlan ? planSymbols() : [
    ...ACTIVITIES.map((name, i) => [ACTIVITY_NAMES[i], robotSymbol(name)]),
    ["Slot", '<circle cx="9" cy="9" r="7" fill="none" stroke="var(--muted)" stroke-dasharray="2 2.4"/>'],
    ["Way of the load", '<path d="M0 9h18" stroke="var(--trace)" stroke-width="2.5"/>'],
    ["Plan", '<path d="M0 9h18" stroke="var(--obstacle-line)" stroke-width="1.5" stroke-dasharray="5 4"/>'],
    ["Waypoint", '<circle cx="9" cy="9" r="7" fill="none" stroke="var(--waypoint)" stroke-dasharray="3 2"/><circle cx="9" cy="9" r="2.5" fill="none" stroke="var(--waypoint)" stroke-width="1.4"/>'],
  ];
  byId("legend").replaceChildren(...symbols.map(([name, drawing]) => {
    const item = element("li", null);
    // constant text, nothing of the mission
    item.innerHTML = `<svg viewBox="0 0 18 18" aria-hidden="true">${drawing}</svg>`;
    item.append(name);
    return item;
  }));
}

function robotSymbol(name) {
  const body = `<path d="M12.5 4.5L18 9l-5.5 4.5z" fill="var(--${name})"/><circle cx="8" cy="9" r="6.5" fill="var(--${name})"/>`;
  if (name === "hold") return `${body}<circle cx="8" cy="9" r="4.4" fill="var(--card)"/>`;
  if (name === "reposition") return `${body}<circle cx="8" cy="9" r="8.6" fill="none" stroke="var(--${name})" stroke-width="1.3" stroke-dasharray="3 2.2"/>`;
  return body;
}

const KEYS = {
  " ": () => (playing ? pause() : play()),
  ArrowLeft: (event) => seek(time - (event.shiftKey ? 10 : 1)),
  ArrowRight: (event) => seek(time + (event.shiftKey ? 10 : 1)),
  Home: () => seek(startTime),
  End: () => seek(endTime),
  "[": () => stepSpeed(-1),
  "]": () => stepSpeed(1),
  f: () => { fitView(); show(); },
  "?": () => (byId("help").open ? byId("help").close() : byId("help").showModal()),
};

function listen() {
  byId("play").onclick = () => (playing ? pause() : play());
  byId("speed").onchange = (event) => setSpeed(Number(event.target.value));
  byId("fit").onclick = KEYS.f;
  const zoom = (factor) => () => { zoomAt(surface.width / 2, surface.height / 2, factor); show(); };
  byId("zoom-in").onclick = zoom(1.4);
  byId("zoom-out").onclick = zoom(1 / 1.4);
  byId("help-open").onclick = KEYS["?"];
  slider.oninput = () => seek(slider.value);
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // a focused button takes its own space, a focused list its own arrows
    const own = event.target.tagName;
    if ((own === "BUTTON" && event.key === " ") || (own === "SELECT" && !"[]?f".includes(event.key))) return;
    if (byId("help").open && event.key !== "?") return;
    const action = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  });

  let drag = null;
  scene.onpointerdown = (event) => {
    if (event.button !== 0) return;
    scene.setPointerCapture(event.pointerId);
    scene.classList.add("panning");
    drag = [event.offsetX, event.offsetY];
  };
  scene.onpointermove = (event) => {
    pointer = { x: event.offsetX, y: event.offsetY };
    if (!drag) return showTip();
    view.x -= (event.offsetX - drag[0]) / view.scale;
    view.y += (event.offsetY - drag[1]) / view.scale;
    drag = [event.offsetX, event.offsetY];
    fitted = false;
    show();
  };
  scene.onpointerup = scene.onpointercancel = () => {
    drag = null;
    scene.classList.remove("panning");
  };
  scene.onpointerleave = () => {
    pointer = null;
    showTip();
  };
  scene.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    zoomAt(event.offsetX, event.offsetY, Math.exp(-0.0015 * lines * event.deltaY));
    show();
  }, { passive: false });

  let seeking = false;
  chart.onpointerdown = (event) => {
    chart.setPointerCapture(event.pointerId);
    seeking = true;
    seek(pixelToTime(event.offsetX));
  };
  chart.onpointermove = (event) => seeking && seek(pixelToTime(event.offsetX));
  chart.onpointerup = chart.onpointercancel = () => (seeking = false);
}

function repaint() {
  readColors();
  if (isPlan) writeLegend();
  resizeStage();
  paintChart();
  show();
}

window.cohaul = {
  /// What is drawn: time and speed of the player, poses in m and rad, which robots are part of a violation.
  state: () => ({
    time,
    startTime,
    duration: endTime - startTime,
    playing,
    speed,
    loads: shown.loads.map((pose) => ({ ...pose })),
    robots: shown.robots.map(({ x, y, yaw, activity, phase }) => (isPlan ? { x, y, yaw } : { x, y, yaw, activity: ACTIVITIES[activity], phase })),
    conflicts: [...robotsIn(conflictsAt(time))],
  }),
  seek,
  play,
  pause,
};

writePage();
listen();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
new ResizeObserver(repaint).observe(byId("stage"));
new ResizeObserver(repaint).observe(chart);
repaint();
