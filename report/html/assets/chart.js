// One live chart in its figure: an SVG in the place of the still one, drawn by drawing.js whenever
// the ranges or the size change, with a selection, a cursor and readings over it.

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

function place(shape, attributes) {
  for (const [key, value] of Object.entries(attributes)) shape.setAttribute(key, value);
}

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

/** The range with a margin on either side; something to look at where it is empty or one value. */
function widened([min, max], margin, log) {
  if (min > max) return log ? [1, 10] : [0, 1];
  const size = Math.max(Math.abs(min), Math.abs(max));
  const one = max - min <= 1e-12 * size;  // but for rounding
  if (log) {
    const factor = one ? 2 : (max / min) ** margin;
    return [min / factor, max * factor];
  }
  const extra = one ? 0.05 * size || 1 : (max - min) * margin;
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
    // Points anywhere in the plane are read by their distance, others by their x.
    this.scattered =
        !spec.time && (spec.kind === "points" || !series.every((s) => s.sorted));
    this.fileName = spec.id.replace(/[^\w-]+/g, "_");
    this.extent = this.wholeX();
    this.x = this.extent;
    this.y = this.fittingY();
    this.makeElements();
    this.size = figure.querySelector("svg").getBoundingClientRect();
    this.redraw();
    this.attach();
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
    this.redraw();
    this.point(null);
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
    const at = clamped(this.toX(centre), 0, 1);
    this.zoomTo(this.fromX(at - at * factor), this.fromX(at + (1 - at) * factor));
  }

  pan(share) {
    const [min, max] = this.extent.map((v) => this.toX(v));
    const by = clamped(share, min, max - 1);
    this.zoomTo(this.fromX(by), this.fromX(1 + by));
  }

  reset() {
    this.linked.zoom(this, null);
  }

  /** Place of x in the view, 0 at its left edge and 1 at its right, and back. */
  toX(x) {
    return scaleOf(this.rangeOf("x"), 0, 1).to(x);
  }

  fromX(share) {
    return scaleOf(this.rangeOf("x"), 0, 1).back(share);
  }

  // --- what is on the page

  makeElements() {
    const {title, x} = this.spec;
    this.at = element("span", {className: "at"});
    this.note = element("span", {className: "note"});
    this.spoken = element("p", {className: "unseen", ariaLive: "polite"});
    this.keys = this.series.map((s) => this.makeKey(s));
    this.drawing = shape("g", {});
    this.selection = shape("rect", {class: "selection"});
    this.line = shape("path", {class: "cursor"});
    this.over = shape("rect", {class: "over"});
    this.svg = shape("svg", {"aria-hidden": "true"},
                     shape("g", {transform: `translate(${MARGIN.left} ${MARGIN.top})`},
                           this.drawing, this.selection, this.line,
                           ...this.keys.map((k) => k.dot), this.over));
    this.plot = element("div", {
      className: "plot",
      tabIndex: 0,
      role: "application",
      ariaLabel: `${title}, against ${x.label}`,
      "aria-roledescription": "chart",
      "aria-describedby": "chart-keys",
    }, this.svg);
    const save = ([name, write]) => button(name, `Save ${name}: ${title}`, async () => {
      try {
        await write(this);
      } catch (error) {
        this.note.textContent = `${name} could not be created: ${error.message}`;
      }
    });
    this.tools = [
      button("\u2212", `Zoom out: ${title}`, () => this.zoomBy(2)),
      button("+", `Zoom in: ${title}`, () => this.zoomBy(0.5)),
      button("Reset", `Reset the zoom: ${title}`, () => this.reset()),
      element("span", {className: "gap"}),
      ...Object.entries(FORMATS).map(save),
    ];
  }

  /** A button for the legend; a series is read beside its name, and by a dot. */
  makeKey(series) {
    const value = element("span", {className: "value"});
    const reading = element("span", {hidden: true}, `${series.label} `, value);
    const key = element("button", {type: "button", className: "key", ariaPressed: "true",
                                   title: "Show or hide"});
    key.onclick = () => {
      series.shown = !series.shown;
      key.ariaPressed = String(series.shown);
      this.show(this.x);
    };
    return {button: key, reading, value,
            dot: shape("circle", {class: `dot ${series.role}`, r: 4, visibility: "hidden"})};
  }

  /** Fills the empty rows of the figure, and takes the place of its picture. */
  attach() {
    const part = (name) => this.figure.querySelector(name);
    const {width, height} = part("svg").viewBox.baseVal;
    this.plot.style.aspectRatio = `${width} / ${height}`;
    this.figure.querySelectorAll(".legend .key").forEach((words, i) => {
      this.keys[i].button.append(...words.childNodes);
      words.replaceWith(this.keys[i].button);
    });
    part(".reading").append(this.at, ...this.keys.map((k) => k.reading), this.note);
    part(".tools").append(...this.tools);
    part(".tools").setAttribute("role", "group");
    part(".tools").setAttribute("aria-label", `Tools: ${this.spec.title}`);
    this.figure.append(this.plot, this.spoken);
    this.figure.classList.add("live");
    this.listen();
  }

  redraw() {
    const {width, height} = this.size;
    if (width === 0) return;  // in a part that is folded up
    const {frame, parts} = drawn(this, this.size);
    this.frame = frame;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.drawing.replaceChildren(...parts);
    place(this.over, {width: frame.width, height: frame.height});
  }

  // --- cursor and keys

  /** Where a pointer is in the frame. */
  placeOf(event) {
    const box = this.over.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  }

  listen() {
    const {over} = this;
    let from = null;  // where a drag began
    let selected = null;
    over.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || event.pointerType === "touch") return;
      from = this.placeOf(event);
      over.setPointerCapture(event.pointerId);
    });
    over.addEventListener("pointermove", (event) => {
      const at = this.placeOf(event);
      selected = from && this.selectionOf(from, at);
      place(this.selection, selected ?? {width: 0, height: 0});
      this.point(this.frame.fromX(at.x), this.frame.fromY(at.y), true);
    });
    const end = (zoom) => {
      if (zoom && selected) this.zoomToSelection(selected);
      from = selected = null;
      place(this.selection, {width: 0, height: 0});
    };
    over.addEventListener("pointerup", () => end(true));
    over.addEventListener("pointercancel", () => end(false));
    over.addEventListener("pointerleave", () => this.point(null, null, true));
    over.addEventListener("dblclick", () => this.reset());
    over.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.zoomBy(event.deltaY > 0 ? 1.25 : 0.8, this.frame.fromX(this.placeOf(event).x));
    }, {passive: false});
    this.plot.addEventListener("keydown", (event) => {
      const act = this.actionOf(event);
      if (!act) return;
      event.preventDefault();
      act();
    });
    this.plot.addEventListener("blur", () => this.point(null, null, true));
    new ResizeObserver(([{contentRect}]) => {
      const {width, height} = this.size;
      if (contentRect.width === width && contentRect.height === height) return;
      this.size = contentRect;
      this.show(this.x, this.y);
    }).observe(this.plot);
  }

  /** The part of the frame between two places; of full height or width unless both are meant. */
  selectionOf(a, b) {
    const {width, height} = this.frame;
    const [left, right] = [a.x, b.x].sort((m, n) => m - n).map((v) => clamped(v, 0, width));
    const [top, bottom] = [a.y, b.y].sort((m, n) => m - n).map((v) => clamped(v, 0, height));
    if (Math.hypot(a.x - b.x, a.y - b.y) < 4) return null;
    const meant = 24;
    const byY = this.scattered && bottom - top >= meant;
    const byX = !byY || right - left >= meant;
    return {x: byX ? left : 0, width: byX ? right - left : width,
            y: byY ? top : 0, height: byY ? bottom - top : height};
  }

  zoomToSelection({x, y, width, height}) {
    const {fromX, fromY} = this.frame;
    const rangeX = [fromX(x), fromX(x + width)];
    if (!this.scattered) this.zoomTo(...rangeX);
    else if (width > 0)
      this.show(width < this.frame.width ? rangeX : this.x,
                height < this.frame.height ? [fromY(y + height), fromY(y)] : null);
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
    if (!this.frame) return;
    const {toX, toY, width, height} = this.frame;
    const inView = x !== null && x >= this.x[0] && x <= this.x[1];
    const samples = inView ? this.samplesAt(x, y) : [];
    const found = samples.find((s) => s);
    this.cursor = found?.x;
    this.keys.forEach(({reading, value, dot}, i) => {
      const sample = samples[i];
      reading.hidden = !sample;
      value.textContent = sample ? `${sample.y}` : "";
      place(dot, sample ? {visibility: "visible", cx: toX(sample.x), cy: toY(sample.y)}
                        : {visibility: "hidden"});
    });
    this.at.textContent = found ? `${this.spec.x.label} ${found.x} ${this.spec.x.unit}` : "";
    this.note.textContent = found ? this.noteAt(found.x) : "";
    const across = found && this.scattered ? `M0 ${toY(found.y)}H${width}` : "";
    place(this.line, {d: found ? `M${toX(found.x)} 0V${height}${across}` : ""});
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
    const {toX, toY} = this.frame;
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
    const {toX, width} = this.frame;
    const reach = this.fromX(4 / width) - this.fromX(0);
    const near = list.slice(lowerBound(times, x - reach), lowerBound(times, x + reach));
    near.sort((a, b) => Math.abs(toX(a.at) - toX(x)) - Math.abs(toX(b.at) - toX(x)));
    const notes = near.slice(0, 1).map((e) => `${e.text} at ${e.at} ${this.spec.x.unit}`);
    if (near.length > 1) notes.push(`${near.length - 1} more events here`);
    for (const {from, to, text} of this.phases) if (x >= from && x <= to) notes.push(text);
    return notes.join("; ");
  }
}
