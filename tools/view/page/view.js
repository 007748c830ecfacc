"use strict";
/* The page of slamsensor view. What it shows comes as JSON: from /api/stream (live) or /api/at (a recording). It keeps
   the newest story, says it in words, and draws it when something has changed. Lengths m, angles rad. */

const $ = (id) => document.getElementById(id);
const PROPERTIES = ["x", "y", "id", "xi", "sightings", "sigma"];
const noLandmarks = () => Object.fromEntries(PROPERTIES.map((name) => [name, []]));
const story = { fixes: 0, map: noLandmarks(), chunks: [], path: [], events: [], local_maps: {} };
const SILENT_S = 4; // the status comes every second
const stats = { frames: 0, drawn_ms: 0, worst_ms: 0, bases: 0, bytes: 0, messages: 0 };

// --- Words ----------------------------------------------------------------------------------------------------------

const fixed = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : "–");
const degrees = (radians) => (radians * 180) / Math.PI;

function span(seconds) {
  if (!Number.isFinite(seconds)) return "–";
  if (seconds < 1) return `${Math.max(0, seconds * 1000).toFixed(seconds < 0.01 ? 1 : 0)} ms`;
  if (seconds < 120) return `${seconds.toFixed(1)} s`;
  if (seconds < 7200) return `${Math.floor(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

function fillList(list, rows) {
  const kept = rows.filter((row) => row);
  while (list.children.length > 2 * kept.length) list.lastChild.remove();
  kept.forEach(([name, value, tone], i) => {
    if (list.children.length <= 2 * i) list.append(document.createElement("dt"), document.createElement("dd"));
    const [term, data] = [list.children[2 * i], list.children[2 * i + 1]];
    if (term.textContent !== name) term.textContent = name;
    if (data.textContent !== value) data.textContent = value;
    data.className = tone || "";
  });
}

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Semi-axes of 1 sigma and the angle of the longer one. */
function ellipse([xx, xy, yy]) {
  const mean = (xx + yy) / 2;
  const half = Math.hypot((xx - yy) / 2, xy);
  return { a: Math.sqrt(Math.max(0, mean + half)), b: Math.sqrt(Math.max(0, mean - half)), angle: Math.atan2(2 * xy, xx - yy) / 2 };
}

const headingText = (heading, digits) => `${fixed(((degrees(heading) % 360) + 360) % 360, digits)}°`;
const placeText = ({ x, y, heading }) => `x ${fixed(x, 1)}, y ${fixed(y, 1)} m, heading ${headingText(heading, 0)}`;

const timesText = (count) => (count === 1 ? "once" : `${count} times`);
const SEARCH_WORDS = { not_started: "not started", share: "cut off: its share of the time was used", deadline: "cut off at the deadline" };

/** Of an ambiguous pose: which place is drawn as the sensor's, and which others explain the scan. */
function rivalWords(pose) {
  const rivals = story.rivals || [];
  if (rivals.length > 0) {
    const places = rivals.map((rival, i) => ` Rival ${i + 1}: ${placeText(rival)}, ${rival.matches} matches.`);
    return `The likeliest of ${rivals.length + 1} places is drawn hollow, with ${pose.matches} matches.${places.join("")}`;
  }
  const soFar = pose.weight_runner_up > 0 ? ` Matches so far: ${pose.weight_best} here, ${pose.weight_runner_up} at the rival.` : "";
  return `The likeliest place is drawn hollow; no rival in this map is known.${soFar}`;
}

/** Nothing has come from the sensor for longer than its status may take. */
const isSilent = () => link.is_live && (link.isLost() || story.heard_s > SILENT_S);
/** Of an age in the last message: what has passed since that message is added. */
const ageNow = (age_s) => age_s + (link.is_live ? link.quiet_s() : 0);

/** The last pose; once it is too old, the fix that it was is none any more, whatever the sensor last said. */
function poseNow() {
  const pose = story.pose;
  const isStale = pose && pose.status !== "no_fix" && story.stale_s > 0 && ageNow(story.since_scan_s) > story.stale_s;
  return isStale ? { ...pose, status: "no_fix", reason: "stale", words: `no fix: stale, no scan for more than ${span(story.stale_s)}` } : pose;
}

function fixWords(pose) {
  if (pose.status !== "fix") return pose.words.replace(/^./, (c) => c.toUpperCase());
  return isSilent() ? "The last fix before the sensor fell silent" : "Fix";
}

function fixTone(pose) {
  if (pose.status === "no_fix") return "bad";
  return pose.status === "fix" && !isSilent() ? "good" : "warn";
}

function stateTone() {
  const state = story.status ? story.status.state : "";
  return { fixed: "good", scanning: "warn", starting: "warn", ambiguous: "warn", held: "warn", lost: "bad", faulted: "bad" }[state] || "";
}

function tellFix() {
  const pose = poseNow();
  if (!pose) {
    setText($("words"), "no scan has been localised yet");
    fillList($("fix"), []);
    $("rivals").hidden = true;
    return;
  }
  // Said aloud when it becomes another matter, not at each new number.
  const matter = `${pose.status} ${pose.reason} ${pose.map} ${isSilent()}`;
  if ($("words").dataset.matter !== matter) {
    $("words").dataset.matter = matter;
    $("words").className = fixTone(pose);
    setText($("words"), fixWords(pose));
  }
  const isAmbiguous = pose.status === "ambiguous";
  $("rivals").hidden = !isAmbiguous;
  if (isAmbiguous) setText($("rivals"), rivalWords(pose));
  const near = pose.has_pose ? ellipse(pose.near) : null;
  const home = pose.has_pose ? ellipse(pose.cov) : null;
  const isOnEarth = pose.status === "fix" && pose.latitude !== undefined;
  const last = pose.reason === "stale" ? "Last " : "";
  fillList($("fix"), [
    story.age_s !== undefined && ["Age", span(ageNow(story.age_s))],
    pose.has_pose && [`${last}x, y`, `${fixed(pose.x, 3)}, ${fixed(pose.y, 3)} m`],
    pose.has_pose && [last ? "Last heading" : "Heading", headingText(pose.heading, 2)],
    isOnEarth && ["Latitude, longitude", `${fixed(pose.latitude, 7)}, ${fixed(pose.longitude, 7)}`],
    isOnEarth && ["True heading", `${fixed(pose.true_heading_deg, 1)}°`],
    isOnEarth && story.datum && story.datum.of_configuration && ["By the datum", "of the configuration", "warn"],
    home && ["Sigma in the map", `${fixed(home.a, 3)} × ${fixed(home.b, 3)} m, ${fixed(degrees(Math.sqrt(pose.cov_heading)), 2)}°`],
    near && ["Sigma to landmarks", `${fixed(near.a, 3)} × ${fixed(near.b, 3)} m`],
    pose.has_pose && ["Protection radius", `${fixed(pose.protection, 2)} m`],
    pose.has_pose && ["Error xi", String(pose.xi)],
    ["Matches", `${pose.matches} of ${pose.seen} seen`],
    ["Chance poses expected", pose.false_alarms === null ? "–" : pose.false_alarms.toPrecision(2)],
    ["Map", pose.map === 0 ? "none" : pose.map === pose.home ? `home (${pose.map})` : `local ${pose.map}`],
    ["Search", SEARCH_WORDS[pose.search] || pose.search],
    ["Jumps", String(pose.jumps)],
    ["First fix after", span(pose.first_fix_s)],
  ]);
}

const NOT_KNOWN = { state: "not known", model: "", problem: "", recoveries: 0 };

function tellSensor() {
  const status = story.status;
  const silent = isSilent();
  $("problem").hidden = silent || !(status && status.problem);
  if (!status) return;
  setText($("problem"), status.problem);
  tellDevices(status.devices.map((device) => (silent ? { ...NOT_KNOWN, name: device.name } : device)));
  fillList($("sensor"), silent ? [["Head", "not known", "warn"]] : sensorRows(status));
}

function tellDevices(devices) {
  const list = $("devices");
  devices.forEach((device, i) => {
    const item = list.children[i] || list.appendChild(document.createElement("li"));
    const text = `${device.name}|${device.state}|${device.model}|${device.problem}|${device.recoveries}`;
    if (item.dataset.text === text) return;
    item.dataset.text = text;
    const state = document.createElement("b");
    state.className = device.state === "ready" ? "good" : ["starting", NOT_KNOWN.state].includes(device.state) ? "warn" : "bad";
    state.textContent = device.state;
    const more = document.createElement("span");
    more.textContent = [device.model, device.problem, device.recoveries && `back ${timesText(device.recoveries)}`].filter(Boolean).join("; ");
    item.replaceChildren(document.createTextNode(`${device.name} `), state, more);
  });
}

function sensorRows(status) {
  return [
    ["Head", status.held ? "held" : status.phase, status.held ? "warn" : ""],
    ["Scan under way", `line ${status.line} of ${status.lines}`],
    ["Looks towards", `pan ${fixed(degrees(status.pan), 1)}°, tilt ${fixed(degrees(status.tilt), 1)}°`],
    ["Readings", `${fixed(status.readings_hz, 0)} a second`],
    ["Scans, fixes", `${status.scans}, ${status.fixes}`],
    ["Scan thread, worst lateness", span(status.wake_max_s), status.wake_max_s > 0.01 ? "warn" : ""],
    ["SLAM thread, last and worst", `${span(status.process_last_s)}, ${span(status.process_max_s)}`],
    ["Real time", status.realtime ? "in force" : "not in force", status.realtime ? "" : "warn"],
    ["Recording", status.recording ? "yes" : "no"],
    story.pose && ["Running for", span(story.pose.uptime_s)],
    story.pose && story.pose.emulated && ["Source", "emulated", "warn"],
  ];
}

/** The map that is drawn, how much of it, and where the sensor is in it. */
function tellPicture() {
  const frame = frameShown();
  const name = frame === "home" ? "Home map" : `Local map ${frame}, not yet tied`;
  const count = `${landmarksShown(frame).x.length} landmarks`;
  const path = frame === "home" ? `, ${story.fixes} fixes on the path` : "";
  const now = poseNow();
  const pose = poseShown(frame);
  const isLast = pose && (isSilent() || pose.reason === "stale");
  const place = pose ? `; the sensor ${isLast ? "was last " : ""}at x ${fixed(pose.x, 1)}, y ${fixed(pose.y, 1)} metres in it` : "; the sensor is in another map";
  const noFix = now && now.reason === "stale" ? "; no fix: stale" : "";
  const rivals = pose ? (story.rivals || []).map((rival, i) => `; rival ${i + 1} of this scan at ${placeText(rival)}`).join("") : "";
  const label = `${name}: ${count}${path}${now && now.has_pose ? place : "; no pose"}${noFix}${rivals}`;
  const map = $("map");
  if (map.getAttribute("aria-label") !== label) map.setAttribute("aria-label", label);
  tellMap(frame, count);
}

function tellMap(frame, count) {
  const status = story.status;
  const datum = story.datum;
  const locals = Object.keys(story.local_maps);
  fillList($("about-map"), [
    status && ["Name", status.map_name || "–"],
    ["Drawn", `${frame === "home" ? "home map" : `local map ${frame}`}, ${count}`],
    frame === "home" && story.sigma_median > 0 && ["Their sigma", `${fixed(story.sigma_median, 2)} m, at most ${fixed(story.sigma_most, 2)} m`],
    status && ["Local maps not tied", `${status.local_maps}, ${status.local_landmarks} landmarks`],
    status && ["Hypotheses", String(status.hypotheses)],
    status && ["Mode", status.frozen ? "frozen" : "growing"],
    status && ["Saved", status.saved_ago_s === null ? "never" : `${span(status.saved_ago_s)} ago${status.unsaved ? ", changed since" : ""}`],
    ["Datum", datum ? `${fixed(datum.latitude, 7)}, ${fixed(datum.longitude, 7)}, ${fixed(datum.height, 1)} m` : "none: metres only"],
    datum && datum.of_configuration && ["Whose datum", "of the configuration", "warn"],
    datum && ["x axis towards", `${fixed(datum.bearing, 2)}° true`],
  ]);
  const options = [["auto", "where the sensor is"], ["home", "home map"], ...locals.map((n) => [n, `local map ${n}`])];
  const select = $("frame");
  const wanted = options.map(([value]) => value).join();
  if (select.dataset.options !== wanted) {
    const chosen = select.value;
    select.dataset.options = wanted;
    select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
    select.value = options.some(([value]) => value === chosen) ? chosen : "auto";
  }
}

function timeText(seconds) {
  return new Date(seconds * 1000).toISOString().slice(11, 19);
}

function tellEvents(list) {
  const items = list.slice(-200).reverse().map((event) => {
    const item = document.createElement("li");
    const time = document.createElement("time");
    time.textContent = timeText(event.t);
    time.dateTime = new Date(event.t * 1000).toISOString();
    const text = document.createElement("span");
    text.className = event.tone;
    text.textContent = event.text;
    item.append(time, text);
    return item;
  });
  $("events").replaceChildren(...items);
}

function tellCounters() {
  const text = JSON.stringify(story.counters || {});
  const box = $("counters");
  if (box.dataset.text === text) return;
  box.dataset.text = text;
  box.replaceChildren(...Object.entries(story.counters || {}).flatMap(([station, counters]) => {
    const head = document.createElement("h3");
    head.textContent = station.replace(/_/g, " ");
    const list = document.createElement("dl");
    fillList(list, Object.entries(counters).map(([name, value]) => [name.replace(/_/g, " "), String(value)]));
    return [head, list];
  }));
}

function tell() {
  const status = story.status;
  const silent = isSilent();
  const words = !status ? (story.heard_s === undefined ? "waiting for a sensor" : "heard") : status.state;
  setText($("state-words"), !silent ? words : link.isLost() ? "not known" : "silent");
  $("silence").hidden = !(silent && story.heard_s !== undefined);
  setText($("silence"), `for ${span(ageNow(story.heard_s))}`); // outside of what is said aloud: it changes all the time
  $("lamp").className = silent ? "bad" : stateTone();
  if (!link.isLost()) link.show(story.problem || "");
  tellFix();
  tellSensor();
  tellPicture();
  tellCounters();
}

// --- The picture ----------------------------------------------------------------------------------------------------

/* Grid, landmarks and path are drawn apart, on a canvas that reaches MARGIN of its size beyond the window. While the map is
   moved or zoomed that picture is shifted and stretched; it is drawn anew when it no longer covers the window, when it
   would be stretched too much, when what it shows changes, and once the hand rests. */
const MARGIN = 0.35, REST_MS = 120, STRETCH = 1.6;
const FADED = 0.35; // of what is no more than the last that was known
const view = { x: 0, y: 0, scale: 20, follow: false, touched: false, colours: {}, base: document.createElement("canvas"), base_at: null, base_key: "",
  base_view: "", resting: 0, dirty: true };

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["canvas", "grid", "ink", "soft", "path", "scan", "guard", "sigma", "spread", "beam", "rival", "bad", "warn", "xi0", "xi1", "xi2", "xi3", "xi4"]) {
    view.colours[name] = style.getPropertyValue(`--${name}`).trim();
  }
  view.base_key = "";
  view.dirty = true;
}

/** The frame that is drawn: "home" or the number of a local map. */
function frameShown() {
  const chosen = $("frame").value;
  if (chosen !== "auto") return chosen;
  const pose = story.pose;
  const isLocal = pose && pose.has_pose && pose.map !== 0 && pose.map !== pose.home && story.local_maps[pose.map];
  return isLocal ? String(pose.map) : "home";
}

function landmarksShown(frame) {
  if (frame === "home") return story.map;
  const points = (story.local_maps[frame] || { points: [] }).points;
  const xs = points.filter((_, i) => i % 2 === 0);
  const ys = points.filter((_, i) => i % 2 === 1);
  return { x: xs, y: ys, id: null, xi: xs.map(() => 0), sightings: null, sigma: xs.map(() => 0) };
}

const pathShown = (frame) => (frame === "home" ? story.path : (story.local_maps[frame] || { path: [] }).path);
const poseShown = (frame) => {
  const pose = poseNow();
  if (!pose || !pose.has_pose) return null;
  return frame === (pose.map === pose.home ? "home" : String(pose.map)) ? pose : null;
};

/** Metres to pixels of a canvas of `width` by `height` pixels in whose middle the point (x, y) stands, and back. */
const projection = (x, y, scale, width, height) => ({
  x, y, scale, width, height,
  px: (mx, my) => [width / 2 + (mx - x) * scale, height / 2 - (my - y) * scale],
  m: (px, py) => [x + (px - width / 2) / scale, y - (py - height / 2) / scale],
});
const windowNow = () => projection(view.x, view.y, view.scale, $("map").clientWidth, $("map").clientHeight);
const toScreen = (x, y) => windowNow().px(x, y);
const toMap = (px, py) => windowNow().m(px, py);

function fit() {
  const frame = frameShown();
  const landmarks = landmarksShown(frame);
  const path = pathShown(frame);
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  const take = (x, y) => {
    x0 = Math.min(x0, x); x1 = Math.max(x1, x); y0 = Math.min(y0, y); y1 = Math.max(y1, y);
  };
  for (let i = 0; i < landmarks.x.length; ++i) take(landmarks.x[i], landmarks.y[i]);
  for (let i = 0; i < path.length; i += 2) if (path[i] !== null) take(path[i], path[i + 1]);
  const pose = poseShown(frame);
  if (pose) for (const place of [pose, ...(story.rivals || [])]) take(place.x, place.y);
  const map = $("map");
  if (!(x1 >= x0)) [x0, x1, y0, y1] = [-10, 10, -10, 10];
  // Between the buttons above and the legend below, over which a local map has a line of words.
  const words = frame === "home" ? 0 : 40;
  const [top, bottom] = [$("map-tools").offsetTop + $("map-tools").offsetHeight + 14, map.clientHeight - $("legend").offsetTop + 24 + words];
  const [width, height] = [map.clientWidth - 48, Math.max(80, map.clientHeight - top - bottom)];
  view.scale = Math.min(width / Math.max(4, x1 - x0), height / Math.max(4, y1 - y0), 200);
  view.x = (x0 + x1) / 2;
  view.y = (y0 + y1) / 2 + (top + height / 2 - map.clientHeight / 2) / view.scale;
  view.dirty = true;
}

/** 1, 2 or 5 times a power of ten that is at least `metres`. */
function roundLength(metres) {
  const power = 10 ** Math.floor(Math.log10(metres));
  return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= metres * 0.999);
}

function drawGrid(context, at) {
  const step = roundLength(70 / at.scale);
  const [left, top] = at.m(0, 0);
  const [right, bottom] = at.m(at.width, at.height);
  context.strokeStyle = view.colours.grid;
  context.lineWidth = 1;
  context.beginPath();
  // By number, not by adding: far out a step may be too small to count.
  const lines = (from, to) => Array.from({ length: Math.min(400, Math.max(0, Math.floor(to / step) - Math.ceil(from / step) + 1)) },
    (_, i) => (Math.ceil(from / step) + i) * step);
  for (const x of lines(left, right)) {
    const [px] = at.px(x, 0);
    context.moveTo(Math.round(px) + 0.5, 0);
    context.lineTo(Math.round(px) + 0.5, at.height);
  }
  for (const y of lines(bottom, top)) {
    const [, py] = at.px(0, y);
    context.moveTo(0, Math.round(py) + 0.5);
    context.lineTo(at.width, Math.round(py) + 0.5);
  }
  context.stroke();
}

/** The radius a landmark is drawn with, px. */
function dotRadius(count, scale) {
  const least = count < 1000 ? 3 : count < 5000 ? 2.2 : 1.6;
  return Math.min(5, Math.max(least, scale * 0.18));
}

/** Circles of three sigma, as far as they reach beyond the dots. */
function drawSpreads(context, landmarks, at) {
  const radius = dotRadius(landmarks.x.length, at.scale);
  context.strokeStyle = view.colours.spread;
  context.lineWidth = 1;
  context.beginPath();
  for (let i = 0; i < landmarks.x.length; ++i) {
    const spread = 3 * landmarks.sigma[i] * at.scale;
    if (!(spread > radius + 1) || spread > 1e4) continue;
    const [px, py] = at.px(landmarks.x[i], landmarks.y[i]);
    if (px < -spread || py < -spread || px > at.width + spread || py > at.height + spread) continue;
    context.moveTo(px + spread, py);
    context.arc(px, py, spread, 0, 2 * Math.PI);
  }
  context.stroke();
}

function drawLandmarks(context, landmarks, at) {
  const highest = Math.max(1, landmarks.xi.reduce((most, xi) => Math.max(most, xi), 0));
  const radius = dotRadius(landmarks.x.length, at.scale);
  const groups = [[], [], [], [], []];
  for (let i = 0; i < landmarks.x.length; ++i) groups[Math.min(4, Math.floor((4.999 * landmarks.xi[i]) / highest))].push(i);
  groups.forEach((group, colour) => {
    context.fillStyle = view.colours[`xi${colour}`];
    context.beginPath();
    for (const i of group) {
      const [px, py] = at.px(landmarks.x[i], landmarks.y[i]);
      if (px < -8 || py < -8 || px > at.width + 8 || py > at.height + 8) continue;
      if (radius < 2) { // one by one: thousands in one path take a browser many times as long
        context.fillRect(px - radius, py - radius, 2 * radius, 2 * radius);
      } else {
        context.moveTo(px + radius, py);
        context.arc(px, py, radius, 0, 2 * Math.PI);
      }
    }
    context.fill();
  });
}

function drawPath(context, path, at) {
  context.strokeStyle = view.colours.path;
  context.lineWidth = 2;
  context.lineJoin = "round";
  context.beginPath();
  let isNew = true;
  for (let i = 0; i < path.length; i += 2) {
    if (path[i] !== null) {
      const [px, py] = at.px(path[i], path[i + 1]);
      isNew ? context.moveTo(px, py) : context.lineTo(px, py);
    }
    isNew = path[i] === null;
  }
  context.stroke();
}

/** Whether the base that is there can be shown in the window `now` by shifting and stretching it. */
function baseCovers(now, key) {
  const at = view.base_at;
  if (!at || key !== view.base_key || now.scale > STRETCH * at.scale || STRETCH * now.scale < at.scale) return false;
  const [left, top] = at.px(...now.m(0, 0));
  const [right, bottom] = at.px(...now.m(now.width, now.height));
  return left >= 0 && top >= 0 && right <= at.width && bottom <= at.height;
}

function drawBase(frame, now, ratio) {
  const landmarks = landmarksShown(frame);
  const path = pathShown(frame);
  const key = [frame, now.width, now.height, ratio, story.map_stamp, landmarks.x.length, path.length, path[path.length - 2]].join();
  const seen = [now.x, now.y, now.scale].join();
  if (key === view.base_key && seen === view.base_view) return;
  clearTimeout(view.resting);
  view.resting = 0;
  if (baseCovers(now, key) && !view.rested) {
    view.resting = setTimeout(() => { view.rested = view.dirty = true; }, REST_MS);
    return;
  }
  view.rested = false;
  view.base_key = key;
  view.base_view = seen;
  const at = projection(now.x, now.y, now.scale, Math.round(now.width * (1 + 2 * MARGIN)), Math.round(now.height * (1 + 2 * MARGIN)));
  view.base_at = at;
  view.base.width = at.width * ratio;
  view.base.height = at.height * ratio;
  const context = view.base.getContext("2d", { alpha: false });
  context.scale(ratio, ratio);
  context.fillStyle = view.colours.canvas;
  context.fillRect(0, 0, at.width, at.height);
  drawGrid(context, at);
  drawSpreads(context, landmarks, at);
  drawPath(context, path, at);
  drawLandmarks(context, landmarks, at);
  setText($("xi-max"), String(landmarks.xi.reduce((most, xi) => Math.max(most, xi), 0)));
  stats.bases += 1;
}

/** Copies the base into the window, in canvas pixels. */
function showBase(context, now, ratio) {
  const at = view.base_at;
  const stretch = now.scale / at.scale;
  const [left, top] = now.px(...at.m(0, 0));
  context.setTransform(1, 0, 0, 1, 0, 0);
  if (stretch === 1) {
    context.drawImage(view.base, Math.round(left * ratio), Math.round(top * ratio));
  } else {
    context.drawImage(view.base, left * ratio, top * ratio, view.base.width * stretch, view.base.height * stretch);
  }
}

function drawScan(context, pose, alpha) {
  if (!story.scan || story.scan.number !== pose.scan) return;
  const [c, s] = [Math.cos(pose.heading), Math.sin(pose.heading)];
  const [ox, oy] = toScreen(pose.x, pose.y);
  const points = story.scan.points;
  const half = Math.min(7, Math.max(2, view.scale * 0.6));
  for (const rays of view.scale < 2 ? [true] : [true, false]) { // from far away the squares would hide each other and the sensor
    context.strokeStyle = view.colours.scan;
    context.globalAlpha = rays ? 0.14 * alpha : alpha;
    context.lineWidth = rays ? 1 : 1.5;
    context.beginPath();
    for (let i = 0; i < points.length; i += 2) {
      const [px, py] = toScreen(pose.x + c * points[i] - s * points[i + 1], pose.y + s * points[i] + c * points[i + 1]);
      if (rays) {
        context.moveTo(ox, oy);
        context.lineTo(px, py);
      } else {
        context.rect(px - half, py - half, 2 * half, 2 * half);
      }
    }
    context.stroke();
  }
  context.globalAlpha = alpha;
}

/** Where the head looks now, and how much of the scan is done. */
function drawBeam(context, pose) {
  const status = story.status;
  if (!status || status.phase !== "scanning" || status.held || isSilent()) return;
  const [px, py] = toScreen(pose.x, pose.y);
  const angle = -(pose.heading + status.pan);
  context.strokeStyle = view.colours.beam;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(px + 14 * Math.cos(angle), py + 14 * Math.sin(angle));
  context.lineTo(px + 90 * Math.cos(angle), py + 90 * Math.sin(angle));
  context.stroke();
  if (status.lines > 0) {
    context.beginPath();
    context.arc(px, py, 20, -Math.PI / 2, -Math.PI / 2 + 2 * Math.PI * Math.min(1, status.line / status.lines));
    context.stroke();
  }
}

function drawPose(context, pose) {
  const [px, py] = toScreen(pose.x, pose.y);
  const isFix = pose.status === "fix";
  const colour = isFix ? view.colours.sigma : pose.status === "ambiguous" ? view.colours.warn : view.colours.bad;
  const reach = 1e4; // px; much larger circles take a browser for ever, most of all dashed ones
  if (pose.protection > 0 && pose.protection * view.scale < reach) {
    context.strokeStyle = view.colours.guard;
    context.lineWidth = 1.5;
    context.setLineDash([6, 4]);
    context.beginPath();
    context.arc(px, py, Math.max(11, pose.protection * view.scale), 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([]);
  }
  if (pose.cov && pose.cov[0] !== null) {
    const { a, b, angle } = ellipse(pose.cov);
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.beginPath();
    context.ellipse(px, py, Math.min(reach, Math.max(1, 3 * a * view.scale)), Math.min(reach, Math.max(1, 3 * b * view.scale)), -angle, 0, 2 * Math.PI);
    context.stroke();
  }
  drawArrow(context, pose, colour, isFix ? colour : view.colours.canvas);
}

/** The other places of an ambiguous scan: a hollow arrow in a ring, with its number. */
function drawRivals(context) {
  (story.rivals || []).forEach((rival, i) => {
    const [px, py] = toScreen(rival.x, rival.y);
    context.strokeStyle = view.colours.rival;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(px, py, 18, 0, 2 * Math.PI);
    context.stroke();
    drawArrow(context, rival, view.colours.rival, view.colours.canvas);
    context.font = "bold 12px system-ui, sans-serif";
    context.textAlign = "left";
    context.lineWidth = 4;
    context.strokeStyle = view.colours.canvas; // a rim, so that it can be read over landmarks
    context.strokeText(`rival ${i + 1}`, px + 22, py + 4);
    context.fillStyle = view.colours.rival;
    context.fillText(`rival ${i + 1}`, px + 22, py + 4);
  });
}

/** Where `pose` is and looks. */
function drawArrow(context, pose, colour, filling) {
  context.save();
  context.translate(...toScreen(pose.x, pose.y));
  context.rotate(-pose.heading);
  context.beginPath();
  context.moveTo(13, 0);
  context.lineTo(-7, 7);
  context.lineTo(-3, 0);
  context.lineTo(-7, -7);
  context.closePath();
  context.lineWidth = 2;
  context.strokeStyle = colour;
  context.fillStyle = filling;
  context.fill();
  context.stroke();
  context.restore();
}

function drawScale(context, width, height) {
  const metres = roundLength(60 / view.scale);
  const legend = $("legend");
  const isInTheWay = legend.offsetLeft + legend.offsetWidth > width - 32 - metres * view.scale;
  const [x1, y] = [width - 16, isInTheWay ? legend.offsetTop - 8 : height - 16];
  context.strokeStyle = context.fillStyle = view.colours.ink;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x1 - metres * view.scale, y - 5);
  context.lineTo(x1 - metres * view.scale, y);
  context.lineTo(x1, y);
  context.lineTo(x1, y - 5);
  context.stroke();
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "right";
  context.fillText(metres >= 1000 ? `${metres / 1000} km` : `${metres} m`, x1, y - 8);
}

/** North with a datum, the axes of the map without one. */
function drawNorth(context, width, frame) {
  const [cx, cy] = [width - 34, 74];
  const arrow = (angle, text) => {
    const [dx, dy] = [Math.cos(angle), -Math.sin(angle)];
    context.beginPath();
    context.moveTo(cx - 14 * dx, cy - 14 * dy);
    context.lineTo(cx + 14 * dx, cy + 14 * dy);
    context.lineTo(cx + 14 * dx - 8 * Math.cos(angle - 0.45), cy + 14 * dy + 8 * Math.sin(angle - 0.45));
    context.moveTo(cx + 14 * dx, cy + 14 * dy);
    context.lineTo(cx + 14 * dx - 8 * Math.cos(angle + 0.45), cy + 14 * dy + 8 * Math.sin(angle + 0.45));
    context.stroke();
    context.fillText(text, cx + 24 * dx, cy + 24 * dy + 4);
  };
  context.strokeStyle = context.fillStyle = view.colours.ink;
  context.lineWidth = 2;
  context.font = "bold 12px system-ui, sans-serif";
  context.textAlign = "center";
  if (story.datum && frame === "home") {
    arrow((story.datum.bearing * Math.PI) / 180, "N"); // x points to the bearing, clockwise from north
  } else {
    arrow(0, "x");
    arrow(Math.PI / 2, "y");
  }
}

function draw() {
  const begin = performance.now();
  const map = $("map");
  const [width, height] = [map.clientWidth, map.clientHeight];
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  if (map.width !== Math.round(width * ratio) || map.height !== Math.round(height * ratio)) {
    map.width = Math.round(width * ratio);
    map.height = Math.round(height * ratio);
  }
  const frame = frameShown();
  const pose = poseShown(frame);
  if (view.follow && pose) [view.x, view.y] = [pose.x, pose.y];
  const now = windowNow();
  drawBase(frame, now, ratio);
  const context = map.getContext("2d", { alpha: false });
  showBase(context, now, ratio);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (pose) {
    context.globalAlpha = isSilent() || pose.reason === "stale" ? FADED : 1;
    drawScan(context, pose, context.globalAlpha);
    drawBeam(context, pose);
    drawRivals(context);
    drawPose(context, pose);
    context.globalAlpha = 1;
  }
  drawScale(context, width, height);
  drawNorth(context, width, frame);
  if (frame !== "home") {
    const text = `local map ${frame}: its place in the home map is not known yet`;
    context.font = "bold 13px system-ui, sans-serif";
    context.textAlign = "center";
    const [x, y, wide] = [width / 2, height - 16 - $("legend").offsetHeight - 24, Math.min(width - 20, context.measureText(text).width + 16)];
    context.fillStyle = view.colours.canvas;
    context.fillRect(x - wide / 2, y - 16, wide, 23);
    context.fillStyle = view.colours.warn;
    context.fillText(text, x, y, wide);
  }
  stats.frames += 1;
  const took_ms = performance.now() - begin;
  stats.drawn_ms += took_ms;
  stats.worst_ms = Math.max(stats.worst_ms, took_ms);
}

function loop() {
  requestAnimationFrame(loop); // first: what cannot be drawn must not be the last that is
  if (view.dirty) {
    view.dirty = false;
    draw();
  }
}

// --- Hands ----------------------------------------------------------------------------------------------------------

function zoom(factor, px, py) {
  const map = $("map");
  const [ax, ay] = [px === undefined ? map.clientWidth / 2 : px, py === undefined ? map.clientHeight / 2 : py];
  const [mx, my] = toMap(ax, ay);
  view.scale = Math.min(2000, Math.max(0.002, view.scale * factor));
  const [nx, ny] = toMap(ax, ay);
  view.x += mx - nx;
  view.y += my - ny;
  view.touched = view.dirty = true;
}

function move(dx, dy) {
  view.x -= dx / view.scale;
  view.y += dy / view.scale;
  view.touched = view.dirty = true;
  setFollow(false);
}

function setFollow(on) {
  view.follow = on;
  $("follow").setAttribute("aria-pressed", String(on));
  view.dirty = true;
}

function tellHover(px, py) {
  const landmarks = landmarksShown(frameShown());
  let [best, distance] = [-1, 14];
  const now = windowNow();
  for (let i = 0; i < landmarks.x.length; ++i) {
    const [lx, ly] = now.px(landmarks.x[i], landmarks.y[i]);
    const d = Math.hypot(lx - px, ly - py);
    if (d < distance) [best, distance] = [i, d];
  }
  const hover = $("hover");
  hover.hidden = best < 0;
  if (best < 0) return;
  const place = `${fixed(landmarks.x[best], 2)}, ${fixed(landmarks.y[best], 2)} m`;
  setText(hover, landmarks.id ? `landmark ${landmarks.id[best]}: ${place}, ${landmarks.sigma[best] > 0 ? `sigma ${fixed(landmarks.sigma[best], 2)} m, ` : ""}xi ${landmarks.xi[best]}, seen ${landmarks.sightings[best]} times` : `landmark at ${place}`);
}

function listenToPointers() {
  const map = $("map");
  const down = new Map();
  const place = (event) => [event.offsetX, event.offsetY];
  map.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, place(event));
    map.setPointerCapture(event.pointerId);
  });
  map.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    const now = place(event);
    if (!before) return tellHover(...now);
    if (down.size === 1) {
      move(now[0] - before[0], now[1] - before[1]);
    } else if (down.size === 2) {
      const other = [...down].find(([id]) => id !== event.pointerId)[1];
      const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      zoom(apart(now) / apart(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    }
    down.set(event.pointerId, now);
    return undefined;
  });
  for (const name of ["pointerup", "pointercancel"]) map.addEventListener(name, (event) => down.delete(event.pointerId));
  map.addEventListener("pointerleave", () => { $("hover").hidden = true; });
  map.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
  }, { passive: false });
}

function listenToKeys() {
  $("map").addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = 60;
    const keys = {
      ArrowLeft: () => move(step, 0), ArrowRight: () => move(-step, 0), ArrowUp: () => move(0, step), ArrowDown: () => move(0, -step),
      "+": () => zoom(1.3), "=": () => zoom(1.3), "-": () => zoom(1 / 1.3), 0: () => { setFollow(false); fit(); }, f: () => setFollow(!view.follow),
    };
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  $("zoom-in").addEventListener("click", () => zoom(1.5));
  $("zoom-out").addEventListener("click", () => zoom(1 / 1.5));
  $("fit").addEventListener("click", () => { setFollow(false); view.touched = false; fit(); });
  $("follow").addEventListener("click", () => { view.touched = true; setFollow(!view.follow); });
  $("frame").addEventListener("change", () => { view.touched = false; fit(); tellPicture(); });
  new ResizeObserver(() => { if (!view.touched) fit(); view.dirty = true; }).observe($("map"));
}

function setTheme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  readColours();
  if (player.about) player.drawMarks();
}

function listenToTheme() {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;
  setTheme(system.matches);
  system.addEventListener("change", () => { if (chosen === null) setTheme(system.matches); });
  $("theme").addEventListener("click", () => {
    chosen = document.documentElement.dataset.theme !== "dark";
    setTheme(chosen);
  });
}

// --- What comes in --------------------------------------------------------------------------------------------------

/** Puts the chunks that have changed among the others. */
function takeMap(map) {
  story.chunks.length = map.chunks;
  for (const [number, chunk] of Object.entries(map.set)) story.chunks[number] = chunk;
  story.map = noLandmarks();
  for (const chunk of story.chunks) if (chunk) for (const name of PROPERTIES) story.map[name].push(...chunk[name]);
  story.map_stamp = (story.map_stamp || 0) + 1;
  const known = story.map.sigma.filter((sigma) => sigma > 0).sort((a, b) => a - b);
  story.sigma_median = known[known.length >> 1];
  story.sigma_most = known[known.length - 1];
}

/** Members that are not in the message are as they were; `null` is none. */
function take(message) {
  const had = story.map.x.length;
  for (const name of ["pose", "status", "datum", "stale_s", "scan", "rivals", "counters", "local_maps"]) if (name in message) story[name] = message[name] || undefined;
  for (const name of ["age_s", "since_scan_s", "heard_s", "problem"]) story[name] = message[name];
  story.local_maps = story.local_maps || {};
  if (message.map) takeMap(message.map);
  if (message.path.restart) story.path = [];
  story.path.push(...message.path.add);
  story.fixes = story.path.filter((value) => value !== null).length / 2;
  if (!view.touched && !view.follow && (message.map || had === 0 || message.path.add.length > 0 || frameShown() !== view.frame)) fit();
  view.frame = frameShown();
  view.dirty = true;
  stats.messages += 1;
  tell();
}

const LOST = "the connection to slamsensor view is lost; trying again";
const QUIET_S = 3; // a message comes every quarter of a second
const link = {
  is_live: false,
  last: performance.now(),
  source: null,
  quiet_s() { return (performance.now() - this.last) / 1000; },
  isLost() { return this.is_live && (this.quiet_s() > QUIET_S || (this.source !== null && this.source.readyState === EventSource.CLOSED)); },
  show(text) {
    $("link").hidden = text === "";
    setText($("link"), text);
  },
  open() {
    this.is_live = true;
    const source = new EventSource("/api/stream");
    this.source = source;
    const opened = performance.now();
    source.onopen = () => { story.events = []; };
    source.onmessage = (event) => {
      this.last = performance.now();
      stats.bytes += event.data.length;
      const message = JSON.parse(event.data);
      take(message);
      if (message.events.length > 0 || story.events.length === 0) {
        story.events = [...story.events, ...message.events].slice(-500);
        tellEvents(story.events);
      }
    };
    // A stream that is refused or cut without a word is opened anew.
    const watch = setInterval(async () => {
      if (!this.isLost()) return;
      tell();
      view.dirty = true;
      $("lamp").className = "bad";
      if (source.readyState === EventSource.CLOSED || (this.quiet_s() > 8 && performance.now() - opened > 8000)) {
        clearInterval(watch);
        source.close();
        this.show(await this.refusal());
        setTimeout(() => this.open(), 1000);
      } else {
        this.show(LOST);
      }
    }, 1000);
  },
  /** Why there is no stream; an EventSource does not say. */
  async refusal() {
    const asking = new AbortController();
    setTimeout(() => asking.abort(), 3000);
    try {
      const answer = await fetch("/api/stream", { signal: asking.signal });
      return answer.ok ? LOST : (await answer.json()).error;
    } catch (error) {
      return LOST;
    } finally {
      asking.abort();
    }
  },
};

const player = {
  about: null, t: 0, playing: false, busy: false, wanted: null, map_version: -1,
  open(about) {
    this.about = about;
    $("player").hidden = false;
    const time = $("time");
    time.max = String(about.end - about.begin);
    time.addEventListener("input", () => this.seek(about.begin + Number(time.value)));
    $("play").addEventListener("click", () => this.play(!this.playing));
    if (about.warning) link.show(about.warning);
    this.drawMarks();
    new ResizeObserver(() => this.drawMarks()).observe($("marks"));
    this.seek(about.end);
    let before = performance.now();
    const tick = (now) => {
      if (this.playing) {
        const t = this.t + ((now - before) / 1000) * Number($("speed").value);
        if (t >= about.end) this.play(false);
        this.seek(Math.min(t, about.end));
      }
      before = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  },
  play(on) {
    if (on && this.t >= this.about.end) this.t = this.about.begin;
    this.playing = on;
    $("play").setAttribute("aria-pressed", String(on));
    setText($("play"), on ? "Pause" : "Play");
  },
  seek(t) {
    this.t = t;
    const passed = t - this.about.begin;
    $("time").value = String(passed);
    const text = `${timeText(t)} UTC, ${passed.toFixed(0)} of ${(this.about.end - this.about.begin).toFixed(0)} s`;
    setText($("clock"), text);
    $("time").setAttribute("aria-valuetext", text);
    this.wanted = t;
    this.fetch();
  },
  async fetch() {
    if (this.busy) return;
    this.busy = true;
    while (this.wanted !== null) {
      const t = this.wanted;
      this.wanted = null;
      try {
        const answer = await fetch(`/api/at?t=${t.toFixed(6)}&map=${this.map_version}`);
        const message = await answer.json();
        this.map_version = message.map_version;
        take(message);
        tellEvents(this.about.events.filter((event) => event.t <= t));
        link.show(this.about.warning);
      } catch (error) {
        link.show("slamsensor view does not answer; is it still running?");
        break;
      }
    }
    this.busy = false;
  },
  drawMarks() {
    const canvas = $("marks");
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!this.about || width === 0) return;
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const colours = ["bad", "warn", "good"].map((name) => style.getPropertyValue(`--${name}`).trim());
    const { begin, end, marks } = this.about;
    marks.forEach(([t, status], i) => {
      const next = i + 1 < marks.length ? marks[i + 1][0] : end;
      const x = ((t - begin) / Math.max(1e-9, end - begin)) * width;
      context.fillStyle = colours[status];
      context.fillRect(x, 0, Math.max(1, ((next - t) / Math.max(1e-9, end - begin)) * width), height);
    });
  },
};

/** Hands a request to the sensor: {ok, and text, code or error}. */
async function order(request, token) {
  if (!/^[\x20-\x7e]*$/.test(token)) return { ok: false, error: "a token has only printable ASCII characters" };
  try {
    const answer = await fetch("/api/ctl", {
      method: "POST",
      headers: { Authorization: `Bearer ${token}`, "Content-Type": "application/json" },
      body: JSON.stringify({ request }),
    });
    const said = await answer.json();
    return { ...said, ok: answer.ok && said.ok };
  } catch (error) {
    return { ok: false, error: "the connection to slamsensor view is lost; it is not known whether the sensor was told" };
  }
}

function offerControl() {
  $("control").hidden = false;
  for (const request of ["scan now", "scan pause", "scan resume", "map save", "map freeze", "map unfreeze", "record start", "record stop"]) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = request;
    button.addEventListener("click", async () => {
      setText($("answer"), "");
      const said = await order(request, $("token").value);
      $("answer").className = said.ok ? "good" : "bad";
      setText($("answer"), `${request}: ${said.error || said.text || (said.ok ? "done" : said.code)}`);
    });
    $("orders").append(button);
  }
}

async function start() {
  listenToTheme();
  listenToPointers();
  listenToKeys();
  requestAnimationFrame(loop);
  const answer = await fetch("/api/about");
  const about = await answer.json();
  if (about.control) offerControl();
  about.live ? link.open() : player.open(about);
}

window.slamsensorView = { story, view, stats, toScreen, player };
start().catch(() => { link.show("slamsensor view does not answer; load the page again"); });
