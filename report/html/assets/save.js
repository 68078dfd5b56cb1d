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

/** What a part looks like by the style sheet, as attributes; they are inherited within SVG. */
const LOOKS = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity",
               "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "font-family", "font-size",
               "text-anchor"];

function withLooks(part, inherited = {}) {
  const copy = part.cloneNode(false);
  if (part.nodeType !== Node.ELEMENT_NODE) return copy;
  copy.removeAttribute("class");
  const style = getComputedStyle(part);
  for (const name of LOOKS)
    if (style.getPropertyValue(name) !== inherited.getPropertyValue?.(name))
      copy.setAttribute(name, style.getPropertyValue(name));
  copy.append(...[...part.childNodes].map((child) => withLooks(child, style)));
  return copy;
}

/** XML has no way to hold control characters and halves of surrogate pairs. */
function forXml(string) {
  return string.replace(/[\0-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]|\p{Surrogate}/gu, "\ufffd");
}

/** The chart as it is shown, with title and legend, and nothing left to look up elsewhere. */
function svgOf({spec, series, size, plot, drawing}) {
  const colour = (name) => getComputedStyle(plot).getPropertyValue(`--${name}`).trim();
  const {width, height} = size;
  const above = 48;
  const picture = withLooks(drawing);
  picture.setAttribute("transform", `translate(${MARGIN.left} ${MARGIN.top + above})`);
  for (const line of picture.querySelectorAll("[data-label]")) {
    line.prepend(shape("title", {}, line.dataset.label));
    delete line.dataset.label;
  }
  const root = shape(
      "svg", {width, height: height + above, viewBox: `0 0 ${width} ${height + above}`,
              "font-family": getComputedStyle(plot).fontFamily, "font-size": 12},
      shape("rect", {width: "100%", height: "100%", fill: colour("paper")}),
      shape("text", {x: 16, y: 22, fill: colour("text"), "font-size": 14, "font-weight": 600},
            spec.title));
  let x = MARGIN.left;
  for (const {label, role, shown} of series) {
    if (!shown) continue;
    root.append(shape("rect", {x, y: 38, width: 14, height: 3, fill: colour(role)}),
                shape("text", {x: x + 20, y: 43, fill: colour("muted")}, label));
    x += 44 + 6.5 * label.length;
  }
  root.append(picture);
  return forXml(new XMLSerializer().serializeToString(root));
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
