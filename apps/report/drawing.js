// Draws the content of a chart through a surface: a canvas on the screen, or SVG to save. Both get
// the same paths in CSS pixels, thinned to what a pixel can show.

const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

/** The colour that report.css gives a role, kind or part, in the theme of the moment. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Width of line and dashes of the roles that are not drawn as the others are. */
const STROKES = {
  measured: {width: 1.75},
  mean: {width: 1.75},
  accepted: {width: 1.75},
  band: {width: 1, dash: [2, 3]},
  reference: {width: 1, dash: [5, 4]},
};
const strokeOf = (role) => ({width: 1.25, dash: [], ...STROKES[role], colour: colour(role)});

/**
 * A path in pieces, since the time to stroke one that crosses itself grows faster than its length:
 * two noisy traces of 100,000 samples took 130 ms in one piece.
 */
class CanvasPath {
  pieces = [];
  points = 0;

  moveTo(x, y) {
    if (this.points % 100 === 0) this.pieces.push(new Path2D());
    this.pieces.at(-1).moveTo(x, y);
    this.points++;
    this.x = x;
    this.y = y;
  }

  lineTo(x, y) {
    if (this.points % 100 === 0) this.moveTo(this.x, this.y);
    this.pieces.at(-1).lineTo(x, y);
    this.points++;
    this.x = x;
    this.y = y;
  }
}

class CanvasSurface {
  constructor(context) {
    this.context = context;
  }

  path() {
    return new CanvasPath();
  }

  stroke(path, {colour, width, dash = [], opacity = 1}) {
    const c = this.context;
    c.globalAlpha = opacity;
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.lineJoin = "bevel";
    for (const piece of path.pieces) c.stroke(piece);
  }

  rectangle(x, y, width, height, {colour, opacity = 1}) {
    this.context.globalAlpha = opacity;
    this.context.fillStyle = colour;
    this.context.fillRect(x, y, width, height);
  }

  dots(points, radius, {colour, opacity}) {
    const c = this.context;
    c.globalAlpha = opacity;
    c.fillStyle = colour;
    const round = points.length < 10000;  // x and y of 5000
    for (let i = 0; i < points.length; i += 2) {
      if (round) {
        c.beginPath();
        c.arc(points[i], points[i + 1], radius, 0, 2 * Math.PI);
        c.fill();
      } else {
        c.fillRect(points[i] - radius, points[i + 1] - radius, 2 * radius, 2 * radius);
      }
    }
  }

  text(string, x, y, {colour, size = 11, anchor = "start"}) {
    const c = this.context;
    c.globalAlpha = 1;
    c.fillStyle = colour;
    c.font = `${size}px ${FONT}`;
    c.textAlign = anchor === "middle" ? "center" : anchor;
    c.textBaseline = "alphabetic";
    c.fillText(string, x, y);
  }

  /** Calls draw with everything outside the rectangle cut off. */
  within({left, top, width, height}, draw) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(left, top, width, height);
    this.context.clip();
    draw();
    this.context.restore();
  }
}

const tenths = (v) => Math.round(v * 10) / 10;

/** Has the part of Path2D that is needed here, and is the text of an SVG path. */
class SvgPath {
  parts = [];

  moveTo(x, y) {
    this.parts.push(`M${tenths(x)} ${tenths(y)}`);
  }

  lineTo(x, y) {
    this.parts.push(`L${tenths(x)} ${tenths(y)}`);
  }

  toString() {
    return this.parts.join("");
  }
}

class SvgSurface {
  constructor(width, height) {
    this.root = this.group = this.make("svg", {
      width,
      height,
      viewBox: `0 0 ${width} ${height}`,
      "font-family": FONT,
    });
  }

