// SPDX-License-Identifier: Apache-2.0
// The notch board tears the same way whatever carries its damage.
#include <gtest/gtest.h>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {
namespace {

struct Torn {
  std::vector<DestroyedElement> elements;
  std::vector<Voigt> stress;
};

Torn tear(FractureModel model, Route route, Update update) {
  Scene scene = notch_board(model);
  scene.solver.route = route;
  scene.solver.update = update;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation.done() && simulation.destroyed().size() < 90) simulation.step();
  return {{simulation.destroyed().begin(), simulation.destroyed().end()}, simulation.stress()};
}

class SameFractures : public ::testing::TestWithParam<FractureModel> {};

TEST_P(SameFractures, ByEveryRouteAndUpdate) {
  const Torn reference = tear(GetParam(), Route::inverse, Update::eager);
  ASSERT_GT(reference.elements.size(), 40u);
  const std::pair<Route, Update> others[] = {{Route::inverse, Update::deferred},
                                             {Route::condensed, Update::deferred},
                                             {Route::factor, Update::deferred},
                                             {Route::cg, Update::automatic}};
  for (const auto& [route, update] : others) {
    SCOPED_TRACE(static_cast<int>(route));
    const Torn torn = tear(GetParam(), route, update);
    ASSERT_EQ(torn.elements.size(), reference.elements.size());
    for (std::size_t i = 0; i < torn.elements.size(); ++i) {
      ASSERT_EQ(torn.elements[i].element, reference.elements[i].element) << "fracture " << i;
      ASSERT_EQ(torn.elements[i].step, reference.elements[i].step) << "fracture " << i;
      ASSERT_EQ(torn.elements[i].event, reference.elements[i].event) << "fracture " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, SameFractures,
                         ::testing::Values(FractureModel::a, FractureModel::b),
                         [](const auto& p) { return p.param == FractureModel::a ? "A" : "B"; });

}  // namespace
}  // namespace sunder::test
