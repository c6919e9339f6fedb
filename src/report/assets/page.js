// Draws the plots of a report page: shared zoom, a hairline with values in every legend, light, dark and print colours.
(function () {
  "use strict";
  const tones = ["neutral", "valve", "chamber", "estimated", "fourth", "fifth", "sixth"];
  const data = document.getElementById("plot-data");
  const plots = data ? JSON.parse(data.textContent) : [];
  const resetButton = document.getElementById("reset-zoom");
  let zooming = false;

  const variable = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const toneColour = (item) => variable(tones[item.tone]);

  function decode(x) {
    if (Array.isArray(x)) return x;
    let at = x.from;
    return x.by.map((by) => { at += by; return at * x.step; });
  }

  // One row an x that any curve has: null where another curve has none there (joined), NaN in a gap (not joined).
  function joinedRows(plot) {
    const width = plot.curves.length + 2 * plot.bands.length;
    const rows = new Map();
    const put = (x, column, value) => {
      let row = rows.get(x);
      if (!row) rows.set(x, row = [x].concat(new Array(width).fill(null)));
      row[column + 1] = value;
    };
    plot.curves.forEach((curve, i) => curve.x.forEach((x, k) => put(x, i, curve.y[k] === null ? NaN : curve.y[k])));
    // Unseen curves let the axis hold the bands too, but no more than three times what the curves span.
    const values = plot.curves.flatMap((curve) => curve.y).filter((y) => y !== null);
    const least = values.reduce((a, b) => Math.min(a, b), Infinity), most = values.reduce((a, b) => Math.max(a, b), -Infinity);
    const room = most - least;
    plot.bands.forEach((band, i) => band.x.forEach((x, k) => {
      if (band.low[k] === null || band.high[k] === null) return;
      put(x, plot.curves.length + 2 * i, Math.max(band.low[k], least - room));
      put(x, plot.curves.length + 2 * i + 1, Math.min(band.high[k], most + room));
    }));
    return Array.from(rows.values()).sort((a, b) => a[0] - b[0]);
  }

  function valueAt(x, xs, ys, steps) {
    if (!xs.length || x < xs[0] || x > xs[xs.length - 1]) return null;
    let low = 0, high = xs.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (xs[middle] <= x) low = middle; else high = middle;
    }
    if (ys[low] === null || ys[high] === null) return null;
    if (steps || high === low) return xs[high] <= x ? ys[high] : ys[low];
    return ys[low] + (ys[high] - ys[low]) * (x - xs[low]) / (xs[high] - xs[low]);
  }

  function figure(value) {
    if (value === null || !isFinite(value)) return "–";
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2);
    return value.toFixed(Math.max(0, Math.min(4, 3 - Math.floor(Math.log10(size || 1)))));
  }

  // toDomXCoord takes every axis as linear; the percentage knows a logarithmic one.
  function domX(graph, x) {
    const area = graph.getArea();
    return area.x + graph.toPercentXCoord(x) * area.w;
  }

  function drawUnder(plot, context, area, graph) {
    context.save();
    context.beginPath();
    context.rect(area.x, area.y, area.w, area.h);
    context.clip();
    context.fillStyle = variable("window");
    for (const [from, to] of plot.windows) {
      const left = domX(graph, from);
      context.fillRect(left, area.y, domX(graph, to) - left, area.h);
    }
    for (const band of plot.bands) {
      context.fillStyle = toneColour(band);
      context.globalAlpha = 0.16;
      context.beginPath();
      band.x.forEach((x, k) => band.high[k] !== null && context.lineTo(domX(graph, x), graph.toDomYCoord(band.high[k])));
      for (let k = band.x.length - 1; k >= 0; --k)
        if (band.low[k] !== null) context.lineTo(domX(graph, band.x[k]), graph.toDomYCoord(band.low[k]));
      context.fill();
      context.globalAlpha = 1;
    }
    context.strokeStyle = variable("alarm");
    context.font = "12px system-ui, sans-serif";
    for (const mark of plot.marks) {
      const x = domX(graph, mark.x);
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(x, area.y);
      context.lineTo(x, area.y + area.h);
      context.stroke();
      const width = context.measureText(mark.text).width, toLeft = x + width + 8 > area.x + area.w;
      context.fillStyle = variable("paper");
      context.fillRect(toLeft ? x - width - 9 : x + 2, area.y + 1, width + 7, 17);
      context.fillStyle = variable("alarm");
      context.textAlign = toLeft ? "right" : "left";
      context.fillText(mark.text, x + (toLeft ? -5 : 5), area.y + 13);
    }
    context.restore();
  }

  const invisible = "rgba(0,0,0,0)";
  const colours = (plot) => plot.curves.map(toneColour).concat(plot.bands.flatMap(() => [invisible, invisible]));

  // A narrow pane has room for labels of three digits.
  function options(plot, width) {
    const narrow = width < 420;
    const curves = plot.curves.map((_, i) => "curve " + i);
    const bands = plot.bands.flatMap((_, i) => ["band low " + i, "band high " + i]);
    const series = {};
    plot.curves.forEach((curve, i) => {
      series[curves[i]] = { strokePattern: curve.dashed ? [6, 4] : null, stepPlot: curve.steps, strokeWidth: curve.tone ? 1.5 : 1.3,
                            fillGraph: plot.logY };
    });
    return {
      labels: ["x"].concat(curves, bands), colors: colours(plot), series, legend: "never", connectSeparatedPoints: true,
      highlightCircleSize: 0, gridLineColor: variable("line"), axisLineColor: variable("soft"), axisLabelFontSize: 12,
      gridLineWidth: 1, xRangePad: 0, yRangePad: plot.logY ? 0 : 8, logscale: plot.logY, labelsKMB: false,
      rightGap: 12,
      axes: { x: { logscale: plot.logX, axisLabelWidth: narrow ? 36 : 60, pixelsPerLabel: plot.logX || narrow ? 40 : 70, drawGrid: false },
              y: { axisLabelWidth: 58, pixelsPerLabel: plot.logY ? 26 : 34 } },
      underlayCallback: (context, area, graph) => drawUnder(plot, context, area, graph),
      drawCallback: (graph, first) => { if (!first) follow(plot, graph); },
    };
  }

  // Plots of one group show the same stretch of x.
  function follow(plot, graph) {
    resetButton.hidden = !plots.some((other) => other.graph && other.graph.isZoomed());
    if (zooming || !plot.group) return;
    zooming = true;
    const dateWindow = graph.isZoomed("x") ? graph.xAxisRange() : null;
    for (const other of plots)
      if (other !== plot && other.graph && other.group === plot.group) other.graph.updateOptions({ dateWindow });
    zooming = false;
  }

  function buildLegend(plot, figureElement) {
    const legend = figureElement.querySelector(".legend");
    const entry = (item, kind) => {
      const button = document.createElement("button");
      button.type = "button";
      button.setAttribute("aria-pressed", "true");
      item.swatch = document.createElement("span");
      item.swatch.className = "swatch" + kind;
      item.value = document.createElement("span");
      item.value.className = "value";
      button.append(item.swatch, document.createTextNode(item.name), item.value);
      legend.append(button);
      return button;
    };
    plot.curves.forEach((curve, i) => {
      const button = entry(curve, curve.dashed ? " dashed" : "");
      button.addEventListener("click", () => {
        const seen = !plot.graph.visibility()[i];
        plot.graph.setVisibility(i, seen);
        button.setAttribute("aria-pressed", String(seen));
      });
    });
    plot.bands.forEach((band) => entry(band, " band"));
  }

  function paintLegend(plot) {
    for (const curve of plot.curves) curve.swatch.style.borderTopColor = toneColour(curve);
    for (const band of plot.bands) band.swatch.style.background = toneColour(band);
  }

  function point(x, group, source) {
    for (const plot of plots) {
      if (plot !== source && (!group || plot.group !== group)) continue;
      const at = x === null ? null : domX(plot.graph, x), area = plot.graph.getArea();
      const inside = at !== null && at >= area.x && at <= area.x + area.w;
      plot.hairline.style.display = inside ? "block" : "none";
      if (inside) plot.hairline.style.left = at + "px";
      for (const curve of plot.curves) curve.value.textContent = inside ? figure(valueAt(x, curve.x, curve.y, curve.steps)) : "";
      for (const band of plot.bands) {
        const low = inside ? valueAt(x, band.x, band.low) : null, high = inside ? valueAt(x, band.x, band.high) : null;
        band.value.textContent = low === null || high === null ? "" : figure(low) + " to " + figure(high);
      }
    }
  }

  function build(plot) {
    const element = document.getElementById(plot.id), canvas = element.querySelector(".canvas");
    for (const item of plot.curves.concat(plot.bands)) item.x = decode(item.x);
    buildLegend(plot, element);
    paintLegend(plot);
    plot.rows = joinedRows(plot);
    plot.graph = new Dygraph(canvas, plot.rows, options(plot, canvas.clientWidth));
    plot.hairline = document.createElement("div");
    plot.hairline.className = "hairline";
    canvas.append(plot.hairline);
    canvas.addEventListener("mousemove", (event) => {
      point(plot.graph.toDataXCoord(event.clientX - canvas.getBoundingClientRect().left), plot.group, plot);
    });
    canvas.addEventListener("mouseleave", () => point(null, plot.group, plot));
    plot.graph.ready(() => {
      element.dataset.points = String(plot.curves.reduce((sum, curve) => sum + curve.y.filter((y) => y !== null).length, 0));
      element.dataset.ready = String(canvas.querySelectorAll("canvas").length > 0 && plot.graph.numRows() > 0);
    });
  }

  function repaint() {
    zooming = true;
    for (const plot of plots) {
      paintLegend(plot);
      plot.graph.updateOptions({ colors: colours(plot), gridLineColor: variable("line"), axisLineColor: variable("soft") });
    }
    zooming = false;
  }

  function printing(on) {
    if (on) document.documentElement.dataset.printing = ""; else delete document.documentElement.dataset.printing;
    for (const plot of plots) plot.graph.resize();
    repaint();
  }

  plots.forEach(build);
  for (const button of document.querySelectorAll("[data-panel]"))
    button.addEventListener("click", () => {
      for (const other of button.parentElement.children) {
        const chosen = other === button;
        other.setAttribute("aria-pressed", String(chosen));
        document.getElementById(other.dataset.panel).classList.toggle("shown", chosen);
      }
    });
  if (resetButton)
    resetButton.addEventListener("click", () => {
      zooming = true;
      for (const plot of plots) plot.graph.resetZoom();
      zooming = false;
      resetButton.hidden = true;
    });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  addEventListener("beforeprint", () => printing(true));
  addEventListener("afterprint", () => printing(false));
})();
