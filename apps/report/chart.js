// One live chart in its figure: uPlot has the axes, the selection and the cursor's line; the
// content is drawn by drawing.js, so that what is saved is what is shown.

function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const button = (text, name, action) =>
    element("button", {type: "button", textContent: text, title: name, ariaLabel: name,
                       onclick: action});

/** Range of the finite (and, for logarithms, positive) values between two indices. */
function extentOf(values, log, first = 0, last = values.length - 1, where = () => true) {
  let min = Infinity;
  let max = -Infinity;
  for (let i = first; i <= last; i++) {
    const v = values[i];
    if (!(v - v === 0) || (log && v <= 0) || !where(i)) continue;
    if (v < min) min = v;
    if (v > max) max = v;
  }
  return [min, max];
}

/** The range with a margin on either side; something to look at where it is empty. */
function widened([min, max], margin, log) {
  if (min > max) return log ? [1, 10] : [0, 1];
  if (log) {
    const factor = max > min ? (max / min) ** margin : 2;
    return [min / factor, max * factor];
  }
  const extra = max > min ? (max - min) * margin : Math.abs(max) * 0.05 || 1;
  return [min - extra, max + extra];
}

const union = ([a, b], [c, d]) => [Math.min(a, c), Math.max(b, d)];

class Chart {
  /** linked is told of zooms and cursors: zoom(chart, x), point(chart, x). */
  static async of(figure, spec, columns, linked) {
    const series = await Promise.all(spec.series.map(async ({label, role, style, x, y, minus}) => {
      const [xs, ys] = await Promise.all([columns.values(x), columns.values(y, minus)]);
      const drawn = style ?? (spec.kind === "points" ? "dots" : "line");
      return {label, role, style: drawn, xs, ys, sorted: isSorted(xs), shown: true};
    }));
    const events = await Promise.all((spec.events ?? []).map(async ({kind, text, at}) =>
        Array.from(await columns.values(at), (time) => ({at: time, kind, text}))));
    return new Chart(figure, spec, series, events.flat(), linked);
  }

  constructor(figure, spec, series, events, linked) {
    this.figure = figure;
    this.spec = spec;
    this.series = series;
    this.linked = linked;
    this.phases = spec.phases ?? [];
    this.bands = spec.bands ?? [];
    events.sort((a, b) => a.at - b.at);
    this.events = {list: events, times: events.map((e) => e.at)};
    this.ticks = {x: {places: [], labels: []}, y: {places: [], labels: []}};
    // Points anywhere in the plane are read by their distance, others by their x.
    this.scattered =
        !spec.time && (spec.kind === "points" || !series.every((s) => s.sorted));
    this.fileName = spec.id.replace(/[^\w-]+/g, "_");
    this.extent = this.wholeX();
    this.x = this.extent;
    this.y = this.fittingY();
    this.makeElements();
    this.makePlot();
    figure.classList.add("live");
  }

  // --- ranges

  wholeX() {
    const {log} = this.spec.x;
    const whole = this.series.map((s) => extentOf(s.xs, log)).reduce(union, [Infinity, -Infinity]);
    return widened(whole, this.scattered ? 0.03 : 0, log);
  }

  /** The range of y of what is shown between the limits of x, and of the bands. */
  fittingY() {
    const {log} = this.spec.y;
    const [min, max] = this.x;
    const ranges = this.series.filter((s) => s.shown).map(({xs, ys, sorted}) => {
      if (!sorted) return extentOf(ys, log, 0, ys.length - 1, (i) => xs[i] >= min && xs[i] <= max);
      const last = Math.min(lowerBound(xs, max), ys.length - 1);
      return extentOf(ys, log, Math.max(lowerBound(xs, min) - 1, 0), last);
    });
    for (const {from, to} of this.bands) ranges.push([Math.min(from, to), Math.max(from, to)]);
    return widened(ranges.reduce(union, [Infinity, -Infinity]), 0.06, log);
  }

  rangeOf(axis) {
    const [min, max] = this[axis];
    return {min, max, log: this.spec[axis].log};
  }

  get zoomed() {
    return this.x[0] > this.extent[0] || this.x[1] < this.extent[1];
  }

  /** Shows x from a to b, everything where it is null; y follows unless it is given. */
  show(x, y = null) {
    this.x = x ?? this.extent;
    this.y = y ?? this.fittingY();
    this.point(null);
    this.redraw();
  }

  redraw() {
    this.uplot.batch(() => {
      for (const axis of ["x", "y"]) {
        const [min, max] = this[axis];
        this.uplot.setScale(axis, {min, max});
      }
    });
  }

