/** The page of `radmpc serve`. */

import { render } from "preact";
import { start } from "./actions";
import { Shell } from "./shell";

const root = document.getElementById("page");
if (root !== null) render(<Shell />, root);
start();
