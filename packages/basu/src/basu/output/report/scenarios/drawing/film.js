// The films of cases: a slider moves the actors of a picture between their key frames, and a button plays them.
"use strict";
(() => {
  const keysOf = (text) => text.split(";").map((key) => key.split(" ").map(Number));

  // the key frames around a time, linearly interpolated; null outside them
  function at(keys, seconds) {
    const last = keys.length - 1;
    if (seconds < keys[0][0] - 1e-6 || seconds > keys[last][0] + 1e-6) return null;
    let next = 1;
    while (next < last && keys[next][0] < seconds) next += 1;
    const [before, after] = [keys[next - 1], keys[next]];
    const part = Math.min(1, Math.max(0, (seconds - before[0]) / Math.max(after[0] - before[0], 1e-9)));
    return before.map((value, column) => value + part * (after[column] - value));
  }

  function prepare(bar) {
    const picture = bar.parentElement.querySelector("svg.case-picture");
    const film = picture && picture.querySelector(".film");
    if (!film) return;
    const [slider, told, play] = [bar.querySelector("input"), bar.querySelector("output"), bar.querySelector(".play")];
    const moving = [...film.querySelectorAll("[data-keys]")].map((part) => [part, keysOf(part.dataset.keys)]);
    const timed = [...film.querySelectorAll("[data-from]")];
    const speeds = keysOf(film.dataset.speed);
    const words = film.dataset.words.split(";").map((text) => [Number(text.split(" ", 1)), text.slice(text.indexOf(" ") + 1)]);
    const [begin, end] = [Number(film.dataset.begin), Number(film.dataset.end)];
    let request = 0;

    function show(seconds) {
      picture.classList.add("moving");
      slider.value = seconds;
      for (const [part, keys] of moving) {
        const place = at(keys, seconds);
        part.style.display = place ? "" : "none";
        if (place) part.setAttribute("transform", `translate(${place[1]} ${place[2]}) rotate(${place[3]})`);
      }
      for (const part of timed) {
        const isThere = seconds >= Number(part.dataset.from) - 1e-6 && !(seconds >= Number(part.dataset.until));
        part.style.display = isThere ? "" : "none";
      }
      const speed = at(speeds, Math.min(Math.max(seconds, speeds[0][0]), speeds[speeds.length - 1][0]));
      const said = words.filter(([from]) => from <= seconds + 1e-6).pop() || words[0];
      told.textContent = `${seconds.toFixed(1)} s, ego at ${speed[1].toFixed(1)} m/s, ${said[1]}`;
    }
    function stop() {
      cancelAnimationFrame(request);
      request = 0;
      play.textContent = "Play";
    }
    function run() {
      const from = Number(slider.value) >= end - 1e-6 ? begin : Number(slider.value);
      let started = null;
      play.textContent = "Pause";
      const step = (now) => {
        started = started ?? now;
        const seconds = Math.min(end, from + (now - started) / 1000);
        show(seconds);
        if (seconds < end) request = requestAnimationFrame(step);
        else stop();
      };
      request = requestAnimationFrame(step);
    }
    [slider.min, slider.max, slider.value] = [begin, end, begin];
    slider.addEventListener("input", () => {
      stop();
      show(Number(slider.value));
    });
    play.addEventListener("click", () => (request ? stop() : run()));
    bar.querySelector(".still").addEventListener("click", () => {
      stop();
      slider.value = begin;
      picture.classList.remove("moving");
      told.textContent = "";
    });
    bar.hidden = false;
  }
  for (const bar of document.querySelectorAll(".film-bar")) prepare(bar);
})();
