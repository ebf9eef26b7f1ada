// SPDX-License-Identifier: Apache-2.0
// Columns that a region may grow by, computed beside the frames: where a host destroys or grasps
// beyond route condensed's region, S grows by the unknowns there, and those around are likely next.
// A column has the same bits whoever computes it (Factor::inverse_block), so what is ready is taken
// at once and what is not is solved for: results never depend on how long anything took.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

class RegionGrowth {
 public:
  /// Unknowns around an event whose columns are computed.
  static constexpr std::size_t kUnknowns = 256;

  /// The problem must outlive it. Its thread starts with the first follow().
  explicit RegionGrowth(const Problem& problem) : problem_(problem) {}
  /// Waits for what is in work, some columns at most.
  ~RegionGrowth();
  RegionGrowth(const RegionGrowth&) = delete;
  RegionGrowth& operator=(const RegionGrowth&) = delete;

  /// An event has touched these unknowns, when S had `inside`: what lies around is computed by
  /// `factor`, unless it is there. Of several events that wait the last two count, as of two hands.
  /// Copies its arguments and does nothing else; where there is no memory or thread for it, not
  /// even that.
  void follow(const std::shared_ptr<const linear_algebra::Factor>& factor,
              std::span<const Index> inside, std::span<const Index> touched) noexcept;
  /// factor.inverse_block(rows, unknowns) into `columns`, to the last bit. False, and `columns` is
  /// as it was: not all of it is there.
  [[nodiscard]] bool take(const linear_algebra::Factor& factor, std::span<const Index> rows,
                          std::span<const Index> unknowns, Eigen::MatrixXd& columns);
  /// Another factor comes: holds on to nothing of the last one.
  void forget();
  /// Waits until nothing is in work.
  void wait();
  /// Columns that have been taken so far.
  [[nodiscard]] std::size_t taken() const;
  /// Of what it holds for frames.
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t kHands = 2, kPlaces = 4;

  struct Request {
    std::shared_ptr<const linear_algebra::Factor> factor;
    std::vector<Index> inside, touched;
  };
  /// Columns at rows: S as it was, their own, and those of other places.
  struct Store {
    std::shared_ptr<const linear_algebra::Factor> factor;
    std::vector<Index> unknowns, rows;
    std::vector<Index> place, row;  // of each unknown of the body in these; kNone: it is not there
    Eigen::MatrixXd columns;
    std::size_t done = 0;  // columns that are there
  };
  using Stores = std::vector<std::shared_ptr<Store>>;
  using Lock = std::unique_lock<std::mutex>;

  void run();
  void make(Lock& lock, const Request& request);
  void fill(Lock& lock, Store& store, std::uint64_t age);
  [[nodiscard]] bool serves(const Store& store, const Request& request,
                            std::span<const Index> near) const;
  [[nodiscard]] bool wanted(const Store& store, std::span<const Request> requests) const;
  [[nodiscard]] std::shared_ptr<Store> store_for(const Request& request,
                                                 const Stores& others) const;
  void number_nodes();
  [[nodiscard]] std::vector<Index> around(const Request& request, int rings,
                                          std::size_t most) const;

  const Problem& problem_;
  // The thread's.
  std::vector<Index> first_, elements_;  // of each node: where in elements_ its own begin
  std::vector<Index> node_;              // of each unknown
  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable asked_, done_;
  std::array<Request, kHands> requests_;  // the first waiting_ ones, in order
  std::size_t waiting_ = 0, taken_ = 0;
  bool busy_ = false, quit_ = false;
  std::uint64_t age_ = 0;    // counts forget()
  Stores stores_, dropped_;  // the newest first; what the thread is to free
  std::thread thread_;       // last: it uses all above
};

}  // namespace sunder::solver
