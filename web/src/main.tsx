/** The page of `radmpc serve`. */

import { render } from "preact";
import { start } from "./actions";
import { listenToKeys } from "./edit/keyboard";
import { keepFocus } from "./focus";
import { watch } from "./scene/viewport";
import { Shell } from "./shell";
import { call } from "./connection";
import { document as opened } from "./state/document";
import { seek, startClock } from "./state/playback";
import { shown } from "./state/plans";
import { restore } from "./state/restore";

const root = document.getElementById("page");
if (root !== null) {
  render(<Shell />, root);
  keepFocus(root);
}
listenToKeys();
startClock();
watch();
restore();
start();

// For benchmarks and for the console of a browser.
Object.assign(window, {
  radmpc: {
    seek,
    tracks: () => shown.peek()?.tracks.length ?? 0,
    plan: () => {
      const id = opened.peek()?.document ?? "";
      void call("plan", { document: id, planner: "certified", seconds: 5, gap: null, riskBound: null });
    },
  },
});
