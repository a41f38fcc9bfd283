// @ts-check
/** Buttons that change a running world: pause, step, speed, weather, spawn, send; only if the program allows it. */

import { element } from "./panel.js";

const WEATHERS = /** @type {Record<string, Record<string, number>>} */ ({
  "clear noon": { cloudiness: 5, precipitation: 0, precipitation_deposits: 0, wetness: 0, fog_density: 2, sun_altitude_angle: 65 },
  "cloudy": { cloudiness: 80, precipitation: 0, precipitation_deposits: 0, wetness: 0, fog_density: 3, sun_altitude_angle: 50 },
  "rain": { cloudiness: 100, precipitation: 70, precipitation_deposits: 80, wetness: 90, fog_density: 10, sun_altitude_angle: 40 },
  "fog": { cloudiness: 60, precipitation: 0, precipitation_deposits: 20, wetness: 20, fog_density: 80, sun_altitude_angle: 35 },
  "sunset": { cloudiness: 10, precipitation: 0, precipitation_deposits: 0, wetness: 0, fog_density: 3, sun_altitude_angle: 8 },
  "night": { cloudiness: 10, precipitation: 0, precipitation_deposits: 0, wetness: 0, fog_density: 2, sun_altitude_angle: -40 },
  "rainy night": { cloudiness: 100, precipitation: 80, precipitation_deposits: 90, wetness: 100, fog_density: 8, sun_altitude_angle: -40 },
});
const SPEEDS = [0.25, 0.5, 1, 2, 4];
const SPAWNS = [
  "vehicle.tesla.model3", "vehicle.easymile.ez10", "vehicle.ford.ambulance", "vehicle.diamondback.century",
  "walker.pedestrian.0001", "walker.pedestrian.0010", "static.prop.trafficcone01",
];

/** @param {(order: Record<string, unknown>) => void} send */
export function controlOf(send) {
  const section = element("control");
  let isPaused = false;
  const pause = button("Pause", () => {
    isPaused = !isPaused;
    pause.textContent = isPaused ? "Go on" : "Pause";
    send({ order: "pause", on: isPaused });
  });
  const step = button("One step", () => {
    isPaused = true;
    pause.textContent = "Go on";
    send({ order: "step" });
  });
  const speed = select("Speed", SPEEDS.map((value) => [String(value), `${value}×`]), "1", (value) =>
    send({ order: "speed", value: Number(value) }));
  const weather = select("Weather", [["", "weather …"], ...Object.keys(WEATHERS).map((name) => [name, name])], "", (name) => {
    if (name) send({ order: "weather", values: WEATHERS[name] });
  });
  const spawned = select("Spawn with a click", [["", "spawn with a click …"], ...SPAWNS.map((type) => [type, type])], "", () => {});
  let wantsGoal = false;
  /** @param {boolean} wants */
  const waitForGoal = (wants) => {
    wantsGoal = wants;
    sent.setAttribute("aria-pressed", String(wants));
    sent.textContent = wants ? "Click where it shall go" : "Send somewhere";
  };
  const sent = button("Send somewhere", () => waitForGoal(!wantsGoal));
  const gone = button("Take away", () => {
    send({ order: "destroy", id: chosen?.id });
  });
  const rows = [[pause, step, speed], [weather], [spawned], [sent, gone]];
  /** @type {{id: number, x: number, y: number, yaw: number, isVehicle: boolean} | null} */
  let chosen = null;
  section.replaceChildren(
    ...rows.map((parts) => {
      const row = document.createElement("div");
      row.append(...parts);
      return row;
    }),
  );
  return {
    /** @param {boolean} isAllowed */
    show(isAllowed) {
      section.hidden = !isAllowed;
    },
    /** Note which actor the buttons are for. @param {typeof chosen} actor */
    choose(actor) {
      chosen = actor;
      sent.disabled = gone.disabled = actor === null;
      sent.title = gone.title = actor === null ? "Click a vehicle or a person first" : `actor ${actor.id}`;
      if (actor === null && wantsGoal) waitForGoal(false);
    },
    get wantsGoal() {
      return !section.hidden && wantsGoal && chosen !== null;
    },
    /** Send the chosen actor to a place. @param {number} x @param {number} y in m */
    sendTo(x, y) {
      if (chosen === null) return;
      send({ order: "send", id: chosen.id, from: [chosen.x, chosen.y, chosen.yaw], to: [x, y], on_lanes: chosen.isVehicle });
      waitForGoal(false);
    },
    get wantsPlace() {
      return !section.hidden && spawned.value !== "";
    },
    /** @param {(number | null)[]} place x, y, z in m; z is null on the ground @param {number} yaw in degrees */
    spawn(place, yaw) {
      send({ order: "spawn", type: spawned.value, place, yaw });
    },
  };
}

/** @param {string} text @param {() => void} act */
function button(text, act) {
  const made = document.createElement("button");
  made.textContent = text;
  made.onclick = act;
  return made;
}

/** @param {string} label @param {string[][]} choices @param {string} chosen @param {(value: string) => void} act */
function select(label, choices, chosen, act) {
  const made = document.createElement("select");
  made.setAttribute("aria-label", label);
  for (const [value, text] of choices) made.add(new Option(text, value, false, value === chosen));
  made.onchange = () => act(made.value);
  return made;
}