  make(name, attributes) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  }

  add(name, attributes) {
    return this.group.appendChild(this.make(name, attributes));
  }

  path() {
    return new SvgPath();
  }

  stroke(path, {colour, width, dash = [], opacity = 1, name}) {
    const line = this.add("path", {
      d: path,
      fill: "none",
      stroke: colour,
      "stroke-width": width,
      "stroke-linejoin": "round",
      "stroke-opacity": opacity,
    });
    if (dash.length) line.setAttribute("stroke-dasharray", dash.join(" "));
    this.name(line, name);
  }

  rectangle(x, y, width, height, {colour, opacity = 1}) {
    this.add("rect", {
      x: tenths(x),
      y: tenths(y),
      width: tenths(width),
      height: tenths(height),
      fill: colour,
      "fill-opacity": opacity,
    });
  }

  dots(points, radius, {colour, opacity, name}) {
    let d = "";
    for (let i = 0; i < points.length; i += 2)
      d += `M${tenths(points[i])} ${tenths(points[i + 1])}h0`;
    this.name(
        this.add("path", {
          d,
          fill: "none",
          stroke: colour,
          "stroke-width": 2 * radius,
          "stroke-linecap": "round",
          "stroke-opacity": opacity,
        }),
        name);
  }

  text(string, x, y, {colour, size = 11, anchor = "start", weight = 400, rotate}) {
    const text = this.add("text", {
      x: tenths(x),
      y: tenths(y),
      fill: colour,
      "font-size": size,
      "font-weight": weight,
      "text-anchor": anchor,
    });
    if (rotate) text.setAttribute("transform", `rotate(${rotate} ${tenths(x)} ${tenths(y)})`);
    text.textContent = forXml(string);
  }

  within({left, top, width, height}, draw) {
    const clip = this.add("clipPath", {id: "plot"});
    clip.append(this.make("rect", {x: left, y: top, width, height}));
    const outer = this.group;
    this.group = outer.appendChild(this.make("g", {"clip-path": "url(#plot)"}));
    draw();
    this.group = outer;
  }

  /** Says in the file, and to a hand that edits it, which series this is. */
  name(element, name) {
    if (name === undefined) return;
    const title = element.appendChild(this.make("title", {}));
    title.textContent = forXml(name);
  }

  toString() {
    return new XMLSerializer().serializeToString(this.root);
  }
}

/** XML has no way to hold control characters and halves of surrogate pairs. */
function forXml(string) {
  return string.replace(/[\0-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]|\p{Surrogate}/gu, "\ufffd");
}

/** Maps min..max, in logarithms where asked, to from..to. */
function scaleTo({min, max, log}, from, to) {
  const a = log ? Math.log10(min) : min;
  const slope = (to - from) / ((log ? Math.log10(max) : max) - a);
  return log ? (v) => from + (Math.log10(v) - a) * slope : (v) => from + (v - a) * slope;
}

/**
 * Where a chart is drawn: its rectangle in CSS pixels, the ranges it shows, device pixels per pixel.
 */
function frameOf({left, top, width, height}, x, y, resolution) {
  return {
    left,
    top,
    width,
    height,
    x,
    y,
    resolution,
    toX: scaleTo(x, left, left + width),
    toY: scaleTo(y, top + height, top),
  };
}

/** First and last index of a series to draw for x from min to max: one more on either side. */
function visibleRange({xs, ys, sorted}, {min, max}) {
  const n = Math.min(xs.length, ys.length);
  if (!sorted) return [0, n - 1];
  return [Math.max(lowerBound(xs, min) - 1, 0), Math.min(lowerBound(xs, max), n - 1)];
}

/**
 * The line of a series. Of consecutive samples in the same column of pixels only the first, the
 * lowest, the highest and the last are drawn, so that no spike is lost and the length of the path
 * does not depend on the number of samples.
 */
function linePath(path, series, frame) {
  const {xs, ys, style} = series;
  const {toX, toY, resolution} = frame;
  const [first, last] = visibleRange(series, frame.x);
  const steps = style === "steps";
  let column = NaN;
  let joined = false;  // whether the path goes on from the column before
  let startX, startY, lowX, lowY, highX, highY, x, y;

  const drawColumn = () => {
    if (joined) path.lineTo(startX, startY);
    else path.moveTo(startX, startY);
    if (lowY < highY) {
      path.lineTo(lowX, lowY);
      path.lineTo(highX, highY);
    } else if (highY < lowY) {
      path.lineTo(highX, highY);
      path.lineTo(lowX, lowY);
    }
    if (x !== startX || y !== startY) path.lineTo(x, y);
    joined = true;
  };

  let open = false;  // whether the column has a sample
  for (let i = first; i <= last; i++) {
    const nextX = toX(xs[i]);
    const nextY = toY(ys[i]);
    if (!Number.isFinite(nextX + nextY)) {
      if (open) drawColumn();
      open = joined = false;
      continue;
    }
    const nextColumn = Math.floor(nextX * resolution);
    if (open && nextColumn === column) {
      if (nextY < lowY) [lowX, lowY] = [nextX, nextY];
      if (nextY > highY) [highX, highY] = [nextX, nextY];
    } else {
      if (open) drawColumn();
      if (steps && joined) path.lineTo(nextX, y);
      column = nextColumn;
      open = true;
      startX = lowX = highX = nextX;
      startY = lowY = highY = nextY;
    }
    x = nextX;
    y = nextY;
  }
  if (open) drawColumn();
  return path;
}

