// What moves in report.html: one moment of the drive, shown in all plots and on the map, and evidence that opens.
"use strict";
(() => {
  const samples = JSON.parse(document.getElementById("samples").textContent);
  const last = samples.t.length - 1;
  const span = Math.max(samples.t[last] - samples.t[0], 1e-3);
  const slider = document.getElementById("moment");
  const here = document.getElementById("here");
  const map = document.getElementById("map");
  const told = {
    speed: (i) => `${samples.speed[i]} m/s` + (samples.limit[i] === null ? "" : ` of ${samples.limit[i]}`),
    acceleration: (i) => `along ${samples.along[i]}, across ${samples.across[i]} m/s²`,
    jerk: (i) => `${samples.jerk[i]} m/s³`,
    offset: (i) => (samples.offset[i] === null ? "no lane" : `${samples.offset[i]} m`),
  };

  // `basu watch` serves reports below record/, and its page takes a moment; from a disk, a command names this folder
  const isServed = /^http/.test(location.protocol) && /\/record\/[^/]*$/.test(location.pathname);
  const folder = location.protocol === "file:" ? decodeURIComponent(location.pathname).replace(/\/[^/]*$/, "") : ".";
  const quoted = /^[\w./-]+$/.test(folder) ? folder : `'${folder.replaceAll("'", "'\\''")}'`;

  function replayAt(place, seconds) {
    const link = place.querySelector("a");
    link.dataset.at = seconds;
    link.textContent = `Replay from ${seconds} s`;
    link.href = `../?t=${seconds}`;
    link.hidden = !isServed;
    place.querySelector("span").hidden = isServed;
    place.querySelector("code").textContent = `basu watch ${quoted} --at ${seconds}`;
    if (folder !== ".") place.querySelector("span").firstChild.textContent = "";
  }
  for (const place of document.querySelectorAll(".replay")) replayAt(place, place.querySelector("a").dataset.at);

  function show(index) {
    const i = Math.min(last, Math.max(0, index));
    slider.value = i;
    document.body.classList.add("moving");
    document.body.style.setProperty("--t", (samples.t[i] - samples.t[0]) / span);
    here.hidden = false;
    here.style.left = `${samples.left[i]}%`;
    here.style.top = `${samples.top[i]}%`;
    replayAt(document.getElementById("replay"), samples.t[i].toFixed(1));
    document.getElementById("now").textContent = `${samples.t[i].toFixed(1)} s of ${samples.t[last].toFixed(1)} s, ${told.speed(i)}`;
    for (const [id, tell] of Object.entries(told)) {
      document.querySelector(`#${id} .now`).textContent = `· ${tell(i)}`;
    }
  }

  // samples are evenly spaced in time
  const showTime = (seconds) => show(Math.round(((seconds - samples.t[0]) / span) * last));

  for (const plot of document.querySelectorAll(".timed")) {
    plot.addEventListener("pointermove", (event) => {
      const box = plot.getBoundingClientRect();
      showTime(samples.t[0] + ((event.clientX - box.left) / box.width) * span);
    });
  }
  map.addEventListener("pointermove", (event) => {
    const box = map.getBoundingClientRect();
    let nearest = -1;
    let least = 30; // px: a pointer farther than this from the drive means something else
    for (let i = 0; i <= last; i++) {
      const away = Math.hypot(
        box.left + (samples.left[i] / 100) * box.width - event.clientX,
        box.top + (samples.top[i] / 100) * box.height - event.clientY,
      );
      if (away < least) [least, nearest] = [away, i];
    }
    if (nearest >= 0) show(nearest);
  });
  slider.max = last;
  slider.addEventListener("input", () => show(Number(slider.value)));
  slider.closest(".moment").hidden = false;

  // `basu index` tells its reports the way back to it
  const index = new URLSearchParams(location.search).get("index");
  if (index && /^(\.\.\/)*index\.html$/.test(index)) {
    document.getElementById("all-runs").href = index;
    document.getElementById("all-runs").hidden = false;
  }

  function openNamed() {
    const named = document.getElementById(location.hash.slice(1));
    const found = named?.tagName === "SECTION" ? named.querySelector(":scope > details") : named;
    if (!found || found.tagName !== "DETAILS") return;
    for (let each = found; each; each = each.parentElement.closest("details")) each.open = true;
    found.scrollIntoView({ block: "nearest" });
    found.querySelector("summary").focus({ preventScroll: true });
    if (found.dataset.t) showTime(Number(found.dataset.t));
  }
  addEventListener("hashchange", openNamed);
  for (const link of document.querySelectorAll('a[href^="#"]')) {
    link.addEventListener("click", () => link.hash === location.hash && openNamed()); // no change, no event
  }
  openNamed();

  const evidence = [...document.querySelectorAll("details")];
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = evidence.filter((each) => !each.open);
    for (const each of opened) each.open = true;
  });
  addEventListener("afterprint", () => {
    for (const each of opened) each.open = false;
  });
})();
