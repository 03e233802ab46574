// A browser loads neither modules nor the model into a page that is opened as a file: say what helps.
if (window.location.protocol === "file:") {
  const main = document.createElement("main");
  main.style.cssText = "max-width: 38rem; margin: 12vh auto; padding: 0 20px; font: 16px/1.5 system-ui, sans-serif";
  const english = `
    <h1 style="font-size: 1.4em; font-weight: 500">CapsuleExplorer has to be served.</h1>
    <p>Opened as a file, a page may not load its program and its model. Serve its folder and open the address:</p>
    <pre><code>python3 -m http.server --bind 127.0.0.1 8000</code></pre>
    <p>in the folder of this file, then <code>http://127.0.0.1:8000/</code>. In the repository,
    <code>cargo xtask explore</code> builds the page and serves it. Nothing leaves the computer.</p>`;
  const french = `
    <h1 style="font-size: 1.4em; font-weight: 500">CapsuleExplorer doit être servi.</h1>
    <p>Ouverte comme fichier, une page ne peut charger ni son programme ni son modèle. Servir son dossier et ouvrir
    l’adresse :</p>
    <pre><code>python3 -m http.server --bind 127.0.0.1 8000</code></pre>
    <p>dans le dossier de ce fichier, puis <code>http://127.0.0.1:8000/</code>. Dans le dépôt,
    <code>cargo xtask explore</code> construit la page et la sert. Rien ne quitte l’ordinateur.</p>`;
  const isFrench = navigator.language.startsWith("fr");
  document.documentElement.lang = isFrench ? "fr" : "en";
  main.innerHTML = isFrench ? french : english;
  document.body.replaceChildren(main);
}
