// What a chart can be saved as: CSV of its data, SVG and PNG of its view.

/** Quoted where needed; a cell that a spreadsheet would take for a formula becomes text. */
function csvCell(text) {
  const inert = /^[=+\-@\t\r\n]/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(inert) ? `"${inert.replaceAll('"', '""')}"` : inert;
}

/** One column of x where the series share it, else one of each, and the series, in full. */
function csvOf({spec, series}) {
  const columns = [];
  for (const s of series) {
    if (!columns.some((c) => c.values === s.xs))
      columns.push({name: withUnit(spec.x), values: s.xs});
    columns.push({name: withUnit({label: s.label, unit: spec.y.unit}), values: s.ys});
  }
  const lines = [columns.map((c) => csvCell(c.name)).join(",")];
  const rows = Math.max(...columns.map((c) => c.values.length));
  for (let i = 0; i < rows; i++)
    lines.push(
        columns.map(({values}) => (Number.isFinite(values[i]) ? values[i] : "")).join(","));
  return lines.join("\n") + "\n";
}

/** The chart as it is shown, with title, legend and axes, and nothing left to look up elsewhere. */
function svgOf(chart) {
  const {spec, series, ticks} = chart;
  const {width, height} = chart.plotSize();
  const margin = {left: 68, right: 16, top: 56, bottom: 44};
  const plot = {left: margin.left, top: margin.top, width, height};
  const surface =
      new SvgSurface(width + margin.left + margin.right, height + margin.top + margin.bottom);
  const frame = frameOf(plot, chart.rangeOf("x"), chart.rangeOf("y"), 1);
  const [right, bottom] = [plot.left + width, plot.top + height];

  surface.rectangle(
      0, 0, width + margin.left + margin.right, height + margin.top + margin.bottom,
      {colour: colour("paper")});
  surface.text(spec.title, 16, 22, {colour: colour("text"), size: 14, weight: 600});
  let x = plot.left;
  for (const {label, role, shown} of series) {
    if (!shown) continue;
    surface.rectangle(x, 38, 14, 3, {colour: colour(role)});
    surface.text(label, x + 20, 43, {colour: colour("muted"), size: 12});
    x += 44 + 6.5 * label.length;
  }

  drawBackground(surface, chart, frame);
  const grid = surface.path();
  const muted = {colour: colour("muted"), size: 11};
  ticks.x.places.forEach((at, i) => {
    const tick = tenths(frame.toX(at));
    if (at === null || tick < plot.left || tick > right || !ticks.x.labels[i]) return;
    grid.moveTo(tick, plot.top);
    grid.lineTo(tick, bottom);
    surface.text(ticks.x.labels[i], tick, bottom + 16, {...muted, anchor: "middle"});
  });
  ticks.y.places.forEach((at, i) => {
    const tick = tenths(frame.toY(at));
    if (at === null || tick < plot.top || tick > bottom || !ticks.y.labels[i]) return;
    grid.moveTo(plot.left, tick);
    grid.lineTo(right, tick);
    surface.text(ticks.y.labels[i], plot.left - 8, tick + 4, {...muted, anchor: "end"});
  });
  surface.stroke(grid, {colour: colour("line"), width: 1});
  surface.text(
      withUnit(spec.x), plot.left + width / 2, bottom + 35, {...muted, anchor: "middle", size: 12});
  surface.text(
      withUnit(spec.y), 16, plot.top + height / 2,
      {...muted, anchor: "middle", size: 12, rotate: -90});
  drawContent(surface, chart, frame);
  return surface.toString();
}

/** The same picture at twice the size of the screen. */
async function pngOf(chart) {
  const url = URL.createObjectURL(new Blob([svgOf(chart)], {type: "image/svg+xml"}));
  try {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = 2 * image.width;
    canvas.height = 2 * image.height;
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise((done) => canvas.toBlob(done, "image/png"));
  } finally {
    URL.revokeObjectURL(url);
  }
}

function save(name, content, type) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], {type}));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** What the buttons offer, with the ending of the file. */
const FORMATS = {
  PNG: async (chart) => save(`${chart.fileName}.png`, await pngOf(chart)),
  SVG: (chart) => save(`${chart.fileName}.svg`, svgOf(chart), "image/svg+xml"),
  CSV: (chart) => save(`${chart.fileName}.csv`, csvOf(chart), "text/csv"),
};
