/* Curves with sliders: the curve at the value of the first, the point on it at the value of the second, and what belongs to
   the point. */
(function () {
  "use strict";
  const source = document.getElementById("explorers");
  if (!source || typeof uPlot === "undefined") return;
  const { style, named, shown, ticked } = glidepolarPage;

  function path(draw) {
    return (u, index) => {
      const [xs, ys] = u.data[index], { ctx, bbox } = u;
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      draw(ctx, xs.map((x, i) => (x === null || ys[i] === null ? null : [u.valToPos(x, "x", true), u.valToPos(ys[i], "y", true)])));
      ctx.restore();
      return null;
    };
  }
  const curve = path((ctx, points) => {
    ctx.strokeStyle = style("--link");
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.beginPath();
    let down = false;
    for (const point of points) {
      if (point) ctx[down ? "lineTo" : "moveTo"](...point);
      down = Boolean(point);
    }
    ctx.stroke();
  });
  const mark = path((ctx, points) => {
    ctx.fillStyle = style("--warning-edge");
    for (const point of points.filter(Boolean)) {
      ctx.beginPath();
      ctx.arc(...point, 6 * devicePixelRatio, 0, 2 * Math.PI);
      ctx.fill();
    }
  });

  function build(place, explorer) {
    const [x, y] = explorer.quantities;
    const inputs = explorer.sliders.map((slider) => {
      const label = document.createElement("label"), input = document.createElement("input"), value = document.createElement("output");
      Object.assign(input, { type: "range", min: 0, max: slider.values.length - 1, step: 1 });
      input.setAttribute("aria-label", named(slider));
      input.value = slider.start;
      label.append(slider.label + " ", value, input);
      place.append(label);
      return { input, value, slider };
    });
    const holder = document.createElement("div");
    holder.className = "curve";
    place.append(holder);
    const list = document.createElement("dl");
    const cells = explorer.quantities.map((quantity) => {
      const name = document.createElement("dt"), value = document.createElement("dd");
      name.textContent = named(quantity.axis);
      list.append(name, value);
      return value;
    });
    place.append(list);
    const grid = { stroke: style("--rule"), width: 1 };
    const side = (axis, more) => ({ label: named(axis), values: ticked, stroke: style("--ink"), grid, ticks: grid, font: "13px system-ui, sans-serif", labelFont: "13px system-ui, sans-serif", ...more });
    const facets = [{ scale: "x", auto: false }, { scale: "y", auto: false }];
    const plot = new uPlot({
      mode: 2,
      width: Math.max(280, place.clientWidth),
      height: 340,
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, range: () => x.axis.range }, y: { range: () => y.axis.range, dir: y.axis.reversed ? -1 : 1 } },
      axes: [side(x.axis, {}), side(y.axis, { size: 62 })],
      series: [null, { facets, paths: curve }, { facets, paths: mark }],
    }, [null, [[], []], [[], []]], holder);
    const update = () => {
      const [i, j] = inputs.map(({ input }) => Number(input.value));
      inputs.forEach(({ input, value, slider }) => {
        const text = shown(slider.values[input.value]) + (slider.unit ? " " + slider.unit : "");
        value.textContent = text;
        input.setAttribute("aria-valuetext", text);
      });
      cells.forEach((cell, k) => { cell.textContent = shown(explorer.quantities[k].values[i][j]); });
      plot.setData([null, [x.values[i], y.values[i]], [[x.values[i][j]], [y.values[i][j]]]]);
    };
    inputs.forEach(({ input }) => input.addEventListener("input", update));
    update();
    place.closest("figure").hidden = false;
    new ResizeObserver(() => requestAnimationFrame(() => {
      const width = Math.max(280, place.clientWidth);
      if (Math.abs(plot.width - width) > 1) plot.setSize({ width, height: plot.height });
    })).observe(place);
  }

  for (const [number, explorer] of Object.entries(JSON.parse(source.textContent))) {
    build(document.querySelector('.explorer[data-explorer="' + number + '"]'), explorer);
  }
})();
