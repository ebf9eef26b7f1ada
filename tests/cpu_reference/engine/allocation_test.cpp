// SPDX-License-Identifier: Apache-2.0
// A frame allocates nothing once it is warm: operator new is counted here.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace {

std::atomic<long> allocations{0};

void* counted(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

namespace sunder::test {
namespace {

class Allocations : public ::testing::TestWithParam<Route> {};

// Room for a rebase is not counted: it is another thread's, once in a hundred fractures.
TEST_P(Allocations, AreNoneInAWarmFrame) {
  Scene scene = pulled_board();
  scene.solver.route = GetParam();
  const Body body(std::move(scene));
  std::vector<double> force(body.problem->dofs().size(), 0.0);
  for (Index n = 0; n < body.problem->node_count(); ++n) {
    if (body.problem->mesh().nodes[n].x() > 49.9) force[3 * static_cast<std::size_t>(n)] = 0.5;
  }
  body.load(force);
  Load load;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const Index d = body.problem->dofs()[i];
    if (d == kNone || force[i] == 0) continue;
    load.force_dofs.push_back(d);
    load.forces.push_back(force[i]);
  }
  load.displacements.assign(body.problem->gripped_dofs().size(), 0.0);
  const auto sequence = crack_sequence(*body.problem, 40, 8);
  std::vector<long> counts;
  for (const Index& e : sequence) {
    const long before = allocations.load();
    body.backend->destroy({&e, 1});
    for (double& f : load.forces) f *= 1.01;
    body.backend->set_load(load);
    body.backend->solve();
    body.backend->stress();
    counts.push_back(allocations.load() - before);
  }
  for (std::size_t i = 10; i < counts.size(); ++i) EXPECT_EQ(counts[i], 0) << "fracture " << i;
  for (int quiet = 0; quiet < 5; ++quiet) {
    const long before = allocations.load();
    body.backend->set_load(load);
    body.backend->solve();
    body.backend->stress();
    EXPECT_EQ(allocations.load() - before, 0) << "quiet frame " << quiet;
  }
}

INSTANTIATE_TEST_SUITE_P(Routes, Allocations,
                         ::testing::Values(Route::inverse, Route::condensed, Route::factor),
                         [](const auto& p) {
                           return p.param == Route::inverse     ? "Inverse"
                                  : p.param == Route::condensed ? "Condensed"
                                                                : "Factor";
                         });

}  // namespace
}  // namespace sunder::test
