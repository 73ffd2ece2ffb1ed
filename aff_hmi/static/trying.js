// Settings that are tried: shown to who commissions, kept or taken back with a reason.
import { byId, put } from "/static/see.js";
import { post } from "/static/work.js";

/** Show what is tried, as the commissioner says it stands; returns it, empty where nothing is. */
export function showTried(state) {
  const tried = state?.ok === true ? (state.service.trying ?? "") : "";
  byId("trying").hidden = !(tried && state.is_open);
  put(byId("tried"), tried);
  return tried;
}

byId("trying").onsubmit = (event) => {
  event.preventDefault();
  const said = { do: event.submitter.value, step: 0, measured: "", seconds: 0 };
  post("/card/settings", { ...said, reason: byId("tried-why").value });
};
