// Sends name and password; what comes back is shown as text.
const byId = (name) => document.getElementById(name);
const form = byId("login");
const language = document.documentElement.lang;

form.onsubmit = async (event) => {
  event.preventDefault();
  const said = { name: byId("name").value, password: byId("password").value };
  byId("password").value = "";
  try {
    const answer = await fetch(`/login?lang=${language}`, {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(said),
      signal: AbortSignal.timeout(15000),
    });
    const found = await answer.json();
    byId("said").textContent = found.text;
    if (found.ok) location.replace(`${form.dataset.back}?lang=${language}${location.hash}`);
  } catch {
    byId("said").textContent = form.dataset.failed;
  }
};
