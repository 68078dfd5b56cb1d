// Makes the charts of report.html live.
//
// C++ writes the page: all text, tables, and a figure for every chart with its legend and a still
// SVG, and the data as JSON in <script> named charts. CMake puts the files of this folder, wrapped
// in one strict function, at its end:
//   columns.js  decodes the columns of numbers, exactly
//   drawing.js  draws a chart as SVG, which report.css styles as it does the still one
//   save.js     CSV, SVG and PNG of a chart
//   chart.js    one live chart: zoom, legend, readout, keys
//   report.js   starts the charts, links their zooms and cursors, light and dark
// Where anything is missing or fails, the static SVG stays. Names in the data come from users'
// files and only ever become text.
//
// For tests and the browser's console: window.axisfit.ready is a promise of the charts being
// live, window.axisfit.charts an object of them by id, each with x and y, the ranges it shows.

const HINT = "Drag across a chart to zoom. Double-click or Esc resets.";

/** What the charts of a page do together. */
class Report {
  charts = [];
  apart = false;

  /** Whether two charts share their zoom and cursor. */
  together(a, b) {
    if (a === b) return true;
    return Boolean(a.spec.time && b.spec.time) &&
           (!this.apart || a.spec.recording === b.spec.recording);
  }

  zoom(from, x) {
    for (const chart of this.charts) {
      if (!this.together(from, chart)) continue;
      if (!x || (chart.extent[0] < x[1] && chart.extent[1] > x[0])) chart.show(x);
    }
  }

  point(from, x) {
    for (const chart of this.charts)
      if (chart !== from && this.together(from, chart)) chart.point(x);
  }

  reset() {
    for (const chart of this.charts) chart.show(null);
  }

  /** Gives way to the browser, so that it can paint and listen between two charts. */
  async start({columns, charts}) {
    const decoded = new Columns(columns);
    const problems = [];
    for (const spec of charts) {
      await new Promise((go) => setTimeout(go));
      const figure = document.getElementById(spec.id);
      if (!figure) continue;
      try {
        this.charts.push(await Chart.of(figure, spec, decoded, this));
      } catch (error) {
        problems.push(`${spec.title}: ${error.message}`);
      }
    }
    return problems;
  }
}

/** The rule that holds the colours of the dark theme. */
function darkRule() {
  for (const sheet of document.styleSheets)
    for (const rule of sheet.cssRules)
      if (rule instanceof CSSMediaRule && rule.media.mediaText.includes("prefers-color-scheme"))
        return rule;
  return null;
}

/** A button that changes between light and dark, from what the system prefers. */
function themeButton() {
  const rule = darkRule();
  const system = matchMedia("(prefers-color-scheme: dark)");
  let dark = system.matches;
  const toggle = button("", "Light or dark", () => {
    dark = !dark;
    rule.media.mediaText = dark ? "screen" : "not all";
    apply();
  });
  const apply = () => {
    toggle.textContent = dark ? "Light" : "Dark";
    toggle.ariaLabel = toggle.title = dark ? "Light colours" : "Dark colours";
  };
  system.addEventListener("change", () => {
    dark = system.matches;
    apply();
  });
  apply();
  return toggle;
}

function controlsOf(report, recordings) {
  const controls = element("div", {className: "controls", role: "group", ariaLabel: "All charts"});
  if (recordings > 1) {
    const apart = element("input", {type: "checkbox", id: "apart"});
    apart.onchange = () => (report.apart = apart.checked);
    controls.append(element("label", {}, apart, "Zoom recordings separately"));
  }
  controls.append(button("Reset all", "Reset all charts", () => report.reset()),
                  themeButton());
  return controls;
}

async function startReport() {
  const report = new Report();
  const say = (text) => document.querySelector("main, body").append(
      element("p", {className: "quiet", textContent: text}));
  try {
    const data = JSON.parse(document.getElementById("charts").textContent);
    if (typeof DecompressionStream === "undefined")
      throw new Error("this browser cannot decompress their data");
    const recordings = new Set(data.charts.filter((c) => c.time).map((c) => c.recording));
    const bar = document.querySelector("nav") ?? document.querySelector("main");
    bar.append(controlsOf(report, recordings.size));
    document.querySelector("main").prepend(element("p", {
      id: "chart-keys",
      className: "unseen",
      textContent: "Arrow keys move the cursor, with Shift by one sample; Home and End go to the " +
                   "edges; plus and minus zoom, Page Up and Page Down move the view, 0 or Escape " +
                   "resets.",
    }));
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape") report.reset();
    });
    // What is wider than its frame is scrolled by keys too.
    for (const frame of document.querySelectorAll(".scroll")) frame.tabIndex = 0;
    // Before the page is painted: what comes later must not move it.
    const hint = element("p", {className: "hint", textContent: HINT});
    document.querySelector("main").prepend(hint);
    const problems = await report.start(data);
    if (!report.charts.length) hint.remove();
    if (problems.length)
      say(`Shown as static pictures: ${problems.join("; ")}.`);
  } catch (error) {
    say(`The charts are static pictures: ${error.message}.`);
  }
  return Object.fromEntries(report.charts.map((chart) => [chart.spec.id, chart]));
}

window.axisfit = {charts: {}};
window.axisfit.ready = startReport().then((charts) => (window.axisfit.charts = charts));
