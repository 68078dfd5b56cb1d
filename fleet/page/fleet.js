// fleet.html: a map of the axes, their alarms, a list with sparklines that draws only what is seen,
// and the history of one axis. The nights of a course are decoded when they are first asked for.
(() => {
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const stateColours = {parameter: "--changed", effect: "--effect", failures: "--failed", outlier: "--outlier"};

/** The numbers of a course: values and standard errors, axis by axis, a place for each night. */
const courses = new Map();
async function course(k) {
  if (!courses.has(k)) courses.set(k, (async () => {
    const unpack = async (id) => {
      const packed = Uint8Array.from(atob(byId(id).textContent), (c) => c.charCodeAt(0));
      const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
      return new Float32Array(await new Response(stream).arrayBuffer());
    };
    return {values: await unpack(`values-${k}`), errors: await unpack(`errors-${k}`)};
  })());
  return courses.get(k);
}
const nightsOf = (numbers, axis) => numbers.subarray(axis * data.nights.length, (axis + 1) * data.nights.length);

function rangeOf(values, errors) {
  let low = Infinity, high = -Infinity;
  values.forEach((v, i) => {
    if (!Number.isFinite(v)) return;
    const e = errors ? 1.96 * errors[i] : 0;
    low = Math.min(low, v - e);
    high = Math.max(high, v + e);
  });
  if (!(high > low)) { const d = Math.abs(low) * 0.01 || 1; low -= d; high += d; }
  return [low, high];
}

/** A canvas at the screen's resolution. */
function context(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const c = canvas.getContext("2d");
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, height);
  return {c, width, height};
}

function number(v) {
  if (!Number.isFinite(v)) return "";
  const size = Math.abs(v);
  return size > 0 && (size < 1e-3 || size >= 1e6) ? v.toExponential(2) : Number(v.toPrecision(4)).toString();
}

const [firstDay, lastDay] = [data.days[0], data.days[data.days.length - 1]];
const share = (night) => lastDay > firstDay ? (data.days[night] - firstDay) / (lastDay - firstDay) : 0.5;

function sparkline(canvas, values, alarms) {
  const {c, width, height} = context(canvas);
  const [low, high] = rangeOf(values);
  const x = (i) => 2 + share(i) * (width - 4), y = (v) => height - 3 - (v - low) / (high - low) * (height - 6);
  c.strokeStyle = colour("--accent");
  c.lineWidth = 1.2;
  c.beginPath();
  let drawn = false;
  values.forEach((v, i) => {
    if (!Number.isFinite(v)) return;
    if (drawn) c.lineTo(x(i), y(v)); else c.moveTo(x(i), y(v));
    drawn = true;
  });
  c.stroke();
  c.fillStyle = colour("--changed");
  for (const a of alarms) c.fillRect(x(a.at) - 1, 0, 2, height);
}

function chart(canvas, values, errors, alarms) {
  const {c, width, height} = context(canvas);
  const left = 62, bottom = 20, [low, high] = rangeOf(values, errors);
  const x = (i) => left + 4 + share(i) * (width - left - 10);
  const y = (v) => height - bottom - 4 - (v - low) / (high - low) * (height - bottom - 10);
  c.font = "12px system-ui, sans-serif";
  c.fillStyle = colour("--muted");
  c.textAlign = "right";
  for (const v of [low, (low + high) / 2, high]) {
    c.fillText(number(v), left - 4, y(v) + 4);
    c.fillStyle = colour("--line");
    c.fillRect(left, y(v), width - left, 1);
    c.fillStyle = colour("--muted");
  }
  c.textAlign = "left";
  c.fillText(data.nights[0], left, height - 4);
  c.textAlign = "right";
  c.fillText(data.nights[data.nights.length - 1], width - 2, height - 4);
  c.fillStyle = colour("--changed");
  for (const a of alarms) c.fillRect(x(a.at) - 1, 0, 2, height - bottom);
  c.strokeStyle = c.fillStyle = colour("--accent");
  values.forEach((v, i) => {
    if (!Number.isFinite(v)) return;
    c.beginPath();
    c.moveTo(x(i), y(v - 1.96 * errors[i]));
    c.lineTo(x(i), y(v + 1.96 * errors[i]));
    c.stroke();
    c.beginPath();
    c.arc(x(i), y(v), 2, 0, 7);
    c.fill();
  });
}

const element = (name, text = "", attributes = {}) => {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
};
const alarmsOf = (axis) => data.alarms.filter((a) => a.axis === axis);

/* The map. */
const map = byId("map");
data.axes.forEach((axis, i) => {
  const button = element("button", "", {title: axis.name, "aria-label": `${axis.name}: ${axis.state || "as it was"}`});
  if (axis.state) button.dataset.state = axis.state;
  button.addEventListener("click", () => show(i));
  map.append(button);
});

/* The alarms, the latest first. */
function alarmTable(alarms, withAxis) {
  const table = element("table"), head = element("tr");
  for (const title of withAxis ? ["axis", "night", "alarm"] : ["night", "alarm"]) head.append(element("th", title));
  table.append(head);
  for (const a of alarms) {
    const row = element("tr");
    if (withAxis) {
      const cell = element("td"), button = element("button", data.axes[a.axis].name);
      button.addEventListener("click", () => show(a.axis));
      cell.append(button);
      row.append(cell);
    }
    row.append(element("td", data.nights[a.at]), element("td", a.text));
    table.append(row);
  }
  return table;
}
const latest = [...data.alarms].sort((a, b) => b.at - a.at);
byId("alarms").append(latest.length ? alarmTable(latest.slice(0, 500), true)
                                    : element("p", "No axis has changed."));

/* The list: rows are made for what is seen, and used again. */
const list = byId("list"), filler = element("div"), select = byId("course"), filter = byId("filter");
const kRow = 34, rows = [];
let shown = data.axes.map((_, i) => i), chosen = 0, current = -1;
data.courses.forEach((c, k) => select.append(element("option", `${c.name} (${c.unit})`, {value: k})));
list.append(filler);

async function draw() {
  const {values} = await course(chosen);
  filler.style.height = `${shown.length * kRow}px`;
  const first = Math.max(0, Math.floor(list.scrollTop / kRow) - 2);
  const last = Math.min(shown.length, Math.ceil((list.scrollTop + list.clientHeight) / kRow) + 2);
  while (rows.length < last - first) {
    const row = element("div", "", {class: "row", role: "button", tabindex: "0"});
    row.append(element("i"), element("span"), element("canvas"), element("b"));
    const open = () => show(Number(row.dataset.axis));
    row.addEventListener("click", open);
    row.addEventListener("keydown", (e) => { if (e.key === "Enter" || e.key === " ") { e.preventDefault(); open(); } });
    rows.push(row);
    list.append(row);
  }
  rows.forEach((row, r) => {
    row.hidden = first + r >= last;
    if (row.hidden) return;
    const i = shown[first + r], axis = data.axes[i], own = nightsOf(values, i);
    row.style.transform = `translateY(${(first + r) * kRow}px)`;
    row.dataset.axis = i;
    row.setAttribute("aria-current", i === current);
    const [dot, name, canvas, value] = row.children;
    if (axis.state) dot.dataset.state = axis.state; else delete dot.dataset.state;
    name.textContent = axis.name;
    sparkline(canvas, own, alarmsOf(i).filter((a) => a.course === chosen));
    let latestValue = NaN;
    for (const v of own) if (Number.isFinite(v)) latestValue = v;
    value.textContent = number(latestValue);
  });
}
let waiting = false;
const drawSoon = () => {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
};
list.addEventListener("scroll", drawSoon);
window.addEventListener("resize", drawSoon);
select.addEventListener("change", () => { chosen = Number(select.value); draw(); });
filter.addEventListener("input", () => {
  shown = data.axes.map((_, i) => i).filter((i) => data.axes[i].name.includes(filter.value));
  list.scrollTop = 0;
  draw();
});

/* One axis. */
async function show(i) {
  current = i;
  [...map.children].forEach((b, k) => b.setAttribute("aria-current", k === i));
  drawSoon();
  const axis = data.axes[i], own = alarmsOf(i), charts = byId("charts");
  byId("axis-name").textContent = axis.name;
  byId("axis-text").textContent = `${axis.results} nights, ${axis.failed} of them failed. The job of a night: ` +
      `axisfit-fleet job FLEET.yaml ${axis.name} ${own.length ? data.nights[own[0].at] : data.nights.at(-1)}`;
  byId("axis-alarms").replaceChildren(own.length ? alarmTable(own, false) : element("p", "No alarm."));
  charts.replaceChildren();
  byId("axis").hidden = false;
  for (let k = 0; k < data.courses.length; ++k) {
    const {values, errors} = await course(k);
    if (current !== i) return;
    const mine = nightsOf(values, i);
    if (!mine.some(Number.isFinite)) continue;
    const figure = element("figure"), canvas = element("canvas", "", {role: "img",
      "aria-label": `${data.courses[k].name} of ${axis.name} over the nights`});
    figure.append(element("figcaption", `${data.courses[k].name}, ${data.courses[k].unit}`), canvas);
    charts.append(figure);
    chart(canvas, mine, nightsOf(errors, i), own.filter((a) => a.course === k));
  }
  byId("axis").scrollIntoView({block: "nearest"});
}

window.axisfitFleet = {ready: data.courses.length ? draw() : Promise.resolve(), show};
})();
