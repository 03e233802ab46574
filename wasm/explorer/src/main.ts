import { CapsuleExplorer, defineElement } from "./element";
import styles from "./style/explorer.css?inline";
import { loadFont } from "./style/font";

/** The script of `<capsule-explorer>` for other pages: it brings the element and its styles, and nothing on screen. */
const sheet = new CSSStyleSheet();
sheet.replaceSync(styles);
document.adoptedStyleSheets.push(sheet);
loadFont();
// The page around it may lie anywhere: the model and the notices are beside the script.
CapsuleExplorer.home = new URL(import.meta.url);
defineElement();
