// SPDX-License-Identifier: Apache-2.0
// Inverse reconstruction: every base and update of Sunder on the CPU and on Vulkan, and what a user
// would pick instead (bench/peers), on the same torn bodies under the same load. One thread, except
// for a software Vulkan device. A row is one event of k connected elements with the frame after it;
// rows "to640" tear 640 elements one by one. Errors are those against a CHOLMOD factor of the
// damaged stiffness with one refinement.
//   bench_reconstruction [Google Benchmark's options]
//   bench_reconstruction --peers               the peers with their settings
//   bench_reconstruction --write FOLDER BODY K the matrices of an event, for bench_peers_alone
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <map>
#include <stdexcept>

#include "bench/cholmod_data.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/reference.hpp"
#include "bench/study/method.hpp"
#include "run_rows.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

extern "C" void openblas_set_num_threads(int);

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct BodyShape {
  std::string name;
  test::BoardShape shape;
  [[nodiscard]] Index tets() const { return 6 * shape.nx * shape.ny * shape.nz; }
};

std::vector<BodyShape> bodies() {
  std::vector<BodyShape> all;
  for (Index n : {9, 18, 36, 71, 141}) {
    all.push_back({"board " + std::to_string(6 * n * n), {n, n, 1, 50, 50, 2.5}});
  }
  all.push_back({"block 7986", {11, 11, 11, 50, 50, 50}});
  return all;
}

const TearingBoard& board_of(const BodyShape& body) {
  static std::map<std::string, std::unique_ptr<TearingBoard>> boards;
  auto& board = boards[body.name];
  if (!board) board = std::make_unique<TearingBoard>(body.shape);
  return *board;
}

const Damaged& reference_of(const BodyShape& body, std::size_t k) {
  static std::map<std::pair<std::string, std::size_t>, std::unique_ptr<Damaged>> all;
  auto& reference = all[{body.name, k}];
  if (!reference) {
    const TearingBoard& board = board_of(body);
    reference = std::make_unique<Damaged>(board, board.connected(k));
  }
  return *reference;
}

struct FrameTimes {
  double update = 0, solve = 0, stress = 0;  ///< [ms]
  [[nodiscard]] double all() const { return update + solve + stress; }
};

/// A body with one way to follow its fractures.
class Follower {
 public:
  virtual ~Follower() = default;
  virtual FrameTimes tear(std::span<const Index> elements) = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Of the last frame: displacement (3 * nodes) and stress (elements).
  virtual void read(std::vector<double>& u, std::vector<Voigt>& stress) const = 0;
};

class BackendFollower : public Follower {
 public:
  BackendFollower(const TearingBoard& board, const SolverOptions& options)
      : load_{board.load_dofs, board.load_values, {}} {
    Scene scene = board.problem->scene();
    scene.solver = options;
    Needs needs;
    needs.stress = needs.damage = true;
    backend_ = create_backend(std::make_shared<Problem>(std::move(scene)), needs).backend;
    tear({});
  }
  FrameTimes tear(std::span<const Index> elements) override {
    FrameTimes times;
    auto start = Clock::now();
    if (!elements.empty()) backend_->destroy(elements);
    times.update = milliseconds_since(start);
    start = Clock::now();
    backend_->set_load(load_);
    backend_->solve();
    times.solve = milliseconds_since(start);
    start = Clock::now();
    backend_->stress();
    times.stress = milliseconds_since(start);
    return times;
  }
  std::size_t bytes() const override { return backend_->info().memory_bytes; }
  void read(std::vector<double>& u, std::vector<Voigt>& stress) const override {
    u.resize(backend_->problem().dofs().size());
    stress.resize(backend_->problem().mesh().tets.size());
    backend_->read_displacement(u);
    backend_->read_stress(stress);
  }

 private:
  Load load_;
  std::unique_ptr<Backend> backend_;
};

