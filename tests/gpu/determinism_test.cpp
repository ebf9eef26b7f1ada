// SPDX-License-Identifier: Apache-2.0
// The same bits in every run, within a process and across processes, and for every number of
// lavapipe's threads: any order of summation that depended on scheduling would show here.
#include <bit>
#include <cstdint>
#include <map>
#include <sstream>

#include "gpu_body.hpp"
#include "run_again.hpp"

namespace sunder::test {
namespace {

/// FNV-1a over the bits of doubles.
class Hash {
 public:
  void add(std::span<const double> values) {
    for (double v : values) {
      for (std::uint64_t bits = std::bit_cast<std::uint64_t>(v), i = 0; i < 8; ++i, bits >>= 8) {
        state_ = (state_ ^ (bits & 0xff)) * 1099511628211ull;
      }
    }
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 14695981039346656037ull;
};

/// Everything that a gripped, tearing board's backend hands out, frame by frame.
std::uint64_t bits_of(const Way& way) {
  Scene scene = held_board();
  Instrument low;
  low.name = "low";
  low.action = Grip{Box{Vec3(20, -0.001, -1), Vec3(30, 0.001, 3)}, Vec3(1, -2, 0.5), Axes{3}};
  scene.instruments.push_back(low);
  const WatchedBackend watched(std::move(scene), way);
  const auto backend = watched.create(all_needs());
  Load load = corner_pull(*watched.problem);
  for (double& d : load.displacements) d = 0.1;
  Hash hash;
  const auto frame = [&] {
    backend->set_load(load);
    const SolveReport report = backend->solve();
    const StressSummary summary = backend->stress();
    hash.add(std::array{report.error, report.residual, summary.any.ratio});
    hash.add(Pair::displacement(*backend));
    for (const Voigt& s : Pair::stress(*backend)) hash.add({s.data(), 6});
    std::vector<double> reactions(load.displacements.size());
    backend->read_reactions(reactions);
    hash.add(reactions);
  };
  if (way.route != Route::cg) frame();  // its iterations take the time of all other ways
  for (Index e : crack_sequence(*watched.problem, 8, 10)) backend->destroy({&e, 1});
  frame();
  std::vector<double> pristine(3 * watched.problem->mesh().nodes.size());
  backend->solve_pristine(load, pristine);
  hash.add(pristine);
  return hash.value();
}

std::vector<Way> every_way() {
  std::vector<Way> ways = all_ways();
  for (gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    ways.push_back({.variant = variant, .update = Update::automatic, .route = Route::cg});
  }
  return ways;
}

// Prints a line per way; run by the test below.
TEST(DeterminismState, DISABLED_Print) {
  for (const Way& way : every_way()) {
    std::printf("state %s %016llx\n", name_of(way).c_str(),
                static_cast<unsigned long long>(bits_of(way)));
  }
}

using States = std::map<std::string, std::string>;

States states_with(const std::string& threads) {
  const auto [output, code] = run_again("LP_NUM_THREADS=" + threads, "DeterminismState.*");
  EXPECT_EQ(code, 0) << output;
  States states;
  std::istringstream words(output);
  for (std::string word; words >> word;) {
    if (word != "state") continue;
    std::string name;
    words >> name >> states[name];
  }
  return states;
}

using Determinism = WithVulkan<>;

TEST_F(Determinism, SameBitsInEveryRunAndForEveryThreadCount) {
  const States first = states_with("0");
  ASSERT_EQ(first.size(), every_way().size());
  for (const char* threads : {"1", "2", "2"}) {
    EXPECT_EQ(states_with(threads), first) << "with " << threads << " threads";
  }
}

TEST_F(Determinism, SameBitsInOneProcess) {
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    const Way way{.precision = precision};
    EXPECT_EQ(bits_of(way), bits_of(way)) << name_of(way);
  }
}

}  // namespace
}  // namespace sunder::test
