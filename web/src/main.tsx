/** The page of `radmpc serve`. */

import { render } from "preact";
import { start } from "./actions";
import { listenToKeys } from "./edit/keyboard";
import { watch } from "./scene/viewport";
import { Shell } from "./shell";
import { startClock } from "./state/playback";
import { restore } from "./state/restore";

const root = document.getElementById("page");
if (root !== null) render(<Shell />, root);
listenToKeys();
startClock();
watch();
restore();
start();
