// A run in contact that goes on from a checkpoint, against one that was never interrupted.
#pragma once

#include <boost/test/unit_test.hpp>

#include "analysis/method.h"
#include "experiments/inputs/subject.h"
#include "solvers/simulation.h"

namespace springstab::test {

/// `with_subject(run)` calls run(subject) with the same scene made anew. Both of 2e-4 s a step; the one is
/// kept at `keep_at` steps, a checkpoint, for the other to go on from, and they end with the same bits and
/// counts.
template <class WithSubject>
void expect_same_when_resumed(const WithSubject& with_subject, const Method& method, long steps,
                              long keep_at) {
  State<Vector> kept, ends[2];
  RunSoFar kept_run;
  ContactCounts kept_counts, counts[2];
  for (const bool resumed : {false, true})
    with_subject([&](Subject& subject) {
      const auto filter = subject.contact_filter();
      const EnergyWatch watch = subject.energy_watch(subject.initial_state());
      const auto stepper = method.stepper();
      State<Vector> state = resumed ? kept : subject.initial_state();
      if (resumed) filter->set_counts(kept_counts);
      const Observer observe = [&](const RunSoFar& run, const State<Vector>& now) {
        if (run.steps == keep_at && !resumed) {
          BOOST_REQUIRE(run.at_checkpoint);
          kept = now;
          kept_run = run;
          kept_counts = filter->counts();
        }
        return true;
      };
      if (resumed)
        resume_simulation(subject.system(), *stepper, kept_run, watch, state, observe, {}, filter.get());
      else
        simulate(subject.system(), *stepper, {2e-4, steps}, watch, state, observe, {}, filter.get());
      ends[resumed] = state;
      counts[resumed] = filter->counts();
    });
  BOOST_TEST((ends[0].x == ends[1].x && ends[0].v == ends[1].v));
  BOOST_TEST(counts[0].pairs == counts[1].pairs);
  BOOST_TEST(counts[0].impulses == counts[1].impulses);
  BOOST_TEST(counts[0].lifts == counts[1].lifts);
  BOOST_TEST(counts[0].passes == counts[1].passes);
  BOOST_TEST(counts[0].normal_work == counts[1].normal_work);
  BOOST_TEST(counts[0].impulses > kept_counts.impulses);
  BOOST_TEST(kept_counts.impulses > 0);
}

}  // namespace springstab::test
