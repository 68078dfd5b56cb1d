// Draws a chart as the SVG of report/html/chart.cpp is drawn, by the same classes of report.css, at the
// size and over the ranges that it has on the screen. Its unit is a CSS pixel, from the upper left
// corner of the frame.

const MARGIN = {left: 70, right: 12, top: 10, bottom: 42};
const PIECE = 100;
const FEW_DOTS = 200;  // of a series, which are larger

function shape(name, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** Maps min..max, in logarithms where asked, to from..to, and back. */
function scaleOf({min, max, log}, from, to) {
  const a = log ? Math.log10(min) : min;
  const slope = (to - from) / ((log ? Math.log10(max) : max) - a);
  return log ? {to: (v) => from + (Math.log10(v) - a) * slope,
                back: (place) => 10 ** (a + (place - from) / slope)}
             : {to: (v) => from + (v - a) * slope, back: (place) => a + (place - from) / slope};
}

const clamped = (v, min, max) => Math.min(Math.max(v, min), max);
const tenths = (v) => Math.round(v * 10) / 10;
const minus = (text) => text.replace("-", "\u2212");
const power = (n) => `10${[...String(n)].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("")}`;
const withUnit = ({label, unit}) => (unit ? `${label} (${unit})` : label);

/** "mm/s" of "m/s" and -3; with the power itself where the unit takes no prefix. */
function scaledUnit(unit, n) {
  if (n === 0) return unit;
  const takesPrefix = /^(m|s|N|A|V|rad|Hz)(?=[ /]|$)/.test(unit) && n >= -12 && n <= 9;
  return takesPrefix ? "pnµm kMG"[n / 3 + 4] + unit : power(n) + (unit && ` ${unit}`);
}

/**
 * Round values in the range, about as many as wanted, their labels, and the name of the axis. The
 * labels are short; what they leave out, a power of a thousand or where they count from, is told by
 * the name.
 */
function ticksOf({min, max, log}, wanted, {label, unit}) {
  const ticks = [];
  if (log) {
    const [first, last] = [Math.ceil(Math.log10(min) - 1e-9), Math.floor(Math.log10(max) + 1e-9)];
    const every = Math.max(1, Math.ceil((last - first) / wanted));
    for (let n = first; n <= last; n += every)
      ticks.push({at: 10 ** n, label: n >= -2 && n <= 3 ? String(10 ** n) : power(n)});
    if (ticks.length > 1) return {ticks, name: withUnit({label, unit})};
    ticks.length = 0;
  }
  const span = max - min;
  const rough = span / wanted;
  const ten = 10 ** Math.floor(Math.log10(rough));
  const step = ten * [1, 2, 5, 10].find((m) => rough < m * ten * 1.5);
  let from = 0;
  if (span < 0.01 * Math.max(Math.abs(min), Math.abs(max))) {
    const round = 10 ** Math.ceil(Math.log10(span));
    from = round * Math.floor(min / round);
    label += ` from ${minus(String(Number(from.toPrecision(12))))}${unit && ` ${unit}`}`;
  }
  const largest = Math.max(Math.abs(min - from), Math.abs(max - from));
  const shift = largest >= 1e5 || largest < 0.01 ? 3 * Math.floor(Math.log10(largest) / 3) : 0;
  const decimals = Math.max(0, shift - Math.floor(Math.log10(step) + 1e-9));
  const first = Math.ceil(min / step - 1e-9);
  const count = Math.floor(max / step + 1e-9) - first + 1;
  for (let k = 0; k < count; k++) {
    const i = first + k;
    const value = i * step - from;
    const digits = minus((value / 10 ** shift).toFixed(decimals));
    ticks.push({at: i * step, label: Math.abs(value) < 0.5 * step ? "0" : digits});
  }
  return {ticks, name: withUnit({label, unit: scaledUnit(unit, shift)})};
}

/** First and last index of a series to draw for x from min to max: one more on either side. */
function visibleRange({xs, ys, sorted}, {min, max}) {
  const n = Math.min(xs.length, ys.length);
  if (!sorted) return [0, n - 1];
  return [Math.max(lowerBound(xs, min) - 1, 0), Math.min(lowerBound(xs, max), n - 1)];
}

/**
 * A line through the lowest and the highest sample of every column of pixels, in their order; in
 * pieces, since the time to stroke a path that crosses itself grows faster than its length.
 */
function linePaths(series, {x, y, toX, toY}) {
  const {xs, ys} = series;
  const steps = series.style === "steps";
  const [first, last] = visibleRange(series, x);
  const paths = [];
  let points = 0;
  let before;  // the last place of the line, where there is one to go on from
  const add = (atX, atY) => {
    const at = [tenths(atX), tenths(atY)];
    if (points++ % PIECE === 0) paths.push(before ? `M${before}` : "");
    paths[paths.length - 1] += !before ? `M${at}` : steps ? `H${at[0]}V${at[1]}` : `L${at}`;
    before = at;
  };
  let column = NaN;
  let lowX, lowY, highX, highY;
  const addColumn = () => {
    if (Number.isNaN(column)) return;
    if (lowX > highX) add(highX, highY);
    add(lowX, lowY);
    if (lowX <= highX && lowY !== highY) add(highX, highY);
  };
  for (let i = first; i <= last; i++) {
    const px = toX(xs[i]);
    const py = toY(ys[i]);
    if (!(px + py - (px + py) === 0)) {  // no value
      addColumn();
      column = NaN;
      before = undefined;
    } else if (Math.floor(px) !== column) {
      addColumn();
      column = Math.floor(px);
      lowX = highX = px;
      lowY = highY = py;
    } else {
      if (py < lowY) [lowX, lowY] = [px, py];
      if (py > highY) [highX, highY] = [px, py];
    }
  }
  addColumn();
  return paths;
}

/** Every sample in view as a line without length, which its round ends make a dot. */
function dotsPath(series, {x, width, height, toX, toY}) {
  const {xs, ys} = series;
  let path = "";
  const [first, last] = visibleRange(series, x);
  for (let i = first; i <= last; i++) {
    const px = toX(xs[i]);
    const py = toY(ys[i]);
    if (px >= 0 && px <= width && py >= 0 && py <= height)
      path += `M${tenths(px)} ${tenths(py)}h0`;
  }
  return path;
}

function drawnSeries(series, frame) {
  const {role, label} = series;
  const dots = series.style === "dots";
  const kind = !dots ? "" : series.xs.length <= FEW_DOTS ? " dots few" : " dots";
  const paths = dots ? [dotsPath(series, frame)] : linePaths(series, frame);
  return shape("g", {class: `series ${role}${kind}`, "data-label": label},
               ...paths.map((d) => shape("path", {d})));
}

/** Phases and bands. */
function drawnRanges({phases, bands}, {width, height, toX, toY}) {
  const places = phases.map(({from, to, kind}) => ({
    kind, left: clamped(toX(from), -10, width + 10), right: clamped(toX(to), -10, width + 10)}));
  return [
    ...places.map(({kind, left, right}) => shape("rect", {
      class: `phase ${kind}`, x: tenths(left), y: 0, width: tenths(Math.max(0.5, right - left)),
      height})),
    ...bands.map(({from, to}) => shape("rect", {
      class: "band", x: 0, y: tenths(toY(to)), width,
      height: Math.max(1, tenths(toY(from) - toY(to)))})),
  ];
}

/** Events as ticks at the upper edge, one per pixel and kind; where they are few, also as lines. */
function drawnEvents({list, times}, {x, width, height, toX}) {
  const shown = list.slice(lowerBound(times, x.min), lowerBound(times, x.max));
  const few = shown.length <= width / 12;
  const ticks = new Map();
  for (const {at, kind} of shown) {
    if (!ticks.has(kind)) ticks.set(kind, new Set());
    ticks.get(kind).add(Math.round(toX(at)));
  }
  return [...ticks].flatMap(([kind, places]) => {
    const path = (length) => [...places].map((px) => `M${px} 0v${length}`).join("");
    const tick = shape("path", {class: `event ${kind}`, d: path(8)});
    return few ? [shape("path", {class: `event line ${kind}`, d: path(height)}), tick] : [tick];
  });
}

/** The parts of the picture at the size, and the frame that tells where values are in it. */
function drawn(chart, size) {
  const width = size.width - MARGIN.left - MARGIN.right;
  const height = size.height - MARGIN.top - MARGIN.bottom;
  const [x, y] = [chart.rangeOf("x"), chart.rangeOf("y")];
  const [scaleX, scaleY] = [scaleOf(x, 0, width), scaleOf(y, height, 0)];
  const frame = {x, y, width, height, toX: scaleX.to, toY: scaleY.to, fromX: scaleX.back,
                 fromY: scaleY.back};
  const text = (kind, px, py, anchor, words, more = {}) =>
      shape("text", {class: kind, x: px, y: py, "text-anchor": anchor, ...more}, words);
  const grid = [];
  const labels = [];
  const [textX, textY] = [ticksOf(x, width / 80, chart.spec.x),
                          ticksOf(y, height / 36, chart.spec.y)];
  for (const {at, label} of textX.ticks) {
    const px = tenths(frame.toX(at));
    grid.push(shape("path", {class: "grid", d: `M${px} 0V${height}`}));
    labels.push(text("tick", px, height + 16, "middle", label));
  }
  for (const {at, label} of textY.ticks) {
    const py = tenths(frame.toY(at));
    grid.push(shape("path", {class: "grid", d: `M0 ${py}H${width}`}));
    labels.push(text("tick", -6, py + 4, "end", label));
  }
  const content = shape(
      "svg", {width, height}, ...drawnRanges(chart, frame), ...grid,
      ...chart.series.filter((s) => s.shown).map((s) => drawnSeries(s, frame)),
      ...drawnEvents(chart.events, frame),
      ...chart.bands.filter((b) => b.text).map(
          (b) => text("tick", width - 6, frame.toY(b.to) - 5, "end", b.text)));
  return {frame, parts: [
    content, ...labels,
    shape("path", {class: "axis", d: `M0 0V${height}H${width}`}),
    text("label", width / 2, height + 34, "middle", textX.name),
    text("label", -57, height / 2, "middle", textY.name,
         {transform: `rotate(-90 -57 ${height / 2})`}),
  ]};
}