  /** Asks for a zoom to x from a to b as far as there are samples to tell apart. */
  zoomTo(a, b) {
    const [min, max] = this.extent;
    const samples = Math.max(...this.series.map((s) => s.xs.length), 2);
    const least = (max - min) / samples;
    const [from, to] = [Math.max(a, min), Math.min(b, max)];
    if (to - from >= 2 * least || (this.spec.x.log && to > from))
      this.linked.zoom(this, from <= min && to >= max ? null : [from, to]);
  }

  zoomBy(factor, centre = this.cursor ?? this.fromX(0.5)) {
    const at = Math.min(Math.max(this.toX(centre), 0), 1);
    this.zoomTo(this.fromX(at - at * factor), this.fromX(at + (1 - at) * factor));
  }

  pan(share) {
    const [min, max] = this.extent.map((v) => this.toX(v));
    const by = Math.min(Math.max(share, min), max - 1);
    this.zoomTo(this.fromX(by), this.fromX(1 + by));
  }

  reset() {
    this.linked.zoom(this, null);
  }

  /** Place of x in the view, 0 at its left edge and 1 at its right, and back. */
  toX(x) {
    return scaleTo(this.rangeOf("x"), 0, 1)(x);
  }

  fromX(share) {
    const [a, b] = this.x;
    return this.spec.x.log ? a * (b / a) ** share : a + (b - a) * share;
  }

  // --- what is on the page

  makeElements() {
    const {title, x} = this.spec;
    this.at = element("span", {className: "at"});
    this.note = element("span", {className: "note"});
    this.spoken = element("p", {className: "unseen", ariaLive: "polite"});
    this.keys = this.series.map((s, i) => this.makeKey(s, i));
    this.legend = element("div", {className: "legend"}, ...this.keys.map((k) => k.button),
                          ...this.eventKeys());
    this.reading = element("div", {className: "reading"}, this.at,
                           ...this.keys.map((k) => k.reading), this.note);
    this.plot = element("div", {
      className: "plot",
      tabIndex: 0,
      role: "application",
      ariaLabel: `${title}, against ${x.label}`,
      "aria-roledescription": "chart",
      "aria-describedby": "chart-keys",
    });
    const zoom = [
      button("\u2212", `Zoom out: ${title}`, () => this.zoomBy(2)),
      button("+", `Zoom in: ${title}`, () => this.zoomBy(0.5)),
      button("Reset", `Reset the zoom: ${title}`, () => this.reset()),
    ];
    const saves = Object.entries(FORMATS).map(
        ([name, write]) => button(name, `Save ${name}: ${title}`, async () => {
          try {
            await write(this);
          } catch (error) {
            this.note.textContent = `${name} could not be made: ${error.message}`;
          }
        }));
    this.tools = element("div", {className: "tools", role: "group", ariaLabel: `Tools: ${title}`},
                         ...zoom, element("span", {className: "gap"}), ...saves);
    this.live = element("div", {className: "chart-live"}, this.tools, this.legend,
                        this.reading, this.plot, this.spoken);
    this.figure.append(this.live);
  }

  makeKey(series) {
    const value = element("span", {className: "value"});
    const swatch = element("span", {className: `swatch ${series.style}`});
    swatch.style.color = `var(--${series.role})`;
    const key = element("button", {type: "button", className: "key", ariaPressed: "true",
                                   title: "Show or hide"},
                        swatch, series.label);
    key.onclick = () => {
      series.shown = !series.shown;
      key.ariaPressed = String(series.shown);
      this.show(this.x);
    };
    const dot = element("span", {className: "dot", hidden: true});
    dot.style.color = `var(--${series.role})`;
    const reading = element("span", {hidden: true}, `${series.label} `, value);
    return {button: key, reading, value, dot};
  }

  /** The kinds of events and phases that there are, with their colours. */
  eventKeys() {
    const kinds = new Map();
    for (const {kind} of this.events.list) kinds.set(kind, (kinds.get(kind) ?? 0) + 1);
    const keys = [...kinds].map(([kind, count]) => [kind, `${kind} (${count})`, "tick"]);
    for (const kind of new Set(this.phases.map((p) => p.kind)))
      keys.push([kind, kind === "limit" ? "at a limit" : kind, "area"]);
    return keys.map(([kind, text, shape]) => {
      const swatch = element("span", {className: `swatch ${shape}`});
      swatch.style.color = `var(--${kind})`;
      return element("span", {className: "kind"}, swatch, text);
    });
  }

