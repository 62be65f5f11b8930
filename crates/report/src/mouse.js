/* The figures of a page under the mouse: values at the pointer, zoom by dragging, axes of one quantity together.
   Without this script, and in print, the drawings stay. */
(function () {
  "use strict";
  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const lighter = { "#0072B2": "#4f9fe0", "#D55E00": "#ff8a3d", "#009E73": "#2cc79a", "#CC79A7": "#e396c1", "#E69F00": "#f5bd45", "#56B4E9": "#9ad6ff" };
  const shade = (colour) => (dark.matches && lighter[colour]) || colour;
  const named = (axis) => axis.label + (axis.symbol ? " " + axis.symbol : "") + (axis.unit ? " [" + axis.unit + "]" : "");
  const shown = (value) => (value == null ? "–" : String(Number(value.toPrecision(5))));

  /* Labels of the ticks of an axis: uPlot's own have three decimals, and a tick at 0.0005 would read 0. */
  const ticked = (_, splits) => splits.map((value) => {
    if (value == null) return "";
    const short = Number(value.toPrecision(5));
    return short !== 0 && Math.abs(short) < 1e-3 ? short.toExponential() : String(short);
  });

  globalThis.glidepolarPage = { style, named, shown, ticked };
  const source = document.getElementById("figures");
  if (!source || typeof uPlot === "undefined") return;
  const figures = JSON.parse(source.textContent);

  /* One column of x for all layers: values of the same x stand in one row, so that a pointer reads them all. */
  function aligned(panel) {
    const rows = new Map();
    const columns = [];
    const put = (x, column, value) => {
      const at = rows.get(x) || [];
      let row = at.find((row) => row[column] === undefined);
      if (!row) at.push((row = []));
      row[column] = value;
      rows.set(x, at);
    };
    for (const layer of panel.layers) {
      if (layer.kind === "line" || layer.kind === "points") {
        layer.x.forEach((x, i) => { if (x !== null && layer.y[i] !== null) put(x, columns.length, layer.y[i]); });
        columns.push(layer);
      } else if (layer.kind === "band") {
        layer.x.forEach((x, i) => {
          if (x === null || layer.low[i] === null || layer.high[i] === null) return;
          put(x, columns.length, layer.low[i]);
          put(x, columns.length + 1, layer.high[i]);
        });
        columns.push({ ...layer, edge: "low" }, { ...layer, edge: "high" });
      }
    }
    const xs = [], ys = columns.map(() => []);
    for (const x of [...rows.keys()].sort((a, b) => a - b)) {
      for (const row of rows.get(x)) {
        xs.push(x);
        ys.forEach((y, i) => y.push(row[i] === undefined ? null : row[i]));
      }
    }
    return { data: [xs, ...ys], columns };
  }

  /* A name for each row of values: no two alike, and none for what only continues another layer. */
  function names(columns, axis) {
    const taken = new Set();
    const name = (layer) => {
      if (!layer.label) return columns.some((other) => other.label) ? "" : axis;
      return taken.has(layer.label + layer.edge) ? layer.label + (layer.kind === "line" ? ", line" : ", points") : layer.label;
    };
    return columns.map((layer) => {
      const first = name(layer);
      if (layer.label) taken.add(layer.label + layer.edge);
      const edged = first && layer.edge ? first + (layer.edge === "low" ? ", from" : ", to") : first;
      const again = taken.has("shown " + edged);
      taken.add("shown " + edged);
      return again ? "" : edged;
    });
  }

  function series(layer, name) {
    const colour = shade(layer.colour);
    const common = { label: name, class: name ? undefined : "unnamed", stroke: colour, spanGaps: true, value: (_, v) => shown(v) };
    if (layer.kind === "points") return { ...common, paths: () => null, points: { show: true, size: layer.x.length > 300 ? 3 : 6, fill: colour, width: 0 } };
    if (layer.kind === "band") return { ...common, width: 0.5, points: { show: false } };
    return { ...common, width: 1.8, dash: layer.dash, points: { show: false } };
  }

  /* Strips, lines across, and the bars of points. */
  function beneath(panel) {
    return (u) => {
      const { ctx, bbox } = u;
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      for (const layer of panel.layers) {
        const x = (value) => u.valToPos(value, "x", true), y = (value) => u.valToPos(value, "y", true);
        const line = (x0, y0, x1, y1) => { ctx.beginPath(); ctx.moveTo(x0, y0); ctx.lineTo(x1, y1); ctx.stroke(); };
        if (layer.kind === "strip") {
          ctx.fillStyle = style("--panel");
          ctx.fillRect(x(layer.from), bbox.top, x(layer.to) - x(layer.from), bbox.height);
        } else if (layer.kind === "at_x" || layer.kind === "at_y") {
          ctx.strokeStyle = style("--faint");
          ctx.lineWidth = devicePixelRatio;
          if (layer.kind === "at_x") line(x(layer.at), bbox.top, x(layer.at), bbox.top + bbox.height);
          else line(bbox.left, y(layer.at), bbox.left + bbox.width, y(layer.at));
        } else if (layer.kind === "points" && layer.bars) {
          ctx.strokeStyle = shade(layer.colour);
          ctx.lineWidth = devicePixelRatio;
          layer.bars.forEach(([low, high], i) => {
            if (low !== null && high !== null && layer.x[i] !== null) line(x(layer.x[i]), y(low), x(layer.x[i]), y(high));
          });
        }
      }
      ctx.restore();
    };
  }

  const font = "13px system-ui, sans-serif";

  /* The name of an axis stands along it: a figure is as high as the name is long. */
  function width_of(text) {
    const context = document.createElement("canvas").getContext("2d");
    context.font = font;
    return context.measureText(text).width;
  }

  /* Bars of points count for the range as their points do; what has one value only has room about it. */
  function around(panel) {
    return (u, low, high) => {
      const { min, max } = u.scales.x;
      let [from, to] = [low ?? Infinity, high ?? -Infinity];
      for (const layer of panel.layers.filter((layer) => layer.kind === "points" && layer.bars)) {
        layer.bars.forEach((ends, i) => {
          const x = layer.x[i];
          // Before the first drawing the range of x is not known yet: all of the data are shown then.
          const is_shown = x !== null && (min == null || (x >= min && x <= max));
          if (!is_shown || ends[0] === null || ends[1] === null) return;
          from = Math.min(from, ...ends);
          to = Math.max(to, ...ends);
        });
      }
      if (!(from <= to)) return [0, 1];
      if (from === to) return [from - (Math.abs(from) * 0.1 || 1), to + (Math.abs(to) * 0.1 || 1)];
      return uPlot.rangeNum(from, to, 0.1, true);
    };
  }

  function draw(place, figure, number) {
    const key = named(figure.x);
    const made = [];
    figure.panels.forEach((panel, index) => {
      const { data, columns } = aligned(panel);
      if (!data[0].length) return;
      const bands = columns.flatMap((c, i) => (c.edge === "high" ? [{ series: [i + 1, i], fill: shade(c.colour) + "33" }] : []));
      const grid = { stroke: style("--rule"), width: 1 };
      const axis = (label, more) => ({ label, values: ticked, stroke: style("--ink"), grid, ticks: grid, font, labelFont: font, ...more });
      const called = names(columns, named(panel.y));
      const y = { range: panel.y.range ? () => panel.y.range : around(panel) };
      // All of the data stand in the figure's own range, as in the drawing; a stretch that was dragged over in its own.
      const [first, last] = [data[0][0], data[0][data[0].length - 1]];
      const whole = (_, from, to) => (from <= first && to >= last ? figure.x.range : [from, to]);
      const x = figure.x.range ? { range: whole } : {};
      const options = {
        title: panel.title || undefined,
        width: Math.max(280, place.clientWidth),
        height: Math.max(figure.panels.length > 1 ? 230 : 340, width_of(named(panel.y)) + 105),
        scales: { x: { time: false, ...x }, y: { ...y, dir: panel.y.reversed ? -1 : 1 } },
        axes: [axis(named(figure.x), {}), axis(named(panel.y), { size: 62 })],
        series: [{ label: named(figure.x), value: (_, v) => shown(v) }, ...columns.map((column, i) => series(column, called[i]))],
        bands,
        cursor: { sync: { key, scales: ["x", null] }, drag: { x: true, y: false }, focus: { prox: 24 } },
        hooks: {
          drawClear: [beneath(panel)],
        },
      };
      const holder = document.createElement("div");
      holder.className = "plot";
      holder.dataset.figure = number;
      holder.dataset.panel = index;
      place.append(holder);
      const plot = new uPlot(options, data, holder);
      holder.plot = plot;
      made.push(plot);
    });
    if (!made.length) return;
    place.classList.add("live");
    const hint = document.createElement("p");
    hint.className = "hint";
    hint.textContent = "Point to read values, drag to zoom, double-click to see all.";
    place.append(hint);
    // In the next frame: a size that changes while sizes are told is reported as an endless loop.
    new ResizeObserver(() => requestAnimationFrame(() => made.forEach((plot) => {
      const width = Math.max(280, place.clientWidth);
      if (Math.abs(plot.width - width) > 1) plot.setSize({ width, height: plot.height });
    }))).observe(place);
  }

  /* A figure inside a closed fold is drawn when it is opened: before, it has no width. */
  for (const [number, figure] of Object.entries(figures)) {
    const place = document.querySelector('.drawing[data-figure="' + number + '"]');
    if (!place) continue;
    const fold = place.closest("details:not([open])");
    if (fold) fold.addEventListener("toggle", () => draw(place, figure, number), { once: true });
    else draw(place, figure, number);
  }
})();
