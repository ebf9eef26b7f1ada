// SPDX-License-Identifier: Apache-2.0
// The same bits in every run, within a process and across processes, and for every number of
// lavapipe's threads: any order of summation that depended on scheduling would show here.
#include <bit>
#include <cstdint>
#include <map>
#include <sstream>

#include "gpu_body.hpp"
#include "organ.hpp"
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

/// Everything that a backend hands out, frame by frame.
class Recorder {
 public:
  Recorder(Backend& backend, Load load) : backend_(backend), load_(std::move(load)) {}

  void frame() {
    backend_.set_load(load_);
    const SolveReport report = backend_.solve();
    const StressSummary summary = backend_.stress();
    hash_.add(std::array{report.error, report.residual, summary.any.ratio});
    hash_.add(Pair::displacement(backend_));
    for (const Voigt& s : Pair::stress(backend_)) hash_.add({s.data(), 6});
    std::vector<double> reactions(load_.displacements.size());
    backend_.read_reactions(reactions);
    hash_.add(reactions);
  }
  void pristine() {
    std::vector<double> u(3 * backend_.problem().mesh().nodes.size());
    backend_.solve_pristine(load_, u);
    hash_.add(u);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_.value(); }

 private:
  Backend& backend_;
  Load load_;
  Hash hash_;
};

Load pull_and_grip(const Problem& problem) {
  Load load = corner_pull(problem);
  for (double& d : load.displacements) d = 0.1;
  return load;
}

/// Of a gripped board with a crack of eight elements.
std::uint64_t bits_of(const Way& way) {
  Scene scene = held_board();
  Instrument low;
  low.name = "low";
  low.action = Grip{Box{Vec3(20, -0.001, -1), Vec3(30, 0.001, 3)}, Vec3(1, -2, 0.5), Axes{3}};
  scene.instruments.push_back(low);
  const WatchedBackend watched(std::move(scene), way);
  const auto backend = watched.create(all_needs());
  Recorder recorder(*backend, pull_and_grip(*watched.problem));
  if (way.route != Route::cg) recorder.frame();  // its iterations take the time of all other ways
  for (Index e : crack_sequence(*watched.problem, 8, 10)) backend->destroy({&e, 1});
  if (way.damage) recorder.frame(), recorder.frame();  // its matrices come with solutions
  recorder.frame();
  recorder.pristine();
  return recorder.value();
}

/// Bytes that the damage since the base takes.
std::size_t damage_bytes(const Backend& backend) {
  for (const BufferPlan& b : backend.buffers()) {
    if (b.name == "small matrix of the damage") return b.bytes;
  }
  return 0;
}

/// Of an organ that tears until a base that a thread has made meanwhile takes over, and on.
std::uint64_t bits_across_a_new_base(const Way& way) {
  Scene scene = organ();
  add_pull(scene);
  const WatchedBackend watched(std::move(scene), way);
  const auto backend = watched.create(all_needs());
  Recorder recorder(*backend, corner_pull(*watched.problem));
  int destroyed = 0, taken = 0;
  for (Index e : crack_sequence(*watched.problem, 210, 0)) {
    const std::size_t before = damage_bytes(*backend);
    backend->destroy({&e, 1});
    if (damage_bytes(*backend) < before) ++taken;
    if (++destroyed % 30 == 0) recorder.frame();
  }
  EXPECT_GE(taken, 1) << name_of(way) << ": no new base has been taken";
  recorder.pristine();
  return recorder.value();
}

std::vector<Way> every_way() {
  std::vector<Way> ways = all_ways();
  for (gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    ways.push_back({.variant = variant, .damage = true});
    ways.push_back({.variant = variant, .update = Update::automatic, .route = Route::cg});
  }
  return ways;
}

std::vector<Way> ways_across_a_new_base() {
  using gpu::Variant;
  using enum Precision;
  return {{.variant = Variant::gpu, .precision = fp64},
          {.variant = Variant::lvp, .precision = fp32},
          {.variant = Variant::gpu, .precision = fp32, .route = Route::condensed},
          {.variant = Variant::lvp, .precision = fp64, .route = Route::condensed},
          {.route = Route::condensed, .region = true, .damage = true}};
}

// Prints a line per way; run by the test below.
TEST(DeterminismState, DISABLED_Print) {
  const auto print = [](const char* what, const Way& way, std::uint64_t bits) {
    std::printf("state %s_%s%s %016llx\n", what, name_of(way).c_str(),
                way.route == Route::condensed ? "_condensed" : "",
                static_cast<unsigned long long>(bits));
  };
  for (const Way& way : every_way()) print("short", way, bits_of(way));
  for (const Way& way : ways_across_a_new_base()) print("long", way, bits_across_a_new_base(way));
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
  ASSERT_EQ(first.size(), every_way().size() + ways_across_a_new_base().size());
  for (const char* threads : {"1", "2"}) {
    EXPECT_EQ(states_with(threads), first) << "with " << threads << " threads";
  }
}

TEST_F(Determinism, SameBitsInOneProcess) {
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    const Way way{.precision = precision};
    EXPECT_EQ(bits_of(way), bits_of(way)) << name_of(way);
    EXPECT_EQ(bits_across_a_new_base(way), bits_across_a_new_base(way)) << name_of(way);
  }
}

}  // namespace
}  // namespace sunder::test
