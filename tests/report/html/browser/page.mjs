// A report page by the same rules as report/html/report_page.cpp, of synthetic recordings: for tests of
// the script that need a page of known numbers.
//   node page.mjs ASSETS_CSS ASSETS_SCRIPT > report.html

import {readFileSync} from "node:fs";
import {fileURLToPath} from "node:url";
import {deflateSync} from "node:zlib";

export const HOSTILE = ["<script>alert(1)</script>", '"><img src=x onerror=alert(2)>'];
export const SAMPLES = 20000;

const escaped = (text) =>
    String(text).replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);

/** What report.js decodes: differences of integers, bytes shuffled, deflated, base64. */
export function encodedColumn(multiples, step) {
  const n = multiples.length;
  const bytes = Buffer.alloc(4 * n);
  let last = 0;
  multiples.forEach((k, i) => {
    const difference = (k - last) | 0;
    last = k;
    for (let plane = 0; plane < 4; plane++)
      bytes[plane * n + i] = (difference >>> (8 * plane)) & 0xff;
  });
  return {length: n, step, data: deflateSync(bytes, {level: 9}).toString("base64")};
}

/** The same numbers in every run. */
function randomNumbers(seed) {
  let state = seed;
  const uniform = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

/** Columns and charts of a page, with the decimals of the columns for comparison. */
export function pageData({samples = SAMPLES, recordings = ["step", HOSTILE[1]]} = {}) {
  const columns = [];
  const charts = [];
  const add = (values, step) => {
    const integers = values.map((v) => (v === null ? -(2 ** 31) : Math.round(v / step)));
    return columns.push(encodedColumn(integers, step)) - 1;
  };

  recordings.forEach((recording, r) => {
    const normal = randomNumbers(r + 1);
    const interval = 2.5e-4;
    const time = columns.push({length: samples, start: r ? 0 : -0.1, interval}) - 1;
    const times = Array.from({length: samples}, (_, i) => (r ? 0 : -0.1) + i * interval);
    const ringing = times.map((t) => {
      const since = ((t % 1.25) + 1.25) % 1.25;
      const sign = Math.floor(t / 1.25) % 2 ? -1 : 1;
      return sign * 0.25 * (1 - Math.exp(-9 * since) * Math.cos(2 * Math.PI * (11 + r) * since));
    });
    const end = r ? samples : Math.round(samples * 0.93);  // the simulation gives up
    const simulated = add(ringing.slice(0, end), 1e-5);
    const velocity = add(ringing.map((v) => v + 0.004 * normal()), 1e-4);
    const crossings = (up) => add(times.filter((_, i) =>
        i && (ringing[i] > 0.25) === up && (ringing[i - 1] > 0.25) !== up), 1e-5);
    const events = [
      {kind: "contact", text: "teeth touch", at: crossings(true)},
      {kind: "separation", text: "teeth part", at: crossings(false)},
    ];
    const phases = [0, 1, 2, 3].flatMap((k) => [
      {from: 1.25 * k + 0.8, to: 1.25 * k + 1.25, kind: "standstill", text: "at rest"},
      {from: 1.25 * k + 0.02, to: 1.25 * k + 0.06, kind: "limit", text: "V_c at its limit"},
    ]);
    const common = {kind: "lines", x: {label: "time", unit: "s"}, time: true, recording, phases};
    const unit = "m/s";
    charts.push({
      ...common,
      id: `velocity-${r}`,
      title: `${recording}: velocity`,
      y: {label: "velocity", unit},
      series: [
        {label: "measured", role: "measured", x: time, y: velocity},
        {label: "simulated", role: "simulated", x: time, y: simulated},
      ],
      events,
    });
    charts.push({
      ...common,
      id: `residual-${r}`,
      title: `${recording}: residual of the velocity`,
      y: {label: "residual", unit},
      series: [{label: "residual", role: "residual", x: time, y: velocity, minus: simulated}],
    });
    const force = add(ringing.map((v, i) => (i % 977 ? 40 * v : null)), 0.01);
    charts.push({
      ...common,
      id: `force-${r}`,
      title: `${recording}: ${HOSTILE[r]}`,
      y: {label: HOSTILE[r], unit: "N"},
      series: [{label: `=${HOSTILE[r]}`, role: "force", style: "steps", x: time, y: force}],
    });
  });

  const normal = randomNumbers(9);
  const speed = Array.from({length: 6000}, () => 0.2 * normal());
  const missing = speed.map((v) => 4 * Math.sign(v) + 12 * v + 0.7 * normal());
  const speeds = add(speed, 1e-4);
  const forces = add(missing, 0.01);
  const grid = Array.from({length: 41}, (_, i) => (i - 20) / 40);
  charts.push({
    id: "by-speed",
    title: "Missing force by speed",
    kind: "points",
    x: {label: "speed", unit: "m/s"},
    y: {label: "force", unit: "N"},
    series: [
      {label: "samples", role: "force", x: speeds, y: forces},
      {label: "mean", role: "mean", style: "line", x: add(grid, 0.025),
       y: add(grid.map((v) => 4 * Math.sign(v) + 12 * v), 0.01)},
    ],
  });
  const lags = columns.push({length: 200, start: 0, interval: 0.001}) - 1;
  charts.push({
    id: "correlation",
    title: "Autocorrelation of the residual",
    kind: "lines",
    x: {label: "lag", unit: "s"},
    y: {label: "correlation", unit: ""},
    series: [{label: "residual", role: "residual", style: "steps", x: lags,
              y: add(Array.from({length: 200}, (_, i) => (i ? 0.008 * normal() : 1)), 1e-4)}],
    bands: [{from: -0.02, to: 0.02, text: "95 % band of white noise"}],
  });
  const frequencies = Array.from({length: 500}, (_, i) => i + 1);
  charts.push({
    id: "spectrum",
    title: "Spectrum of the residual",
    kind: "lines",
    x: {label: "frequency", unit: "Hz", log: true},
    y: {label: "power", unit: "(m/s)²/Hz", log: true},
    series: [{label: "residual", role: "residual", x: add(frequencies, 1),
              y: add(frequencies.map((f) => 1e-5 * (1 + 50 / (1 + (f - 40) ** 2 / 9) +
                                                    0.3 * Math.abs(normal()))), 1e-8)}],
  });
  const rounds = columns.push({length: 12, start: 0, interval: 1}) - 1;
  charts.push({
    id: "cost",
    title: "Cost by iteration",
    kind: "lines",
    x: {label: "iteration", unit: ""},
    y: {label: "cost", unit: "", log: true},
    series: [{label: "cost", role: "accepted", x: rounds,
              y: add(Array.from({length: 12}, (_, i) => 1 + 1e5 * 10 ** -i), 1e-3)}],
  });
  return {columns, charts};
}

/** Values of a column, by the arithmetic of a test: decimals of the step. */
export function decimals({length, start, interval, step}, multiples) {
  const places = (v) => {
    const [digits, exponent = "0"] = String(v).split("e");
    return Math.max(0, (digits.split(".")[1] ?? "").length - Number(exponent));
  };
  if (step === undefined)
    return Array.from({length}, (_, i) =>
        Number((start + i * interval).toFixed(Math.max(places(start), places(interval)))));
  return multiples.map((k) => Number((k * step).toFixed(places(step))));
}

/** A picture of the right shape; that of the program has axes and phases too. */
function picture(chart) {
  const curve = ({role, style = chart.kind === "points" ? "dots" : "line"}, phase) => {
    const points = Array.from({length: 120}, (_, i) =>
        `${60 + i * 5.3},${130 - 80 * Math.exp(-i / 40) * Math.cos(i / 4 + phase)}`);
    const d = style === "dots" ? points.map((p) => `M${p}h0`).join("") : `M${points.join("L")}`;
    return `<path class="series ${escaped(role)}${style === "dots" ? " dots" : ""}" d="${d}"/>`;
  };
  const grid = [50, 90, 130, 170, 210].map(
      (y, i) => `<path class="grid" d="M60 ${y}H700"/>` +
                `<text class="tick" x="52" y="${y + 4}" text-anchor="end">${2 - i}</text>`);
  const below = [0, 1, 2, 3, 4].map(
      (v) => `<text class="tick" x="${60 + 160 * v}" y="240" text-anchor="middle">${v}</text>`);
  return `<svg viewBox="0 0 720 270" role="img" aria-label="${escaped(chart.title)}">
<rect class="phase standstill" x="300" y="20" width="90" height="200"/>
<path class="event contact" d="M120 20V220"/>
${grid.join("")}${below.join("")}<path class="axis" d="M60 220H700"/>
<text class="label" x="380" y="262" text-anchor="middle">${escaped(chart.x.label)}</text>
${chart.series.map((s, i) => curve(s, i / 5)).join("")}</svg>`;
}

export const figure = (chart) => `<figure class="chart" id="${escaped(chart.id)}">
<figcaption>${escaped(chart.title)}</figcaption><div class="tools"></div>
<div class="legend">${chart.series.map((s) => `<span class="key"><span class="swatch ${escaped(s.role)}"></span>${
    escaped(s.label)}</span>`).join("")}</div><div class="reading"></div>
${picture(chart)}
</figure>`;

const ROWS = [
  ["m_eff", "effective mass", "12.418", "0.021", "12.377 .. 12.459", "kg", "determined"],
  ["F_c", "Coulomb friction", "4.06", "0.11", "3.84 .. 4.28", "N", "determined"],
  ["d", "damping", "~10", "-", "-", "N s/m", "open"],
  ["backlash", "play of the gear", "0.00012", "0.00004", "0.00004 .. 0.00020", "m", "weak"],
];

export function pageHtml(data, css, script) {
  const of = (...ids) => data.charts.filter((c) => ids.some((id) => c.id.startsWith(id)));
  const json = JSON.stringify(data).replaceAll("<", "\\u003c");
  const small = (charts) => `<div class="figures">${charts.map(figure).join("\n")}</div>`;
  return `<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Report of a job</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:">
<style>${css}</style></head><body>
<a class="skip" href="#main">Skip to the report</a>
<header><h1>Arm of the gantry, x axis</h1>
<div class="verdict good"><p>The model explains both recordings down to their noise; two of four
parameters are determined.</p></div></header>
<nav aria-label="Sections"><ul><li><a href="#verdict">Verdict</a><li><a href="#recordings">Recordings</a>
<li><a href="#parameters">Parameters</a><li><a href="#residual">Residual</a>
<li><a href="#convergence">Convergence</a></ul></nav>
<main id="main">
<section id="verdict"><h2>Verdict</h2>
<dl class="numbers"><div><dt>error of the velocity</dt><dd>4.01<span class="unit">mm/s</span></dd></div>
<div><dt>reduced chi-square</dt><dd>1.02</dd></div><div><dt>of range</dt><dd>0.8<span class="unit">%</span></dd></div>
<div><dt>samples</dt><dd>40 000</dd></div></dl>
<p>Two recordings were fitted with four free parameters. The damping is not determined by them: see
<a href="#parameters">the parameters</a>.</p></section>
<section id="recordings"><h2>Recordings</h2>
${of("velocity", "residual", "force").map(figure).join("\n")}</section>
<section id="parameters"><h2>Parameters</h2><div class="scroll"><table><thead><tr><th>name</th>
<th>meaning</th><th class="number">value</th><th class="number">std. error</th>
<th class="number">95 % interval</th><th>unit</th><th>verdict</th></tr></thead><tbody>
${ROWS.map(([name, meaning, ...cells]) => `<tr><th scope="row">${name}</th><td>${meaning}</td>${
    cells.slice(0, 3).map((c) => `<td class="number">${c}</td>`).join("")}<td>${cells[3]}</td>
<td><span class="badge ${cells[4]}">${cells[4]}</span></td></tr>`).join("\n")}
</tbody></table></div></section>
<section id="residual"><h2>Residual</h2>${small(of("by-speed", "correlation", "spectrum"))}</section>
<section id="convergence"><h2>Convergence</h2>${small(of("cost"))}</section>
</main>
<script type="application/json" id="charts">${json}</script>
<script>${script}</script>
</body></html>`;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [css, script] = process.argv.slice(2, 4).map((path) => readFileSync(path, "utf8"));
  process.stdout.write(pageHtml(pageData(), css, script));
}