/// Peers know no stress: all take it by the library's plain function, element by element.
class PeerFollower : public Follower {
 public:
  PeerFollower(const TearingBoard& board, const PeerKind& kind)
      : board_(board),
        peer_(kind.create(board)),
        scale_(board.problem->mesh().tets.size(), 1.0),
        unknowns_(board.problem->dof_count()) {
    tear({});
  }
  FrameTimes tear(std::span<const Index> elements) override {
    FrameTimes times;
    if (!elements.empty()) peer_->prepare(elements);
    for (Index e : elements) {
      scale_[static_cast<std::size_t>(e)] = board_.problem->scene().fracture.alpha;
    }
    auto start = Clock::now();
    if (!elements.empty()) peer_->update();
    times.update = milliseconds_since(start);
    start = Clock::now();
    peer_->solve({unknowns_.data(), static_cast<std::size_t>(unknowns_.size())});
    times.solve = milliseconds_since(start);
    start = Clock::now();
    u_ = to_nodes(*board_.problem, unknowns_);
    stress_ = plain_stress(*board_.problem, scale_, u_);
    times.stress = milliseconds_since(start);
    return times;
  }
  std::size_t bytes() const override { return peer_->bytes(); }
  void read(std::vector<double>& u, std::vector<Voigt>& stress) const override {
    u = u_;
    stress = stress_;
  }

 private:
  const TearingBoard& board_;
  std::unique_ptr<Peer> peer_;
  std::vector<double> scale_, u_;
  std::vector<Voigt> stress_;
  Eigen::VectorXd unknowns_;
};

using Create = std::function<std::unique_ptr<Follower>(const TearingBoard&)>;

void note_errors(benchmark::State& state, const Follower& follower, const TearingBoard& board,
                 const Damaged& reference) {
  std::vector<double> u;
  std::vector<Voigt> stress;
  follower.read(u, stress);
  const Accuracy accuracy = reference.accuracy(*board.problem, u, stress);
  state.counters["error_u"] = accuracy.u;
  state.counters["error_stress"] = accuracy.stress;
  state.counters["MiB"] = static_cast<double>(follower.bytes()) / 1048576;
}

void one_event(benchmark::State& state, const BodyShape& body, std::size_t k,
               const Create& create) {
  const TearingBoard& board = board_of(body);
  const Damaged& reference = reference_of(body, k);
  for (auto _ : state) {
    const auto start = Clock::now();
    const auto follower = create(board);
    state.counters["setup_ms"] = milliseconds_since(start);
    const FrameTimes times = follower->tear(board.connected(k));
    state.SetIterationTime(1e-3 * times.all());
    state.counters["update_ms"] = times.update;
    state.counters["solve_ms"] = times.solve;
    state.counters["stress_ms"] = times.stress;
    note_errors(state, *follower, board, reference);
  }
}

/// Time of the row: the median frame.
void accumulated(benchmark::State& state, const BodyShape& body, std::size_t count,
                 const Create& create) {
  const TearingBoard& board = board_of(body);
  const Damaged& reference = reference_of(body, count);
  for (auto _ : state) {
    const auto follower = create(board);
    std::vector<double> ms;
    for (const Index& e : board.connected(count)) ms.push_back(follower->tear({&e, 1}).all());
    const auto median = [](std::vector<double> v) {
      std::sort(v.begin(), v.end());
      return v[v.size() / 2];
    };
    state.SetIterationTime(1e-3 * median(ms));
    state.counters["first_ms"] = median({ms.begin(), ms.begin() + 5});
    state.counters["last_ms"] = median({ms.end() - 100, ms.end()});
    state.counters["worst_ms"] = *std::max_element(ms.begin(), ms.end());
    note_errors(state, *follower, board, reference);
  }
}