/** Pixel coordinates x, y, x, y, ... of the dots in view. */
function dotsInView(series, frame) {
  const {xs, ys} = series;
  const {toX, toY, left, top, width, height} = frame;
  const points = [];
  const [first, last] = visibleRange(series, frame.x);
  for (let i = first; i <= last; i++) {
    const x = toX(xs[i]);
    const y = toY(ys[i]);
    if (x >= left && x <= left + width && y >= top && y <= top + height) points.push(x, y);
  }
  return points;
}

function drawSeries(surface, series, frame) {
  const {role, style, label} = series;
  if (style === "dots") {
    const points = dotsInView(series, frame);
    const count = points.length / 2;
    surface.dots(points, count > 3000 ? 1.25 : count > 200 ? 1.75 : 2.75, {
      colour: colour(role),
      opacity: Math.min(0.85, Math.max(0.25, 30 / Math.sqrt(count))),
      name: label,
    });
  } else {
    surface.stroke(linePath(surface.path(), series, frame), {...strokeOf(role), name: label});
  }
}

/** Shaded phases and bands, below grid and traces. */
function drawBackground(surface, {phases, bands}, frame) {
  const {left, top, width, height, toX, toY} = frame;
  surface.within(frame, () => {
    for (const {from, to, kind} of phases) {
      const x = Math.max(toX(from), left);
      const end = Math.min(toX(to), left + width);
      if (end > x)
        surface.rectangle(x, top, end - x, height, {colour: colour(kind), opacity: 0.1});
    }
    for (const {from, to} of bands) {
      const y = toY(Math.max(from, to));
      surface.rectangle(
          left, y, width, toY(Math.min(from, to)) - y, {colour: colour("band"), opacity: 0.1});
    }
  });
}

/** Events as ticks at the upper edge, one per pixel and kind; where they are few, also as lines. */
function drawEvents(surface, events, frame) {
  const {left, top, width, height, toX, resolution} = frame;
  const first = lowerBound(events.times, frame.x.min);
  const last = lowerBound(events.times, frame.x.max);
  const few = last - first <= width / 12;
  const ticks = new Map();   // path and last column of each kind
  for (let i = first; i < last; i++) {
    const {at, kind} = events.list[i];
    const x = toX(at);
    const column = Math.floor(x * resolution);
    if (!ticks.has(kind)) ticks.set(kind, {path: surface.path(), lines: surface.path()});
    const tick = ticks.get(kind);
    if (tick.column === column) continue;
    tick.column = column;
    tick.path.moveTo(x, top);
    tick.path.lineTo(x, top + 8);
    tick.lines.moveTo(x, top + 8);
    tick.lines.lineTo(x, top + height);
  }
  for (const [kind, {path, lines}] of ticks) {
    if (few) surface.stroke(lines, {colour: colour(kind), width: 1, opacity: 0.28});
    surface.stroke(path, {colour: colour(kind), width: 1.25, name: kind});
  }
}

function drawContent(surface, {series, bands, events}, frame) {
  surface.within(frame, () => {
    for (const s of series) if (s.shown) drawSeries(surface, s, frame);
    drawEvents(surface, events, frame);
    for (const {from, to, text} of bands)
      if (text)
        surface.text(text, frame.left + frame.width - 6, frame.toY(Math.max(from, to)) - 5, {
          colour: colour("muted"),
          anchor: "end",
        });
  });
}

/** Labels of the ticks at the given places, with the decimals that their distance needs. */
function tickLabels(places, distance, log) {
  if (log)
    return places.map((v) => {
      if (v === null) return "";
      const power = Math.round(Math.log10(v));
      if (Math.abs(v - 10 ** power) > 1e-9 * v) return shortNumber(v);
      return power >= -2 && power <= 3 ? String(10 ** power) : `10${superscript(power)}`;
    });
  const largest = Math.max(...places.map(Math.abs));
  if (largest >= 1e5 || (largest < 1e-3 && largest > 0)) {
    const power = Math.floor(Math.log10(largest) + 1e-9);
    const decimals = Math.max(0, power - Math.floor(Math.log10(distance) + 1e-9));
    return places.map(
        (v) => Math.abs(v) < distance * 1e-6
                   ? "0"
                   : `${(v / 10 ** power).toFixed(decimals)}·10${superscript(power)}`.replace(
                         "-", "\u2212"));
  }
  const decimals = Math.max(0, -Math.floor(Math.log10(distance) + 1e-9));
  const needed = Math.abs(distance * 10 ** decimals - Math.round(distance * 10 ** decimals)) > 1e-6;
  return places.map((v) => {
    const text = v.toFixed(decimals + (needed ? 1 : 0));
    return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
  });
}

const shortNumber = (v) => String(Number(v.toPrecision(3))).replace("-", "\u2212");
const superscript = (n) => [...String(n)].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("");

const withUnit = ({label, unit}) => (unit ? `${label} (${unit})` : label);
