/** What opening a file waits for. */

import { attempt } from "../actions";
import { call } from "../connection";
import { counted, seconds } from "../panels/format";
import { judging } from "../state/session";

/** While a file's plan is judged, which may take a while: how far it is, and a way out. */
export function JudgingLine() {
  const now = judging.value;
  if (now === null) return null;
  const stop = () => void attempt(call("stopJudging", { file: now.file }));
  return (
    <div class="notice judging">
      <span>
        {`The referee is judging ${now.file}, ${counted(now.vehicles, "vehicle")}: ${seconds(now.seconds)} of at most ${seconds(now.limit)} of a processor`}
      </span>
      <button type="button" onClick={stop} title="Opens the scenario without its plan">
        Stop
      </button>
    </div>
  );
}