  makePlot() {
    const font = `11.5px ${FONT}`;
    const axis = (scale, more) => ({
      scale,
      font,
      stroke: () => colour("muted"),
      grid: {stroke: () => colour("line"), width: 1},
      ticks: {show: false},
      label: withUnit(this.spec[scale]),
      labelFont: `12px ${FONT}`,
      values: (u, places, index, space, distance) => {
        const labels = tickLabels(places, distance, this.spec[scale].log);
        this.ticks[scale] = {places, labels};
        return labels;
      },
      ...more,
    });
    const scale = (name) => ({
      time: false,
      auto: false,
      distr: this.spec[name].log ? 3 : 1,
      range: () => this[name],
    });
    // uPlot holds no data, but draws axes only around some.
    const nothing = [this.x, [null, null]];
    this.uplot = new uPlot(
        {
          ...this.size(),
          legend: {show: false},
          padding: [8, 16, 0, 0],
          scales: {x: scale("x"), y: scale("y")},
          series: [{}, {scale: "y", paths: () => null, points: {show: false}}],
          axes: [
            axis("x", {size: 24, gap: 6, labelSize: 20, space: 70}),
            axis("y", {size: 58, gap: 8, labelSize: 18, space: 32}),
          ],
          cursor: {
            y: this.scattered,
            points: {show: false},
            drag: {x: true, y: this.scattered, setScale: false, dist: 4, uni: 24},
            bind: {dblclick: () => () => this.reset()},
          },
          hooks: {
            drawClear: [() => this.draw(drawBackground)],
            draw: [() => this.draw(drawContent)],
            setSelect: [() => this.zoomToSelection()],
          },
        },
        nothing, this.plot);
    this.uplot.over.append(...this.keys.map((k) => k.dot));
    this.listen();
  }

  /** Size of the plot with its axes: as wide as the page has it, shaped like the picture. */
  size() {
    const picture = this.figure.querySelector("svg")?.viewBox.baseVal;
    const width = Math.max(this.plot.clientWidth || this.figure.clientWidth, 120);
    const ratio = picture?.width ? picture.height / picture.width : 0.36;
    const height = Math.round(Math.min(Math.max(width * ratio, 190), 420));
    this.plot.style.height = `${height}px`;
    return {width, height};
  }

  plotSize() {
    const {width, height} = this.uplot.bbox;
    return {width: width / uPlot.pxRatio, height: height / uPlot.pxRatio};
  }

  frame() {
    const {left, top} = this.uplot.bbox;
    const plot = {left: left / uPlot.pxRatio, top: top / uPlot.pxRatio, ...this.plotSize()};
    return frameOf(plot, this.rangeOf("x"), this.rangeOf("y"), uPlot.pxRatio);
  }

  draw(what) {
    const context = this.uplot.ctx;
    context.save();
    context.scale(uPlot.pxRatio, uPlot.pxRatio);
    what(new CanvasSurface(context), this, this.frame());
    context.restore();
  }

  zoomToSelection() {
    const {left, top, width, height} = this.uplot.select;
    if (width === 0 && height === 0) return;
    this.uplot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    const valueAt = (position, axis) => this.uplot.posToVal(position, axis);
    const plot = this.plotSize();
    if (!this.scattered) {
      if (width > 0) this.zoomTo(valueAt(left, "x"), valueAt(left + width, "x"));
      return;
    }
    const all = (share, whole) => share <= 0 || share >= whole;
    this.show(all(width, plot.width) ? this.x : [valueAt(left, "x"), valueAt(left + width, "x")],
              all(height, plot.height) ? null
                                       : [valueAt(top + height, "y"), valueAt(top, "y")]);
  }

  // --- cursor and keys

