// SPDX-License-Identifier: Apache-2.0
// The notch board tears the same way whatever carries its damage.
#include <gtest/gtest.h>

#include "support/torn_board.hpp"

namespace sunder::test {
namespace {

TornBoard tear(FractureModel model, Route route, Update update) {
  SolverOptions solver;
  solver.route = route;
  solver.update = update;
  return torn_board(model, solver, 90);
}

class SameFractures : public ::testing::TestWithParam<FractureModel> {};

TEST_P(SameFractures, ByEveryRouteAndUpdate) {
  const TornBoard reference = tear(GetParam(), Route::inverse, Update::eager);
  ASSERT_GT(reference.elements.size(), 40u);
  const std::pair<Route, Update> others[] = {{Route::inverse, Update::deferred},
                                             {Route::condensed, Update::deferred},
                                             {Route::factor, Update::deferred},
                                             {Route::cg, Update::automatic}};
  for (const auto& [route, update] : others) {
    SCOPED_TRACE(static_cast<int>(route));
    const TornBoard torn = tear(GetParam(), route, update);
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
