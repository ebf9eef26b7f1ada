// SPDX-License-Identifier: Apache-2.0
// Create, step, destroy, over and over: nothing is left. The leak sanitizer looks at the same
// tests; here the heap is counted.
#include <algorithm>
#include <cstdlib>

#include "api/c_scene.hpp"
#include "support/heap.hpp"

namespace sunder::test {
namespace {

void cycle(sunder_backend backend) {
  const sunder_scene scene = board_scene(backend, 2);
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  ASSERT_OK(sunder_simulation_destroy(simulation));
  ASSERT_OK(sunder_scene_destroy(scene));
}

/// Bytes that the heap has grown by over `count` cycles, after half as many that fill caches: the
/// allocator counts what it keeps for this thread as in use, 6 kB in the end.
std::ptrdiff_t growth(sunder_backend backend, int count) {
  for (int i = 0; i < std::max(5, count / 2); ++i) cycle(backend);
  const std::size_t before = heap_in_use();
  for (int i = 0; i < count; ++i) cycle(backend);
  return static_cast<std::ptrdiff_t>(heap_in_use()) - static_cast<std::ptrdiff_t>(before);
}

int cycles(int usual) {
  const char* asked = std::getenv("SUNDER_CYCLES");
  return asked ? std::atoi(asked) : usual;
}

TEST(CLifetime, AThousandCyclesLeaveNothing) {
  const int count = cycles(1000);
  // A byte a cycle would be a leak; the allocator's own books may move by a page.
  EXPECT_LT(growth(SUNDER_BACKEND_CPU, count), 4096);
}

TEST(CLifetime, FailedCreationsLeaveNothing) {
  const auto fail = [] {
    const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 2);
    const std::int32_t outside = 1000000;
    sunder_selection s{};
    s.ids = &outside;
    s.id_count = 1;
    EXPECT_OK(sunder_scene_add_removal(scene, 0, &s));
    sunder_simulation simulation = nullptr;
    EXPECT_EQ(sunder_simulation_create(scene, nullptr, &simulation), SUNDER_ERROR_INPUT);
    EXPECT_OK(sunder_scene_destroy(scene));
  };
  for (int i = 0; i < 5; ++i) fail();
  const std::size_t before = heap_in_use();
  for (int i = 0; i < 100; ++i) fail();
  EXPECT_LT(heap_in_use(), before + 4096);
}

}  // namespace
}  // namespace sunder::test
