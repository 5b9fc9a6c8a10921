"""The certified planner: sets planned exactly at one price of risk, joined, and judged.

All files share the Lagrangian of the chance-constrained program over the whole fleet,

    minimize  Σ over sets of  (effort + λ · risk / unit),

which decomposes into one problem per set at a Lagrange multiplier λ common to all, the unit price
of risk (`fleet` defines the unit); the referee says which sets may stay apart, and λ is chosen so
that the joint risk is just within Δ.

There are two values, both immutable. The `Fleet` is the problem: scenario, gap, limits, the
programs of sets, each built when first asked for. The `SearchState` is all that is known of it so
far. Every phase takes both and returns the next state:

1. `pricing.price_alone` plans every vehicle alone, for a price to begin with.
2. `rounds.run_round` plans all sets at the price and merges those that collide (`set_searches`
   asks for them, `initial_plan` helps where one is hard).
3. `acceptance.accept_round` rescales the round's risks until the referee's certificate is just
   within Δ, and keeps the plan if it is the cheapest so far.
4. `search.PriceSearch.run` repeats these two, each time at a better price.
5. `closing.close_gap` searches within budgets where prices leave a gap (`within_budget`).
6. `fallbacks.last_resort` is for where there is no plan by then: it looks for one from the safest,
   and says why there is none.
7. `turned` improves the plan by half-spaces that need not be faces.

`certified` calls them in turn. Beside the two values only the search trees of `within_budget` are
kept, which go on where they stood; `state.bounds` reads off a state what it proves.
"""
