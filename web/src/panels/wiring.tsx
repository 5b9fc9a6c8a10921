/**
 * Side panels and the timeline, wired to the state.
 *
 * The shell puts these into its regions: `PlanRegion`, `RiskRegion` and `FlightRegion` into tabs of
 * the side column, `TimelineRegion` below the map.
 */

import { computed } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { change, comparePlan, showPlan } from "../actions";
import { document, scenario } from "../state/document";
import { flight, flights } from "../state/flights";
import { flip, switches } from "../state/layers";
import { compared, comparedId, shown, shownId, shownTrails, summaries } from "../state/plans";
import { dt, goTo, horizon, isFollowing, isPlaying, play, speed, time } from "../state/playback";
import { hello, whyEmpty } from "../state/session";
import { replans } from "./account";
import * as asking from "./asking";
import { Compare } from "./compare";
import { Delta } from "./delta";
import { Flight } from "./flight";
import { risksBySteps } from "./ledger";
import { Plans } from "./plans";
import { pointAtDifference, pointAtLines, pointAtRemark, pointAtVehicles, release, stay } from "./pointing";
import { pricePoints } from "./price";
import { Risk } from "./risk";
import { Search } from "./search";
import { Simulate } from "./simulate";
import { Timeline } from "./timeline";
import { Together } from "./together";
import { Why } from "./why";

asking.follow();

const points = computed(() => pricePoints(summaries.value, document.value?.revision ?? -1));

/** Nothing is pointed at any more from a panel that is turned away from. */
function useRelease(): void {
  useEffect(() => release, []);
}

export function PlanRegion() {
  useRelease();
  if (document.value === null) return <p class="p-block p-empty">{whyEmpty()}</p>;
  return (
    <>
      <DeltaPart />
      <SearchPart />
      <PlansPart />
      <ComparePart />
      <WhyPart />
    </>
  );
}

function DeltaPart() {
  const ofScenario = scenario.value?.riskBound;
  if (ofScenario === undefined) return null;
  const set = (riskBound: number) => (asking.chosenBound.value = riskBound === ofScenario ? null : riskBound);
  return (
    <Delta
      riskBound={asking.nextBound.value}
      ofScenario={ofScenario}
      points={points.value}
      shown={shownId.value}
      onChange={set}
      onShow={(plan) => void showPlan(plan)}
      onWrite={(riskBound) =>
        void change([{ path: ["risk_bound"], value: riskBound }], "Change Δ").then((isDone) => {
          if (isDone) asking.chosenBound.value = null;
        })
      }
    />
  );
}

function SearchPart() {
  return (
    <Search
      planners={hello.value?.planners ?? []}
      wishes={asking.wishes.value}
      refusal={asking.refusal.value}
      search={asking.search.value}
      moments={asking.moments.value}
      riskBound={asking.nextBound.value}
      onWishes={(wishes) => (asking.wishes.value = wishes)}
      onPlan={() => void asking.once(asking.isStarting.search, asking.startSearch)}
      onPause={() => void asking.steer("pause")}
      onResume={() => void asking.steer("resume")}
      onStop={() => void asking.steer("stop")}
    />
  );
}

function PlansPart() {
  const state = document.value;
  const stem = (state?.file ?? scenario.value?.name ?? "scenario").replace(/\.(ya?ml|json)$/u, "");
  return (
    <Plans
      plans={summaries.value}
      revision={state?.revision ?? 0}
      shown={shownId.value}
      compared={comparedId.value}
      exports={hello.value?.exports ?? []}
      path={`${stem.replace(/\.plan$/u, "")}.plan.json`}
      onShow={(plan) => void showPlan(plan)}
      onCompare={(plan) => void comparePlan(plan)}
      onSave={(plan, path, overwrite) => void asking.savePlan(plan, path, overwrite)}
      onExport={(plan, format) => void asking.exportPlan(plan, format)}
    />
  );
}

function ComparePart() {
  const plan = shown.value;
  const other = compared.value;
  if (plan === null || other === null || plan.plan === other.plan) return null;
  return (
    <Compare
      plan={plan}
      other={other}
      onEnd={() => void comparePlan(null)}
      onSwap={() => {
        void comparePlan(plan.plan);
        void showPlan(other.plan);
      }}
      onPoint={pointAtDifference}
      onGo={(difference) => stay(difference.step)}
    />
  );
}

function WhyPart() {
  return (
    <Why
      remarks={asking.reasons.value}
      tried={asking.tried.value}
      isLooking={asking.isLooking.value}
      canLook={asking.refusal.value === null}
      onLook={() => void asking.look()}
      onCure={(cure) => void change(cure.changes, cure.label)}
      onPoint={pointAtRemark}
      onGo={pointAtRemark}
    />
  );
}

export function RiskRegion() {
  useRelease();
  const plan = shown.value;
  return (
    <>
      <Risk
        plan={plan}
        vehicle={asking.riskVehicle.value}
        onVehicle={(vehicle) => (asking.riskVehicle.value = vehicle)}
        onPoint={pointAtLines}
        onGo={(lines) => stay(lines[0]?.step ?? null)}
      />
      {plan !== null && <Together plan={plan} onPoint={pointAtVehicles} />}
      {plan !== null && (
        <Simulate
          plan={plan.summary}
          trails={shownTrails.value}
          isRunning={asking.isSimulating.value}
          isShown={switches.value.trails}
          onSimulate={(missions, seed) => void asking.runSimulation(plan.plan, missions, seed)}
          onToggle={() => flip("trails")}
        />
      )}
    </>
  );
}

export function FlightRegion() {
  const plan = shown.value;
  return (
    <Flight
      plan={plan?.summary ?? null}
      flights={flights.value}
      flight={flight.value}
      dt={dt.value}
      time={time.value}
      isFollowing={isFollowing.value}
      order={asking.order.value}
      onOrder={(order) => (asking.order.value = order)}
      onFly={() => {
        if (plan !== null) void asking.once(asking.isStarting.flight, () => asking.startFlight(plan.plan));
      }}
      onStop={(id) => void asking.stopFlight(id)}
      onChoose={asking.chooseFlight}
      onTime={goTo}
      onFollow={(isOn) => (isFollowing.value = isOn)}
    />
  );
}

/** The vehicle of the ledger's filter, where the plan shown has it. */
const risks = computed(() => {
  const plan = shown.value;
  if (plan === null) return null;
  const vehicle = asking.riskVehicle.value;
  const isThere = plan.scenario.vehicles.some((one) => one.name === vehicle);
  return risksBySteps(plan.ledger, plan.scenario.horizon, isThere ? vehicle : null);
});

const planned = computed(() => replans(flight.value));

export function TimelineRegion() {
  return (
    <Timeline
      time={time.value}
      horizon={horizon.value}
      dt={dt.value}
      isPlaying={isPlaying.value}
      speed={speed.value}
      risks={risks.value}
      replans={planned.value}
      onTime={goTo}
      onPlay={play}
      onSpeed={(value) => (speed.value = value)}
    />
  );
}