  listen() {
    const {over} = this.uplot;
    over.addEventListener("pointermove", (event) => {
      const box = over.getBoundingClientRect();
      const x = this.uplot.posToVal(event.clientX - box.left, "x");
      this.point(x, this.uplot.posToVal(event.clientY - box.top, "y"), true);
    });
    over.addEventListener("pointerleave", () => this.point(null, null, true));
    over.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      const box = over.getBoundingClientRect();
      const centre = this.uplot.posToVal(event.clientX - box.left, "x");
      this.zoomBy(event.deltaY > 0 ? 1.25 : 0.8, centre);
    }, {passive: false});
    this.plot.addEventListener("keydown", (event) => {
      const act = this.actionOf(event);
      if (!act) return;
      event.preventDefault();
      act();
    });
    this.plot.addEventListener("blur", () => this.point(null, null, true));
    new ResizeObserver(() => {
      const size = this.size();
      if (size.width !== this.uplot.width) this.uplot.setSize(size);
    }).observe(this.plot);
  }

  actionOf({key, shiftKey, ctrlKey, metaKey, altKey}) {
    if (ctrlKey || metaKey || altKey) return null;
    const actions = {
      ArrowLeft: () => this.step(-1, shiftKey),
      ArrowRight: () => this.step(1, shiftKey),
      Home: () => this.speakAt(this.x[0]),
      End: () => this.speakAt(this.x[1]),
      PageUp: () => this.pan(-0.5),
      PageDown: () => this.pan(0.5),
      "+": () => this.zoomBy(0.5),
      "=": () => this.zoomBy(0.5),
      "-": () => this.zoomBy(2),
      "0": () => this.reset(),
    };
    return actions[key];
  }

  /** Moves the cursor by a hundredth of the view, or by one sample. */
  step(direction, single) {
    const from = this.cursor ?? this.fromX(direction > 0 ? 0 : 1);
    if (!single) return this.speakAt(this.fromX(this.toX(from) + direction / 100), direction);
    return this.speakAt(from, direction);
  }

  /**
   * Puts the cursor on the sample nearest to x; where that is no step from where it stands, on the
   * next one in the direction.
   */
  speakAt(x, direction = 0) {
    const xs = this.scattered ? this.placesOfPoints() : this.lead().xs;
    let i = nearest(xs, x);
    while (direction && this.cursor !== undefined && xs[i + direction] !== undefined &&
           (xs[i] - this.cursor) * direction <= 0)
      i += direction;
    const [min, max] = this.x;
    if (xs[i] < min || xs[i] > max) {
      if (this.zoomed) this.pan(direction * 0.5 || 0);
      if (xs[i] < this.x[0] || xs[i] > this.x[1]) return;
    }
    this.point(xs[i], this.scattered ? null : undefined, true);
    this.spoken.textContent =
        [this.at, ...this.keys.map((k) => k.reading).filter((r) => !r.hidden), this.note]
            .map((part) => part.textContent).filter(Boolean).join(", ");
  }

  placesOfPoints() {
    const all = this.series.filter((s) => s.shown).flatMap((s) => Array.from(s.xs));
    return Float64Array.from(all.filter(Number.isFinite)).sort();
  }

  lead() {
    return this.series.find((s) => s.shown) ?? this.series[0];
  }

  /**
   * Reads the samples at x, or the one nearest to x and y where they lie anywhere; null: nothing.
   * Own: it is this chart that the hand is on, and the linked ones follow.
   */
  point(x, y = null, own = false) {
    const inView = x !== null && x >= this.x[0] && x <= this.x[1];
    const samples = inView ? this.samplesAt(x, y) : [];
    const found = samples.find((s) => s);
    this.cursor = found?.x;
    this.keys.forEach(({reading, value, dot}, i) => {
      const sample = samples[i];
      reading.hidden = !sample;
      value.textContent = sample ? `${sample.y}` : "";
      dot.hidden = !sample;
      if (sample) {
        const left = this.uplot.valToPos(sample.x, "x");
        dot.style.transform = `translate(${left}px, ${this.uplot.valToPos(sample.y, "y")}px)`;
      }
    });
    this.at.textContent = found ? `${this.spec.x.label} ${found.x} ${this.spec.x.unit}` : "";
    this.note.textContent = found ? this.noteAt(found.x) : "";
    this.uplot.setCursor(
        found ? {left: this.uplot.valToPos(found.x, "x"), top: this.uplot.valToPos(found.y, "y")}
              : {left: -10, top: -10},
        false);
    if (own) this.linked.point(this, found ? found.x : null);
  }

  /** Of each series the sample to read, or nothing. */
  samplesAt(x, y) {
    if (this.scattered) return this.nearestPoint(x, y);
    const lead = this.lead();
    const i = nearest(lead.xs, x);
    const at = lead.xs[i];
    return this.series.map(({xs, ys, shown}) => {
      const j = xs === lead.xs ? i : nearest(xs, at);
      return shown && Number.isFinite(ys[j]) ? {x: xs[j], y: ys[j]} : undefined;
    });
  }

  nearestPoint(x, y) {
    const {toX, toY} = this.frame();
    const [atX, atY] = [toX(x), y === null ? null : toY(y)];
    let least = Infinity;
    let found = [];
    this.series.forEach(({xs, ys, shown}, s) => {
      for (let i = 0; shown && i < Math.min(xs.length, ys.length); i++) {
        const distance = (toX(xs[i]) - atX) ** 2 + (atY === null ? 0 : (toY(ys[i]) - atY) ** 2);
        if (distance < least) {
          least = distance;
          found = [];
          found[s] = {x: xs[i], y: ys[i]};
        }
      }
    });
    return found;
  }

  /** Events within four pixels, phases and bands at x. */
  noteAt(x) {
    const {list, times} = this.events;
    const {toX, width} = this.frame();
    const reach = this.fromX(4 / width) - this.fromX(0);
    const near = list.slice(lowerBound(times, x - reach), lowerBound(times, x + reach));
    near.sort((a, b) => Math.abs(toX(a.at) - toX(x)) - Math.abs(toX(b.at) - toX(x)));
    const notes = near.slice(0, 1).map((e) => `${e.text} at ${e.at} ${this.spec.x.unit}`);
    if (near.length > 1) notes.push(`${near.length - 1} more events here`);
    for (const {from, to, text} of this.phases) if (x >= from && x <= to) notes.push(text);
    return notes.join("; ");
  }
}
