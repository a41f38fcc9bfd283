// What moves in matrix.html: cases are shown and hidden by group, verdict and agent, and a link opens its card.
"use strict";
(() => {
  const form = document.querySelector(".filters");
  const by = Object.fromEntries(["group", "verdict", "agent"].map((name) => [name, document.getElementById(`by-${name}`)]));
  const told = document.getElementById("shown");

  function filter() {
    let shown = 0;
    for (const group of document.querySelectorAll(".of-group")) {
      let ofGroup = 0;
      for (const each of group.querySelectorAll("details.case")) {
        let ofCase = 0;
        for (const card of each.querySelectorAll(".case-card")) {
          const fits =
            (!by.verdict.value || card.dataset.verdict === by.verdict.value) &&
            (!by.agent.value || card.dataset.agent === by.agent.value);
          card.hidden = !fits;
          ofCase += fits;
        }
        each.hidden = ofCase === 0;
        ofGroup += ofCase;
      }
      group.hidden = ofGroup === 0 || (by.group.value !== "" && by.group.value !== group.dataset.group);
      shown += group.hidden ? 0 : ofGroup;
    }
    told.textContent = `${shown} shown`;
  }
  for (const choice of Object.values(by)) choice.addEventListener("change", filter);

  document.getElementById("open").addEventListener("click", () => {
    for (const each of document.querySelectorAll(".of-group:not([hidden]) details.case:not([hidden])")) each.open = true;
  });

  function openNamed() {
    const found = document.getElementById(location.hash.slice(1));
    const around = found && found.closest("details.case");
    if (!around) return;
    if (found.hidden || around.hidden || around.closest(".of-group").hidden) {
      for (const choice of Object.values(by)) choice.value = "";
      filter();
    }
    around.open = true;
    found.scrollIntoView({ block: "start" });
    around.querySelector("summary").focus({ preventScroll: true });
  }
  addEventListener("hashchange", openNamed);
  for (const link of document.querySelectorAll('a[href^="#"]')) {
    link.addEventListener("click", () => link.hash === location.hash && openNamed()); // no change, no event
  }
  form.hidden = false;
  filter();
  openNamed();
})();