template <class Run>
void add(const std::string& name, const Run& run) {
  const auto guarded = [=](benchmark::State& state) {
    try {
      run(state);
    } catch (const Error& error) {
      state.SkipWithError((std::string("refused: ") + error.what()).c_str());
    } catch (const std::exception& error) {
      state.SkipWithError(error.what());
    }
  };
  benchmark::RegisterBenchmark(name.c_str(), guarded)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

constexpr Index kLargestBody = 130000;  // tetrahedra, of bodies()

struct Rows {
  std::vector<std::size_t> events{1, 10, 100};  ///< elements each
  Index most_accumulated = 0;                   ///< bodies up to which 640 events pay
};

void add_rows(const BodyShape& body, const std::string& method, const Create& create,
              const Rows& rows) {
  const std::string start = "reconstruction/" + body.name + "/";
  for (std::size_t k : rows.events) {
    add(start + "k" + std::to_string(k) + "/" + method,
        [=](auto& state) { one_event(state, body, k, create); });
  }
  if (body.tets() < 1000 || body.tets() > rows.most_accumulated) return;
  add(start + "to640/" + method, [=](auto& state) { accumulated(state, body, 640, create); });
}

/// An eager update of more than 8,000 tetrahedra by hundred elements takes minutes: ten show it.
/// Only the factor's 640 are worth their time on every body; conjugate gradients and eager updates
/// cost about the same for every fracture.
Rows rows_of(const SolverOptions& options, const BodyShape& body) {
  Rows rows;
  const bool dense = options.route == Route::inverse || options.route == Route::condensed;
  const bool deferred = options.backend == "cpu" && options.update == Update::deferred;
  if (dense && options.update == Update::eager && body.tets() > 8000) rows.events = {10};
  rows.most_accumulated = options.route == Route::factor ? kLargestBody : deferred ? 8000 : 2000;
  return rows;
}
Index most_accumulated(const PeerKind& kind) {
  if (kind.name.find("updown") != std::string::npos) return kLargestBody;
  const bool sparse = kind.name.find("stale") != std::string::npos ||
                      kind.name.find("supernodal") != std::string::npos;
  return sparse ? 2000 : 0;
}

std::vector<PeerKind> all_peers() {
  std::vector<PeerKind> all = eigen_peers();
  for (const PeerKind& kind : cholmod_peers()) all.push_back(kind);
  return all;
}

void register_rows() {
  for (const BodyShape& body : bodies()) {
    for (const PeerKind& kind : all_peers()) {
      if (body.tets() > kind.most_tets) continue;
      add_rows(body, kind.name,
               [=](const TearingBoard& b) { return std::make_unique<PeerFollower>(b, kind); },
               {.most_accumulated = most_accumulated(kind)});
    }
    for (const Method& method : methods()) {
      add_rows(
          body, method.name,
          [=](const TearingBoard& b) {
            return std::make_unique<BackendFollower>(b, method.options);
          },
          rows_of(method.options, body));
    }
  }
}

/// One line per peer: name, tab, settings.
void list_peers() {
  for (const PeerKind& kind : all_peers()) std::cout << kind.name << '\t' << kind.settings << '\n';
}

void write_matrix(const std::string& path, const linear_algebra::SparseMatrix& matrix, int stype) {
  cholmod_common common;
  cholmod_start(&common);
  cholmod_sparse* sparse = to_cholmod(matrix, stype, common);
  FILE* file = std::fopen(path.c_str(), "w");
  const bool written = file && cholmod_write_sparse(file, sparse, nullptr, nullptr, &common) >= 0;
  const bool closed = file && std::fclose(file) == 0;
  cholmod_free_sparse(&sparse, &common);
  cholmod_finish(&common);
  if (!written || !closed) throw std::runtime_error("cannot write " + path);
}

/// Matrices of one event for bench_peers_alone: intact, damaged, update columns.
void write_event(const std::string& folder, const std::string& name, std::size_t k) {
  for (const BodyShape& body : bodies()) {
    if (body.name != name) continue;
    const TearingBoard& board = board_of(body);
    const auto elements = board.connected(k);
    write_matrix(folder + "/intact.mtx", damaged_stiffness(*board.problem, {}), -1);
    write_matrix(folder + "/damaged.mtx", damaged_stiffness(*board.problem, elements), -1);
    write_matrix(folder + "/columns.mtx", update_columns(*board.problem, elements, {}), 0);
    return;
  }
  throw std::runtime_error("no body is called " + name);
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) try {
  openblas_set_num_threads(1);
  if (argc == 5 && std::string(argv[1]) == "--write") {
    sunder::bench::write_event(argv[2], argv[3], std::stoul(argv[4]));
    return 0;
  }
  if (argc == 2 && std::string(argv[1]) == "--peers") {
    sunder::bench::list_peers();
    return 0;
  }
  sunder::bench::register_rows();
  return sunder::bench::run_rows(argc, argv);
} catch (const std::exception& error) {
  std::cerr << "bench_reconstruction: " << error.what() << '\n';
  return 1;
}
